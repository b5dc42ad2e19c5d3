// SPDX-License-Identifier: MIT
//
// lanczos_real.h: the smallest eigenpair of a real symmetric pencil given by its products and a solve. For problems on
// complex fields that are linear over the reals only: vectors are (re, im) interleaved. Internal to the library.
#pragma once

#include <functional>

#include "alcap/solve.h"

namespace alcap::detail {

/// S u = lambda M u: S positive semidefinite, M positive definite. Vectors have `rows` entries.
struct RealPencil {
  using Apply = std::function<void(const double* x, double* y)>;
  Eigen::Index rows = 0;
  Apply S, M;
  Apply solve;       ///< (S - shift M)^-1
  double shift = 0;  ///< below the smallest eigenvalue
  double scale = 1;  ///< 1 / scale is the size of eigenvalues; u = 1 has about this mass
  std::string name;  ///< of the solve
};

struct RealPair {
  VectorX<double> u;  ///< u' M u = 1, of either sign
  EigenReport report;
};

/// Shift-invert Lanczos with a checked residual |S u - lambda M u| / (max(lambda, 1/scale) |M u|). A repeated
/// eigenvalue gives one of its vectors. `next` is not established. Non-convergence is reported.
[[nodiscard]] RealPair smallest_lanczos_real(const RealPencil& pencil, const EigenOptions& options);

/// The same for matrices so small that a dense solve is the quickest.
[[nodiscard]] RealPair smallest_dense_real(const SparseMatrix<double>& S, const SparseMatrix<double>& M, double scale,
                                           const EigenOptions& options);

}  // namespace alcap::detail
