// SPDX-License-Identifier: MIT
//
// Multigrid on what is asked of it: the factor by which an iteration shrinks the residual and the growth of iterations
// under refinement, for every degree; trivial connections, obtuse triangles, shuffled numbers, a thousand pieces, one
// vertex of valence 2,000, matrices that are all but singular. Only through the public interface.
#include <doctest/doctest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <string>
#include <vector>

#include "alcap/connection.h"
#include "alcap/generators.h"
#include "alcap/solve.h"
#include "src/base/parallel.h"
#include "tests/solvers/solver_fixture.h"
#include "tests/support/mesh_helpers.h"

using namespace alcap;
using namespace alcap::test;

namespace {

/// (2 S + weight / area M) x = b by multigrid alone.
MultigridRun solve(const Problem& p, double weight = 1) {
  MultigridRun run = run_multigrid(p.shifted(weight), &p.M);
  CHECK(run.report.solver == "multigrid");
  return run;
}

void refine(const std::function<MeshData(int)>& family) {
  std::vector<int> first(7);
  for (const int level : {3, 4, 5, 6, 7}) {
    const MeshCase shape(family(level));
    const Connection connection = polar(shape.mesh, shape.geometry);
    for (const int n : {1, 2, 3, 4, 5, 6}) {
      CAPTURE(level);
      CAPTURE(n);
      const MultigridRun run = solve(problem_of(shape, connection, n));
      int& at_first = first[static_cast<std::size_t>(n)];
      if (level == 3) at_first = run.report.iterations;
      CHECK(run.factor <= 0.25);
      CHECK(run.report.iterations <= at_first + 2);
    }
  }
}

MeshData pieces(int count) {
  const MeshData piece = jittered_sphere(1, 0.1, 3);
  const auto v = static_cast<Index>(piece.V.rows()), f = static_cast<Index>(piece.F.rows());
  MeshData all{Positions<double>(count * v, 3), Faces(count * f, 3)};
  for (Index k = 0; k < count; ++k) {
    all.V.middleRows(k * v, v) = piece.V;
    all.F.middleRows(k * f, f) = (piece.F.array() + k * v).matrix();
  }
  return all;
}

}  // namespace

TEST_CASE("factor below 1/4 and no growth over four refinements: icosphere") {
  refine([](int level) { return icosphere(level); });
}

TEST_CASE("factor below 1/4 and no growth over four refinements: jittered sphere") {
  refine([](int level) { return jittered_sphere(level, 0.2, 1); });
}

TEST_CASE("factor below 1/4 and no growth over four refinements: torus with random diagonals") {
  refine([](int level) { return torus_random_diagonals(5 << level, 2 << level, 1, 0.4, 2); });
}

TEST_CASE("factor below 1/4 and no growth over four refinements: noisy scan") {
  refine([](int level) { return noisy_scan(level, 0.1, 3); });
}

TEST_CASE("factor below 1/4 and no growth over four refinements: stepped shaft with needles") {
  refine([](int level) { return cad_like(32, 2 << level); });
}

TEST_CASE("factor below 1/4 and no growth: trivial connections, flat but for their cones") {
  std::vector<int> first(7);
  for (const int level : {3, 4, 5, 6}) {
    const MeshCase shape(jittered_sphere(level, 0.2, 1));
    for (const int n : {1, 2, 3, 4, 5, 6}) {
      std::vector<Cone> cones;
      for (Index k = 0; k < 2 * n; ++k) cones.push_back({k * (shape.mesh.vertices() / (2 * n)), 1.0 / n});
      CAPTURE(level);
      CAPTURE(n);
      const MultigridRun run = solve(problem_of(shape, trivial(shape.mesh, shape.geometry, cones, {.n = n}), n));
      int& at_first = first[static_cast<std::size_t>(n)];
      if (level == 3) at_first = run.report.iterations;
      CHECK(run.factor <= 0.25);
      CHECK(run.report.iterations <= at_first + 2);
    }
  }
}

