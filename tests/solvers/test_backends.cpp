// SPDX-License-Identifier: MIT
//
// Every linear backend against every other, and every eigensolver over every linear backend against every other, on
// every kind of mesh: solutions and eigenvalues agree, and reports say what recomputing says.
#include <doctest/doctest.h>

#include <algorithm>
#include <complex>
#include <string>
#include <vector>

#include "alcap/connection.h"
#include "alcap/solve.h"
#include "tests/solvers/solver_fixture.h"
#include "tests/support/mesh_families.h"

using namespace alcap;
using namespace alcap::test;

namespace {

Problem problem_with_best_connection(const MeshData& surface, int n) {
  const ConnectedCase s(surface);
  return problem_of(s, s.connection, n);
}

/// |x|_A, largest over columns.
template <class Scalar>
double energy_norm(const SparseMatrix<Scalar>& A, const MatrixX<Scalar>& X) {
  double most = 0;
  for (Eigen::Index c = 0; c < X.cols(); ++c)
    most = std::max(most, std::sqrt(std::abs(X.col(c).dot(MatrixX<Scalar>(A * X.col(c)).col(0)))));
  return most;
}

template <class Scalar>
void all_agree(const SparseMatrix<Scalar>& A, const SparseMatrix<Scalar>& transport, const MatrixX<Scalar>& exact) {
  const MatrixX<Scalar> B = A * exact;
  const double scale = energy_norm<Scalar>(A, exact);
  for (const std::string& name : linear_solvers()) {
    CAPTURE(name);
    const auto solver = make_linear_solver<Scalar>({.name = name, .tolerance = 1e-11, .max_iterations = 3000});
    solver->set_transport(transport);
    solver->analyse(A);
    solver->factorise(A);
    MatrixX<Scalar> X(B.rows(), B.cols());
    const SolveReport report = solver->solve(B, X);
    CHECK(report.converged);
    CHECK(report.solver.starts_with(solver->name()));
    const double true_residual = residual<Scalar>(A, X, B);
    CHECK(true_residual <= 1e-11);
    // Direct backends leave it to their caller, see solve.h.
    if (report.iterations > 0) CHECK(report.residual == doctest::Approx(true_residual).epsilon(0.01));
    // They all agree with the solution, hence with each other.
    CHECK(energy_norm<Scalar>(A, X - exact) <= 1e-8 * scale);
  }
}

}  // namespace

TEST_CASE("linear backends agree on every kind of mesh, complex and real") {
  for (const Family& family : mesh_families(3)) {
    for (const int n : {1, 4}) {
      CAPTURE(family.name);
      CAPTURE(n);
      const Problem p = problem_with_best_connection(family.surface, n);
      const Hermitian A = p.shifted();
      all_agree<Z>(A, p.M, random_dense(A.rows(), 2, 1));
      if (n > 1) continue;
      // A graph Laplacian of the same mesh, as trivial connections and cones need it.
      SparseMatrix<double> L = p.M.cwiseAbs();
      for (Index j = 0; j < L.cols(); ++j) {
        double sum = 0;
        for (SparseMatrix<double>::InnerIterator it(L, j); it; ++it)
          if (it.row() != j) it.valueRef() = -1, ++sum;
        L.coeffRef(j, j) = sum + 1e-3;
      }
      all_agree<double>(L, L, random_dense(L.rows(), 2, 2).real());
    }
  }
}

TEST_CASE("eigensolvers agree on every kind of mesh, for every degree") {
  for (const Family& family : mesh_families(2)) {
    for (const int n : {1, 2, 3, 4, 6}) {
      const Problem p = problem_with_best_connection(family.surface, n);
      double reference = -1;
      for (const std::string& method : eigen_solvers()) {
        CAPTURE(family.name);
        CAPTURE(n);
        CAPTURE(method);
        const EigenResult r =
            smallest_eigenpair(p.S, p.M, p.area, {.tolerance = 1e-8, .method = method, .max_iterations = 20000});
        CHECK(r.report.converged);
        const double residual = true_residual(p, r);
        // Where slivers leave more than the tolerance, the report says that it is rounding.
        CHECK((residual <= 1e-8 || !r.report.message.empty()));
        CHECK(r.report.residual == doctest::Approx(residual).epsilon(0.05));
        CHECK(std::abs(r.u.dot(p.M * r.u) - 1.0) <= 1e-10);
        if (reference < 0) reference = r.report.lambda;
        CHECK(std::abs(r.report.lambda - reference) <= 1e-8 * std::max(reference, 1 / p.area));
      }
    }
  }
}

TEST_CASE("methods that solve linear systems give the same over every backend") {
  for (const Family& family : mesh_families(2)) {
    for (const int n : {1, 4}) {
      const Problem p = problem_with_best_connection(family.surface, n);
      const double reference = smallest_eigenpair(p.S, p.M, p.area).report.lambda;
      for (const std::string method : {"lanczos", "inverse-iteration"}) {
        for (const std::string& solver : linear_solvers()) {
          CAPTURE(family.name);
          CAPTURE(n);
          CAPTURE(method);
          CAPTURE(solver);
          const EigenResult r = smallest_eigenpair(p.S, p.M, p.area, {.solver = solver, .method = method});
          CHECK(r.report.converged);
          CHECK(std::abs(r.report.lambda - reference) <= 1e-8 * std::max(reference, 1 / p.area));
          if (p.S.rows() > 2) CHECK(r.report.solver.find(solver.substr(0, 6)) != std::string::npos);
        }
      }
    }
  }
}
