// SPDX-License-Identifier: MIT
//
// The bound of a field's angle: held against a solve to the last digits, on all families, methods and tolerances.
#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "alcap/errors.h"
#include "alcap/generators.h"
#include "alcap/solve.h"
#include "solvers/eigenpair/problem.h"
#include "src/base/parallel.h"
#include "tests/solvers/solver_fixture.h"
#include "tests/support/angles.h"
#include "tests/support/mesh_helpers.h"

using namespace alcap;
using namespace alcap::test;

namespace {

std::vector<MeshData> surfaces() {
  MeshData squeezed = noisy_scan(4, 0.2, 3);
  squeezed.V.col(2) *= 0.3;
  return {jittered_sphere(4, 0.2, 1),
          bumpy_sphere(4, 0.3, 5),
          squeezed,
          disk(24),
          cylinder(40, 36),
          torus_random_diagonals(60, 24, 1, 0.4, 2),
          noisy_scan(4, 0.2, 7),
          genus_surface(2, 6),
          cad_like(24, 40)};
}

EigenResult solved(const Problem& p, const EigenOptions& options) {
  return smallest_eigenpair(p.S, p.M, p.area, options);
}

// Where the bound says something, the truth is below; with `asked`, what was asked for is kept.
void hold_against(const Problem& p, const EigenResult& r, const EigenResult& exact, int n) {
  const AngleError error = angle_error(p.M, p.area, r.u, exact.u, n);
  constexpr double rounding = 1e-6;  // degrees: what the exact one is off itself
  CHECK(std::abs(r.report.lambda - exact.report.lambda) <= r.report.distance + 1e-9 * exact.report.lambda);
  CHECK(r.report.angle.has_value() == (r.report.angle_check != AngleCheck::unknown));
  CHECK(r.report.angle_at_vertices.has_value() == r.report.angle.has_value());
  if (!r.report.angle || r.report.angle_check != AngleCheck::bounded) return;
  CHECK(error.rms <= *r.report.angle + rounding);
  CHECK(error.vertices <= *r.report.angle_at_vertices + rounding);
}

}  // namespace

TEST_CASE("the angle that is reported is above the true one, whatever the method and the tolerance") {
  int bounded = 0, by_angle = 0;
  std::size_t s = 0;
  for (const MeshData& surface : surfaces()) {
    for (const int n : {1, 4}) {
      CAPTURE(s);
      CAPTURE(n);
      const Problem p = problem_of(surface, n);
      const EigenResult exact = solved(p, {.tolerance = 1e-12, .degree = n, .method = "lanczos"});
      REQUIRE(exact.report.smallest == Smallest::proven);
      const EigenResult usual = solved(p, {.angle_tolerance = 0.01, .degree = n});
      CHECK(usual.report.converged);
      CHECK(within_tolerance(usual.report, {.angle_tolerance = 0.01, .degree = n}));
      CHECK((usual.report.residual <= 1e-8 || usual.report.angle.value() <= 0.01));
      hold_against(p, usual, exact, n);
      by_angle += usual.report.residual > 1e-8 ? 1 : 0;
      for (const char* method : {"lobpcg", "inverse-iteration"})
        for (const double tolerance : {1e-2, 1e-4, 1e-6}) {
          const EigenResult r = solved(p, {.tolerance = tolerance, .degree = n, .method = method});
          hold_against(p, r, exact, n);
          bounded += r.report.angle_check == AngleCheck::bounded ? 1 : 0;
        }
    }
    ++s;
  }
  CHECK(bounded >= 40);  // of 108: clusters and loose tolerances leave no bound
  CHECK(by_angle >= 8);  // of 18
}

TEST_CASE("a residual that is asked for is reached, whatever the angle") {
  const Problem p = problem_of(noisy_scan(4, 0.2, 7), 4);
  for (const double tolerance : {1e-3, 1e-6, 1e-10}) {
    const EigenResult r = solved(p, {.tolerance = tolerance, .angle_tolerance = 5, .degree = 4});
    CHECK(r.report.converged);
    CHECK(true_residual(p, r) <= tolerance);
  }
  const EigenResult fixed = solved(p, {.angle_tolerance = 0});
  CHECK(true_residual(p, fixed) <= 1e-8);
}

