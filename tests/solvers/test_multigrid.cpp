// SPDX-License-Identifier: MIT
//
// Multigrid: iterations that do not grow with the mesh, blindness to the gauge, independence of threads, and the graphs
// that aggregation finds hard.
#include <doctest/doctest.h>

#include <algorithm>
#include <complex>
#include <string>
#include <vector>

#include "alcap/generators.h"
#include "alcap/solve.h"
#include "src/base/parallel.h"
#include "tests/solvers/solver_fixture.h"

using namespace alcap;
using namespace alcap::test;

namespace {

/// Couplings against the transport: of obtuse triangles.
Index edges_against(const Problem& p) {
  Index entries = 0;
  for (Eigen::Index k = 0; k < p.S.nonZeros(); ++k)
    if (std::real(p.S.valuePtr()[k] * std::conj(p.M.valuePtr()[k])) > 0) ++entries;
  return (entries - static_cast<Index>(p.S.rows())) / 2;
}

MultigridRun solve(const Problem& p) { return run_multigrid(p.shifted(), &p.M); }

}  // namespace

TEST_CASE("iterations stay the same from mesh to mesh, for every family and degree") {
  for (const int n : {1, 2, 4, 6}) {
    int first = 0;
    for (const int level : {3, 4, 5, 6}) {
      CAPTURE(n);
      CAPTURE(level);
      for (const MeshData& surface : {icosphere(level), jittered_sphere(level, 0.2, 1),
                                      torus_random_diagonals(5 << level, 2 << level, 1, 0.4, 2)}) {
        const int iterations = solve(problem_of(surface, n)).report.iterations;
        CHECK(iterations <= 14);
        if (level == 3) first = std::max(first, iterations);
        if (level > 3) CHECK(iterations <= first + 3);
      }
    }
  }
}

TEST_CASE("boundaries, holes and obtuse triangles") {
  for (const int n : {1, 4}) {
    CAPTURE(n);
    CHECK(solve(problem_of(disk(60), n)).report.iterations <= 14);
    CHECK(solve(problem_of(cylinder(100, 80), n)).report.iterations <= 14);
    const Problem scan = problem_of(noisy_scan(6, 0.2, 3), n);
    CHECK(edges_against(scan) > 1000);
    CHECK(solve(scan).report.iterations <= 20);
  }
}

TEST_CASE("the gauge does not matter: same iterations, turned solution") {
  const Problem p = problem_of(icosphere(5), 4);
  const Hermitian A = p.shifted();
  detail::Random random(4);
  ComplexVectorX<double> gauge(A.rows());
  for (Z& z : gauge) z = std::polar(1.0, random.uniform(-pi<double>, pi<double>));
  const auto turned = [&](const Hermitian& B) {
    return Hermitian(gauge.asDiagonal() * B * gauge.conjugate().asDiagonal());
  };
  const Hermitian turned_A = turned(A);
  const Hermitian turned_M = turned(p.M);
  const int plain = run_multigrid(A, &p.M).report.iterations;
  CHECK(std::abs(run_multigrid(turned_A, &turned_M).report.iterations - plain) <= 1);
  CHECK(std::abs(run_multigrid(turned_A, nullptr).report.iterations - plain) <= 1);
}

TEST_CASE("bitwise the same for 1, 2 and 4 threads") {
  const Problem p = problem_of(jittered_sphere(5, 0.2, 5), 2);
  std::vector<MultigridRun> runs(3);
  for (const int i : {0, 1, 2}) run_with_threads(1 << i, [&] { runs[static_cast<std::size_t>(i)] = solve(p); });
  CHECK(runs[0].x == runs[1].x);
  CHECK(runs[0].x == runs[2].x);
  CHECK(runs[0].report.iterations == runs[2].report.iterations);
}

TEST_CASE("many components, one large star, isolated rows, no rows to coarsen") {
  std::vector<Eigen::Triplet<Z, Index>> entries;
  const auto edge = [&](Index i, Index j, double w) {
    entries.emplace_back(i, i, w);
    entries.emplace_back(j, j, w);
    entries.emplace_back(i, j, -w);
    entries.emplace_back(j, i, -w);
  };
  const auto matrix = [&](Index rows, double shift) {
    for (Index i = 0; i < rows; ++i) entries.emplace_back(i, i, shift);
    Hermitian A(rows, rows);
    A.setFromTriplets(entries.begin(), entries.end());
    entries.clear();
    return A;
  };
  for (Index c = 0; c < 1000; ++c)
    for (Index i = 0; i < 12; ++i) edge(12 * c + i, 12 * c + (i + 1) % 12, 1);
  CHECK(run_multigrid(matrix(12000, 1e-3), nullptr).report.iterations <= 25);
  for (Index i = 1; i <= 2000; ++i) {
    edge(0, i, 1);
    edge(i, i % 2000 + 1, 1);
  }
  CHECK(run_multigrid(matrix(2001, 1e-4), nullptr).report.iterations <= 25);
  CHECK(run_multigrid(matrix(5000, 3), nullptr).report.iterations <= 2);
  CHECK(run_multigrid(matrix(1, 3), nullptr).report.iterations <= 2);
}

