// SPDX-License-Identifier: MIT
//
// Eigenvalues counted, and what follows from it: proofs that an eigenpair is the smallest, the second eigenvalue, the
// k smallest. Against dense spectra and against each other.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "alcap/backends.h"
#include "alcap/connection.h"
#include "alcap/control.h"
#include "alcap/generators.h"
#include "alcap/solve.h"
#include "solvers/linear/multifrontal.h"
#include "src/base/parallel.h"
#include "tests/solvers/solver_fixture.h"
#include "tests/support/mesh_families.h"
#include "tests/support/mesh_helpers.h"

using namespace alcap;
using namespace alcap::test;

namespace {

/// A scan whose noise localises the smallest eigenvectors: the cascade alone ends at the second one for n = 8.
Problem localised(int n) {
  const MeshCase s(noisy_scan(5, 0.5, 1));
  return problem_of(s, globally_optimal(s.mesh, s.geometry), n);
}

}  // namespace

TEST_CASE("inertia counts what the dense spectrum has below sigma, on every family and for every degree") {
  for (const Family& family : mesh_families(2)) {
    CAPTURE(family.name);
    for (const int n : {1, 2, 3, 4, 5, 6}) {
      CAPTURE(n);
      const Problem p = problem_of(family.surface, n);
      const VectorX<double> exact = dense_spectrum(p.S, p.M);
      const double unit = 1 / p.area;
      std::vector<double> sigmas{-unit, exact[exact.size() - 1] + unit};
      // Between neighbours that are clearly apart.
      for (Eigen::Index k = 0; k + 1 < exact.size(); k += std::max<Eigen::Index>(1, exact.size() / 12))
        if (exact[k + 1] - exact[k] > 1e-6 * (std::abs(exact[k]) + unit))
          sigmas.push_back((exact[k] + exact[k + 1]) / 2);
      for (const double sigma : sigmas) {
        CAPTURE(sigma);
        const Inertia counted = inertia(p.S, p.M, sigma);
        CHECK(counted.below == (exact.array() < sigma).count());
        CHECK(counted.growth >= 1);
        CHECK(std::abs(counted.sigma - sigma) <= 1e-11 * std::max(std::abs(sigma), exact[exact.size() - 1]));
      }
    }
  }
}

TEST_CASE("inertia of more rows than a front, in any order, by any number of threads, without moving the scale") {
  const MeshData surface = torus_random_diagonals(90, 40, 1, 0.4, 2);
  const Problem p = problem_of(surface, 4);
  const EigenModes modes = eigenpairs(p.S, p.M, p.area, 12);
  REQUIRE(modes.smallest == Smallest::proven);
  const Problem mixed =
      problem_of(relabelled(surface, random_order(surface.V.rows(), 7), random_order(surface.F.rows(), 8)), 4);
  for (const Eigen::Index k : {0, 3, 7, 10}) {
    if (modes.cluster[static_cast<std::size_t>(k)] == modes.cluster[static_cast<std::size_t>(k + 1)]) continue;
    const double sigma = (modes.lambda[k] + modes.lambda[k + 1]) / 2;
    CHECK(inertia(p.S, p.M, sigma).below == k + 1);
    CHECK(inertia(mixed.S, mixed.M, sigma).below == k + 1);
    CHECK(inertia(p.S, 1e12 * p.M, sigma * 1e-12).below == k + 1);
    std::vector<Inertia> counted;
    for (const int threads : {1, 2, 4}) run_with_threads(threads, [&] { counted.push_back(inertia(p.S, p.M, sigma)); });
    CHECK(counted[0].growth == counted[1].growth);
    CHECK(counted[0].growth == counted[2].growth);
  }
}

