// SPDX-License-Identifier: MIT
//
// lanczos_real.cpp: as lanczos_spectra.cpp, for operators that are linear over the reals only: nothing pairs u with iu.
#include "solvers/lanczos_real.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "solvers/backends.h"
#include "solvers/eigen_problem.h"
#include "solvers/lanczos_recurrence.h"

namespace alcap::detail {
namespace {

using Eigen::Index;
using Vector = VectorX<double>;

/// The second eigenvalue is an information, not the result.
constexpr double next_tolerance = 1e-3;
constexpr int solves_for_next = 12;
/// Ritz values this close, relatively, to the first may be copies of it.
constexpr double copy = 1e-6;

/// Operators in units of `scale`, so that Spectra's absolute thresholds see numbers near 1.
class ShiftInvert {
 public:
  using Scalar = double;
  explicit ShiftInvert(const RealPencil& pencil) : pencil_(pencil), Mx_(pencil.rows) {}
  [[nodiscard]] Index rows() const { return pencil_.rows; }
  void perform_op(const double* x, double* y) const {
    pencil_.M(x, Mx_.data());
    Mx_ /= pencil_.scale;
    pencil_.solve(Mx_.data(), y);
  }

 private:
  const RealPencil& pencil_;
  mutable Vector Mx_;
};

class Mass {
 public:
  using Scalar = double;
  explicit Mass(const RealPencil& pencil)
      : pencil_(pencil), factor_(static_cast<double>(pencil.rows) / (2 * pencil.scale)) {}
  [[nodiscard]] Index rows() const { return pencil_.rows; }
  void perform_op(const double* x, double* y) const {
    pencil_.M(x, y);
    Eigen::Map<Vector>(y, rows()) *= factor_;
  }

 private:
  const RealPencil& pencil_;
  double factor_;
};

using Operators = Spectra::ArnoldiOp<double, ShiftInvert, Mass>;
using Recurrence = LanczosRecurrence<Operators>;
using Ritz = Eigen::SelfAdjointEigenSolver<MatrixX<double>>;

class Lanczos {
 public:
  Lanczos(const RealPencil& pencil, const EigenOptions& options)
      : pencil_(pencil), options_(options), Su_(pencil.rows), Mu_(pencil.rows) {}

  RealPair run() {
    RealPair result;
    const ShiftInvert op(pencil_);
    const Mass mass(pencil_);
    const Index size = std::min<Index>(basis_size, pencil_.rows - 1);
    Recurrence basis(Operators(op, mass), size);
    const ComplexVector start = start_vector((pencil_.rows + 1) / 2, options_.seed);
    Index solves = 0;
    Eigen::Map<const Vector> real(reinterpret_cast<const double*>(start.data()), pencil_.rows);
    basis.init(real, solves);
    Index stop_next = options_.max_iterations;
    bool found = false;
    for (Index k = 1;; ++k) {
      check_cancelled(options_.cancel);
      const Ritz ritz(basis.matrix_H().topLeftCorner(k, k));
      if (!found && estimate(basis, ritz) <= options_.tolerance) {
        found = accept(basis, ritz, result, solves);
        if (found) stop_next = std::min<Index>(stop_next, solves + solves_for_next);
      }
      const bool give_up = solves >= options_.max_iterations;
      if ((found && (second_is_good(basis, ritz) || solves >= stop_next)) || give_up) {
        if (!found) static_cast<void>(accept(basis, ritz, result, solves));
        const double second = k < 2 ? ritz.eigenvalues()[k - 1] : ritz.eigenvalues()[k - second_place(ritz)];
        result.report.next = pencil_.shift + 1 / (pencil_.scale * second);
        break;
      }
      if (k == size) {
        basis.restart(std::min(kept, size / 2), ritz.eigenvalues());
        k = basis.subspace_dim();
      }
      basis.factorize_from(k, k + 1, solves);
    }
    EigenReport& report = result.report;
    report.iterations = static_cast<int>(solves);
    report.solver = "real shift-invert Lanczos, " + pencil_.name;
    report.residual = check(result.u, report.lambda);
    report.next = std::max(report.next, report.lambda);
    report.converged = report.residual <= options_.tolerance;
    if (!report.converged) report.message = "the residual asked for was not reached";
    return result;
  }

