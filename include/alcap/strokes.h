// SPDX-License-Identifier: MIT
//
// strokes.h: polylines on the surface (surface_path.h). Strokes that fields are aligned with come from points on faces,
// from paths of vertices, or from polylines in space.
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
#include "alcap/surface_path.h"

namespace alcap {

/// Through points on faces, in order. Points closer than 1e-9 of their face to an edge or a vertex are put there;
/// repeated points count once. A last point equal to the first closes the stroke. Throws OptionError for bad points,
/// for fewer than two different ones, and, naming the two points, where the stroke leaves the surface (at a boundary,
/// or because the two lie on different components or the plane misses the second one: points between them help).
[[nodiscard]] SurfacePolyline stroke_through_points(const Surface& surface, const std::vector<SurfacePoint>& points);

/// Along edges. Consecutive vertices that no edge joins are joined by a shortest path of edges (shortest_path.h).
/// Throws OptionError for vertices that no face uses, fewer than two different ones, or two on different components.
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
