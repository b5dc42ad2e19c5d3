// SPDX-License-Identifier: MIT
//
// block_lobpcg.h: block LOBPCG (Knyazev 2001, algorithm 5.1) in single precision for K vectors, with the Gram matrices
// summed in double. For the cascade from the coarsest level; the last digits are the work of the refinement in double.
// Internal to solvers/.
//
// A step takes the K lowest Ritz pairs of S u = lambda M u in the span of (X, W, P): X the vectors, W = T (S X - M X
// Theta) the preconditioned residuals, P what the step before added to X:
//   (X, W, P)^H S (X, W, P) C = (X, W, P)^H M (X, W, P) C Theta,   P := W C_W + P C_P,   X := X C_X + P.
// Blocks lie as in multigrid/level.h. Gram matrices of X and P are known from the step before, so a step computes only
// the products of W with everything.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "solvers/dense/ritz.h"
#include "solvers/multigrid/level.h"
#include "src/base/parallel.h"

namespace alcap::detail {

/// K vectors and their products with S and M.
struct Block {
  Buffer<float> v, S, M;
  Block() = default;
  explicit Block(std::int64_t size) : v(size), S(size), M(size) {}
};

/// Rows whose products are summed in single precision before they go into the double sum; they stay in the cache.
inline constexpr std::int64_t gram_tile = 64;

/// K x K matrices that add(i, count, out) adds up over the rows i ... i + count, out as of BlockKernels::gram, one
/// after another; bitwise independent of threads.
template <int K, std::size_t Count, class Add>
std::array<MatrixX<std::complex<double>>, Count> block_grams(std::int64_t rows, Add&& add) {
  constexpr std::size_t size = 2 * K * K;
  using Sums = std::vector<double>;
  const Sums sums = parallel_reduce(
      rows, Sums{},
      [&](std::int64_t begin, std::int64_t end) {
        Sums sum(Count * size);
        for (std::int64_t i = begin; i < end; i += gram_tile) add(i, std::min(gram_tile, end - i), sum.data());
        return sum;
      },
      [](Sums total, const Sums& part) {
        if (total.empty()) return part;
        for (std::size_t s = 0; s < part.size(); ++s) total[s] += part[s];
        return total;
      });
  std::array<MatrixX<std::complex<double>>, Count> result;
  for (std::size_t p = 0; p < Count; ++p) {
    result[p].resize(K, K);
    for (int a = 0; a < K; ++a)
      for (int b = 0; b < K; ++b) {
        const double* entry = sums.data() + p * size + K * a + b;
        result[p](a, b) = {entry[0], entry[K * K]};
      }
  }
  return result;
}

/// left[p]^H right[p] for Pairs pairs of blocks, summed over all rows.
template <int K, std::size_t Pairs>
std::array<MatrixX<std::complex<double>>, Pairs> grams(std::int64_t rows,
                                                       const std::array<std::array<const float*, 2>, Pairs>& pairs) {
  return block_grams<K, Pairs>(rows, [&](std::int64_t i, std::int64_t count, double* out) {
    for (std::size_t p = 0; p < Pairs; ++p)
      block_kernels<K>().gram(pairs[p][0] + 2 * K * i, pairs[p][1] + 2 * K * i, count, out + p * 2 * K * K);
  });
}

/// Coefficients as BlockKernels::combine takes them.
template <int K>
std::vector<float> as_floats(const MatrixX<std::complex<double>>& C) {
  std::vector<float> c(2 * K * K);
  for (int a = 0; a < K; ++a)
    for (int b = 0; b < K; ++b) {
      c[static_cast<std::size_t>(K * a + b)] = static_cast<float>(C(a, b).real());
      c[static_cast<std::size_t>(K * (K + a) + b)] = static_cast<float>(C(a, b).imag());
    }
  return c;
}

/// out = a A + b B, row by row, with K x K matrices A and B; b may be null, out may be a or b.
template <int K>
void combine(std::int64_t rows, const float* a, const MatrixX<std::complex<double>>& A, const float* b,
             const MatrixX<std::complex<double>>& B, float* out) {
  const std::vector<float> ca = as_floats<K>(A);
  const std::vector<float> cb = b == nullptr ? std::vector<float>() : as_floats<K>(B);
  const auto kernel = block_kernels<K>().combine;
  parallel_ranges(rows, mg_grain, [&](std::int64_t begin, std::int64_t end) {
    const std::int64_t at = 2 * K * begin;
    kernel(a + at, ca.data(), b == nullptr ? nullptr : b + at, cb.data(), end - begin, out + at);
  });
}

/// x := x A, row by row.
template <int K>
void rotate(std::int64_t rows, const MatrixX<std::complex<double>>& A, float* x) {
  combine<K>(rows, x, A, nullptr, A, x);
}

/// K approximate eigenvectors on one level.
///
/// Pencil: void apply(const float* x, float* Sx, float* Mx) const for K vectors.
/// Preconditioner: writes T r for residuals r: void operator()(const float* r, float* w).
template <int K, class Pencil>
class BlockSolver {
 public:
  using Dense = MatrixX<std::complex<double>>;

  /// Starts from any K independent vectors in `x` (used up): makes them Ritz vectors. `rows` >= K.
  BlockSolver(const Pencil& pencil, std::int64_t rows, Buffer<float> x) : pencil_(pencil), rows_(rows) {
    X_.v = std::move(x);
    X_.S = Buffer<float>(X_.v.size());
    X_.M = Buffer<float>(X_.v.size());
    pencil_.template apply<K>(X_.v.data(), X_.S.data(), X_.M.data());
    const auto [S, M] = grams<K, 2>(rows_, {{{X_.v.data(), X_.S.data()}, {X_.v.data(), X_.M.data()}}});
    accept(rayleigh_ritz(hermitian(S), hermitian(M), K, dependent));
  }

