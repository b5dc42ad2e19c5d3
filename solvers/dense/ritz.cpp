// SPDX-License-Identifier: MIT
#include "solvers/dense/ritz.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>

namespace alcap::detail {
namespace {

using Dense = MatrixX<std::complex<double>>;

/// T with T^H M T = 1 for a matrix M of unit diagonal, without the directions that are dependent.
Dense orthonormal(const Dense& M, double dependent) {
  // A basis this well conditioned needs no eigenvectors to lose nothing, which take five times as long.
  constexpr double well_conditioned = 1e-4;
  const Eigen::LLT<Dense> llt(M);
  if (llt.info() == Eigen::Success && llt.rcond() > well_conditioned)
    return llt.matrixU().solve(Dense::Identity(M.rows(), M.cols()));
  const Eigen::SelfAdjointEigenSolver<Dense> basis(M);
  const double largest = basis.eigenvalues()[M.rows() - 1];
  const Eigen::Index first = (basis.eigenvalues().array() <= dependent * largest).cast<Eigen::Index>().sum();
  const Eigen::Index rank = M.rows() - first;
  return basis.eigenvectors().rightCols(rank) * basis.eigenvalues().tail(rank).cwiseSqrt().cwiseInverse().asDiagonal();
}

}  // namespace

Ritz rayleigh_ritz(const MatrixX<std::complex<double>>& S, const MatrixX<std::complex<double>>& M, Eigen::Index count,
                   double dependent) {
  const VectorX<double> length = M.diagonal().real().cwiseMax(0).cwiseSqrt();
  // A vector of length 0 is no direction: its row becomes that of the identity times 0.
  const VectorX<double> scale = length.unaryExpr([](double l) { return l > 0 && std::isfinite(l) ? 1 / l : 0.0; });
  const Dense unit = scale.asDiagonal() * M * scale.asDiagonal();
  const Dense T = scale.asDiagonal() * orthonormal(unit, dependent);
  const Dense H = T.adjoint() * S * T;
  Eigen::SelfAdjointEigenSolver<Dense> projected;
  projected.compute(H);
  count = std::min(count, T.cols());
  return {projected.eigenvalues().head(count), T * projected.eigenvectors().leftCols(count)};
}

}  // namespace alcap::detail
