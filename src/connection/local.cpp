// SPDX-License-Identifier: MIT
//
// local.cpp: the locally optimal connection (LTGD 2016, Sec. 5.2).
#include "alcap/connection.h"
#include "src/base/parallel.h"
#include "src/connection/construction.h"

namespace alcap {

void detail::optimise_locally(const Mesh& mesh, Connection& c, LiftedResiduals& r) {
  // Fixing each corner in turn makes all tau equal -K/3 (LTGD 2016, eq. 13); the mean of the three solutions turns
  // corner i by (tau_ij - tau_ki) / 3.
  parallel_for(mesh.faces(), [&](std::int64_t t) {
    const Index h = static_cast<Index>(3 * t);
    const double tau[3] = {c.tau[h], c.tau[h + 1], c.tau[h + 2]};
    for (Index k = 0; k < 3; ++k) {
      const double turn = (tau[k] - tau[(k + 2) % 3]) / 3;
      c.rho_t[h + k] += turn;
      r.start[h + k] += turn;
      r.end[h + (k + 2) % 3] += turn;
    }
  });
  close_faces(mesh, r, c);
}

Connection locally_optimal(const Mesh& mesh, const Geometry& geometry) {
  detail::LiftedResiduals residuals;
  Connection c = detail::polar_start(mesh, geometry, PolarCenter::incenter, residuals);
  detail::optimise_locally(mesh, c, residuals);
  c.kind = ConnectionKind::local;
  measure_deviation(mesh, geometry, {}, c);
  return c;
}

}  // namespace alcap
