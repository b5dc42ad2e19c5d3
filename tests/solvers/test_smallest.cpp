// SPDX-License-Identifier: MIT
//
// Whether the eigenpair that is returned is the smallest one where nobody counts eigenvalues: localised vectors, which
// coarse levels put into a wrong order; the search that takes the place of a proof; and pairs that are none.
#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "alcap/backends.h"
#include "alcap/connection.h"
#include "alcap/control.h"
#include "alcap/solve.h"
#include "solvers/eigenpair/patches.h"
#include "tests/solvers/solver_fixture.h"
#include "tests/support/mesh_helpers.h"
#include "tests/support/random_meshes.h"

using namespace alcap;
using namespace alcap::test;

namespace {

Problem on(const MeshData& surface, int n) {
  const MeshCase s(surface);
  return problem_of(s, globally_optimal(s.mesh, s.geometry), n);
}

/// Spheres whose radii differ by a few percent.
MeshData uneven_chain(int count, std::uint64_t seed) {
  Dice dice(seed);
  std::vector<double> radii;
  for (int k = 0; k < count; ++k) radii.push_back(1 + 0.03 * dice.normal());
  return chain_of(radii, 12, 12, 0.15);
}

void check_smallest_without_proof(const Problem& p) {
  const EigenReport r =
      smallest_eigenpair(p.S, p.M, p.area, {.method = "lobpcg", .prove_smallest = Prove::never}).report;
  CHECK(r.converged);
  CHECK(r.smallest == Smallest::not_checked);
  CHECK(inertia(p.S, p.M, r.lambda * (1 - 2e-6)).below == 0);
  CHECK(inertia(p.S, p.M, r.lambda * (1 + 2e-6)).below >= 1);
}

EigenProblem as_problem(const Problem& p) { return {.S = p.S, .M = p.M, .area = p.area, .transport = &p.M}; }

}  // namespace

TEST_CASE("LOBPCG finds the smallest of many localised states by itself: scans") {
  for (const int n : {4, 8}) check_smallest_without_proof(on(noisy_scan(5, 0.5, 1), n));
}

TEST_CASE("LOBPCG finds the smallest of many localised states by itself: chains of spheres") {
  for (const int n : {2, 5, 6}) check_smallest_without_proof(on(uneven_chain(60, 7), n));
}

TEST_CASE("LOBPCG finds the smallest of many localised states by itself: more rows than one patch") {
  // Patches of the finest mesh, and those of a coarser level.
  check_smallest_without_proof(on(uneven_chain(180, 3), 5));
  check_smallest_without_proof(on(cad_like(384, 48), 8));
}