  /// One step: new directions from the preconditioned residuals.
  template <class Preconditioner>
  void step(Preconditioner&& preconditioner) {
    if (W_.v.size() == 0) {
      W_ = Block(X_.v.size());
      P_ = Block(X_.v.size());
    }
    // The residuals go where the products of W will be.
    residuals(W_.S.data());
    preconditioner(W_.S.data(), W_.v.data());
    pencil_.template apply<K>(W_.v.data(), W_.S.data(), W_.M.data());
    const auto [S, M] = basis_products();
    const Ritz ritz = rayleigh_ritz(S, M, K, dependent);
    if (ritz.values.size() < K || !ritz.coefficients.allFinite()) return;  // nothing new to be had
    values_ = ritz.values;
    Dense added = ritz.coefficients;  // (0; C_W; C_P)
    added.topRows(K).setZero();
    PSX_ = added.adjoint() * S * ritz.coefficients;
    PMX_ = added.adjoint() * M * ritz.coefficients;
    PSP_ = hermitian(added.adjoint() * S * added);
    PMP_ = hermitian(added.adjoint() * M * added);
    advance(ritz.coefficients);
    have_p_ = true;
  }

  /// Ritz values, ascending; as many as there are independent vectors.
  [[nodiscard]] const VectorX<double>& values() const { return values_; }
  /// The Ritz vectors and their products.
  [[nodiscard]] Block& vectors() { return X_; }

 private:
  /// Parts of the basis that are this small beside the whole are rounding of single precision.
  static constexpr double dependent = 1e-6;

  /// S X - M X Theta.
  void residuals(float* out) const {
    std::array<float, K> theta;
    for (int k = 0; k < K; ++k) theta[static_cast<std::size_t>(k)] = static_cast<float>(values_[k]);
    parallel_for(rows_, [&](std::int64_t i) {
      const float* const s = X_.S.data() + 2 * K * i;
      const float* const m = X_.M.data() + 2 * K * i;
      float r[2 * K];
      for (int k = 0; k < 2 * K; ++k) r[k] = s[k] - theta[static_cast<std::size_t>(k % K)] * m[k];
      std::copy(r, r + 2 * K, out + 2 * K * i);
    });
  }

  /// Gram matrices of (X, W, P), or of (X, W) in the first step, by S and by M.
  [[nodiscard]] std::array<Dense, 2> basis_products() const {
    using Pair = std::array<const float*, 2>;
    const float *const x = X_.v.data(), *const w = W_.v.data(), *const p = P_.v.data();
    const Pair xs{x, W_.S.data()}, xm{x, W_.M.data()}, ws{w, W_.S.data()}, wm{w, W_.M.data()};
    const Dense theta = values_.cast<std::complex<double>>().asDiagonal();
    const Eigen::Index size = have_p_ ? 3 * K : 2 * K;
    Dense S(size, size), M(size, size);
    if (!have_p_) {
      const auto g = grams<K, 4>(rows_, {xs, xm, ws, wm});
      fill(S, theta, g[0], g[2]);
      fill(M, Dense::Identity(K, K), g[1], g[3]);
      return {S, M};
    }
    const auto g = grams<K, 6>(rows_, {xs, xm, ws, wm, Pair{p, W_.S.data()}, Pair{p, W_.M.data()}});
    fill(S, theta, g[0], g[2]);
    fill(M, Dense::Identity(K, K), g[1], g[3]);
    set(S, 2, 1, g[4]);
    set(M, 2, 1, g[5]);
    set(S, 2, 0, PSX_);
    set(M, 2, 0, PMX_);
    S.template bottomRightCorner<K, K>() = PSP_;
    M.template bottomRightCorner<K, K>() = PMP_;
    return {S, M};
  }

  /// P := W C_W + P C_P, X := X C_X + P, and the same for their products.
  void advance(const Dense& C) {
    const Dense c_x = C.topRows(K), c_w = C.middleRows(K, K);
    const Dense c_p = have_p_ ? Dense(C.bottomRows(K)) : Dense();
    const Dense one = Dense::Identity(K, K);
    const auto combined = [&](Buffer<float>& x, const Buffer<float>& w, Buffer<float>& p) {
      combine<K>(rows_, w.data(), c_w, have_p_ ? p.data() : nullptr, c_p, p.data());
      combine<K>(rows_, x.data(), c_x, p.data(), one, x.data());
    };
    combined(X_.v, W_.v, P_.v);
    combined(X_.S, W_.S, P_.S);
    combined(X_.M, W_.M, P_.M);
  }

  static Dense hermitian(const Dense& A) { return 0.5 * (A + A.adjoint()); }

  static void set(Dense& A, int row, int column, const Dense& value) {
    A.block<K, K>(K * row, K * column) = value;
    A.block<K, K>(K * column, K * row) = value.adjoint();
  }

  static void fill(Dense& A, const Dense& xx, const Dense& xw, const Dense& ww) {
    A.topLeftCorner<K, K>() = xx;
    set(A, 0, 1, xw);
    A.block<K, K>(K, K) = hermitian(ww);
  }

  void accept(const Ritz& ritz) {
    values_ = ritz.values;
    if (values_.size() < K) return;
    for (Buffer<float>* block : {&X_.v, &X_.S, &X_.M}) rotate<K>(rows_, ritz.coefficients, block->data());
  }

  const Pencil& pencil_;
  std::int64_t rows_;
  Block X_, W_, P_;  // the vectors, the preconditioned residuals, what the last step added
  bool have_p_ = false;
  VectorX<double> values_;
  Dense PSX_, PMX_, PSP_, PMP_;  // Gram matrices P^H S X ... of the last step
};

}  // namespace alcap::detail
