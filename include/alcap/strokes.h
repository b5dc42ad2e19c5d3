// SPDX-License-Identifier: MIT
//
// strokes.h: polylines on the surface, cut into segments that each lie inside one face. Strokes that fields are aligned
// with come from points on faces, from paths of vertices, or from polylines in space.
//
//   auto line = alcap::stroke_through_points(surface, {{12, {0.2, 0.3, 0.5}}, {840, {0.1, 0.1, 0.8}}});
//   auto edges = alcap::stroke_along_vertices(surface, {0, 17, 55});
//   auto drawn = alcap::stroke_from_space(surface, points);    // #points x 3, anywhere near the surface
//   for (const alcap::SurfaceSegment& s : line.segments) { ... s.face, s.tangent, s.length ... }
//
// Between two points a stroke follows the plane that holds both and the mean of their faces' normals, from face to
// face. A stroke built backwards is the same stroke reversed, bit for bit.
#pragma once

#include <array>
#include <vector>

#include "alcap/geometry.h"
#include "alcap/mesh.h"

namespace alcap {

class Surface;

/// A point of the surface: barycentric coordinates, summing to 1, in a face.
struct SurfacePoint {
  Index face = none;
  std::array<double, 3> barycentric{};
};

/// A straight piece of a stroke inside one face, of positive length.
struct SurfaceSegment {
  Index face = none;
  std::array<double, 3> a{}, b{};  ///< barycentric coordinates of both ends, not negative, summing to 1
  Complex<double> tangent = 1;     ///< unit direction from a to b in the face's frame (halfedge 3 t)
  double length = 0;

  /// Barycentric coordinates at the fraction s in [0, 1] of the way.
  [[nodiscard]] std::array<double, 3> at(double s) const {
    return {(1 - s) * a[0] + s * b[0], (1 - s) * a[1] + s * b[1], (1 - s) * a[2] + s * b[2]};
  }
};

/// Segments in order: each starts where the one before ends, in the same face or across an edge, or, where the stroke
/// passes through a vertex, in another face of that vertex.
struct SurfacePolyline {
  std::vector<SurfaceSegment> segments;
  bool closed = false;  ///< the end is the start

  [[nodiscard]] double length() const;
  [[nodiscard]] SurfacePolyline reversed() const;
};

/// Through points on faces, in order. Points closer than 1e-9 of their face to an edge or a vertex are put there;
/// repeated points count once. A last point equal to the first closes the stroke. Throws OptionError for bad points,
/// for fewer than two different ones, and, naming the two points, where the stroke leaves the surface (at a boundary,
/// or because the two lie on different components or the plane misses the second one: points between them help).
[[nodiscard]] SurfacePolyline stroke_through_points(const Surface& surface, const std::vector<SurfacePoint>& points);

/// Along edges. Consecutive vertices that no edge joins are joined by a shortest path of edges (Dijkstra 1959). Throws
/// OptionError for vertices that no face uses, fewer than two different ones, or two on different components.
[[nodiscard]] SurfacePolyline stroke_along_vertices(const Surface& surface, const std::vector<Index>& vertices);

/// Closest points on a mesh, by a tree of boxes. O(F log F) to build; queries are const, fit for several threads.
class SurfaceLocator {
 public:
  /// Copies what it needs. Throws OptionError on a surface that lies in no space.
  explicit SurfaceLocator(const Surface& surface);
  /// The point of the surface that is closest to `point`; among equals the one in the smallest face. O(log F) usually.
  /// Throws OptionError when `point` is not finite or beyond 1e150.
  [[nodiscard]] SurfacePoint closest(const Eigen::RowVector3d& point) const;

 private:
  struct Box {
    Eigen::RowVector3d low, high;
    Index begin = 0, end = 0;  // triangles of a leaf
    Index right = none;        // the second child; the first one is next in the array; none in a leaf
  };
  Index build(Index begin, Index end);
  std::vector<Box> boxes_;
  std::vector<Index> order_;                                // faces in the order of the leaves
  std::vector<std::array<Eigen::RowVector3d, 3>> corners_;  // of every face
};

/// A polyline in space (one point a row), each point moved to the closest one of the surface, then as
/// stroke_through_points(). The second form uses a locator made before.
[[nodiscard]] SurfacePolyline stroke_from_space(const Surface& surface, const Positions<double>& points);
[[nodiscard]] SurfacePolyline stroke_from_space(const Surface& surface, const SurfaceLocator& locator,
                                                const Positions<double>& points);

}  // namespace alcap
