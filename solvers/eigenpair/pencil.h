// SPDX-License-Identifier: MIT
//
// pencil.h: the matrices S and M of an eigenproblem side by side: S x and M x in one pass, and used on the spot, so
// that products are never stored. Internal to solvers/.
//
// Both come scaled, so that numbers are near 1 and fit single precision: S to a mean diagonal entry of about 1, M to a
// mean row sum of 1.
#pragma once

#include <array>

#include "solvers/eigenpair/block_lobpcg.h"
#include "solvers/eigenpair/problem.h"
#include "solvers/multigrid/level.h"

namespace alcap::detail {

inline const double* as_pairs(const std::complex<double>* z) { return reinterpret_cast<const double*>(z); }
inline double* as_pairs(std::complex<double>* z) { return reinterpret_cast<double*>(z); }

/// The matrices of the eigenproblem itself. Both are compressed and have the same pattern.
struct FinePencil {
  const HermitianMatrix& S;
  const HermitianMatrix& M;
  double S_scale = 1;
  double M_scale = 1;

  [[nodiscard]] std::int64_t rows() const { return S.cols(); }

  /// use(i, count, Sx, Mx, sums) for tiles of rows i ... i + count - 1 that cover all, Sx and Mx being the products of
  /// these; the sums are added up over fixed chunks.
  template <std::size_t N, class Use>
  [[nodiscard]] std::array<double, N> sums(const std::complex<double>* x, Use&& use) const {
    using Sums = std::array<double, N>;
    const auto both_products = vector_kernels<4>().pencil;
    return parallel_reduce(
        rows(), Sums{},
        [&, raw = raw()](std::int64_t begin, std::int64_t end) {
          Sums total{};
          std::complex<double> Sx[gram_tile], Mx[gram_tile];
          for (std::int64_t i = begin; i < end; i += gram_tile) {
            const std::int64_t count = std::min(gram_tile, end - i);
            both_products(raw, i, i + count, as_pairs(x), as_pairs(Sx), as_pairs(Mx));
            use(i, count, Sx, Mx, total);
          }
          return total;
        },
        [](Sums total, const Sums& part) {
          for (std::size_t k = 0; k < N; ++k) total[k] += part[k];
          return total;
        });
  }

  /// Rows first ... first + count - 1 of S x and M x for K vectors, blocks as in multigrid/level.h. Sums are double: S
  /// x cancels, to one part in V.
  template <int K>
  void multiply(std::int64_t first, std::int64_t count, const float* x, float* Sx, float* Mx) const {
    block_kernels<K>().pencil(raw(), first, first + count, x, Sx, Mx);
  }

 private:
  [[nodiscard]] simd::RawPencil raw() const {
    return {S.outerIndexPtr(), S.innerIndexPtr(), as_pairs(S.valuePtr()), as_pairs(M.valuePtr()), S_scale, M_scale};
  }
};

/// A level of the hierarchy with a diagonal mass, in its scaled unknowns.
struct LevelPencil {
  const Level& level;
  const Buffer<float>& mass;

  template <int K>
  void apply(const float* x, float* Sx, float* Mx) const {
    combine_rows<K>(level.off, x, 1, x, 0, nullptr, 1, Sx);
    const float* const m = mass.data();
    parallel_for(level.rows(), [=](std::int64_t i) {
      float row[2 * K];
      for (int k = 0; k < 2 * K; ++k) row[k] = m[i] * x[2 * K * i + k];
      std::copy(row, row + 2 * K, Mx + 2 * K * i);
    });
  }
};

}  // namespace alcap::detail
