// SPDX-License-Identifier: MIT
//
// eigen_library_ldlt.cpp: Eigen's simplicial LDL^H with AMD ordering. No dependency beyond Eigen; on one thread and
// without dense blocks, so only for small problems and for embedders who build without CHOLMOD.
#include <Eigen/SparseCholesky>
#include <cstdint>
#include <optional>
#include <string>

#include "solvers/linear/backends.h"
#include "solvers/linear/stages.h"

namespace alcap::detail {
namespace {

template <class Scalar>
class EigenLdlt final : public LinearSolver<Scalar> {
 public:
  explicit EigenLdlt(const SolverOptions& options) : stages_("Eigen LDLT", options.cancel) {}

  void analyse(const SparseMatrix<Scalar>& A) override {
    stages_.begin_analysis(A);
    guarded("Eigen LDLT analysis", less_than_a_factor, [&] {
      ldlt_.emplace();  // Eigen's arrays do not survive a resize without memory: the old ones are given up first
      ldlt_->analyzePattern(Wide(A));
    });
    stages_.analysed(A);
  }

  void factorise(const SparseMatrix<Scalar>& A) override {
    stages_.begin_factorisation(A);
    guarded("Eigen LDLT factorisation", less_than_a_factor, [&] {
      ldlt_->factorize(Wide(A));
      check_pivots(A);
    });
    stages_.factorised(ldlt_->matrixL().nestedExpression().nonZeros() + A.rows());
  }

  SolveReport solve(const Eigen::Ref<const MatrixX<Scalar>>& B, Eigen::Ref<MatrixX<Scalar>> X) const override {
    const Stopwatch timer;
    SolveReport report = stages_.begin_solve<Scalar>(B, X, name());
    report.converged = true;
    if (B.cols() == 0) return report;
    guarded("Eigen LDLT solve", less_than_a_factor, [&] { X = ldlt_->solve(B); });
    report.solve_seconds = timer.seconds();
    return report;
  }

  [[nodiscard]] std::string name() const override { return "eigen-ldlt"; }

 private:
  // 64-bit indices: the factor of a few million rows has more than 2^31 entries.
  using Wide = Eigen::SparseMatrix<Scalar, Eigen::ColMajor, std::int64_t>;

  void check_pivots(const SparseMatrix<Scalar>& A) const {
    if (ldlt_->info() != Eigen::Success) throw SolveError("Eigen LDLT: the matrix is singular (zero pivot)");
    const auto pivots = ldlt_->vectorD();
    const VectorX<double> diagonal = A.diagonal().real();
    for (Eigen::Index k = 0; k < A.rows(); ++k) {
      const Eigen::Index column = ldlt_->permutationPinv().indices()[k];
      const double pivot = std::real(pivots[k]);
      if (pivot > singular_pivot * diagonal[column]) continue;
      throw SolveError(std::string("Eigen LDLT: the matrix is ") +
                       (pivot < -singular_pivot * std::abs(diagonal[column]) ? "not positive definite"
                                                                             : "singular to working precision") +
                       " (found at column " + std::to_string(column) + ")");
    }
  }

  Stages stages_;
  std::optional<Eigen::SimplicialLDLT<Wide, Eigen::Lower, Eigen::AMDOrdering<std::int64_t>>> ldlt_;
};

}  // namespace

template <class Scalar>
SolverPtr<Scalar> make_eigen_ldlt(const SolverOptions& options) {
  return std::make_unique<EigenLdlt<Scalar>>(options);
}
template SolverPtr<double> make_eigen_ldlt<double>(const SolverOptions&);
template SolverPtr<std::complex<double>> make_eigen_ldlt<std::complex<double>>(const SolverOptions&);

}  // namespace alcap::detail
