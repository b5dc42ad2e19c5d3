// SPDX-License-Identifier: MIT
//
// lanczos_spectra.cpp: smallest eigenpair by shift-invert Lanczos with implicit restarts (Sorensen 1992), the
// recurrence by Spectra, the linear solves by any backend.
//
// Spectra knows real symmetric operators only. The complex operator Op = (S - sigma M)^-1 M acts on the interleaved
// real view of its vectors. For a Hermitian operator and one start vector the two Lanczos processes are the same in
// exact arithmetic (all inner products are real), so the doubled spectrum of the real view costs nothing; copies i u
// that rounding brings in are removed by a complex Rayleigh-Ritz step.
//
// The basis grows one vector, one solve, at a time, and after each the residual of the first Ritz pair is computed:
// with Op V = V H + f e^T, a Ritz pair (theta, y = V s) has S y - lambda M y = -(s_last / theta) (S - sigma M) f. When
// that says it is done, the vector is formed and its true residual decides.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

#include "solvers/backends.h"
#include "solvers/eigen_problem.h"
#include "solvers/lanczos_recurrence.h"

namespace alcap::detail {
namespace {

using Eigen::Index;
using std::complex;

/// The second eigenvalue is an information, not the result: its Ritz vector this good gives it to about 1e-3.
constexpr double next_tolerance = 1e-3;
constexpr int solves_for_next = 12;
/// Ritz values this close, relatively, to the first may be copies of it.
constexpr double copy = 1e-6;
/// When the recurrence promises this fraction of the true residual, the rest is rounding.
constexpr double limited = 1e-2;

/// Op in units of the area, so that Spectra's absolute thresholds see numbers near 1.
class ShiftInvert {
 public:
  using Scalar = double;
  ShiftInvert(const EigenProblem& problem, const LinearSolver<complex<double>>& solver)
      : problem_(problem), solver_(solver), Mx_(problem.M.rows(), 1) {}
  [[nodiscard]] Index rows() const { return 2 * problem_.M.rows(); }
  void perform_op(const double* x, double* y) const {
    hermitian_product(problem_.M, reinterpret_cast<const complex<double>*>(x), Mx_.data());
    Mx_ /= problem_.area;
    Eigen::Map<MatrixX<complex<double>>> result(reinterpret_cast<complex<double>*>(y), Mx_.rows(), 1);
    solver_.solve(Mx_, result);
  }

 private:
  const EigenProblem& problem_;
  const LinearSolver<complex<double>>& solver_;
  mutable MatrixX<complex<double>> Mx_;
};

/// Inner product: M in units of its mean row sum.
class Mass {
 public:
  using Scalar = double;
  explicit Mass(const EigenProblem& problem)
      : M_(problem.M), scale_(static_cast<double>(problem.M.rows()) / problem.area) {}
  [[nodiscard]] Index rows() const { return 2 * M_.rows(); }
  void perform_op(const double* x, double* y) const {
    hermitian_product(M_, reinterpret_cast<const complex<double>*>(x), reinterpret_cast<complex<double>*>(y));
    Eigen::Map<VectorX<double>>(y, rows()) *= scale_;
  }

 private:
  const HermitianMatrix& M_;
  double scale_;
};

using Operators = Spectra::ArnoldiOp<double, ShiftInvert, Mass>;

using Recurrence = LanczosRecurrence<Operators>;

class Lanczos {
 public:
  Lanczos(const EigenProblem& problem, const EigenOptions& options)
      : problem_(problem), options_(options), rows_(problem.S.rows()), inverse_(shift_invert(problem, options)) {}

  EigenResult run() {
    EigenResult result;
    const ShiftInvert op(problem_, *inverse_.solver);
    const Mass mass(problem_);
    const Index size = std::min<Index>(basis_size, 2 * rows_ - 1);
    Recurrence basis(Operators(op, mass), size);
    ComplexVector start = start_vector(rows_, options_.seed);
    static_cast<void>(check_pair(problem_, start, Su_, Mu_));  // throws when M is not positive definite
    Index solves = 0;
    Eigen::Map<const VectorX<double>> real(reinterpret_cast<const double*>(start.data()), 2 * rows_);
    basis.init(real, solves);
    Index stop_next = options_.max_iterations;  // when to stop waiting for the second Ritz value
    bool found = false;
    for (Index k = 1;; ++k) {
      check_cancelled(options_.cancel);
      const Eigen::SelfAdjointEigenSolver<MatrixX<double>> ritz(basis.matrix_H().topLeftCorner(k, k));
      if (!found && estimate(basis, ritz) <= options_.tolerance) {
        found = accept(basis, ritz, result.u, solves);
        if (found) stop_next = std::min<Index>(stop_next, solves + solves_for_next);
      }
      const bool next_known = second_is_good(basis, ritz);
      const bool give_up = solves >= options_.max_iterations;
      if ((found && (next_known || solves >= stop_next)) || give_up) {
        if (!found) static_cast<void>(accept(basis, ritz, result.u, solves));
        result.report.next = second(basis, ritz);
        break;
      }
      if (k == size) {
        basis.restart(std::min(kept, size / 2), ritz.eigenvalues());
        k = basis.subspace_dim();
      }
      basis.factorize_from(k, k + 1, solves);
    }
    result.report.iterations = static_cast<int>(solves);
    result.report.solver = "shift-invert Lanczos, " + inverse_.solver->name();
    conclude(problem_, options_, result);
    return result;
  }

