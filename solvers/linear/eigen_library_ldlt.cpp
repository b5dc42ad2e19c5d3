// SPDX-License-Identifier: MIT
//
// eigen_library_ldlt.cpp: Eigen's simplicial LDL^H with AMD ordering. No dependency beyond Eigen; on one thread and
// without dense blocks, so only for small problems and for embedders who build without CHOLMOD.
#include <Eigen/SparseCholesky>
#include <cstdint>
#include <optional>
#include <string>

#include "solvers/linear/backends.h"

namespace alcap::detail {
namespace {

template <class Scalar>
class EigenLdlt final : public LinearSolver<Scalar> {
 public:
  explicit EigenLdlt(const SolverOptions& options) : cancel_(options.cancel) {}

  void analyse(const SparseMatrix<Scalar>& A) override {
    const Timer timer;
    require_square(A);
    check_cancelled(cancel_);
    factorised_ = false;
    rows_ = 0;
    guarded("Eigen LDLT analysis", [&] {
      ldlt_.emplace();  // Eigen's arrays do not survive a resize without memory: the old ones are given up first
      ldlt_->analyzePattern(Wide(A));
    });
    rows_ = A.rows();
    nonzeros_ = A.nonZeros();
    report_.analyse_seconds = timer.seconds();
  }

  void factorise(const SparseMatrix<Scalar>& A) override {
    const Timer timer;
    if (rows_ == 0) throw SolveError("Eigen LDLT: factorise() before analyse()");
    if (A.rows() != rows_ || A.cols() != rows_ || A.nonZeros() != nonzeros_) {
      throw SolveError("Eigen LDLT: the matrix has another pattern than the one analysed");
    }
    check_cancelled(cancel_);
    factorised_ = false;
    guarded("Eigen LDLT factorisation", [&] {
      ldlt_->factorize(Wide(A));
      check_pivots(A);
    });
    factorised_ = true;
    report_.factor_nonzeros = ldlt_->matrixL().nestedExpression().nonZeros() + rows_;
    report_.factorise_seconds = timer.seconds();
  }

  SolveReport solve(const Eigen::Ref<const MatrixX<Scalar>>& B, Eigen::Ref<MatrixX<Scalar>> X) const override {
    const Timer timer;
    if (!factorised_) throw SolveError("Eigen LDLT: solve() before factorise()");
    require_sizes(B, X, rows_);
    check_cancelled(cancel_);
    SolveReport report = report_;
    report.solver = name();
    report.converged = true;
    if (B.cols() == 0) return report;
    guarded("Eigen LDLT solve", [&] { X = ldlt_->solve(B); });
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
    for (Eigen::Index k = 0; k < rows_; ++k) {
      const Eigen::Index column = ldlt_->permutationPinv().indices()[k];
      const double pivot = std::real(pivots[k]);
      if (pivot > singular_pivot * diagonal[column]) continue;
      throw SolveError(std::string("Eigen LDLT: the matrix is ") +
                       (pivot < -singular_pivot * std::abs(diagonal[column]) ? "not positive definite"
                                                                             : "singular to working precision") +
                       " (found at column " + std::to_string(column) + ")");
    }
  }

  std::function<bool()> cancel_;
  std::optional<Eigen::SimplicialLDLT<Wide, Eigen::Lower, Eigen::AMDOrdering<std::int64_t>>> ldlt_;
  Eigen::Index rows_ = 0;
  Eigen::Index nonzeros_ = 0;
  bool factorised_ = false;
  SolveReport report_;  // times of analyse() and factorise()
};

}  // namespace

template <class Scalar>
SolverPtr<Scalar> make_eigen_ldlt(const SolverOptions& options) {
  return std::make_unique<EigenLdlt<Scalar>>(options);
}
template SolverPtr<double> make_eigen_ldlt<double>(const SolverOptions&);
template SolverPtr<std::complex<double>> make_eigen_ldlt<std::complex<double>>(const SolverOptions&);

}  // namespace alcap::detail
