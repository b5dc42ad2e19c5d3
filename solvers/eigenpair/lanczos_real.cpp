// SPDX-License-Identifier: MIT
//
// lanczos_real.cpp: as lanczos_spectra.cpp, for operators that are linear over the reals only: nothing pairs u with iu.
#include "solvers/eigenpair/lanczos_real.h"

#include <algorithm>
#include <cmath>

#include "solvers/eigenpair/lanczos_loop.h"
#include "solvers/eigenpair/problem.h"

namespace alcap::detail {
namespace {

using Eigen::Index;
using Vector = VectorX<double>;

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

/// See lanczos_loop.h.
class Iterated {
 public:
  Vector u;
  double lambda = 0;

  explicit Iterated(const RealPencil& pencil) : pencil_(pencil), Su_(pencil.rows), Mu_(pencil.rows) {}

  [[nodiscard]] double estimate(const Recurrence& basis, const RitzPairs& ritz) const {
    const Index k = ritz.values.size();
    const double theta = ritz.values[k - 1];
    Vector Sf(pencil_.rows), Mf(pencil_.rows);
    pencil_.S(basis.vector_f().data(), Sf.data());
    pencil_.M(basis.vector_f().data(), Mf.data());
    const double uniform = 2 * pencil_.scale / static_cast<double>(pencil_.rows);
    const double scale = std::max(1 / theta, 1.0) / pencil_.scale;
    return (Sf - pencil_.shift * Mf).norm() * std::abs(ritz.vectors(k - 1, k - 1)) / (theta * scale * uniform);
  }

  void form(const Recurrence& basis, const RitzPairs& ritz) {
    const Index k = ritz.values.size();
    u.noalias() = basis.matrix_V().leftCols(k) * ritz.vectors.col(k - 1);
  }

  double check() {
    pencil_.M(u.data(), Mu_.data());
    const double mass = u.dot(Mu_);
    if (!(mass > 0)) throw SolveError("the mass matrix is not positive definite");
    u /= std::sqrt(mass);
    Mu_ /= std::sqrt(mass);
    pencil_.S(u.data(), Su_.data());
    lambda = u.dot(Su_);
    return (Su_ - lambda * Mu_).norm() / (std::max(lambda, 1 / pencil_.scale) * Mu_.norm());
  }

  void polish(Index& solves) {
    pencil_.solve(Vector(Mu_).data(), u.data());
    ++solves;
  }

 private:
  const RealPencil& pencil_;
  Vector Su_, Mu_;
};

}  // namespace

RealPair smallest_lanczos_real(const RealPencil& pencil, const EigenOptions& options) {
  const Index size = std::min<Index>(basis_size, pencil.rows - 1);
  const ShiftInvert op(pencil);
  const Mass mass(pencil);
  Recurrence basis(Operators(op, mass), size);
  const ComplexVector start = start_vector((pencil.rows + 1) / 2, options.seed);
  Iterated pair(pencil);
  LanczosLoop loop(pair, basis, options);
  const RitzPairs ritz = loop.run({reinterpret_cast<const double*>(start.data()), pencil.rows}, size);
  const Index k = ritz.values.size();
  const double second = ritz.values[k < 2 ? k - 1 : k - second_place(ritz)];
  EigenReport report;
  report.solver = "real shift-invert Lanczos, " + pencil.name;
  report.iterations = loop.solves();
  report.residual = pair.check();
  report.lambda = pair.lambda;
  report.next = std::max(pencil.shift + 1 / (pencil.scale * second), report.lambda);
  report.converged = report.residual <= options.tolerance;
  if (!report.converged) report.message = "the residual asked for was not reached";
  return {.u = std::move(pair.u), .report = std::move(report)};
}

RealPair smallest_dense_real(const SparseMatrix<double>& S, const SparseMatrix<double>& M, double scale,
                             const EigenOptions& options) {
  using Dense = MatrixX<double>;
  const auto pairs = generalised_eigenpairs<double>(Dense(S), Dense(M));
  if (!pairs) throw SolveError("the mass matrix is not positive definite");
  RealPair result;
  result.u = pairs->vectors.col(0);
  EigenReport& report = result.report;
  report.solver = "dense";
  report.lambda = pairs->values[0];
  report.next = pairs->values[std::min<Index>(1, S.rows() - 1)];
  const Vector Mu = M * result.u;
  report.residual = (S * result.u - report.lambda * Mu).norm() / (std::max(report.lambda, 1 / scale) * Mu.norm());
  report.converged = report.residual <= options.tolerance;
  if (!report.converged) report.message = "the residual asked for was not reached";
  return result;
}

}  // namespace alcap::detail
