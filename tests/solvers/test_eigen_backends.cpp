// SPDX-License-Identifier: MIT
//
// Every eigensolver over every mesh family against each other, the dense solver and known spectra: clusters, kernels,
// shuffled numbers, pieces, needles, threads.
#include <doctest/doctest.h>

#include <algorithm>
#include <complex>
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

EigenResult solve(const Problem& p, const EigenOptions& options) {
  const EigenResult r = smallest_eigenpair(p.S, p.M, p.area, options);
  CHECK(r.report.converged);
  CHECK(true_residual(p, r) <= options.residual_tolerance());
  CHECK(std::abs(r.u.dot(p.M * r.u) - 1.0) <= 1e-10);
  CHECK(r.report.smallest == Smallest::proven);
  CHECK(r.report.lower_bound.value() <= r.report.lambda);
  CHECK(r.report.next.value_or(r.report.lambda) >= r.report.lambda);
  return r;
}

/// The cascade itself, not the factorisation it falls back to.
EigenResult cascade(const Problem& p, double tolerance = 1e-8) {
  const EigenResult r = solve(p, {.tolerance = tolerance, .method = "lobpcg"});
  CHECK(r.report.solver == "LOBPCG, multigrid");
  CHECK(r.report.message == "");
  return r;
}

}  // namespace

TEST_CASE("all paths find the same eigenvalue on every family, for every degree") {
  const std::vector<MeshData> surfaces{icosphere(3),
                                       jittered_sphere(3, 0.2, 1),
                                       bumpy_sphere(3, 0.3, 5),
                                       disk(14),
                                       cylinder(28, 22),
                                       torus_random_diagonals(30, 16, 1, 0.4, 2),
                                       noisy_scan(3, 0.2, 3),
                                       genus_surface(2, 3)};
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    for (const int n : {1, 2, 3, 4, 5, 6}) {
      const Problem p = problem_of(surfaces[s], n);
      double lambda = -1;
      for (const std::string& method : eigen_solvers()) {
        if (method == "dense") continue;  // O(V^3): below
        CAPTURE(s);
        CAPTURE(n);
        CAPTURE(method);
        const EigenResult r = solve(p, {.tolerance = 1e-8, .method = method});
        if (lambda < 0) lambda = r.report.lambda;
        CHECK(std::abs(r.report.lambda - lambda) <= 1e-8 * std::max(lambda, 1 / p.area));
      }
    }
  }
}

TEST_CASE("the cascade against the dense solver") {
  const Problem p = problem_of(torus_random_diagonals(30, 18, 1, 0.4, 2), 1);
  const VectorX<double> exact = dense_spectrum(p.S, p.M);
  const EigenResult r = cascade(p, 1e-9);
  CHECK(std::abs(r.report.lambda - exact[0]) <= 1e-11 * exact[0]);
  CHECK(std::abs(r.report.next.value() - exact[1]) <= 1e-3 * exact[1]);
}

TEST_CASE("round spheres: 2n + 1 equal eigenvalues n, and order h^2") {
  for (const int n : {1, 2, 4, 6}) {
    CAPTURE(n);
    std::vector<double> errors;
    for (const int level : {4, 5}) errors.push_back(cascade(problem_of(icosphere(level), n)).report.lambda - n);
    // On the unit sphere the eigenvalues of degree n are l (l + 1) - n^2, l >= n.
    CHECK(std::abs(errors[1]) <= 0.01 * n);
    CHECK(std::abs(errors[0] / errors[1] - 4) <= 0.3);
  }
}

TEST_CASE("members of a cluster are told apart, however close") {
  const MeshData sphere = icosphere(5);
  for (const int n : {1, 4}) {
    for (const double apart : {1e-8, 1e-7, 3e-7, 1e-6, 1e-5}) {
      CAPTURE(n);
      CAPTURE(apart);
      // A potential that grows from pole to pole splits the 2n + 1 equal eigenvalues evenly, by apart n / (n + 1).
      Problem p = problem_of(sphere, n);
      for (Index j = 0; j < p.S.outerSize(); ++j)
        for (Hermitian::InnerIterator s(p.S, j), m(p.M, j); s; ++s, ++m)
          s.valueRef() += apart * n * m.value() * (sphere.V(s.row(), 2) + sphere.V(j, 2)) / 2.0;
      const EigenResult r = cascade(p, 1e-10);
      const EigenResult exact = solve(p, {.tolerance = 1e-11, .method = "lanczos"});
      CHECK(std::abs(r.report.lambda - exact.report.lambda) <= 1e-11 * n);
      // n = 1: at the pole where the potential is low, no mixture (n = 4 is split more by the triangles themselves).
      if (n == 1 && apart >= 1e-7) {
        const double z = r.u.dot(p.M * (r.u.array() * sphere.V.col(2).array()).matrix()).real();
        CHECK(z == doctest::Approx(-0.5).epsilon(1e-3));
      }
    }
  }
}

