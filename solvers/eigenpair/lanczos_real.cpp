// SPDX-License-Identifier: MIT
//
// lanczos_real.cpp: as lanczos.cpp, for operators that are linear over the reals only: nothing pairs u with iu.
#include "solvers/eigenpair/lanczos_real.h"

#include <algorithm>
#include <cmath>

#include "solvers/eigenpair/lanczos_loop.h"
#include "solvers/eigenpair/problem.h"

namespace alcap::detail {
namespace {

using Vector = VectorX<double>;

class RealProblem final : public LanczosProblem {
 public:
  explicit RealProblem(const RealPencil& pencil)
      : LanczosProblem(pencil.rows, pencil.scale),
        pencil_(pencil),
        Mx_(pencil.rows),
        u_(pencil.rows),
        Su_(pencil.rows),
        Mu_(pencil.rows) {}

  void solve(const double* Mx, double* y) const override {
    Mx_ = Eigen::Map<const Vector>(Mx, rows()) * (2 / static_cast<double>(rows()));
    pencil_.solve(Mx_.data(), y);
  }

  void mass(const double* x, double* y) const override { pencil_.M(x, y); }

  [[nodiscard]] double shifted_norm(const double* x) const override {
    Vector Sx(rows()), Mx(rows());
    pencil_.S(x, Sx.data());
    pencil_.M(x, Mx.data());
    return (Sx - pencil_.shift * Mx).norm();
  }

  Eigen::Map<Vector> vector() override { return {u_.data(), rows()}; }

  double check() override {
    pencil_.M(u_.data(), Mu_.data());
    const double square = u_.dot(Mu_);
    if (!(square > 0))
      throw SolveError(u_.allFinite() && !u_.isZero(0)
                           ? "the mass matrix M is not positive definite"
                           : "the linear solver returned zeros or values that are not finite; try another "
                             "EigenOptions::solver");
    u_ /= std::sqrt(square);
    Mu_ /= std::sqrt(square);
    pencil_.S(u_.data(), Su_.data());
    lambda_ = u_.dot(Su_);
    return (Su_ - lambda_ * Mu_).norm() / (std::max(lambda_, 1 / pencil_.scale) * Mu_.norm());
  }

  int polish() override {
    pencil_.solve(Vector(Mu_).data(), u_.data());
    return 1;
  }

  [[nodiscard]] Vector& u() { return u_; }
  [[nodiscard]] double lambda() const { return lambda_; }

 private:
  const RealPencil& pencil_;
  mutable Vector Mx_;
  Vector u_, Su_, Mu_;
  double lambda_ = 0;
};

/// The verdict, from the residual.
void judge(EigenReport& report, const EigenOptions& options) {
  report.converged = report.residual <= options.residual_tolerance();
  if (!report.converged) report.message = not_reached;
}

}  // namespace

RealPair smallest_lanczos_real(const RealPencil& pencil, const EigenOptions& options) {
  const ComplexVector start = start_vector((pencil.rows + 1) / 2, options.seed);
  RealProblem problem(pencil);
  LanczosLoop loop(problem, options);
  loop.run(reinterpret_cast<const double*>(start.data()));
  EigenReport report;
  report.solver = "real shift-invert Lanczos, " + pencil.name;
  report.iterations = loop.solves();
  report.residual = problem.check();
  report.lambda = problem.lambda();
  judge(report, options);
  return {.u = std::move(problem.u()), .report = std::move(report)};
}

RealPair smallest_dense_real(const SparseMatrix<double>& S, const SparseMatrix<double>& M, double scale,
                             const EigenOptions& options) {
  const auto pairs = generalised_eigenpairs<double>(MatrixX<double>(S), MatrixX<double>(M));
  if (!pairs) throw_mass(M);
  RealPair result;
  result.u = pairs->vectors.col(0);
  EigenReport& report = result.report;
  report.solver = "dense";
  report.lambda = pairs->values[0];
  if (S.rows() > 1) report.next = pairs->values[1];
  const Vector Mu = M * result.u;
  report.residual = (S * result.u - report.lambda * Mu).norm() / (std::max(report.lambda, 1 / scale) * Mu.norm());
  judge(report, options);
  return result;
}

}  // namespace alcap::detail
