// SPDX-License-Identifier: MIT
//
// solver_fixture.h: the matrices of smoothest fields on a mesh, random right-hand sides and reference solutions, for
// the tests of solvers.
#pragma once

#include <doctest/doctest.h>

#include <cmath>
#include <complex>
#include <string>
#include <utility>

#include "alcap/connection.h"
#include "alcap/energies.h"
#include "alcap/solve.h"
#include "solvers/dense/hermitian.h"
#include "src/base/random.h"
#include "tests/support/mesh_case.h"

namespace alcap::test {

using Z = std::complex<double>;
using Hermitian = SparseMatrix<Z>;
using Dense = MatrixX<Z>;

struct Problem {
  Hermitian S, M;
  double area = 0;

  /// 2 S + weight / area M, positive definite for weights that are.
  [[nodiscard]] Hermitian shifted(double weight = 1) const { return 2.0 * S + weight / area * M; }
};

inline Problem problem_of(const Mesh& mesh, const Geometry& geometry, const Connection& connection, int n) {
  auto matrices = stiffness_and_mass(mesh, HermitianPattern(mesh), geometry, connection, n);
  return {.S = std::move(matrices.S), .M = std::move(matrices.M), .area = geometry.total_area()};
}

inline Problem problem_of(const MeshCase& s, const Connection& connection, int n) {
  return problem_of(s.mesh, s.geometry, connection, n);
}

/// With the polar connection.
inline Problem problem_of(MeshData surface, int n) {
  const MeshCase s(std::move(surface));
  return problem_of(s, polar(s.mesh, s.geometry), n);
}

inline Dense random_dense(Eigen::Index rows, Eigen::Index cols, std::uint64_t seed) {
  detail::Random random(seed);
  Dense X(rows, cols);
  for (Z& z : X.reshaped()) {
    const double re = random.uniform(-1, 1);
    z = {re, random.uniform(-1, 1)};
  }
  return X;
}

/// |S u - lambda M u| / (max(lambda, 1 / area) |M u|), as reports define it.
inline double true_residual(const Hermitian& S, const Hermitian& M, double area, const EigenResult& r) {
  const ComplexVectorX<double> Mu = M * r.u;
  return (S * r.u - r.report.lambda * Mu).norm() / (std::max(r.report.lambda, 1 / area) * Mu.norm());
}
inline double true_residual(const Problem& p, const EigenResult& r) { return true_residual(p.S, p.M, p.area, r); }

/// Three right-hand sides of a small real system by the linear backend of that name.
inline void check_small_real_system(const std::string& name, double tolerance) {
  SparseMatrix<double> A(4, 4);
  A.setIdentity();
  A.coeffRef(0, 3) = A.coeffRef(3, 0) = -0.5;
  const auto solver = make_linear_solver<double>({.name = name});
  solver->analyse(A);
  solver->factorise(A);
  const MatrixX<double> B = MatrixX<double>::Random(4, 3);
  MatrixX<double> X(4, 3);
  CHECK(solver->solve(B, X).converged);
  CHECK(residual<double>(A, X, B) <= tolerance);
}

/// All eigenvalues of S u = lambda M u, ascending, by the dense solver.
inline VectorX<double> dense_spectrum(const Hermitian& S, const Hermitian& M) {
  return detail::generalised_eigenpairs<Z>(Dense(S), Dense(M)).value().values;
}

/// A x = b by multigrid for a random b.
struct MultigridRun {
  Dense x;
  SolveReport report;
  double factor = 1;  ///< of the residual, per iteration
};

inline MultigridRun run_multigrid(const Hermitian& A, const Hermitian* transport, double tolerance = 1e-8) {
  const auto solver = make_linear_solver<Z>({.name = "multigrid", .tolerance = tolerance, .max_iterations = 200});
  if (transport != nullptr) solver->set_transport(*transport);
  solver->analyse(A);
  solver->factorise(A);
  const Dense b = random_dense(A.rows(), 1, 1);
  MultigridRun run{.x = Dense(A.rows(), 1), .report = {}};
  run.report = solver->solve(b, run.x);
  const double after = residual<Z>(A, run.x, b);
  CHECK(run.report.converged);
  CHECK(run.report.residual == doctest::Approx(after).epsilon(1e-3));
  CHECK(after <= tolerance);
  run.factor = std::pow(after, 1.0 / run.report.iterations);
  return run;
}

}  // namespace alcap::test
