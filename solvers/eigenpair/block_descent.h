// SPDX-License-Identifier: MIT
//
// block_descent.h: the block phase on the finest level: preconditioned block steepest descent (Knyazev 2001, section 4)
// for K vectors in single precision with the matrices of the problem itself: the K lowest Ritz vectors of (X, W), with
// W = T (S X - M X Theta). A few steps, so the search directions of LOBPCG would not pay for their memory. Internal to
// solvers/.
#pragma once

#include "solvers/eigenpair/pencil.h"
#include "solvers/multigrid/hierarchy.h"

namespace alcap::detail {

template <int K>
class FinestBlock {
 public:
  using Dense = MatrixX<std::complex<double>>;

  /// Starts from K vectors in the scaled unknowns of the finest level.
  FinestBlock(const FinePencil& pencil, const Hierarchy& hierarchy, Buffer<float> x)
      : pencil_(pencil), hierarchy_(hierarchy), X_(std::move(x)), workspace_(hierarchy.workspace<K>()) {
    unscale(X_.data());
    const auto [S, M] = block_grams<K, 2>(pencil_.rows(), [this](std::int64_t i, std::int64_t count, double* out) {
      float Sx[2 * K * gram_tile], Mx[2 * K * gram_tile];
      pencil_.template multiply<K>(i, count, X_.data(), Sx, Mx);
      block_kernels<K>().gram(X_.data() + 2 * K * i, Sx, count, out);
      block_kernels<K>().gram(X_.data() + 2 * K * i, Mx, count, out + 2 * K * K);
    });
    const Ritz ritz = rayleigh_ritz(hermitian(S), hermitian(M), K, dependent);
    values_ = ritz.values;
    if (values_.size() == K) rotate<K>(pencil_.rows(), ritz.coefficients, X_.data());
  }

  /// One step; false when there was nothing new to be had.
  bool step() {
    residuals();
    hierarchy_.cycle<K>(workspace_);
    const float* const W = workspace_.x[0].data();
    unscale(workspace_.x[0].data());
    const auto [XSW, XMW, WSW, WMW] =
        block_grams<K, 4>(pencil_.rows(), [this, W](std::int64_t i, std::int64_t count, double* out) {
          float Sw[2 * K * gram_tile], Mw[2 * K * gram_tile];
          pencil_.template multiply<K>(i, count, W, Sw, Mw);
          const float* const rows[2] = {X_.data() + 2 * K * i, W + 2 * K * i};
          for (int p = 0; p < 4; ++p)
            block_kernels<K>().gram(rows[p / 2], p % 2 == 0 ? Sw : Mw, count, out + p * 2 * K * K);
        });
    Dense S(2 * K, 2 * K), M(2 * K, 2 * K);
    S << Dense(values_.cast<std::complex<double>>().asDiagonal()), XSW, XSW.adjoint(), hermitian(WSW);
    M << Dense::Identity(K, K), XMW, XMW.adjoint(), hermitian(WMW);
    const Ritz ritz = rayleigh_ritz(S, M, K, dependent);
    if (ritz.values.size() < K || !ritz.coefficients.allFinite()) return false;
    values_ = ritz.values;
    combine<K>(pencil_.rows(), X_.data(), ritz.coefficients.topRows(K), W, ritz.coefficients.bottomRows(K), X_.data());
    return true;
  }

  /// Ritz values, ascending; fewer than K when the vectors were dependent.
  [[nodiscard]] const VectorX<double>& values() const { return values_; }
  /// The Ritz vectors, of M-length 1; ends the block.
  [[nodiscard]] Buffer<float> take() {
    workspace_ = {};
    return std::move(X_);
  }

 private:
  /// Parts of the basis that are this small beside the whole are rounding of single precision.
  static constexpr double dependent = 1e-6;

  static Dense hermitian(const Dense& A) { return 0.5 * (A + A.adjoint()); }

  /// b = N^-1 (S x - theta M x).
  void residuals() {
    float theta[2 * K];
    for (int k = 0; k < 2 * K; ++k) theta[k] = static_cast<float>(values_[k % K]);
    const float* const near = hierarchy_.levels()[0].near.data();
    float* const b = workspace_.b[0].data();
    parallel_ranges(pencil_.rows(), gram_tile, [=, this](std::int64_t begin, std::int64_t end) {
      float Sx[2 * K * gram_tile], Mx[2 * K * gram_tile];
      for (std::int64_t i = begin; i < end; i += gram_tile) {
        const std::int64_t count = std::min(gram_tile, end - i);
        pencil_.template multiply<K>(i, count, X_.data(), Sx, Mx);
        for (std::int64_t j = 0; j < count; ++j) {
          const float scale = 1 / near[i + j];
          float* const out = b + 2 * K * (i + j);
          for (int k = 0; k < 2 * K; ++k) out[k] = scale * (Sx[2 * K * j + k] - theta[k] * Mx[2 * K * j + k]);
        }
      }
    });
  }

  void unscale(float* x) const {
    const float* const near = hierarchy_.levels()[0].near.data();
    parallel_for(pencil_.rows(), [=](std::int64_t i) {
      const float scale = 1 / near[i];
      for (int k = 0; k < 2 * K; ++k) x[2 * K * i + k] *= scale;
    });
  }

  const FinePencil& pencil_;
  const Hierarchy& hierarchy_;
  Buffer<float> X_;
  Hierarchy::Workspace workspace_;
  VectorX<double> values_;
};

}  // namespace alcap::detail
