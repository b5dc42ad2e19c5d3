// SPDX-License-Identifier: MIT
//
// trace.h: from one point of a mesh to another along a cutting plane, and strokes of such steps. Internal to strokes
// and src/distributed.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "alcap/strokes.h"

namespace alcap::detail {

/// A straight step inside a face.
struct Step {
  Index face = none;
  std::array<double, 3> a{}, b{};
};

/// The steps from `from` to `to`, or nothing when no plane leads there. Steps may have no length. Never loops: the
/// plane crosses each face at most once.
[[nodiscard]] std::optional<std::vector<Step>> trace(const Mesh& mesh, const Positions<double>& V,
                                                     const SurfacePoint& from, const SurfacePoint& to);

/// The ends of a trace in space, with the normals of their faces.
struct TraceEnds {
  Eigen::RowVector3d from, to, from_normal, to_normal;
};
[[nodiscard]] TraceEnds ends_of(const Mesh& mesh, const Positions<double>& V, const SurfacePoint& from,
                                const SurfacePoint& to);
/// Sets marks[t] for the faces t that a trace between these ends may enter, besides those around the ends.
void mark_crossed(const Mesh& mesh, const Positions<double>& V, const TraceEnds& ends, std::vector<char>& marks);

/// The points of a stroke, checked, repeated ones once, and their places among those given.
struct StrokePoints {
  std::vector<SurfacePoint> at;
  std::vector<std::size_t> number;
};
/// Throws OptionError as stroke_through_points() does.
[[nodiscard]] StrokePoints distinct_points(const Mesh& mesh, const std::vector<SurfacePoint>& points);
/// Of two points, whether the trace between them is to start at the second one: always at the smaller, so that a
/// reversed stroke is the same.
[[nodiscard]] bool traced_backwards(const SurfacePoint& p, const SurfacePoint& q);
/// stroke_through_points(). connected(k): whether points k and k + 1 lie on one component. The mesh may be a part that
/// has all faces which mark_crossed() marks, and those around the points.
[[nodiscard]] SurfacePolyline stroke_through(const Mesh& mesh, const Positions<double>& V, const Geometry& geometry,
                                             const StrokePoints& points,
                                             const std::function<bool(std::size_t k)>& connected);

}  // namespace alcap::detail
