// SPDX-License-Identifier: MIT
//
// path.h: one curve of a field from a point, face by face. Internal to streamlines.
#pragma once

#include <functional>
#include <vector>

#include "src/curves/streamlines/chart.h"

namespace alcap::detail {

/// A point as the segment before it and the segment behind it see it.
struct PathPoint {
  Index face = none;
  Barycentric b{};
  Index next_face = none;
  Barycentric next_b{};
  double arc = 0;  ///< length from the start
};

struct Path {
  std::vector<PathPoint> points;  ///< the start first, at least this
  CurveEnd end = CurveEnd::stuck;
  std::int64_t work = 0;  ///< steps of the integration and crossings of edges that it took
  [[nodiscard]] double length() const { return points.back().arc; }
};

/// Lengths in the units of the mesh.
struct PathLimits {
  double length = 0;        ///< of the curve at most
  double tolerance = 1e-6;  ///< of a step, relative to it
  double zero_radius = 0;   ///< the curve ends this close to a zero
  double sample_step = 0;   ///< how often the guard is asked; 0: never
  double close_within = 0;  ///< a curve that passes its start at less than this, with its direction, ends there
  std::int64_t work = 0;    ///< at most so many steps and crossings, as Path::work counts them
};

/// Asked at the start, and then every sample_step: may the curve go on to here?
using Guard = std::function<bool(const FaceChart& chart, const Barycentric& b, const Cplx& v, double arc)>;

/// The curve from a point in direction v, which need not be exactly a branch; with sign -1 along branches of -u for odd
/// n, that is, against the field. Always ends.
[[nodiscard]] Path trace_path(const Flow& flow, const SurfacePoint& start, const Cplx& v, int sign,
                              const PathLimits& limits, const Guard& guard = {});

}  // namespace alcap::detail