TEST_CASE("nearly singular: a flat connection with a tiny shift") {
  // Cotangent Laplacian of a sphere without its connection: the constants are its kernel.
  const Problem p = problem_of(icosphere(5), 1);
  Hermitian A = p.S;
  for (Index j = 0; j < A.cols(); ++j) {
    double sum = 0;
    Z* diagonal = nullptr;
    for (Hermitian::InnerIterator it(A, j); it; ++it) {
      if (it.row() == j) {
        diagonal = &it.valueRef();
      } else {
        it.valueRef() = -std::abs(it.value());
        sum += std::abs(it.value());
      }
    }
    *diagonal = sum + 1e-9;
  }
  // The right-hand side is not orthogonal to the kernel: the solution is 1e9 times as large.
  CHECK(run_multigrid(A, nullptr).report.iterations <= 35);
}

TEST_CASE("what it cannot do is said") {
  Hermitian bad(4, 4);
  bad.setIdentity();
  bad.coeffRef(2, 2) = -1;
  auto solver = make_linear_solver<Z>({.name = "multigrid"});
  solver->analyse(bad);
  CHECK_THROWS_WITH_AS(solver->factorise(bad),
                       "multigrid: the matrix is not positive definite (its diagonal is not positive at column 2)",
                       SolveError);

  const Problem p = problem_of(icosphere(4), 1);
  const Hermitian indefinite = p.S - 50 / p.area * p.M;
  solver->analyse(indefinite);
  solver->factorise(indefinite);
  Dense x(indefinite.rows(), 1);
  CHECK_THROWS_WITH_AS(solver->solve(random_dense(x.rows(), 1, 2), x),
                       doctest::Contains("not positive definite; a factorisation (the solver '"), SolveError);

  auto limited = make_linear_solver<Z>({.name = "multigrid", .tolerance = 1e-12, .max_iterations = 2});
  const Hermitian A = p.S + p.M;
  limited->analyse(A);
  limited->factorise(A);
  const SolveReport report = limited->solve(random_dense(x.rows(), 1, 2), x);
  CHECK(!report.converged);
  CHECK(report.iterations == 2);
  CHECK(report.residual > 1e-12);

  auto other = make_linear_solver<Z>({.name = "multigrid"});
  other->set_transport(bad);
  other->analyse(A);
  CHECK_THROWS_WITH_AS(other->factorise(A), "multigrid: the transport has another pattern than the matrix", SolveError);
}

TEST_CASE("a transport fits when its entries are at the places of the matrix, compressed or not") {
  const auto with = [](const std::vector<Eigen::Triplet<Z, Index>>& entries) {
    Hermitian T(4, 4);
    T.setFromTriplets(entries.begin(), entries.end());
    return T;
  };
  const Hermitian A = with({{0, 0, 2}, {1, 0, -1}, {0, 1, -1}, {1, 1, 2}, {2, 2, 2}, {3, 3, 2}});
  // The same rows one after another, but in other columns.
  const Hermitian other = with({{0, 0, 2}, {1, 0, 1}, {0, 1, 1}, {1, 2, 1}, {2, 2, 1}, {3, 3, 1}});
  REQUIRE(std::equal(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros(), other.innerIndexPtr()));
  const auto factorise = [&](const Hermitian& transport) {
    const auto solver = make_linear_solver<Z>({.name = "multigrid"});
    solver->set_transport(transport);
    solver->analyse(A);
    solver->factorise(A);
  };
  CHECK_THROWS_AS(factorise(other), SolveError);
  Hermitian same = A;
  same.uncompress();
  CHECK_NOTHROW(factorise(same));
}

TEST_CASE("needles and slivers: the smoother's bound holds for the worst of them") {
  for (const int n : {1, 4}) {
    CAPTURE(n);
    const Problem needles = problem_of(cad_like(4000, 3), n);  // hundreds of times longer than wide
    CHECK(solve(needles).report.iterations <= 14);
    const Problem slivers = problem_of(jittered_sphere(5, 0.45, 2), n);
    REQUIRE(edges_against(slivers) > slivers.S.rows() / 5);
    CHECK(solve(slivers).report.iterations <= 18);
  }
}

TEST_CASE("where the cycles stall, the matrix is factorised, and the report says so") {
  // The cube of a connection Laplacian is no second-order operator: its couplings say nothing about its smooth vectors.
  const Problem p = problem_of(icosphere(4), 4);
  const Hermitian A = Hermitian(p.S * p.S * p.S + 1e-6 * p.M);
  const auto solver = make_linear_solver<Z>({.name = "multigrid", .tolerance = 1e-9});
  solver->analyse(A);
  solver->factorise(A);
  Dense B(A.rows(), 2), X(A.rows(), 2);
  B << random_dense(A.rows(), 1, 1), random_dense(A.rows(), 1, 2);
  const SolveReport report = solver->solve(B, X);
  CHECK(report.converged);
  CHECK(residual<Z>(A, X, B) <= 1e-9);
  CHECK(report.iterations < 1000);
  CHECK(report.solver.find("stalled") != std::string::npos);
  // Other values of the same pattern: nothing of the old factorisation is left.
  const Hermitian twice = 2 * A;
  solver->factorise(twice);
  (void)solver->solve(B, X);
  CHECK(residual<Z>(twice, X, B) <= 1e-9);
}
