// SPDX-License-Identifier: MIT
//
// curves.h: from traced paths to sets of curves. Internal to streamlines.
#pragma once

#include <vector>

#include "src/curves/streamlines/path.h"

namespace alcap::detail {

struct Curve {
  std::vector<SurfacePoint> points;
  CurveEnd start = CurveEnd::seed, end = CurveEnd::seed;
};

/// Throws OptionError.
void check(const StreamlineOptions& options);

/// Without guard.
[[nodiscard]] PathLimits limits(const Flow& flow, const StreamlineOptions& options);

/// The backward path turned around, then the forward path; the backward one may be empty.
[[nodiscard]] Curve join(const Path& forward, const Path& backward);

[[nodiscard]] CurveSet collect(const Flow& flow, const std::vector<Curve>& curves);

}  // namespace alcap::detail
