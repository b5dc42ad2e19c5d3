// SPDX-License-Identifier: MIT
#include "solvers/ritz.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace alcap::detail {

Ritz rayleigh_ritz(const MatrixX<std::complex<double>>& S, const MatrixX<std::complex<double>>& M, Eigen::Index count,
                   double dependent) {
  using Dense = MatrixX<std::complex<double>>;
  const VectorX<double> length = M.diagonal().real().cwiseMax(0).cwiseSqrt();
  // A vector of length 0 is no direction: its row becomes that of the identity times 0.
  const VectorX<double> scale = length.unaryExpr([](double l) { return l > 0 && std::isfinite(l) ? 1 / l : 0.0; });
  const Dense unit = scale.asDiagonal() * M * scale.asDiagonal();
  Eigen::SelfAdjointEigenSolver<Dense> basis;
  basis.compute(unit);
  const double largest = basis.eigenvalues()[unit.rows() - 1];
  const Eigen::Index first = (basis.eigenvalues().array() <= dependent * largest).cast<Eigen::Index>().sum();
  const Eigen::Index rank = unit.rows() - first;
  const Dense T = scale.asDiagonal() * (basis.eigenvectors().rightCols(rank) *
                                        basis.eigenvalues().tail(rank).cwiseSqrt().cwiseInverse().asDiagonal());
  const Dense H = T.adjoint() * S * T;
  Eigen::SelfAdjointEigenSolver<Dense> projected;
  projected.compute(H);
  count = std::min(count, rank);
  return {projected.eigenvalues().head(count), T * projected.eigenvectors().leftCols(count)};
}

}  // namespace alcap::detail