 private:
  /// Scales u to mass 1; its residual and Rayleigh quotient.
  double check(Vector& u, double& lambda) {
    pencil_.M(u.data(), Mu_.data());
    const double mass = u.dot(Mu_);
    if (!(mass > 0)) throw SolveError("the mass matrix is not positive definite");
    u /= std::sqrt(mass);
    Mu_ /= std::sqrt(mass);
    pencil_.S(u.data(), Su_.data());
    lambda = u.dot(Su_);
    return (Su_ - lambda * Mu_).norm() / (std::max(lambda, 1 / pencil_.scale) * Mu_.norm());
  }

  /// Residual of the first Ritz pair, up to a factor that accept() learns.
  double estimate(const Recurrence& basis, const Ritz& ritz) {
    const Index k = ritz.eigenvalues().size();
    const double theta = ritz.eigenvalues()[k - 1];
    Vector Sf(pencil_.rows), Mf(pencil_.rows);
    pencil_.S(basis.vector_f().data(), Sf.data());
    pencil_.M(basis.vector_f().data(), Mf.data());
    const double uniform = 2 * pencil_.scale / static_cast<double>(pencil_.rows);
    const double scale = std::max(1 / theta, 1.0) / pencil_.scale;
    return correction_ * (Sf - pencil_.shift * Mf).norm() * std::abs(ritz.eigenvectors()(k - 1, k - 1)) /
           (theta * scale * uniform);
  }

  bool accept(const Recurrence& basis, const Ritz& ritz, RealPair& result, Index& solves) {
    const Index k = ritz.eigenvalues().size();
    Vector& u = result.u;
    u.noalias() = basis.matrix_V().leftCols(k) * ritz.eigenvectors().col(k - 1);
    double lambda = 0;
    double residual = check(u, lambda);
    const double promised = estimate(basis, ritz) / correction_;
    for (int round = 0; residual > options_.tolerance && promised < 1e-2 * residual; ++round) {
      // The recurrence has converged further than the vector: inverse iteration removes what the solves rounded.
      const Vector before = u;
      pencil_.solve(Vector(Mu_).data(), u.data());
      ++solves;
      const double after = check(u, lambda);
      if (after > residual) u = before;
      if (round == 3 || after > 0.5 * residual) return true;
      residual = after;
    }
    if (residual <= options_.tolerance) return true;
    correction_ *= 2 * residual / options_.tolerance;
    return false;
  }

  static Index second_place(const Ritz& ritz) {
    const Vector& theta = ritz.eigenvalues();
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

  const RealPencil& pencil_;
  const EigenOptions& options_;
  double correction_ = 1;
  Vector Su_, Mu_;
};

}  // namespace

RealPair smallest_lanczos_real(const RealPencil& pencil, const EigenOptions& options) {
  return Lanczos(pencil, options).run();
}

RealPair smallest_dense_real(const SparseMatrix<double>& S, const SparseMatrix<double>& M, double scale,
                             const EigenOptions& options) {
  using Dense = MatrixX<double>;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Dense> solver{Dense(S), Dense(M)};
  if (solver.info() != Eigen::Success) throw SolveError("the mass matrix is not positive definite");
  RealPair result;
  result.u = solver.eigenvectors().col(0);
  EigenReport& report = result.report;
  report.solver = "dense";
  report.lambda = solver.eigenvalues()[0];
  report.next = solver.eigenvalues()[std::min<Index>(1, S.rows() - 1)];
  const Vector Mu = M * result.u;
  report.residual = (S * result.u - report.lambda * Mu).norm() / (std::max(report.lambda, 1 / scale) * Mu.norm());
  report.converged = report.residual <= options.tolerance;
  if (!report.converged) report.message = "the residual asked for was not reached";
  return result;
}

}  // namespace alcap::detail
