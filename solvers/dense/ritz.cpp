// SPDX-License-Identifier: MIT
#include "solvers/dense/ritz.h"

#include <algorithm>
#include <cmath>

#include "solvers/dense/hermitian.h"

namespace alcap::detail {
namespace {

using Dense = MatrixX<std::complex<double>>;

/// T with T^H M T = 1 for a matrix M of unit diagonal, without the directions that are dependent.
Dense orthonormal(const Dense& M, double dependent) {
  // A basis this well conditioned needs no eigenvectors to lose nothing, which take five times as long.
  constexpr double well_conditioned = 1e-4;
  if (std::optional<Dense> T = inverse_cholesky_factor(M, well_conditioned)) return *std::move(T);
  return orthonormal_basis(M, dependent);
}

}  // namespace

Ritz rayleigh_ritz(const MatrixX<std::complex<double>>& S, const MatrixX<std::complex<double>>& M, Eigen::Index count,
                   double dependent) {
  const VectorX<double> length = M.diagonal().real().cwiseMax(0).cwiseSqrt();
  // A vector of length 0 is no direction: its row becomes that of the identity times 0.
  const VectorX<double> scale = length.unaryExpr([](double l) { return l > 0 && std::isfinite(l) ? 1 / l : 0.0; });
  const Dense unit = scale.asDiagonal() * M * scale.asDiagonal();
  const Dense T = scale.asDiagonal() * orthonormal(unit, dependent);
  if (T.cols() == 0) return {VectorX<double>(), Dense(M.rows(), 0)};  // no direction has a length
  const Dense H = T.adjoint() * S * T;
  const Eigenpairs<std::complex<double>> projected = hermitian_eigenpairs<std::complex<double>>(H);
  count = std::min(count, T.cols());
  return {projected.values.head(count), T * projected.vectors.leftCols(count)};
}

}  // namespace alcap::detail
