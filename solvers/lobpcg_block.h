// SPDX-License-Identifier: MIT
//
// lobpcg_block.h: block LOBPCG (Knyazev 2001) in single precision for K vectors, with the Gram matrices summed in
// double. For the cascade from the coarsest level; the last digits are the work of the refinement in double. Internal
// to solvers/.
//
// Blocks lie as in mg_level.h. Gram matrices of the old vectors are known from the step before, so a step computes only
// the products of the new directions W with everything.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "alcap/parallel.h"
#include "solvers/ritz.h"

namespace alcap::detail {

/// K vectors and their products with S and M.
struct Block {
  std::vector<float> v, S, M;
  void resize(std::size_t size) {
    for (std::vector<float>* x : {&v, &S, &M}) x->resize(size);
  }
};

/// out += left^H right over a few rows, summed in Real; out is K x K: rows of real parts and, behind all of them, rows
/// of imaginary parts.
template <int K, class Real = float>
void add_gram(const float* left, const float* right, std::int64_t rows, double* out) {
  for (int a = 0; a < K; ++a) {
    Real re[K] = {};
    Real im[K] = {};
    for (std::int64_t i = 0; i < rows; ++i) {
      const Real lr = left[2 * K * i + a];
      const Real li = left[2 * K * i + K + a];
      const float* z = right + 2 * K * i;
      for (int b = 0; b < K; ++b) re[b] += lr * Real{z[b]} + li * Real{z[K + b]};
      for (int b = 0; b < K; ++b) im[b] += lr * Real{z[K + b]} - li * Real{z[b]};
    }
    for (int b = 0; b < K; ++b) out[K * a + b] += double{re[b]};
    for (int b = 0; b < K; ++b) out[K * (K + a) + b] += double{im[b]};
  }
}

/// Rows whose products are summed in single precision before they go into the double sum; they stay in the cache.
inline constexpr std::int64_t gram_tile = 64;

/// left[p]^H right[p] for Pairs pairs of blocks, summed over all rows; bitwise independent of threads.
template <int K, std::size_t Pairs, class Real = float>
std::array<MatrixX<std::complex<double>>, Pairs> grams(std::int64_t rows,
                                                       const std::array<std::array<const float*, 2>, Pairs>& pairs) {
  constexpr std::size_t size = 2 * K * K;
  using Sums = std::vector<double>;
  const Sums sums = parallel_reduce(
      rows, Sums{},
      [&](std::int64_t begin, std::int64_t end) {
        Sums sum(Pairs * size);
        for (std::int64_t i = begin; i < end; i += gram_tile) {
          const std::int64_t count = std::min(gram_tile, end - i);
          for (std::size_t p = 0; p < Pairs; ++p)
            add_gram<K, Real>(pairs[p][0] + 2 * K * i, pairs[p][1] + 2 * K * i, count, sum.data() + p * size);
        }
        return sum;
      },
      [](Sums total, const Sums& part) {
        if (total.empty()) return part;
        for (std::size_t s = 0; s < part.size(); ++s) total[s] += part[s];
        return total;
      });
  std::array<MatrixX<std::complex<double>>, Pairs> result;
  for (std::size_t p = 0; p < Pairs; ++p) {
    result[p].resize(K, K);
    for (int a = 0; a < K; ++a)
      for (int b = 0; b < K; ++b) {
        const double* entry = sums.data() + p * size + K * a + b;
        result[p](a, b) = {entry[0], entry[K * K]};
      }
  }
  return result;
}

/// sum += row times coefficients, for the 2 K numbers of one row; c as out of add_gram.
template <int K>
void add_combination(const float* row, const float* c, float* sum) {
  for (int a = 0; a < K; ++a) {
    const float re = row[a];
    const float im = row[K + a];
    for (int b = 0; b < K; ++b) sum[b] += re * c[K * a + b] - im * c[K * (K + a) + b];
    for (int b = 0; b < K; ++b) sum[K + b] += re * c[K * (K + a) + b] + im * c[K * a + b];
  }
}

/// K approximate eigenvectors on one level. Inner products are summed in Sum over short pieces, in double over these.
///
/// Pencil: void apply(const float* x, float* Sx, float* Mx) const for K vectors.
/// Preconditioner: writes T r for residuals r: void operator()(const std::vector<float>& r, std::vector<float>& w).
template <int K, class Pencil, class Sum>
class BlockSolver {
 public:
  using Dense = MatrixX<std::complex<double>>;

  /// Starts from any K independent vectors in `x` (used up): makes them Ritz vectors. `rows` >= K.
  BlockSolver(const Pencil& pencil, std::int64_t rows, std::vector<float> x) : pencil_(pencil), rows_(rows) {
    X_.v = std::move(x);
    X_.S.resize(X_.v.size());
    X_.M.resize(X_.v.size());
    pencil_.template apply<K>(X_.v.data(), X_.S.data(), X_.M.data());
    const auto [S, M] = grams<K, 2, Sum>(rows_, {{{X_.v.data(), X_.S.data()}, {X_.v.data(), X_.M.data()}}});
    accept(rayleigh_ritz(hermitian(S), hermitian(M), K, dependent));
  }

