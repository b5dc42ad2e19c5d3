// SPDX-License-Identifier: MIT
//
// intrinsic.h: other triangles on the same surface. Slivers are bad for matrices, not for the surface: an edge that is
// straight in the surface need not be straight in space. Flips to the intrinsic Delaunay triangulation (Bobenko and
// Springborn 2007; Fisher, Springborn, Schroeder and Bobenko 2007) make every sum of cotangents opposite an edge
// positive, and change no length, angle or curvature of the surface. Vertices keep their numbers and know where their
// axes were (signposts: Sharp, Soliman and Crane 2019), so values at vertices carry over.
//
//   const alcap::IntrinsicTriangulation better = alcap::intrinsic_delaunay(surface);
//   const alcap::ConnectedSurface solved = alcap::connect(better.surface);
//   const alcap::Field there = alcap::smoothest_field(solved, {.n = 4}).field;
//   const auto u = better.to_given(there.u, 4);   // in the frames of alcap::connect(surface)
#pragma once

#include <cstdint>
#include <vector>

#include "alcap/surface.h"

namespace alcap {

/// How a surface is triangulated anew. A bad value throws OptionError.
struct IntrinsicOptions {
  std::vector<Index> keep = {};  // edges that stay as they are, such as features; boundary edges always do
  /// Radians, in [0, pi/6]. Above 0: vertices are added until no corner is smaller (Ruppert 1995, in the surface),
  /// where none of the surface's own is: kept and boundary edges that meet at less than 60 degrees, or pointed
  /// vertices. Such edges are split where they need it. 0: no vertex is added. Below 20 degrees it is known to end.
  double min_angle = 0;
  /// In the surface's unit of length: with min_angle, vertices are also added until no triangle's circumcircle is
  /// larger than this. Angles alone leave the middle of a long flat piece to a few large triangles. 0: no bound.
  double max_radius = 0;
  double most_flips = 100;    // per edge; a few are usual
  double most_vertices = 10;  // added, at most so many times the vertices that there are
};

/// How good the triangles of a surface are.
struct TriangleQuality {
  double angle_min = 0;      ///< of all corners, radians
  double angle_max = 0;      ///< of all corners, radians
  double cotangent_min = 0;  ///< smallest sum of the two cotangents opposite an inner edge; below 0: not Delaunay
  Index not_delaunay = 0;    ///< inner edges below 0 by more than rounding
  Index slivers = 0;         ///< faces with a corner below 1 degree
};

/// Measures the triangles of a surface. O(F).
[[nodiscard]] TriangleQuality triangle_quality(const Surface& surface);

/// What intrinsic_delaunay() returns.
struct IntrinsicTriangulation {
  /// The given vertices, then the added ones; it lies in no space, because its edges are not straight there.
  Surface surface;
  Index given_vertices = 0;  ///< how many the given surface has
  /// Of every given vertex: the direction of the first halfedge of `surface` there, radians in the polar angles of the
  /// given surface, which start at its own first halfedge.
  VectorX<double> turn;
  /// For every kept edge, in the order of the option: the vertices along it, from the tail of its halfedge to the tip.
  std::vector<std::vector<Index>> kept;
  TriangleQuality before;  ///< of the given triangles
  TriangleQuality after;   ///< of the new ones
  std::int64_t flips = 0;  ///< all
  Index added = 0;         ///< vertices
  /// Edges that are not Delaunay because a flip would join two vertices twice, or a vertex to itself.
  Index barred = 0;
  bool complete = true;  ///< false: most_flips or most_vertices ended it
  double seconds = 0;    ///< wall clock

  /// Values of an n-field at the vertices of `surface`, relative to a connection made there, as values at the given
  /// vertices relative to the same kind of connection made on the given surface.
  [[nodiscard]] ComplexVectorX<double> to_given(const ComplexVectorX<double>& u, int n) const;
  /// The other way; 0 at added vertices.
  [[nodiscard]] ComplexVectorX<double> from_given(const ComplexVectorX<double>& u, int n) const;
};

/// The intrinsic Delaunay triangulation of a surface, refined if asked for. The result is a simplicial complex: flips
/// that would give two vertices a second edge are left out, and counted. Bitwise the same for any number of threads,
/// and in any unit of length that is a power of two. Throws OptionError. About O(F) where few edges need a flip.
[[nodiscard]] IntrinsicTriangulation intrinsic_delaunay(const Surface& surface, const IntrinsicOptions& options = {});

}  // namespace alcap
