// SPDX-License-Identifier: MIT
//
// triangle_frame.h: what the kernels need to know of one face of a connection.
#pragma once

#include "alcap/connection.h"
#include "kernels/basis.h"

namespace alcap::detail {

[[nodiscard]] inline kernels::TriangleFrame<double> triangle_frame(const Mesh& mesh, const Geometry& geometry,
                                                                   const Connection& connection, Index t) {
  kernels::TriangleFrame<double> frame;
  kernels::Cplx<double> edge[3];
  for (Index c = 0; c < 3; ++c) {
    const Index h = 3 * t + c;
    frame.rho[c] = connection.rho_t[h];
    frame.tau[c] = connection.tau[h];
    const double length = geometry.length(mesh.edge(h)), angle = geometry.direction(h);
    edge[c] = {length * std::cos(angle), length * std::sin(angle)};
  }
  kernels::hat_gradients(edge, geometry.area(t), frame.grad);
  return frame;
}

}  // namespace alcap::detail