  /// One step: new directions from the preconditioned residuals.
  template <class Preconditioner>
  void step(Preconditioner&& preconditioner) {
    if (W_.v.empty()) {
      W_.resize(X_.v.size());
      P_.resize(X_.v.size());
    }
    // The residuals go where the products of W will be.
    std::array<float, K> theta;
    for (int k = 0; k < K; ++k) theta[static_cast<std::size_t>(k)] = static_cast<float>(values_[k]);
    parallel_for(rows_, [&](std::int64_t i) {
      for (int k = 0; k < 2 * K; ++k) {
        const std::int64_t at = 2 * K * i + k;
        W_.S[static_cast<std::size_t>(at)] =
            X_.S[static_cast<std::size_t>(at)] -
            theta[static_cast<std::size_t>(k % K)] * X_.M[static_cast<std::size_t>(at)];
      }
    });
    preconditioner(W_.S, W_.v);
    pencil_.template apply<K>(W_.v.data(), W_.S.data(), W_.M.data());
    const float* w = W_.v.data();
    Dense S = Dense::Zero(3 * K, 3 * K);
    Dense M = Dense::Zero(3 * K, 3 * K);
    const Eigen::Index size = have_p_ ? 3 * K : 2 * K;
    if (have_p_) {
      const auto g = grams<K, 6, Sum>(rows_, {{{X_.v.data(), W_.S.data()},
                                               {X_.v.data(), W_.M.data()},
                                               {w, W_.S.data()},
                                               {w, W_.M.data()},
                                               {P_.v.data(), W_.S.data()},
                                               {P_.v.data(), W_.M.data()}}});
      fill(S, Dense(values_.cast<std::complex<double>>().asDiagonal()), g[0], g[2]);
      fill(M, Dense::Identity(K, K), g[1], g[3]);
      set(S, 2, 1, g[4]);
      set(M, 2, 1, g[5]);
      set(S, 2, 0, PSX_);
      set(M, 2, 0, PMX_);
      S.template bottomRightCorner<K, K>() = PSP_;
      M.template bottomRightCorner<K, K>() = PMP_;
    } else {
      const auto g = grams<K, 4, Sum>(
          rows_, {{{X_.v.data(), W_.S.data()}, {X_.v.data(), W_.M.data()}, {w, W_.S.data()}, {w, W_.M.data()}}});
      fill(S, Dense(values_.cast<std::complex<double>>().asDiagonal()), g[0], g[2]);
      fill(M, Dense::Identity(K, K), g[1], g[3]);
    }
    const Dense s = S.topLeftCorner(size, size);
    const Dense m = M.topLeftCorner(size, size);
    const Ritz ritz = rayleigh_ritz(s, m, K, dependent);
    if (ritz.values.size() < K || !ritz.coefficients.allFinite()) return;  // nothing new to be had
    const Dense x = ritz.coefficients.topRows(K);
    Dense p = ritz.coefficients;
    p.topRows(K).setZero();
    PSX_ = p.adjoint() * s * ritz.coefficients;
    PMX_ = p.adjoint() * m * ritz.coefficients;
    PSP_ = hermitian(p.adjoint() * s * p);
    PMP_ = hermitian(p.adjoint() * m * p);
    values_ = ritz.values;
    const std::vector<float> cx = coefficients(x);
    const std::vector<float> cw = coefficients(p.middleRows(K, K));
    const std::vector<float> cp = have_p_ ? coefficients(p.bottomRows(K)) : std::vector<float>();
    const auto combine = [&](std::vector<float>& xs, const std::vector<float>& ws, std::vector<float>& ps) {
      parallel_for(rows_, [&](std::int64_t i) {
        const auto at = static_cast<std::size_t>(2 * K * i);
        float direction[2 * K] = {};
        add_combination<K>(ws.data() + at, cw.data(), direction);
        if (!cp.empty()) add_combination<K>(ps.data() + at, cp.data(), direction);
        std::copy(direction, direction + 2 * K, ps.data() + at);
        add_combination<K>(xs.data() + at, cx.data(), direction);
        std::copy(direction, direction + 2 * K, xs.data() + at);
      });
    };
    combine(X_.v, W_.v, P_.v);
    combine(X_.S, W_.S, P_.S);
    combine(X_.M, W_.M, P_.M);
    have_p_ = true;
  }

  /// Ritz values, ascending; as many as there are independent vectors.
  [[nodiscard]] const VectorX<double>& values() const { return values_; }
  /// The Ritz vectors and their products.
  [[nodiscard]] Block& vectors() { return X_; }

 private:
  /// Parts of the basis that are this small beside the whole are rounding of single precision.
  static constexpr double dependent = 1e-6;

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

  static std::vector<float> coefficients(const Dense& C) {
    std::vector<float> c(2 * K * K);
    for (int a = 0; a < K; ++a)
      for (int b = 0; b < K; ++b) {
        c[static_cast<std::size_t>(K * a + b)] = static_cast<float>(C(a, b).real());
        c[static_cast<std::size_t>(K * (K + a) + b)] = static_cast<float>(C(a, b).imag());
      }
    return c;
  }

  void accept(const Ritz& ritz) {
    values_ = ritz.values;
    if (values_.size() < K) return;
    const std::vector<float> c = coefficients(ritz.coefficients);
    for (std::vector<float>* block : {&X_.v, &X_.S, &X_.M}) {
      parallel_for(rows_, [&](std::int64_t i) {
        float sum[2 * K] = {};
        float* row = block->data() + 2 * K * i;
        add_combination<K>(row, c.data(), sum);
        std::copy(sum, sum + 2 * K, row);
      });
    }
  }

  const Pencil& pencil_;
  std::int64_t rows_;
  Block X_, W_, P_;
  bool have_p_ = false;
  VectorX<double> values_;
  Dense PSX_, PMX_, PSP_, PMP_;  // Gram matrices P^H S X ... of the last step
};

}  // namespace alcap::detail
