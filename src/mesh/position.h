// SPDX-License-Identifier: MIT
//
// position.h: points of a surface in space, for inner loops.
#pragma once

#include "alcap/surface_path.h"

namespace alcap::detail {

/// What alcap::position() gives, without its checks. V is #V x 3.
[[nodiscard]] inline Eigen::RowVector3d position(const Mesh& mesh, const Positions<double>& V,
                                                 const SurfacePoint& point) {
  const auto& [t, b] = point;
  return b[0] * V.row(mesh.F()(t, 0)) + b[1] * V.row(mesh.F()(t, 1)) + b[2] * V.row(mesh.F()(t, 2));
}

}  // namespace alcap::detail
