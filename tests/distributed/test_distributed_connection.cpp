// SPDX-License-Identifier: MIT
//
// The pieces of connections on every rank's patch against those of one machine, number by number.
#include "src/distributed/connect.h"
#include "tests/distributed/ranks_fixture.h"

using namespace alcap;
using namespace alcap::test;

TEST_CASE("curvature, rotations and directions of core faces are those of one machine") {
  for (const MeshData& data :
       {noisy_scan(3, 0.3, 7), side_by_side({bumpy_sphere(3, 0.4, 3), disk(8)}), cad_like(20, 5)})
    for (const ConnectionKind kind : {ConnectionKind::polar, ConnectionKind::local, ConnectionKind::global}) {
      CAPTURE(std::string(name(kind)));
      const double tolerance = kind == ConnectionKind::global ? 1e-10 : 1e-15;
      const OneMachine one(data, kind, 1);
      const detail::petsc::Session session;
      auto part = detail::distributed::make_patch(slice_of(data.V, data.F), PartitionMethod::scotch);
      const auto& patch = part.patch;
      detail::distributed::measure(part.patch);
      const auto components = detail::distributed::find_components(patch);
      const Connection c = detail::distributed::connect(patch, components, {.connection = {kind}});
      const double scale = std::max(1.0, one.connection.K.cwiseAbs().maxCoeff());
      double K = 0, tau = 0, rho = 0, rho_t = 0, rho_e = 0;
      for (Index t = 0; t < patch.mesh.faces(); ++t) {
        if (patch.core[static_cast<std::size_t>(t)] == 0) continue;
        const Index T = patch.face[static_cast<std::size_t>(t)];
        K = std::max(K, std::abs(c.K[t] - one.connection.K[T]));
        for (Index k = 0; k < 3; ++k) {
          const Index h = 3 * t + k, H = 3 * T + k;
          tau = std::max(tau, std::abs(c.tau[h] - one.connection.tau[H]));
          rho = std::max(rho, std::abs(wrap(c.rho_along(patch.mesh, h) - one.connection.rho_along(one.mesh, H))));
          rho_t = std::max(rho_t, std::abs(wrap(c.rho_t[h] - one.connection.rho_t[H])));
          rho_e = std::max(rho_e, std::abs(wrap(c.rho_start(patch.mesh, h) - one.connection.rho_start(one.mesh, H))));
        }
      }
      CHECK(K <= tolerance * scale);
      CHECK(tau <= 10 * tolerance * scale);
      CHECK(rho <= 10 * tolerance * scale);
      CHECK(rho_t <= 100 * tolerance * scale);
      CHECK(rho_e <= 100 * tolerance * scale);
    }
}
