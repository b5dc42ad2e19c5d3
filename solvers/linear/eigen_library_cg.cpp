// SPDX-License-Identifier: MIT
//
// eigen_library_cg.cpp: Eigen's conjugate gradients, preconditioned by its incomplete Cholesky factorisation with as
// many entries as the matrix (Lin and More 1999). On one thread. Iterations grow with the square root of the number of
// vertices, so this is to compare with; it needs the least memory.
#include <Eigen/IterativeLinearSolvers>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "solvers/linear/backends.h"
#include "solvers/linear/stages.h"

namespace alcap::detail {
namespace {

/// The recurrence of the residual drifts from the truth: CG starts again from where it is until the true residual is
/// met, as long as a round gains this factor.
constexpr double least_progress = 0.5;

/// What factorise() made, shared by all solves. Where the factorisation breaks down (it raises the diagonal ten times
/// before it gives up) the diagonal is left.
template <class Scalar>
struct Preconditioner {
  Eigen::IncompleteCholesky<Scalar, Eigen::Lower, Eigen::NaturalOrdering<Index>> factor;
  Eigen::Matrix<Scalar, Eigen::Dynamic, 1> inverse_diagonal;  // empty: use the factor
};

/// What Eigen's CG sees of it: called once per iteration, hence the place to cancel.
template <class Scalar>
class Applied {
 public:
  void bind(const Preconditioner<Scalar>& shared, const std::function<bool()>& cancel) {
    shared_ = &shared;
    cancel_ = &cancel;
  }
  template <class Matrix>
  Applied& analyzePattern(const Matrix&) {
    return *this;
  }
  template <class Matrix>
  Applied& factorize(const Matrix&) {
    return *this;
  }
  template <class Matrix>
  Applied& compute(const Matrix&) {
    return *this;
  }
  template <class Vector>
  [[nodiscard]] Eigen::Matrix<Scalar, Eigen::Dynamic, 1> solve(const Vector& r) const {
    check_cancelled(*cancel_);
    if (shared_->inverse_diagonal.size() > 0) return shared_->inverse_diagonal.cwiseProduct(r);
    return shared_->factor.solve(r);
  }
  [[nodiscard]] Eigen::ComputationInfo info() const { return Eigen::Success; }

 private:
  const Preconditioner<Scalar>* shared_ = nullptr;
  const std::function<bool()>* cancel_ = nullptr;
};

template <class Scalar>
class EigenCg final : public LinearSolver<Scalar> {
 public:
  explicit EigenCg(const SolverOptions& options) : options_(options), stages_("Eigen CG", options.cancel) {}

  void analyse(const SparseMatrix<Scalar>& A) override {
    stages_.begin_analysis(A);
    guarded("Eigen CG analysis", more_memory, [&] {
      // Eigen's arrays do not survive a resize without memory: the old ones are given up first.
      Matrix().swap(A_);
      preconditioner_.emplace();
      preconditioner_->factor.analyzePattern(A);
    });
    stages_.analysed(A);
  }

  void factorise(const SparseMatrix<Scalar>& A) override {
    stages_.begin_factorisation(A);
    guarded("Eigen CG factorisation", more_memory, [&] {
      A_ = A;
      preconditioner_->inverse_diagonal = A_.diagonal();
      for (Eigen::Index j = 0; j < A.rows(); ++j) {
        Scalar& d = preconditioner_->inverse_diagonal[j];
        if (!(std::real(d) > 0)) {
          throw SolveError("Eigen CG: the matrix is not positive definite (its diagonal is not positive at column " +
                           std::to_string(j) + ")");
        }
        d = 1 / std::real(d);
      }
      preconditioner_->factor.factorize(A_);
      if (preconditioner_->factor.info() == Eigen::Success) preconditioner_->inverse_diagonal.resize(0);
    });
    stages_.factorised(preconditioner_->inverse_diagonal.size() > 0 ? A.rows()
                                                                    : preconditioner_->factor.matrixL().nonZeros());
  }

  SolveReport solve(const Eigen::Ref<const MatrixX<Scalar>>& B, Eigen::Ref<MatrixX<Scalar>> X) const override {
    const Stopwatch timer;
    SolveReport report = stages_.begin_solve<Scalar>(B, X, name());
    guarded("Eigen CG solve", more_memory, [&] {
      for (Eigen::Index c = 0; c < B.cols(); ++c) column(B.col(c), X.col(c), report);
    });
    report.converged = report.residual <= options_.tolerance;
    report.solve_seconds = timer.seconds();
    return report;
  }

  [[nodiscard]] std::string name() const override {
    return preconditioner_->inverse_diagonal.size() > 0 ? "eigen-cg (diagonal)" : "eigen-cg (incomplete Cholesky)";
  }

 private:
  using Matrix = SparseMatrix<Scalar>;
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

  void column(const Eigen::Ref<const Vector>& b, Eigen::Ref<Vector> out, SolveReport& report) const {
    // The object keeps counts of its last solve: each solve has its own, on the same matrix and factor.
    Eigen::ConjugateGradient<Matrix, Eigen::Lower | Eigen::Upper, Applied<Scalar>> cg;
    cg.preconditioner().bind(*preconditioner_, options_.cancel);
    cg.setTolerance(options_.tolerance);
    cg.compute(A_);
    Vector x = Vector::Zero(b.size());
    double residual = b.norm() > 0 ? 1 : 0;
    int iterations = 0;
    for (bool progress = true; progress && residual > options_.tolerance && iterations < options_.max_iterations;) {
      const int limit = options_.max_iterations - iterations;
      cg.setMaxIterations(limit);
      const Vector next = cg.solveWithGuess(b, x);
      // Eigen does not count the last one.
      iterations += std::min(limit, static_cast<int>(cg.iterations()) + 1);
      const double now = alcap::residual<Scalar>(A_, next, b);
      if (!(now < residual)) break;  // the last digit is reached, or the recurrence broke down
      progress = now <= least_progress * residual;
      x = next;
      residual = now;
    }
    // x' A x = x' b up to the residual: negative only where A is.
    if (residual <= options_.tolerance && std::real(x.dot(b)) < 0) {
      throw SolveError("Eigen CG: the matrix is not positive definite; a factorisation (the solver '" +
                       preferred_factorisation() + "') says at which column");
    }
    out = x;
    report.iterations = std::max(report.iterations, iterations);
    if (!(residual <= report.residual)) report.residual = residual;
  }

  SolverOptions options_;
  Stages stages_;
  Matrix A_;
  std::optional<Preconditioner<Scalar>> preconditioner_{std::in_place};
};

}  // namespace

template <class Scalar>
SolverPtr<Scalar> make_eigen_cg(const SolverOptions& options) {
  return std::make_unique<EigenCg<Scalar>>(options);
}
template SolverPtr<double> make_eigen_cg<double>(const SolverOptions&);
template SolverPtr<std::complex<double>> make_eigen_cg<std::complex<double>>(const SolverOptions&);

}  // namespace alcap::detail
