// SPDX-License-Identifier: MIT
//
// What is left at an angle of 0.01 degrees and a connection to 1e-6: against a run with everything solved to ten digits
// and more.
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "alcap/energies.h"
#include "alcap/field_run.h"
#include "alcap/generators.h"
#include "tests/support/angles.h"

using namespace alcap;
using namespace alcap::test;

namespace {

FieldRun usual(const MeshData& m, int n) {
  FieldRunOptions options{.n = n};
  options.connection.global.tolerance = 1e-6;
  options.eigen.angle_tolerance = 0.01;
  return run_field(m.V, m.F, options);
}

FieldRun precise(const MeshData& m, int n) {
  FieldRunOptions options{.n = n};
  options.connection.global.tolerance = 1e-12;
  options.eigen.tolerance = 1e-11;
  return run_field(m.V, m.F, options);
}

}  // namespace

TEST_CASE("an angle and a connection to six digits: directions to 0.01 degrees, the same singularities") {
  MeshData squeezed = noisy_scan(4, 0.2, 3);
  squeezed.V.col(2) *= 0.3;
  const std::vector<MeshData> surfaces{noisy_scan(4, 0.3, 1),
                                       noisy_scan(5, 0.1, 2),
                                       squeezed,
                                       bumpy_sphere(4, 0.3, 5),
                                       torus_random_diagonals(80, 30, 1, 0.4, 2),
                                       genus_surface(2, 6),
                                       disk(24)};
  for (std::size_t s = 0; s < surfaces.size(); ++s)
    for (const int n : {1, 4}) {
      CAPTURE(s);
      CAPTURE(n);
      const FieldRun run = usual(surfaces[s], n);
      const FieldRun exact = precise(surfaces[s], n);
      REQUIRE(run.certificate.holds());
      const EigenReport& eigen = run.eigen[0];
      const double K = exact.connection().K.norm();
      CHECK((run.connection().K - exact.connection().K).norm() <= 1e-5 * K + 1e-12);
      // A pair of equally smooth fields may come out in any mixture.
      if (!eigen.next || *eigen.next - eigen.lambda < 1e-3 * *eigen.next) continue;
      CHECK(run.certificate.angle.value() <= 0.01);
      CHECK(run.certificate.angle_check == AngleCheck::bounded);
      CHECK(run.indices == exact.indices);
      const StiffnessMass m = energy_matrices(run.mesh(), run.geometry(), exact.connection(), n, 0.0);
      const AngleError error = angle_error(m.M, run.geometry().total_area(), run.field.u, exact.field.u, n);
      CHECK(error.rms <= 0.01);
      CHECK(error.vertices <= eigen.angle_at_vertices.value() + 0.01);
    }
}
