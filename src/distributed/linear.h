// SPDX-License-Identifier: MIT
//
// linear.h: Hermitian positive definite systems over all ranks, by conjugate gradients with the covariant multigrid.
// Internal to src/distributed.
#pragma once

#include <string>

#include "src/distributed/multigrid.h"

namespace alcap::detail::distributed {

class LinearSystem {
 public:
  /// `transport`: as of Multigrid. `tolerance`: relative residual, recomputed.
  LinearSystem(petsc::OwnedMat A, Mat transport, double tolerance, int max_iterations);

  /// x = A^-1 b, or as near to it as rounding and the iterations let it come. Both are values at this rank's rows.
  void solve(const ComplexVectorX<double>& b, ComplexVectorX<double>& x);
  /// y = A x.
  void multiply(const ComplexVectorX<double>& x, ComplexVectorX<double>& y) const;

  [[nodiscard]] int solves() const { return solves_; }
  [[nodiscard]] int iterations() const { return iterations_; }
  [[nodiscard]] std::string name() const;

 private:
  /// A vector over the values of somebody.
  [[nodiscard]] petsc::OwnedVec over(const ComplexVectorX<double>& x) const;

  Multigrid multigrid_;
  petsc::OwnedKsp ksp_;
  double tolerance_;
  int max_iterations_;
  PetscInt rows_ = 0, all_ = 0;
  int solves_ = 0, iterations_ = 0;
};

/// |x| over all ranks.
[[nodiscard]] double norm(const ComplexVectorX<double>& x);

}  // namespace alcap::detail::distributed
