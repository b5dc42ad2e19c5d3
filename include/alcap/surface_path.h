// SPDX-License-Identifier: MIT
//
// surface_path.h: points of a surface, given in a face, and polylines on it, cut into segments that each lie inside one
// face. polyline_through() and strokes.h make such polylines, transport.h carries vectors along them.
//
//   alcap::SurfacePoint p{12, {0.2, 0.3, 0.5}};
//   Eigen::RowVector3d x = alcap::position(surface, p);
#pragma once

#include <array>
#include <vector>

#include "alcap/surface.h"

namespace alcap {

/// A point of the surface: barycentric coordinates, summing to 1, in a face.
struct SurfacePoint {
  Index face = none;                    ///< the face
  std::array<double, 3> barycentric{};  ///< its coordinates there
};

/// A straight piece of a path inside one face, of positive length.
struct SurfaceSegment {
  Index face = none;  ///< the face it lies in
  /// Barycentric coordinates of both ends, not negative, summing to 1.
  std::array<double, 3> a{}, b{};  ///< barycentric coordinates of both ends, not negative, summing to 1
  Complex<double> tangent = 1;     ///< unit direction from a to b in the face's frame (halfedge 3 t)
  double length = 0;               ///< its length

  /// Barycentric coordinates at the fraction s in [0, 1] of the way.
  [[nodiscard]] std::array<double, 3> at(double s) const {
    return {(1 - s) * a[0] + s * b[0], (1 - s) * a[1] + s * b[1], (1 - s) * a[2] + s * b[2]};
  }
};

/// Segments in order: each starts where the one before ends, in the same face or across an edge, or, where the path
/// passes through a vertex, in another face of that vertex.
struct SurfacePolyline {
  std::vector<SurfaceSegment> segments;  ///< in order
  bool closed = false;                   ///< the end is the start

  /// The sum of the segments.
  [[nodiscard]] double length() const;
  /// The same line the other way round.
  [[nodiscard]] SurfacePolyline reversed() const;
};

/// Through points, in order, each of which lies in a face with the next one, perhaps on its border: a straight segment
/// inside that face between them. Needs lengths only, no positions. Points closer than 1e-9 of their face to an edge or
/// a vertex are put there, and repeated ones add nothing. Closed when the last point is the first. Throws OptionError,
/// naming them, for bad points and for two in a row that no face holds (stroke_through_points of strokes.h finds those
/// between).
[[nodiscard]] SurfacePolyline polyline_through(const Surface& surface, const std::vector<SurfacePoint>& points);

/// Where a point of the surface lies in space. Throws OptionError when there is no such face, and on a surface that
/// lies in no space.
[[nodiscard]] Eigen::RowVector3d position(const Surface& surface, const SurfacePoint& point);

namespace detail {

/// The point of halfedge h at the fraction s of the way to its tip, in the face of h.
[[nodiscard]] inline SurfacePoint on_halfedge(Index h, double s) {
  SurfacePoint p{Mesh::face(h), {}};
  p.barycentric[static_cast<std::size_t>(h % 3)] = 1 - s;
  p.barycentric[static_cast<std::size_t>(Mesh::next(h) % 3)] = s;
  return p;
}

}  // namespace detail

}  // namespace alcap
