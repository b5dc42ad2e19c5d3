// SPDX-License-Identifier: MIT
//
// polar.cpp: the connection of geodesic polar maps (LTGD 2016, Sec. 5.1).
#include "alcap/connection.h"
#include "src/connection/construction.h"

namespace alcap {

Connection polar(const Mesh& mesh, const Geometry& geometry, const PolarOptions& options) {
  detail::LiftedResiduals residuals;
  Connection c = detail::polar_start(mesh, geometry, options.center, residuals);
  c.kind = ConnectionKind::polar;
  c.center = options.center;
  measure_deviation(mesh, geometry, {}, c);
  return c;
}

}  // namespace alcap
