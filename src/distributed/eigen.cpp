// SPDX-License-Identifier: MIT
//
// eigen.cpp: one component over all ranks: SLEPc's LOBPCG, preconditioned by a multigrid cycle, on tightened tolerances
// until the residual that is recomputed is met.
#include "src/distributed/eigen.h"

#include <slepceps.h>

#include <algorithm>
#include <cmath>

#include "src/base/array.h"
#include "src/base/cancel.h"
#include "src/base/clock.h"
#include "src/base/random.h"
#include "src/distributed/multigrid.h"

namespace alcap::detail::distributed {
namespace {

/// S - sigma M is positive definite even where S is singular or indefinite by rounding.
constexpr double relative_shift = 1e-3;
/// So many rounds at most, each at least this much tighter; one that gains nothing is the last.
constexpr int most_rounds = 8;
constexpr double tighter = 0.1, least_tightening = 1e-4, no_gain = 0.9;
/// Neighbours are computed as well: within a cluster one vector alone hardly moves.
constexpr PetscInt block = 6;

petsc::OwnedVec vector_for(Mat A) {
  petsc::OwnedVec v;
  check(MatCreateVecs(A, v.out(), nullptr));
  return v;
}

class Together {
 public:
  Together(const petsc::OwnedMat& S, const petsc::OwnedMat& M, double area, const std::vector<Index>& numbers,
           const DistributedOptions& options)
      : S_(S.get()),
        M_(M.get()),
        area_(area),
        numbers_(numbers),
        options_(options),
        multigrid_(shifted(), M_),
        u_(vector_for(S_)),
        Su_(vector_for(S_)),
        Mu_(vector_for(S_)),
        diagonal_(vector_for(S_)) {
    check(MatGetDiagonal(S_, diagonal_.get()));
    PetscScalar total = 0;
    PetscInt rows = 0;
    petsc::OwnedVec mass = vector_for(M_);
    check(MatGetDiagonal(M_, mass.get()));
    check(VecSum(mass.get(), &total));
    check(VecGetSize(mass.get(), &rows));
    typical_ = std::sqrt(total.real() / rows);
  }

  EigenReport run() {
    EigenReport report;
    create();
    double tolerance = options_.tolerance, best = HUGE_VAL;
    petsc::OwnedVec x = vector_for(S_);
    start(x.get());
    check(VecCopy(x.get(), u_.get()));
    for (int round = 0; round < most_rounds; ++round) {
      check(VecCopy(u_.get(), x.get()));
      const bool finished = solve(x.get(), tolerance, report);
      const EigenReport now = checked(x.get());
      const double residual = std::max(now.residual, now.energy_residual);
      if (!std::isfinite(residual)) break;
      const bool gained = residual < no_gain * best;
      if (residual < best) {
        best = residual;
        check(VecCopy(x.get(), u_.get()));
        report.lambda = now.lambda;
        report.residual = now.residual;
        report.energy_residual = now.energy_residual;
      }
      if (best <= options_.tolerance || !gained || !finished || report.iterations >= options_.max_iterations) break;
      tolerance *= std::clamp(tighter * options_.tolerance / best, least_tightening, tighter);
    }
    report.converged = best <= options_.tolerance;
    if (!report.converged) report.message = "the residual asked for was not reached";
    report.solver = "SLEPc lobpcg, covariant multigrid of " + std::to_string(multigrid_.levels()) + " levels";
    report.smallest_note = "an inertia over several ranks is not computed";
    return report;
  }

  void copy_to(ComplexVectorX<double>& out) const {
    PetscInt size = 0;
    const PetscScalar* value = nullptr;
    check(VecGetLocalSize(u_.get(), &size));
    check(VecGetArrayRead(u_.get(), &value));
    out = Eigen::Map<const ComplexVectorX<double>>(value, size);
    check(VecRestoreArrayRead(u_.get(), &value));
  }

 private:
  [[nodiscard]] petsc::OwnedMat shifted() const {
    petsc::OwnedMat A;
    check(MatDuplicate(S_, MAT_COPY_VALUES, A.out()));
    check(MatAXPY(A.get(), relative_shift / area_, M_, SAME_NONZERO_PATTERN));
    check(MatSetOption(A.get(), MAT_HERMITIAN, PETSC_TRUE));
    return A;
  }

  /// The same start however the rows are divided among ranks.
  void start(Vec x) const {
    PetscScalar* value = nullptr;
    check(VecGetArray(x, &value));
    for (std::size_t i = 0; i < numbers_.size(); ++i) {
      Random random(options_.seed + (static_cast<std::uint64_t>(numbers_[i]) << 20U));
      const double re = random.uniform(-1, 1);
      value[i] = C(re, random.uniform(-1, 1));
    }
    check(VecRestoreArray(x, &value));
  }

