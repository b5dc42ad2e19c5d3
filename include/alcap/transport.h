// SPDX-License-Identifier: MIT
//
// transport.h: parallel transport of a vector, or of an n-vector, along a path on the surface (LTGD 2016, Secs. 2 and
// 4.1): along edges from vertex to vertex, from point to point through faces, along a polyline, or along a traced
// curve.
//
//   const auto path = alcap::shortest_path(surface, from, to);
//   const alcap::Transported there = alcap::transport(connected, path, u[from], n);   // compare with u[to]
//   const auto along = alcap::transport(connected, curves.path(0), 1.0);              // a curve of streamlines.h
//   const auto loop = alcap::stroke_through_points(connected, points);   // its last point is its first
//   const double enclosed = 2 * pi + alcap::transport(connected, loop, 1.0).turn_from_path;   // curvature inside
//
// Everything has a closed form. Along an edge components turn by -rho_ij. Inside a face the connection is the Whitney
// 1-form tau_ij (phi_i dphi_j - phi_j dphi_i) + ..., so along a straight segment from barycentric a to b they turn by
// minus the sum of tau_ij (a_i b_j - a_j b_i) over the halfedges. From face to face they turn by the difference of
// rho_{e->t} at the crossed point of the edge, of rho_{v->t} at a vertex. Around a closed path that bounds a disk on
// its left a vector turns by the curvature inside, of which every face has K_t, spread evenly.
#pragma once

#include <span>
#include <vector>

#include "alcap/connected_surface.h"
#include "alcap/surface_path.h"

namespace alcap {

/// What became of a vector on its way.
struct Transported {
  Complex<double> z;  ///< the component in the frame at the end: z_start exp(i n turn)
  /// Radians, counter-clockwise, for n = 1: how far the component has turned against the frames on the way. A true
  /// angle inside a face; where frames change only its value modulo 2 pi means something.
  double turn = 0;
  /// Radians, counter-clockwise, for n = 1: how far the vector has turned against the direction of the path, which does
  /// not depend on frames; on a closed path it includes the corner at the start. Minus the total turn of the path as
  /// the connection sees it, each of its corners in [-pi, pi]. A closed path that bounds a disk on its left has 2 pi
  /// less than the curvature of the disk, without any modulus.
  double turn_from_path = 0;
};

/// Along edges: each vertex is joined with the next one, repeated vertices stand still. z is in the frame of the first
/// vertex, the result in that of the last, n the degree of the field that z is a value of (z = w^n for a vector w). The
/// path is closed when its last vertex is the first. Throws OptionError for an empty path, numbers that are not
/// vertices, and, naming them, vertices that no edge joins (shortest_path.h finds those between them).
[[nodiscard]] Transported transport(const ConnectedSurface& surface, const std::vector<Index>& vertices,
                                    Complex<double> z, int n = 1);

/// Along a polyline. z is in the frame of the face of the first segment, the result in that of the last one; where the
/// path is closed, in that of the first one again. At a vertex v, z exp(-i n rho_t[c]) in the face is z in the frame of
/// v, c the face's corner there. Throws OptionError for an empty path, a segment in no face, and, naming it, a
/// segment that does not start (to 1e-6 of its face) where the one before ends.
[[nodiscard]] Transported transport(const ConnectedSurface& surface, const SurfacePolyline& path, Complex<double> z,
                                    int n = 1);

/// From point to point, each of which lies in a face with the next one, on straight segments inside these faces (see
/// polyline_through); CurveSet::path() gives such points. z is in the frame of the face that the first point names, the
/// result in that of the last one's. The path is closed when the last point is the first. Throws OptionError as
/// polyline_through.
[[nodiscard]] Transported transport(const ConnectedSurface& surface, std::span<const SurfacePoint> points,
                                    Complex<double> z, int n = 1);

}  // namespace alcap