TEST_CASE("patches cover all rows, overlap, and bound the smallest eigenvalue from above") {
  const Problem p = on(noisy_scan(5, 0.5, 1), 8);
  const auto patches = detail::patches_of(p.S, 800, 6);
  std::vector<int> covered(static_cast<std::size_t>(p.S.rows()), 0);
  for (const std::vector<Index>& rows : patches) {
    CHECK(std::is_sorted(rows.begin(), rows.end()));
    for (const Index i : rows) ++covered[static_cast<std::size_t>(i)];
  }
  CHECK(*std::min_element(covered.begin(), covered.end()) >= 1);
  CHECK(std::accumulate(covered.begin(), covered.end(), std::size_t{0}) > covered.size());
  CHECK(detail::patches_of(p.S, 1, 0).size() == covered.size());

  const Problem large = on(uneven_chain(180, 3), 5);
  REQUIRE(large.S.rows() > 16'000);
  const EigenReport exact = smallest_eigenpair(large.S, large.M, large.area, {.prove_smallest = Prove::always}).report;
  REQUIRE(exact.smallest == Smallest::proven);
  const auto found = detail::search_patches(as_problem(large), {}, 1.1 * exact.lambda, 5);
  REQUIRE(!found.empty());
  CHECK(found.size() <= 5);
  for (const detail::LocalVector& local : found) {
    CHECK(local.lambda >= exact.lambda * (1 - 1e-9));
    CHECK(local.rows.size() == static_cast<std::size_t>(local.u.size()));
  }
  CHECK(found.front().lambda <= 1.001 * exact.lambda);
  CHECK(detail::search_patches(as_problem(large), {}, exact.lambda * (1 - 1e-6), 5).empty());
  std::atomic<int> asked = 0;
  const EigenOptions stopped{.cancel = [&asked] { return ++asked > 3; }};
  CHECK_THROWS_AS(static_cast<void>(detail::search_patches(as_problem(large), stopped, exact.lambda, 5)), Cancelled);
}

TEST_CASE("too large to be factorised: an independent search confirms a pair, or replaces it") {
  const Problem p = problem_of(bumpy_sphere(4, 0.3, 5), 2);
  const EigenModes modes = eigenpairs(p.S, p.M, p.area, 5);
  REQUIRE(modes.smallest == Smallest::proven);
  const EigenOptions options{.prove_smallest = Prove::always};
  constexpr double no_memory = 0;
  const auto searched = [&](Eigen::Index k) {
    EigenResult result;
    result.u = modes.U.col(k);
    result.report.converged = true;
    result.report.lambda = modes.lambda[k];
    result.report.next = modes.lambda[k] + 1;
    detail::prove_smallest(as_problem(p), options, true, result, no_memory);
    return result.report;
  };
  const EigenReport right = searched(0);
  CHECK(right.smallest == Smallest::searched);
  CHECK(right.lambda == modes.lambda[0]);
  CHECK(!right.next.has_value());
  CHECK(!right.lower_bound.has_value());
  CHECK(right.smallest_note.find("not proven") == 0);
  CHECK(right.smallest_note.find("99.9 %") != std::string::npos);

  const EigenReport replaced = searched(4);
  CHECK(replaced.smallest == Smallest::searched);
  CHECK(replaced.converged);
  CHECK(replaced.lambda == doctest::Approx(modes.lambda[0]).epsilon(1e-8));
  CHECK(!replaced.next.has_value());
  CHECK(replaced.smallest_note.find("an independent one found a smaller eigenvalue") != std::string::npos);

  // With memory the same is proven.
  EigenResult proven;
  proven.u = modes.U.col(4);
  proven.report.converged = true;
  proven.report.lambda = modes.lambda[4];
  detail::prove_smallest(as_problem(p), options, true, proven, 1e9);
  CHECK(proven.report.smallest == Smallest::proven);
  CHECK(proven.report.lambda == doctest::Approx(modes.lambda[0]).epsilon(1e-8));
}

TEST_CASE("where a proof would take longer than the solve, patches still find out a pair that is not the smallest") {
  MeshData rough = icosphere(6);
  Dice dice(5);
  for (Eigen::Index i = 0; i < rough.V.rows(); ++i) rough.V.row(i) *= 1 + 0.006 * dice.normal();
  const Problem p = problem_of(rough, 4);
  const EigenModes modes = eigenpairs(p.S, p.M, p.area, 2, {.tolerance = 1e-6});
  REQUIRE(modes.lambda[1] > 1.0001 * modes.lambda[0]);
  REQUIRE(detail::states_below(modes.lambda[0], p.area) > detail::dense_states);
  for (const Eigen::Index k : {0, 1}) {
    EigenResult result;
    result.u = modes.U.col(k);
    result.report.converged = true;
    result.report.lambda = modes.lambda[k];
    result.report.solver = "LOBPCG";
    result.report.iterations = 1;  // so quick was the solve
    detail::prove_smallest(as_problem(p), {}, true, result);
    CHECK(result.report.smallest == Smallest::not_checked);
    CHECK(result.report.lambda == doctest::Approx(modes.lambda[0]).epsilon(1e-8));
    CHECK((result.report.smallest_note.find("solved again") != std::string::npos) == (k == 1));
  }
}

TEST_CASE("a fan of needles: a residual relative to the area lets pass what is no eigenpair, the energy does not") {
  // A cone so flat that its smallest eigenvalue is small beside 1 / area.
  MeshData cone = fan(60);
  for (Eigen::Index i = 0; i < cone.V.rows(); ++i) cone.V(i, 2) = -0.028 * cone.V.row(i).head<2>().norm();
  const Problem p = problem_of(cone, 1);
  const EigenResult exact = smallest_eigenpair(p.S, p.M, p.area, {.tolerance = 1e-10});
  REQUIRE(exact.report.lambda * p.area < 1e-4);
  REQUIRE(exact.report.lambda * p.area > 1e-8);
  // Noise that leaves the residual just within the tolerance.
  constexpr double tolerance = 1e-2;
  ComplexVectorX<double> w = random_dense(p.S.rows(), 1, 3).col(0);
  const ComplexVectorX<double> Sw = p.S * w;
  w *= 0.8 * tolerance * ComplexVectorX<double>(p.M * exact.u).norm() / (p.area * Sw.norm());
  const auto sloppy = register_eigen_solver("sloppy", [&](const EigenProblem&, const EigenOptions&) {
    EigenResult result;
    result.u = exact.u + w;
    return result;
  });
  for (const double unit : {1e-6, 1.0, 1e6}) {
    const EigenOptions options{.tolerance = tolerance, .method = "sloppy", .prove_smallest = Prove::never};
    const EigenReport r = smallest_eigenpair(p.S, unit * p.M, unit * p.area, options).report;
    CHECK(r.residual <= tolerance);
    CHECK(unit * r.lambda > 2 * exact.report.lambda);
    CHECK(r.distance > 2 * r.lambda);
    CHECK(r.energy_residual > tolerance);
    CHECK(!r.converged);
    CHECK(!within_tolerance(r, options));
  }
  for (const std::string method : {"lanczos", "lobpcg", "inverse-iteration"}) {
    const EigenReport r = smallest_eigenpair(p.S, p.M, p.area, {.tolerance = tolerance, .method = method}).report;
    CAPTURE(method);
    CHECK(r.converged);
    CHECK(r.lambda <= (1 + 3 * tolerance) * exact.report.lambda);
  }
}