  void create() {
    check(EPSCreate(PETSC_COMM_WORLD, eps_.out()));
    EPS eps = eps_.get();
    check(EPSSetOperators(eps, S_, M_));
    check(EPSSetProblemType(eps, EPS_GHEP));
    check(EPSSetType(eps, EPSLOBPCG));
    check(EPSSetDimensions(eps, 1, PETSC_DEFAULT, PETSC_DEFAULT));
    check(EPSSetWhichEigenpairs(eps, EPS_SMALLEST_REAL));
    check(EPSLOBPCGSetBlockSize(eps, block));
    check(EPSSetConvergenceTestFunction(eps, measure, this, nullptr));
    ST st = nullptr;
    KSP ksp = nullptr;
    PC pc = nullptr;
    check(EPSGetST(eps, &st));
    check(STSetType(st, STPRECOND));
    check(STSetPreconditionerMat(st, multigrid_.matrix()));
    check(STGetKSP(st, &ksp));
    check(KSPSetType(ksp, KSPPREONLY));
    check(KSPGetPC(ksp, &pc));
    multigrid_.configure(pc);
  }

  static PetscErrorCode measure(EPS, PetscScalar value, PetscScalar, PetscReal residual, PetscReal* estimate,
                                void* context) {
    const auto& run = *static_cast<const Together*>(context);
    *estimate = residual / (std::max(value.real(), 1 / run.area_) * run.typical_);
    return 0;
  }

  bool solve(Vec x, double tolerance, EigenReport& report) {
    EPS eps = eps_.get();
    check(EPSSetTolerances(eps, std::max(tolerance, 1e-16), std::max(1, options_.max_iterations - report.iterations)));
    check(EPSSetInitialSpace(eps, 1, &x));
    check(EPSSolve(eps));
    PetscInt iterations = 0, converged = 0;
    check(EPSGetIterationNumber(eps, &iterations));
    check(EPSGetConverged(eps, &converged));
    report.iterations += static_cast<int>(iterations);
    if (converged > 0) {
      check(EPSGetEigenvector(eps, 0, x, nullptr));
    } else {
      BV basis = nullptr;
      check(EPSGetBV(eps, &basis));
      check(BVCopyVec(basis, 0, x));
    }
    return converged > 0;
  }

  /// Scales x to |x|_M = 1; its Rayleigh quotient and residuals (EigenReport), recomputed.
  EigenReport checked(Vec x) {
    EigenReport now;
    PetscScalar xMx = 0, xSx = 0, energy = 0;
    PetscReal norm_r = 0, norm_m = 0;
    check(MatMult(M_, x, Mu_.get()));
    check(VecDot(Mu_.get(), x, &xMx));
    check(VecScale(x, 1 / std::sqrt(xMx.real())));
    check(MatMult(M_, x, Mu_.get()));
    check(MatMult(S_, x, Su_.get()));
    check(VecDot(Su_.get(), x, &xSx));
    now.lambda = xSx.real();
    check(VecNorm(Mu_.get(), NORM_2, &norm_m));
    check(VecAXPY(Su_.get(), -now.lambda, Mu_.get()));
    check(VecNorm(Su_.get(), NORM_2, &norm_r));
    now.residual = norm_r / (std::max(now.lambda, 1 / area_) * norm_m);
    check(VecPointwiseDivide(Mu_.get(), Su_.get(), diagonal_.get()));
    check(VecDot(Mu_.get(), Su_.get(), &energy));
    now.energy_residual = energy.real() / std::max(now.lambda, 1e-6 / area_);
    return now;
  }

  Mat S_, M_;
  double area_;
  const std::vector<Index>& numbers_;
  const DistributedOptions& options_;
  Multigrid multigrid_;
  petsc::OwnedVec u_, Su_, Mu_, diagonal_;
  petsc::OwnedEps eps_;
  double typical_ = 1;  ///< |M x| at |x|_M = 1, about
};

}  // namespace

EigenReport smallest_together(const petsc::OwnedMat& S, const petsc::OwnedMat& M, double area,
                              const std::vector<Index>& numbers, const DistributedOptions& options,
                              ComplexVectorX<double>& u) {
  const Stopwatch watch;
  Together together(S, M, area, numbers, options);
  EigenReport report = together.run();
  together.copy_to(u);
  report.seconds = watch.seconds();
  return report;
}

}  // namespace alcap::detail::distributed
