// SPDX-License-Identifier: MIT
// Your own linear solver, registered under a name: here Eigen's LLT. It then works wherever alcap takes a name.
#include <alcap/alcap.h>

#include <Eigen/SparseCholesky>
#include <complex>
#include <iostream>
#include <memory>
#include <string>

namespace {

using Scalar = std::complex<double>;

class MySolver final : public alcap::LinearSolver<Scalar> {
 public:
  void analyse(const alcap::SparseMatrix<Scalar>& A) override { llt_.analyzePattern(A); }
  void factorise(const alcap::SparseMatrix<Scalar>& A) override {
    llt_.factorize(A);
    if (llt_.info() != Eigen::Success) throw alcap::SolveError("mine: the matrix is not positive definite");
  }
  alcap::SolveReport solve(const Eigen::Ref<const alcap::MatrixX<Scalar>>& B,
                           Eigen::Ref<alcap::MatrixX<Scalar>> X) const override {
    X = llt_.solve(B);
    alcap::SolveReport report;
    report.solver = name();
    report.converged = true;
    return report;
  }
  [[nodiscard]] std::string name() const override { return "mine"; }

 private:
  Eigen::SimplicialLLT<alcap::SparseMatrix<Scalar>> llt_;
};

}  // namespace

int main() {
  // Registered for as long as `mine` lives.
  const auto mine =
      alcap::register_linear_solver("mine", [](const alcap::SolverOptions&) { return std::make_unique<MySolver>(); });

  const alcap::MeshData sphere = alcap::icosphere(3);
  const alcap::FieldRun run =
      alcap::run_field(sphere.V, sphere.F, {.n = 4, .eigen = {.solver = "mine", .method = "lanczos"}});
  std::cout << "solved by: " << run.eigen[0].solver << "\n"
            << "smallest eigenvalue: " << run.eigen[0].lambda << "\n"
            << "certified: " << (run.certificate.holds() ? "yes" : "no") << "\n";
}
