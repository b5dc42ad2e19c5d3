// SPDX-License-Identifier: MIT
//
// closest.h: the closest point of one triangle. Internal.
#pragma once

#include <Eigen/Core>
#include <array>

namespace alcap::detail {

/// Barycentric coordinates of the point of a triangle closest to x, and the square of its distance: the foot of the
/// perpendicular, or the best of the three edges' closest points when the foot is outside.
[[nodiscard]] std::array<double, 3> closest_in(const std::array<Eigen::RowVector3d, 3>& p, const Eigen::RowVector3d& x,
                                               double& squared);

}  // namespace alcap::detail
