// SPDX-License-Identifier: MIT
//
// linear.cpp: linear backends by PETSc's KSP. The residual that PETSc stops at is its own; so a solve corrects what is
// left over, A d = b - A x, until the true residual is met.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "solvers/linear/stages.h"
#include "solvers/petsc/session.h"
#include "src/base/numbers.h"

namespace alcap::detail::petsc {
namespace {

/// A round of corrections that gains less than this ends them.
constexpr double least_progress = 0.5;
/// How far below the residual that is asked for a round aims: what is recomputed is a little larger.
constexpr double aim = 0.5;
constexpr double least_tolerance = 1e-14;

class Solver final : public LinearSolver<C> {
 public:
  Solver(Kind kind, std::string name, std::string options, const SolverOptions& solver_options)
      : kind_(kind),
        name_(std::move(name)),
        text_(std::move(options)),
        options_(solver_options),
        stages_(name_, solver_options.cancel) {}

  void analyse(const Hermitian& A) override {
    stages_.begin_analysis(A);
    stages_.analysed(A);
  }

  void factorise(const Hermitian& A) override {
    stages_.begin_factorisation(A);
    for (Eigen::Index j = 0; j < A.rows(); ++j)
      if (!(A.coeff(j, j).real() > 0))
        throw SolveError(name_ + ": the matrix is not positive definite (its diagonal is not positive at column " +
                         std::to_string(j) + ")");
    const Session session;
    guarded(name_, advice(), [&] {
      A_ = A;
      ksp_.reset();
      matrix_ = matrix(A_);
      check(KSPCreate(PETSC_COMM_SELF, ksp_.out()));
      check(KSPSetOperators(ksp_.get(), matrix_.get(), matrix_.get()));
      check(KSPSetErrorIfNotConverged(ksp_.get(), PETSC_FALSE));
      choose();
      ask_in_iterations(ksp_.get(), options_.cancel, escape_);
      check(KSPSetUp(ksp_.get()));
      PC pc = nullptr;
      PCFailedReason failed = PC_NOERROR;
      check(KSPGetPC(ksp_.get(), &pc));
      check(PCGetFailedReason(pc, &failed));
      if (failed != PC_NOERROR)
        throw SolveError(name_ + ": the factorisation failed: the matrix is singular, or memory ran out" + advice());
      stages_.factorised(entries(pc));
    });
  }

  SolveReport solve(const Eigen::Ref<const MatrixX<C>>& B, Eigen::Ref<MatrixX<C>> X) const override {
    const Stopwatch timer;
    SolveReport report = stages_.begin_solve<C>(B, X, name_);
    const Session session;
    guarded(name_ + " solve", advice(), [&] {
      for (Eigen::Index c = 0; c < B.cols(); ++c) column(B.col(c), X.col(c), report);
    });
    report.converged = report.residual <= options_.tolerance || (direct() && std::isfinite(report.residual));
    report.solve_seconds = timer.seconds();
    return report;
  }

  [[nodiscard]] std::string name() const override { return name_; }

 private:
  [[nodiscard]] bool direct() const { return kind_ == Kind::mumps; }
  [[nodiscard]] const char* advice() const { return direct() ? less_than_a_factor : more_memory; }

  void choose() {
    KSP ksp = ksp_.get();
    if (kind_ == Kind::mumps) {
      use_mumps(ksp);
      return;
    }
    check(KSPSetType(ksp, KSPCG));
    if (kind_ == Kind::cg_gamg) {
      check(KSPSetNormType(ksp, KSP_NORM_UNPRECONDITIONED));
      use_gamg(ksp);
      return;
    }
    if (text_.empty()) {
      check(KSPSetOptionsPrefix(ksp, "alcap_"));
    } else {
      check(PetscOptionsCreate(database_.out()));
      check(PetscOptionsInsertString(database_.get(), text_.c_str()));
      check(PetscObjectSetOptions(reinterpret_cast<PetscObject>(ksp), database_.get()));
    }
    check(KSPSetFromOptions(ksp));
  }

