// SPDX-License-Identifier: MIT
#include "src/connection/global/gauge.h"

#include "src/base/parallel.h"

namespace alcap::detail {

VectorX<double> mean_turns(const Mesh& mesh, const Geometry& geometry, const Array<double>& corners) {
  VectorX<double> turn(mesh.vertices());
  parallel_for(mesh.vertices(), [&](std::int64_t v) {
    double sum = 0, weight = 0;
    mesh.for_each_outgoing(static_cast<Index>(v), [&](Index h) {
      sum += geometry.angle(h) * corners[h];
      weight += geometry.angle(h);
    });
    turn[v] = weight > 0 ? sum / weight : 0.0;
  });
  return turn;
}

}  // namespace alcap::detail
