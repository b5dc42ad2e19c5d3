// SPDX-License-Identifier: MIT
#include "src/distributed/linear.h"

#include <algorithm>
#include <cmath>

#include "src/base/cancel.h"

namespace alcap::detail::distributed {
namespace {

/// Residuals that conjugate gradients carry along drift from the true ones: so much is asked of a round, from the true
/// residual, and the next one starts there.
constexpr double reduction = 1e-10;
/// A round that gains less than this has come to rounding.
constexpr double useful = 0.5;

}  // namespace

double norm(const ComplexVectorX<double>& x) { return std::sqrt(sum(x.squaredNorm())); }

LinearSystem::LinearSystem(petsc::OwnedMat A, Mat transport, double tolerance, int max_iterations)
    : multigrid_(std::move(A), transport), tolerance_(tolerance), max_iterations_(max_iterations) {
  const Mat matrix = multigrid_.matrix();
  check(MatGetLocalSize(matrix, &rows_, nullptr));
  check(MatGetSize(matrix, &all_, nullptr));
  PC pc = nullptr;
  check(KSPCreate(PETSC_COMM_WORLD, ksp_.out()));
  check(KSPSetOperators(ksp_.get(), matrix, matrix));
  check(KSPSetType(ksp_.get(), KSPCG));
  check(KSPSetNormType(ksp_.get(), KSP_NORM_UNPRECONDITIONED));
  check(KSPGetPC(ksp_.get(), &pc));
  multigrid_.configure(pc);
}

petsc::OwnedVec LinearSystem::over(const ComplexVectorX<double>& x) const {
  petsc::OwnedVec v;
  check(VecCreateMPIWithArray(PETSC_COMM_WORLD, 1, rows_, all_, x.data(), v.out()));
  return v;
}

void LinearSystem::multiply(const ComplexVectorX<double>& x, ComplexVectorX<double>& y) const {
  y.resize(rows_);
  check(MatMult(multigrid_.matrix(), over(x).get(), over(y).get()));
}

void LinearSystem::solve(const ComplexVectorX<double>& b, ComplexVectorX<double>& x) {
  ++solves_;
  x = ComplexVectorX<double>::Zero(rows_);
  const double size = norm(b);
  if (size == 0 || !std::isfinite(size)) {
    if (size != 0) x.setConstant(std::nan(""));
    return;
  }
  ComplexVectorX<double> r = b, step(rows_), y;
  double last = size;
  for (int used = 0; used < max_iterations_;) {
    check_cancelled();
    PetscInt count = 0;
    check(KSPSetTolerances(ksp_.get(), std::max(reduction, tolerance_ * size / last / 2), PETSC_DEFAULT, PETSC_DEFAULT,
                           max_iterations_ - used));
    check(KSPSolve(ksp_.get(), over(r).get(), over(step).get()));
    check(KSPGetIterationNumber(ksp_.get(), &count));
    used += std::max<int>(count, 1);
    iterations_ += count;
    step += x;
    multiply(step, y);
    y = b - y;
    const double now = norm(y);
    if (!(now < last)) return;  // what is there is better
    x.swap(step);
    r.swap(y);
    if (now <= tolerance_ * size || now > useful * last) return;
    last = now;
  }
}

std::string LinearSystem::name() const {
  return "conjugate gradients, covariant multigrid of " + std::to_string(multigrid_.levels()) + " levels over PETSc";
}

}  // namespace alcap::detail::distributed
