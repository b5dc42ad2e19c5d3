// SPDX-License-Identifier: MIT
//
// A user of the library, installed or embedded: the smoothest cross field on a small mesh of their own, then again with
// a linear solver and with an eigensolver of their own.
#include <alcap/alcap.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <iostream>
#include <memory>
#include <string>

namespace {

using C = std::complex<double>;
using Dense = alcap::MatrixX<C>;

struct Mine final : alcap::LinearSolver<C> {
  void analyse(const alcap::SparseMatrix<C>& A) override { ldlt.analyzePattern(A); }
  void factorise(const alcap::SparseMatrix<C>& A) override {
    ldlt.factorize(A);
    if (ldlt.info() != Eigen::Success) throw alcap::SolveError("mine: the matrix is singular");
  }
  alcap::SolveReport solve(const Eigen::Ref<const Dense>& B, Eigen::Ref<Dense> X) const override {
    X = ldlt.solve(B);
    alcap::SolveReport report;
    report.solver = name();
    report.converged = true;
    return report;
  }
  std::string name() const override { return "mine"; }
  Eigen::SimplicialLDLT<alcap::SparseMatrix<C>> ldlt;
};

// All eigenpairs of a small matrix, of which the first one is given back.
alcap::EigenResult all_pairs(const alcap::EigenProblem& problem, const alcap::EigenOptions&) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Dense> eigen(Dense(problem.S), Dense(problem.M));
  alcap::EigenResult result;
  result.u = eigen.eigenvectors().col(0);
  return result;
}

}  // namespace

int main() {
  alcap::Positions<double> V(4, 3);
  V << 1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1;
  alcap::Faces F(4, 3);
  F << 0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2;
  const alcap::FieldRun run = alcap::run_field(V, F, {.n = 4});
  std::cout << "alcap " << alcap::version() << ": " << run.singularities.size() << " singularities, lambda "
            << run.eigen.at(0).lambda << "\n";
  if (!run.certificate.holds() || run.index_sums.at(0).sum != 4 * 2) return 1;  // n times the Euler characteristic

  const auto mine = alcap::register_linear_solver("mine", [](const auto&) { return std::make_unique<Mine>(); });
  const alcap::FieldRun own = alcap::run_field(V, F, {.n = 4, .eigen = {.solver = "mine", .method = "lanczos"}});
  std::cout << own.eigen.at(0).solver << ": lambda " << own.eigen.at(0).lambda << "\n";
  const auto all = alcap::register_eigen_solver("all-pairs", all_pairs);
  const alcap::FieldRun dense = alcap::run_field(V, F, {.n = 4, .eigen = {.method = "all-pairs"}});
  std::cout << dense.eigen.at(0).solver << ": lambda " << dense.eigen.at(0).lambda << "\n";
  const auto agrees = [&](const alcap::FieldRun& other, const char* name) {
    const alcap::EigenReport& report = other.eigen.at(0);
    return std::abs(report.lambda - run.eigen.at(0).lambda) < 1e-7 * run.eigen.at(0).lambda &&
           other.certificate.holds() && report.solver.find(name) != std::string::npos;
  };
  return agrees(own, "mine") && agrees(dense, "all-pairs") ? 0 : 1;
}