TEST_CASE("inertia of graphs that are no meshes: stars, combs, wheels, complete ones, many pieces") {
  constexpr Index n = 900;
  const auto graph = [](int kind, Index i, Index j) {
    switch (kind) {
      case 0:
        return i == 0;  // star
      case 1:
        return j == i + 1;  // path
      case 2:
        return (i % 30 == 0 && j == i + 30) || (i / 30 == j / 30 && j == i + 1);  // comb
      case 3:
        return i < 3 || j == i + 1;  // wheel of three hubs
      case 4:
        return i < 300 && j < 300;  // complete, and vertices alone
      case 5:
        return i % 7 == 0 && j > i && j < i + 7;  // many stars
      default:
        return (i * 7919 + j * 104729) % 331 == 0;  // no order at all
    }
  };
  for (int kind = 0; kind < 7; ++kind) {
    CAPTURE(kind);
    std::vector<Eigen::Triplet<Z, Index>> entries;
    detail::Random random(3);
    for (Index i = 0; i < n; ++i) {
      entries.emplace_back(i, i, random.uniform(-1, 1));
      for (Index j = i + 1; j < n; ++j) {
        if (!graph(kind, i, j)) continue;
        const Z z = std::polar(1.0, random.uniform(0, 6));
        entries.emplace_back(i, j, z);
        entries.emplace_back(j, i, std::conj(z));
      }
    }
    Hermitian S(n, n), M(n, n);
    S.setFromTriplets(entries.begin(), entries.end());
    M.setIdentity();
    const std::vector<Index> order = detail::dissection_order(S);
    std::vector<Index> sorted = order;
    std::sort(sorted.begin(), sorted.end());
    REQUIRE(sorted.size() == static_cast<std::size_t>(n));
    for (Index i = 0; i < n; ++i) CHECK(sorted[static_cast<std::size_t>(i)] == i);
    const VectorX<double> exact = detail::hermitian_eigenvalues(Dense(S));
    for (const double sigma : {-0.51, 0.013, 0.77}) {
      const Inertia counted = inertia(S, M, sigma);
      if (counted.growth < 1e8) CHECK(counted.below == (exact.array() < sigma).count());
    }
  }
}

TEST_CASE("a hundred thousand vertices alone are ordered at once") {
  constexpr Index n = 100'000;
  Hermitian S(n, n), M(n, n);
  S.setIdentity();
  M.setIdentity();
  CHECK(inertia(S, M, 0.5).below == 0);
  CHECK(inertia(S, M, 1.5).below == n);
}

TEST_CASE("inertia where a pivot vanishes, of diagonal matrices, of one row; errors; cancelling") {
  Hermitian S(4, 4), M(4, 4);
  S.setIdentity();
  M.setIdentity();
  S.coeffRef(0, 0) = -3;
  S.coeffRef(1, 1) = 0;
  S.coeffRef(0, 1) = Z(0, 1);
  S.coeffRef(1, 0) = Z(0, -1);         // (0, 0, 1, 1) and the eigenvalues (-3 +- sqrt(13)) / 2
  CHECK(inertia(S, M, 0).below == 1);  // the second diagonal entry is 0
  CHECK(inertia(S, M, 0.5).below == 2);
  CHECK(inertia(S, M, -4).below == 0);
  CHECK(inertia(S, M, 2).below == 4);
  Hermitian one(1, 1);
  one.insert(0, 0) = 2;
  CHECK(inertia(one, one, 0.5).below == 0);
  CHECK(inertia(one, one, 1.5).below == 1);
  CHECK_THROWS_AS(static_cast<void>(inertia(S, one, 0)), SolveError);
  CHECK_THROWS_AS(static_cast<void>(inertia(S, M, std::nan(""))), OptionError);
  const Problem p = problem_of(icosphere(4), 1);
  CHECK_THROWS_AS(controlled({.cancel = [] { return true; }}, [&] { return inertia(p.S, p.M, 1); }), Cancelled);
}

TEST_CASE("a pair that is not the smallest is refuted, replaced and the smallest one proven") {
  const Problem p = localised(8);
  const EigenResult alone = smallest_eigenpair(p.S, p.M, p.area, {.method = "lobpcg", .prove_smallest = Prove::never});
  CHECK(alone.report.converged);
  CHECK(alone.report.smallest == Smallest::not_checked);
  CHECK(!alone.report.smallest_note.empty());
  CHECK(!alone.report.next.has_value());
  const EigenResult proven = smallest_eigenpair(p.S, p.M, p.area);
  CHECK(proven.report.smallest == Smallest::proven);
  CHECK(proven.report.lambda == doctest::Approx(352.443).epsilon(1e-5));
  const double bound = proven.report.lower_bound.value();
  CHECK(bound < proven.report.lambda);
  CHECK(bound > (1 - 2e-6) * proven.report.lambda);
  CHECK(inertia(p.S, p.M, bound).below == 0);
  CHECK(inertia(p.S, p.M, proven.report.lambda * (1 + 1e-6)).below == 1);
  const double next = proven.report.next.value();
  CHECK(inertia(p.S, p.M, next * (1 - 1.01e-3)).below == 1);
  CHECK(inertia(p.S, p.M, next * (1 + 1e-6)).below >= 2);
}

