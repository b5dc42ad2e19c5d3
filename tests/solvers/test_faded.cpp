// SPDX-License-Identifier: MIT
//
// Eigenvectors that are localised: where they have faded by many orders of magnitude their equations hold to digits of
// the values there, and directions do not depend on method, backend and tolerance.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "solvers/eigenpair/faded.h"
#include "solvers/eigenpair/problem.h"
#include "tests/solvers/solver_fixture.h"
#include "tests/support/mesh_helpers.h"
#include "tests/support/random_meshes.h"

using namespace alcap;
using namespace alcap::test;

namespace {

/// Spheres joined by necks: the field of the largest hardly leaves it.
Problem chain_of_spheres() {
  Dice dice(1000022);
  return problem_of(families.at("chain")(dice), 5);
}

Problem noisy_ball() {
  Dice dice(1000033);
  return problem_of(families.at("noise")(dice), 3);
}

double root_mean_square(const Problem& p) { return 1 / std::sqrt(p.area); }

/// Largest |row i of (S - lambda M) u| over the sum of the sizes of its terms, of rows that see no value above
/// `ceiling`.
double worst_row(const Problem& p, const EigenResult& r, double ceiling) {
  const Hermitian A = p.S - r.report.lambda * p.M;
  double worst = 0;
  for (Eigen::Index j = 0; j < A.cols(); ++j) {
    Z sum = 0;
    double terms = 0, most = 0;
    for (Hermitian::InnerIterator it(A, j); it; ++it) {
      sum += std::conj(it.value()) * r.u[it.row()];
      terms += std::abs(it.value()) * std::abs(r.u[it.row()]);
      most = std::max(most, std::abs(r.u[it.row()]));
    }
    if (most < ceiling * root_mean_square(p)) worst = std::max(worst, std::abs(sum) / terms);
  }
  return worst;
}

/// The mean difference in direction, in radians, of small entries that are not below `floor`; both have their phases
/// fixed.
double mean_turn(const Problem& p, const EigenResult& a, const EigenResult& b, double floor) {
  double sum = 0, count = 0;
  for (Eigen::Index i = 0; i < a.u.size(); ++i) {
    const double length = std::abs(b.u[i]) / root_mean_square(p);
    if (!(length > floor && length < 1e-5)) continue;
    sum += std::abs(std::arg(a.u[i] * std::conj(b.u[i])));
    ++count;
  }
  REQUIRE(count > 100);
  return sum / count;
}

}  // namespace

TEST_CASE("where an eigenvector has faded its rows hold to digits of the values there, by every method and backend") {
  for (const Problem& p : {chain_of_spheres(), noisy_ball()}) {
    const EigenResult exact = smallest_eigenpair(p.S, p.M, p.area, {.tolerance = 1e-13, .method = "lanczos"});
    REQUIRE(exact.u.cwiseAbs().minCoeff() < 1e-8 * root_mean_square(p));
    std::vector<EigenOptions> ways{{}, {.method = "lobpcg"}, {.method = "lanczos"}};
    for (const std::string solver : {"eigen-ldlt", "multigrid"})
      ways.push_back({.solver = solver, .method = "lanczos"});
    for (const EigenOptions& options : ways) {
      CAPTURE(options.method);
      CAPTURE(options.solver);
      const EigenResult r = smallest_eigenpair(p.S, p.M, p.area, options);
      CHECK(r.report.converged);
      CHECK(r.report.smallest == Smallest::proven);
      CHECK(true_residual(p, r) == doctest::Approx(r.report.residual).epsilon(1e-3));
      // Rows that see no value given from outside.
      CHECK(worst_row(p, r, 1e-4) < 1e-5);
      // To an angle the values around are good to two digits only, of which later ones keep less.
      if (options.tolerance) CHECK(mean_turn(p, r, exact, 1e-25) < 0.01);
    }
  }
}

TEST_CASE("an eigenvector that is large everywhere but at its zeros stays as it is, to the last bit") {
  // Icospheres have zeros at vertices.
  for (const MeshData& mesh :
       {torus_random_diagonals(40, 20, 1, 0.4, 1), jittered_sphere(4, 0.2, 1), icosphere(4), grid(24, 24)}) {
    const Problem p = problem_of(mesh, 4);
    const EigenProblem problem{.S = p.S, .M = p.M, .area = p.area};
    const EigenResult before = detail::smallest_lanczos(problem, {});
    EigenResult after = before;
    detail::restore_faded(problem, {}, after);
    CHECK(after.u == before.u);
  }
}

TEST_CASE("a vector that is not the smallest, or did not converge, is not made worse") {
  const Problem p = chain_of_spheres();
  const EigenProblem problem{.S = p.S, .M = p.M, .area = p.area};
  const EigenModes modes = eigenpairs(p.S, p.M, p.area, 4);
  for (Eigen::Index k = 0; k < modes.U.cols(); ++k) {
    EigenResult mode{.u = modes.U.col(k), .report = {}};
    detail::conclude(problem, {}, mode);
    EigenResult after = mode;
    detail::restore_faded(problem, {}, after);
    CHECK(after.report.converged == mode.report.converged);
    CHECK(after.report.distance <= 2 * mode.report.distance + 1e-12);
    CHECK(std::abs(after.report.lambda - mode.report.lambda) <= 1e-9 * mode.report.lambda);
  }
  EigenResult rough = detail::smallest_lanczos(problem, {});
  rough.report.converged = false;
  EigenResult after = rough;
  detail::restore_faded(problem, {}, after);
  CHECK(after.u == rough.u);
}
