// SPDX-License-Identifier: MIT
//
// pencil.h: the matrices S and M of an eigenproblem side by side: S x and M x in one pass, and used on the spot, so
// that products are never stored. Internal to solvers/.
//
// Both come scaled, so that numbers are near 1 and fit single precision: S to a mean diagonal entry of about 1, M to a
// mean row sum of 1.
#pragma once

#include <array>

#include "solvers/eigen_problem.h"
#include "solvers/lobpcg_block.h"
#include "solvers/mg_level.h"

namespace alcap::detail {

/// The matrices of the eigenproblem itself. Both are compressed and have the same pattern.
struct FinePencil {
  const HermitianMatrix& S;
  const HermitianMatrix& M;
  double S_scale = 1;
  double M_scale = 1;

  [[nodiscard]] std::int64_t rows() const { return S.cols(); }

  /// use(i, (S x)_i, (M x)_i, sums) for all rows; the sums are added up over fixed chunks.
  template <std::size_t N, class Use>
  [[nodiscard]] std::array<double, N> sums(const std::complex<double>* x, Use&& use) const {
    using Sums = std::array<double, N>;
    const Index* const start = S.outerIndexPtr();
    const Index* const row = S.innerIndexPtr();
    const std::complex<double>* const s = S.valuePtr();
    const std::complex<double>* const m = M.valuePtr();
    return parallel_reduce(
        rows(), Sums{},
        [&](std::int64_t begin, std::int64_t end) {
          Sums total{};
          for (std::int64_t j = begin; j < end; ++j) {
            // Row j is the conjugate of column j.
            double sr = 0, si = 0, mr = 0, mi = 0;
            for (Index e = start[j]; e < start[j + 1]; ++e) {
              const double re = x[row[e]].real(), im = x[row[e]].imag();
              sr += s[e].real() * re + s[e].imag() * im;
              si += s[e].real() * im - s[e].imag() * re;
              mr += m[e].real() * re + m[e].imag() * im;
              mi += m[e].real() * im - m[e].imag() * re;
            }
            use(j, std::complex<double>(S_scale * sr, S_scale * si), std::complex<double>(M_scale * mr, M_scale * mi),
                total);
          }
          return total;
        },
        [](Sums total, const Sums& part) {
          for (std::size_t k = 0; k < N; ++k) total[k] += part[k];
          return total;
        });
  }

  /// Rows first ... first + count - 1 of S x and M x for K vectors, blocks as in mg_level.h. Sums are double: S x
  /// cancels, to one part in V.
  template <int K>
  void multiply(std::int64_t first, std::int64_t count, const float* x, float* Sx, float* Mx) const {
    const simd::RawPencil raw{S.outerIndexPtr(),
                              S.innerIndexPtr(),
                              reinterpret_cast<const double*>(S.valuePtr()),
                              reinterpret_cast<const double*>(M.valuePtr()),
                              S_scale,
                              M_scale};
    block_kernels<K>().pencil(raw, first, first + count, x, Sx, Mx);
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