  /// Of the factor or the hierarchy, as far as PETSc knows.
  [[nodiscard]] std::int64_t entries(PC pc) const {
    if (kind_ == Kind::mumps) {
      Mat factor = nullptr;
      PetscInt count = 0;
      check(PCFactorGetMatrix(pc, &factor));
      check(MatMumpsGetInfog(factor, 29, &count));
      return count >= 0 ? count : -std::int64_t{1'000'000} * count;  // negative: in millions
    }
    PetscReal grid = 0;
    PetscReal operators = 0;
    if (kind_ == Kind::cg_gamg) check(PCMGGetGridComplexity(pc, &grid, &operators));
    return detail::rounded<std::int64_t>(operators * static_cast<double>(A_.nonZeros())).value_or(0);
  }

  void column(const Eigen::Ref<const Vector>& b, Eigen::Ref<Vector> out, SolveReport& report) const {
    const double norm = b.norm();
    Vector x = Vector::Zero(b.size());
    Vector r = b;
    double residual = norm > 0 ? 1 : 0;
    int iterations = 0;
    while (residual > options_.tolerance && iterations < options_.max_iterations) {
      check_cancelled(options_.cancel);
      Vector d = Vector::Zero(b.size());
      iterations += correction(r, d, residual, options_.max_iterations - iterations);
      const Vector next = x + d;
      const Vector left = b - A_ * next;
      const double now = left.norm() / norm;
      if (!(now < residual)) break;
      const bool progress = now <= least_progress * residual;
      x = next;
      r = left;
      residual = now;
      if (!progress) break;
    }
    // x^H A x = x^H b up to the residual: negative only where A is.
    if (residual < 1 && std::real(x.dot(b)) < 0) throw_indefinite();
    out = x;
    report.iterations = std::max(report.iterations, direct() ? 0 : iterations);
    if (!(residual <= report.residual)) report.residual = residual;
  }

  /// A d = r, so far that the residual of the whole is met; the iterations it took.
  int correction(const Vector& r, Vector& d, double residual, int most) const {
    KSP ksp = ksp_.get();
    const OwnedVec from = wrapped(r.data(), r.size());
    const OwnedVec to = wrapped(d.data(), d.size());
    const double relative = std::clamp(aim * options_.tolerance / residual, least_tolerance, aim);
    check(KSPSetTolerances(ksp, relative, 1e-300, PETSC_INFINITY, most));
    const PetscErrorCode code = KSPSolve(ksp, from.get(), to.get());
    escape_.rethrow();
    check(code);
    KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
    PetscInt iterations = 0;
    check(KSPGetConvergedReason(ksp, &reason));
    check(KSPGetIterationNumber(ksp, &iterations));
    if (reason == KSP_DIVERGED_INDEFINITE_MAT || reason == KSP_DIVERGED_INDEFINITE_PC) throw_indefinite();
    if (reason == KSP_DIVERGED_PC_FAILED)
      throw SolveError(name_ + ": the preconditioner or factorisation failed; take another solver, such as '" +
                       preferred_factorisation() + "'");
    return std::max(1, static_cast<int>(iterations));
  }

  [[noreturn]] void throw_indefinite() const { throw SolveError(name_ + ": the matrix is not positive definite"); }

  Kind kind_;
  std::string name_, text_;
  SolverOptions options_;
  Stages stages_;
  Hermitian A_;
  mutable Escape escape_;  // used under a session only
  OwnedOptions database_;
  OwnedMat matrix_;
  OwnedKsp ksp_;
};

}  // namespace

std::unique_ptr<LinearSolver<C>> make_solver(Kind kind, std::string name, std::string options,
                                             const SolverOptions& solver_options) {
  return std::make_unique<Solver>(kind, std::move(name), std::move(options), solver_options);
}

}  // namespace alcap::detail::petsc