 private:
  using Ritz = Eigen::SelfAdjointEigenSolver<MatrixX<double>>;

  /// Residual of the first Ritz pair, but for |M y|, for which the first guess is that of a uniform vector, and later
  /// what the last true residual taught.
  double estimate(const Recurrence& basis, const Ritz& ritz) {
    const Index k = ritz.eigenvalues().size();
    const double theta = ritz.eigenvalues()[k - 1];
    ComplexVector r(rows_);
    hermitian_product(inverse_.A, reinterpret_cast<const complex<double>*>(basis.vector_f().data()), r.data());
    // Basis vectors have y^H M y = area / rows: see Mass. Eigenvalues are theta = 1 / (area (lambda - sigma)).
    const double uniform = problem_.area / static_cast<double>(rows_);
    const double scale = std::max(1 / theta, 1.0) / problem_.area;
    return correction_ * r.norm() * std::abs(ritz.eigenvectors()(k - 1, k - 1)) / (theta * scale * uniform);
  }

  /// Forms the first Ritz vector and says whether to stop: its true residual is good enough, or rounding does not let
  /// it get better.
  bool accept(const Recurrence& basis, const Ritz& ritz, ComplexVector& u, Index& solves) {
    const Index k = ritz.eigenvalues().size();
    u.resize(rows_);
    Eigen::Map<VectorX<double>>(reinterpret_cast<double*>(u.data()), 2 * rows_).noalias() =
        basis.matrix_V().leftCols(k) * ritz.eigenvectors().col(k - 1);
    double residual = check_pair(problem_, u, Su_, Mu_).residual;
    const double promised = estimate(basis, ritz) / correction_;
    for (int round = 0; residual > options_.tolerance && promised < limited * residual; ++round) {
      // The recurrence has converged further than the vector: what is left is rounding in the solves.
      const ComplexVector before = u;
      polish(u, solves);
      const double after = check_pair(problem_, u, Su_, Mu_).residual;
      if (after > residual) u = before;
      if (round == 3 || after > 0.5 * residual) return true;
      residual = after;
    }
    if (residual <= options_.tolerance) return true;
    correction_ *= 2 * residual / options_.tolerance;
    return false;
  }

  /// One step of inverse iteration with a refined solve: its error is that of the residual's own rounding.
  void polish(ComplexVector& u, Index& solves) const {
    MatrixX<complex<double>> x(rows_, 1);
    MatrixX<complex<double>> r = Mu_;
    inverse_.solver->solve(r, x);
    ComplexVector Ax(rows_);
    hermitian_product(inverse_.A, x.data(), Ax.data());
    r = Mu_ - Ax;
    u = x;
    inverse_.solver->solve(r, x);
    u += x.col(0);
    solves += 2;
  }

  /// The Ritz value after the first, or the copies of it that rounding brings in, counted from the end.
  static Index second_place(const Ritz& ritz) {
    const VectorX<double>& theta = ritz.eigenvalues();
    const Index k = theta.size();
    Index place = 2;
    while (place < k && theta[k - place] > (1 - copy) * theta[k - 1]) ++place;
    return place;
  }

  static bool second_is_good(const Recurrence& basis, const Ritz& ritz) {
    const Index k = ritz.eigenvalues().size();
    if (k < 2) return false;
    const Index at = k - second_place(ritz);
    return std::abs(ritz.eigenvectors()(k - 1, at)) * basis.f_norm() <= next_tolerance * ritz.eigenvalues()[at];
  }

  /// The second eigenvalue from the first few Ritz vectors, u and i u counted once.
  double second(const Recurrence& basis, const Ritz& ritz) const {
    const Index k = ritz.eigenvalues().size();
    const Index count = std::min<Index>(k, k < 2 ? 1 : second_place(ritz) + 2);
    MatrixX<complex<double>> Y(rows_, count);
    Eigen::Map<MatrixX<double>>(reinterpret_cast<double*>(Y.data()), 2 * rows_, count).noalias() =
        basis.matrix_V().leftCols(k) * ritz.eigenvectors().rightCols(count);
    const std::vector<double> values = ritz_values(problem_, Y);
    return values[std::min<std::size_t>(1, values.size() - 1)];
  }

  const EigenProblem& problem_;
  const EigenOptions& options_;
  Index rows_;
  ShiftInverted inverse_;
  double correction_ = 1;
  ComplexVector Su_, Mu_;
};

}  // namespace

EigenResult smallest_lanczos(const EigenProblem& problem, const EigenOptions& options) {
  return Lanczos(problem, options).run();
}

}  // namespace alcap::detail