TEST_CASE("a fifth of the triangles obtuse") {
  const MeshCase shape(jittered_sphere(6, 0.4, 2));
  int obtuse = 0;
  for (Index t = 0; t < shape.mesh.faces(); ++t) {
    const auto cot = [&](Index c) { return shape.geometry.cot(3 * t + c); };
    if (std::min({cot(0), cot(1), cot(2)}) < 0) ++obtuse;
  }
  REQUIRE(obtuse >= 0.2 * shape.mesh.faces());
  const Connection connection = polar(shape.mesh, shape.geometry);
  for (const int n : {1, 4}) {
    CAPTURE(n);
    CHECK(solve(problem_of(shape, connection, n)).factor <= 0.25);
  }
}

TEST_CASE("shuffled numbers: as many iterations, give or take one") {
  const MeshData s = jittered_sphere(6, 0.2, 4);
  const MeshData shuffled = relabelled(s, random_order(s.V.rows(), 7), random_order(s.F.rows(), 8));
  for (const int n : {1, 4}) {
    CAPTURE(n);
    const MultigridRun a = solve(problem_of(s, n)), b = solve(problem_of(shuffled, n));
    CHECK(b.factor <= 0.25);
    CHECK(std::abs(a.report.iterations - b.report.iterations) <= 1);
  }
}

TEST_CASE("a thousand pieces, and one vertex of valence 2,000") {
  for (const int n : {1, 4}) {
    CAPTURE(n);
    CHECK(solve(problem_of(pieces(1000), n)).factor <= 0.25);
    CHECK(solve(problem_of(fan(2000), n)).factor <= 0.25);
  }
}

TEST_CASE("all but singular: a parallel field exists, and the shift is tiny") {
  // No cone on a torus: its trivial connection has a parallel field of every degree.
  const MeshCase shape(torus_random_diagonals(96, 40, 1, 0.4, 5));
  const Connection connection = trivial(shape.mesh, shape.geometry, {}, {.n = 4});
  const Problem p = problem_of(shape, connection, 4);
  for (const double weight : {1e-2, 1e-4, 1e-5}) {
    CAPTURE(weight);
    // The solution is mostly the parallel field, 1/weight times as large as the rest: smaller weights leave no digits
    // for the rest, to any solver.
    CHECK(solve(p, weight).report.iterations <= 25);
  }
  const EigenResult r = smallest_eigenpair(p.S, p.M, p.area, {.method = "lobpcg"});
  CHECK(r.report.converged);
  CHECK(r.report.solver == "LOBPCG, multigrid");
  CHECK(std::abs(r.report.lambda) * p.area <= 1e-8);
  CHECK(r.report.next.value() * p.area > 1);
  // Parallel: all of the same length.
  CHECK(r.u.cwiseAbs().maxCoeff() - r.u.cwiseAbs().minCoeff() <= 1e-5 * r.u.cwiseAbs().maxCoeff());
}

TEST_CASE("bitwise the same for 1, 2 and 4 threads, linear and eigen") {
  const Problem p = problem_of(noisy_scan(5, 0.1, 3), 4);
  std::vector<Dense> x(3);
  std::vector<EigenResult> r(3);
  for (const int i : {0, 1, 2})
    run_with_threads(1 << i, [&] {
      const auto at = static_cast<std::size_t>(i);
      x[at] = solve(p).x;
      r[at] = smallest_eigenpair(p.S, p.M, p.area, {.method = "lobpcg"});
    });
  CHECK(r[0].report.converged);
  for (const std::size_t i : {1, 2}) {
    CHECK(x[i] == x[0]);
    CHECK(r[i].u == r[0].u);
    CHECK(r[i].report.lambda == r[0].report.lambda);
  }
}

TEST_CASE("the sphere's eigenvalue is n, by extrapolation of order h^2") {
  for (const int n : {1, 2, 3, 4, 5, 6}) {
    CAPTURE(n);
    const auto lambda = [&](int level) {
      const Problem p = problem_of(icosphere(level), n);
      const EigenResult r = smallest_eigenpair(p.S, p.M, p.area, {.method = "lobpcg"});
      CHECK(r.report.solver == "LOBPCG, multigrid");
      CHECK(r.report.converged);
      return r.report.lambda;
    };
    // l (l + 1) - n^2 with l = n.
    const double coarse = lambda(4), fine = lambda(5);
    CHECK(std::abs((4 * fine - coarse) / 3 - n) <= 1e-3 * std::abs(coarse - n));
  }
}
