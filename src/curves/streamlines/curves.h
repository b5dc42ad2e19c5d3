// SPDX-License-Identifier: MIT
//
// curves.h: from traced paths to sets of curves. Internal to streamlines.
#pragma once

#include <algorithm>
#include <vector>

#include "src/curves/streamlines/path.h"

namespace alcap::detail {

struct Curve {
  std::vector<SurfacePoint> points;
  CurveEnd start = CurveEnd::seed, end = CurveEnd::seed;
};

/// Throws OptionError.
void check(const StreamlineOptions& options);

/// Without guard and without work.
[[nodiscard]] PathLimits limits(const Flow& flow, const StreamlineOptions& options);

/// What a curve of full length costs on a usual mesh, in samples of CurveBudget.
[[nodiscard]] inline double usual_work(const Flow& flow, const StreamlineOptions& options) {
  return 16 + 2 * options.max_length * flow.diagonal() / flow.mean_edge();
}

/// The work (Path::work) that curves may cost, all together and each.
class CurveBudget {
 public:
  /// With so many samples of all curves and of a single one, whatever the size of the faces.
  CurveBudget(const Flow& flow, const StreamlineOptions& options, double all_samples, double samples);

  /// For each of so many paths that are traced at the same time.
  [[nodiscard]] std::int64_t each_of(std::int64_t paths) const {
    return std::max(least_, std::min(curve_, left_ / std::max<std::int64_t>(1, paths)));
  }
  void spend(std::int64_t work) { left_ -= work; }
  [[nodiscard]] bool used_up() const { return left_ <= 0; }
  /// How many samples of other curves may be looked at, all together, to keep curves apart.
  [[nodiscard]] std::int64_t looks() const { return looks_; }

 private:
  std::int64_t least_, curve_, left_, looks_;
};

/// The backward path turned around, then the forward path; the backward one may be empty.
[[nodiscard]] Curve join(const Path& forward, const Path& backward);

[[nodiscard]] CurveSet collect(const Flow& flow, const std::vector<Curve>& curves);

}  // namespace alcap::detail