TEST_CASE("a smaller angle is reached, and takes no fewer steps") {
  const Problem p = problem_of(noisy_scan(5, 0.2, 7), 4);
  int before = 0;
  for (const double degrees : {1.0, 0.01, 1e-4}) {
    const EigenResult r = solved(p, {.angle_tolerance = degrees, .degree = 4});
    CHECK(r.report.angle.value() <= degrees);
    CHECK(r.report.iterations >= before);
    before = r.report.iterations;
  }
}

TEST_CASE("where the eigenvalue is multiple the angle is that to the space of its vectors") {
  const Problem p = problem_of(icosphere(4), 1);  // three-fold
  const EigenModes exact = eigenpairs(p.S, p.M, p.area, 4, {.tolerance = 1e-12, .method = "lanczos"});
  REQUIRE(exact.lambda[2] < exact.lambda[0] * (1 + 1e-9));
  REQUIRE(exact.lambda[3] > exact.lambda[0] * 1.1);
  const Dense space = exact.U.leftCols(3);
  for (const char* method : {"lobpcg", "lanczos", "inverse-iteration"})
    for (const double asked : {1.0, 0.01, 0.001}) {
      const EigenResult r = solved(p, {.angle_tolerance = asked, .method = method});
      CHECK(r.report.converged);
      CHECK(r.report.angle_check == AngleCheck::of_many);
      CHECK(r.report.angle.value() <= asked);
      const double inside = (space.adjoint() * (p.M * r.u)).norm();
      const double off = std::sqrt(std::max(0.0, 1 - inside * inside)) * 180 / pi<double>;
      CHECK(off <= *r.report.angle + 1e-6);
    }
  // Without a second eigenvalue, too: the bound counts on nothing.
  const EigenResult alone = solved(p, {.angle_tolerance = 0.01, .prove_smallest = Prove::never});
  CHECK(alone.report.angle_check == AngleCheck::of_many);
}

TEST_CASE("the distance is the residual in the norm of the inverse mass") {
  for (const int n : {1, 3}) {
    const Problem p = problem_of(noisy_scan(3, 0.3, 2), n);
    for (const double tolerance : {1e-1, 1e-5}) {
      const EigenResult r = solved(p, {.tolerance = tolerance, .method = "inverse-iteration"});
      const Dense residual = p.S * r.u - r.report.lambda * (p.M * r.u);
      const Dense solution = Dense(p.M).ldlt().solve(residual);
      const double truth = std::sqrt((residual.adjoint() * solution)(0, 0).real());
      CHECK(r.report.distance >= truth * (1 - 1e-9) - 1e-14);
      CHECK(r.report.distance <= 1.1 * truth + 1e-12);
    }
  }
}

TEST_CASE("angles do not depend on threads") {
  const Problem p = problem_of(noisy_scan(5, 0.2, 3), 4);
  EigenResult one, two;
  run_with_threads(1, [&] { one = solved(p, {.angle_tolerance = 0.01, .degree = 4}); });
  run_with_threads(2, [&] { two = solved(p, {.angle_tolerance = 0.01, .degree = 4}); });
  CHECK(one.u == two.u);
  CHECK(one.report.angle == two.report.angle);
  CHECK(one.report.angle_at_vertices == two.report.angle_at_vertices);
  CHECK(one.report.distance == two.report.distance);
}

TEST_CASE("angles that make no sense are refused") {
  const Problem p = problem_of(icosphere(2), 1);
  for (const double degrees :
       {-1.0, 90.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    CHECK_THROWS_AS(static_cast<void>(solved(p, {.angle_tolerance = degrees})), OptionError);
  CHECK_THROWS_AS(static_cast<void>(solved(p, {.degree = 0})), OptionError);
}