TEST_CASE("a flat torus has the eigenvalue 0: recognised, with the covariantly constant field") {
  const FlatTorus flat = flat_torus(40, 36);
  const Mesh mesh(flat.F, flat.vertices);
  VectorX<double> lengths(mesh.edges());
  for (Index h = 0; h < mesh.halfedges(); ++h) lengths[mesh.edge(h)] = flat.lengths(h / 3, h % 3);
  const auto geometry = Geometry::from_lengths(mesh, lengths);
  for (const int n : {1, 4}) {
    CAPTURE(n);
    const Problem p = problem_of(mesh, geometry, polar(mesh, geometry), n);
    const EigenResult r = cascade(p);
    CHECK(std::abs(r.report.lambda) <= 1e-7);
    CHECK(r.report.next.value() == doctest::Approx(4 * pi<double> * pi<double>).epsilon(0.05));
    CHECK(r.u.cwiseAbs().maxCoeff() - r.u.cwiseAbs().minCoeff() <= 1e-5);
  }
}

TEST_CASE("a shuffled mesh has the same eigenvalue in about as many iterations") {
  const MeshData s = bumpy_sphere(4, 0.3, 5);
  const EigenResult plain = cascade(problem_of(s, 4));
  const EigenResult shuffled =
      cascade(problem_of(relabelled(s, random_order(s.V.rows(), 7), random_order(s.F.rows(), 8)), 4));
  CHECK(std::abs(plain.report.lambda - shuffled.report.lambda) <= 1e-9 * plain.report.lambda);
  CHECK(std::abs(plain.report.iterations - shuffled.report.iterations) <= 5);
}

TEST_CASE("iterations stay the same from mesh to mesh") {
  for (const int n : {1, 4}) {
    for (const int level : {3, 4, 5}) {
      CAPTURE(n);
      CAPTURE(level);
      CHECK(cascade(problem_of(jittered_sphere(level, 0.2, 1), n)).report.iterations <= 20);
      CHECK(cascade(problem_of(torus_random_diagonals(5 << level, 2 << level, 1, 0.4, 2), n)).report.iterations <= 20);
    }
  }
}

TEST_CASE("bitwise the same for 1, 2 and 4 threads") {
  const Problem p = problem_of(torus_random_diagonals(160, 64, 1, 0.4, 2), 4);
  std::vector<EigenResult> runs(3);
  for (const int i : {0, 1, 2}) run_with_threads(1 << i, [&] { runs[static_cast<std::size_t>(i)] = cascade(p); });
  CHECK(runs[0].u == runs[1].u);
  CHECK(runs[0].u == runs[2].u);
  CHECK(runs[0].report.next == runs[2].report.next);
}

TEST_CASE("units and single pieces do not matter") {
  Problem p = problem_of(bumpy_sphere(3, 0.3, 5), 2);
  const double lambda = cascade(p).report.lambda;
  for (const double scale : {1e-12, 1e12}) {
    CAPTURE(scale);
    const Problem scaled{.S = p.S, .M = scale * p.M, .area = scale * p.area};
    CHECK(std::abs(cascade(scaled).report.lambda * scale - lambda) <= 1e-9 * lambda);
  }
  for (const MeshData& tiny : {single_triangle(), tetrahedron(), cube(), fan(7)}) {
    const Problem q = problem_of(tiny, 1);
    const EigenResult a = solve(q, {.method = "lobpcg"});
    const EigenResult b = solve(q, {.method = "dense"});
    CHECK(std::abs(a.report.lambda - b.report.lambda) <= 1e-10 * std::max(b.report.lambda, 1 / q.area));
  }
}

TEST_CASE("auto takes the cascade, on good triangles and on needles, in any unit") {
  const auto solver = [](const MeshData& s, double unit) {
    const Problem p = problem_of(s, 4);
    const EigenResult r = smallest_eigenpair(p.S, unit * p.M, unit * p.area, {});
    CHECK(r.report.converged);
    CHECK(r.report.message == "");
    return r.report.solver;
  };
  for (const double unit : {1e-6, 1.0, 1e6}) {
    CHECK(solver(torus_random_diagonals(60, 30, 1, 0.4, 1), unit) == "LOBPCG, multigrid");
    CHECK(solver(jittered_sphere(4, 0.2, 1), unit) == "LOBPCG, multigrid");
    CHECK(solver(cad_like(64, 12), unit) == "LOBPCG, multigrid");
  }
}

TEST_CASE("what multigrid cannot do is factorised, and the report says so") {
  // The cube of a connection Laplacian: its couplings say nothing about its smooth vectors.
  Problem p = problem_of(icosphere(4), 4);
  p.S = Hermitian(p.S * p.S * p.S);
  const EigenResult lanczos = solve(p, {.tolerance = 1e-6, .method = "lanczos"});
  const EigenResult lobpcg = solve(p, {.tolerance = 1e-6, .method = "lobpcg"});
  CHECK(std::abs(lobpcg.report.lambda - lanczos.report.lambda) <= 1e-8 * lanczos.report.lambda);
  CHECK(lobpcg.report.solver != "LOBPCG, multigrid");
  CHECK(lobpcg.report.message.find("factorised instead") != std::string::npos);

  const EigenResult stopped = smallest_eigenpair(p.S, p.M, p.area, {.method = "lobpcg", .max_iterations = 3});
  CHECK(!stopped.report.converged);
  CHECK(!stopped.report.message.empty());
}