TEST_CASE("a solver from outside that ends at the fifth pair is found out") {
  const Problem p = problem_of(bumpy_sphere(4, 0.3, 5), 2);
  const EigenModes modes = eigenpairs(p.S, p.M, p.area, 5);
  const auto wrong = register_eigen_solver("fifth", [&](const EigenProblem&, const EigenOptions&) {
    EigenResult result;
    result.u = modes.U.col(4);
    result.report.smallest = Smallest::proven;  // not its to say
    result.report.lower_bound = 0;
    result.report.next = modes.lambda[1];
    return result;
  });
  const EigenResult r = smallest_eigenpair(p.S, p.M, p.area, {.method = "fifth"});
  CHECK(r.report.smallest == Smallest::proven);
  CHECK(r.report.lambda == doctest::Approx(modes.lambda[0]).epsilon(1e-10));
  CHECK(!r.report.smallest_note.empty());
  const EigenResult believed =
      smallest_eigenpair(p.S, p.M, p.area, {.method = "fifth", .prove_smallest = Prove::never});
  CHECK(believed.report.lambda == doctest::Approx(modes.lambda[4]).epsilon(1e-10));
  CHECK(believed.report.smallest == Smallest::not_checked);
  CHECK(!believed.report.lower_bound.has_value());
}

TEST_CASE("a multiple smallest eigenvalue is seen by every method") {
  for (const int level : {2, 4}) {
    const Problem p = problem_of(icosphere(level), 1);
    for (const std::string& method : eigen_solvers()) {
      if (method == "dense" && level == 4) continue;
      CAPTURE(level);
      CAPTURE(method);
      const EigenResult r = smallest_eigenpair(p.S, p.M, p.area, {.method = method});
      CHECK(r.report.smallest == Smallest::proven);
      CHECK(r.report.next.value() == doctest::Approx(r.report.lambda).epsilon(1e-6));
    }
  }
}

TEST_CASE("the k smallest by every method, multiple ones as often as they are") {
  const Problem sphere = problem_of(icosphere(2), 1);
  const Problem bumpy = problem_of(bumpy_sphere(3, 0.3, 5), 4);
  for (const Problem* p : {&sphere, &bumpy}) {
    const VectorX<double> exact = dense_spectrum(p->S, p->M);
    for (const std::string method : {"auto", "dense", "lanczos", "lobpcg", "inverse-iteration"}) {
      for (const int count : {1, 2, 3, 9}) {
        CAPTURE(method);
        CAPTURE(count);
        const EigenModes modes = eigenpairs(p->S, p->M, p->area, count, {.method = method, .max_iterations = 20000});
        REQUIRE(modes.lambda.size() == count);
        CHECK(modes.converged);
        CHECK(modes.smallest == Smallest::proven);
        CHECK(modes.message == "");
        CHECK((modes.lambda - exact.head(count)).cwiseAbs().maxCoeff() <= 1e-8 * exact[count - 1]);
        const Dense gram = modes.U.adjoint() * p->M * modes.U;
        CHECK((gram - Dense::Identity(count, count)).cwiseAbs().maxCoeff() <= 1e-8);
        for (Eigen::Index k = 0; k < count; ++k) {
          const ComplexVectorX<double> u = modes.U.col(k), Mu = p->M * u;
          CHECK((p->S * u - modes.lambda[k] * Mu).norm() <= 1e-8 * std::max(modes.lambda[k], 1 / p->area) * Mu.norm());
        }
      }
    }
  }
  // l = 1 three times, l = 2 five times.
  CHECK(eigenpairs(sphere.S, sphere.M, sphere.area, 8).cluster == std::vector<int>{0, 0, 0, 1, 1, 1, 1, 1});
  CHECK_THROWS_AS(static_cast<void>(eigenpairs(sphere.S, sphere.M, sphere.area, 0)), OptionError);
  CHECK_THROWS_AS(static_cast<void>(eigenpairs(sphere.S, sphere.M, sphere.area, 1000)), OptionError);
}

TEST_CASE("modes without a proof, of all rows, of a kernel, of pieces") {
  const Problem p = problem_of(icosphere(3), 2);
  const EigenModes unproven = eigenpairs(p.S, p.M, p.area, 5, {.method = "lanczos", .prove_smallest = Prove::never});
  CHECK(unproven.smallest == Smallest::not_checked);
  CHECK(unproven.converged);
  CHECK((unproven.lambda - eigenpairs(p.S, p.M, p.area, 5).lambda).cwiseAbs().maxCoeff() <= 1e-8 * unproven.lambda[4]);

  const Problem tiny = problem_of(tetrahedron(), 1);
  const EigenModes all = eigenpairs(tiny.S, tiny.M, tiny.area, 4, {.method = "lanczos"});
  CHECK((all.lambda - dense_spectrum(tiny.S, tiny.M)).cwiseAbs().maxCoeff() <= 1e-9 * all.lambda[3]);

  const Problem pieces = problem_of(together(icosphere(2), icosphere(2)), 1);
  const EigenModes six = eigenpairs(pieces.S, pieces.M, pieces.area, 6);
  CHECK(six.cluster.back() == 0);  // three on each
  CHECK(six.smallest == Smallest::proven);
}
