// SPDX-License-Identifier: MIT
//
// pencil.h: S x and M x in one pass over two matrices of the same pattern, for one vector in double or K vectors in
// single precision. Internal to solvers/.
//
// Both operators come scaled, so that their numbers are near 1 and fit single precision: S by its mean diagonal entry,
// M by its mean row sum.
#pragma once

#include <vector>

#include "solvers/eigen_problem.h"
#include "solvers/mg_level.h"

namespace alcap::detail {

/// The matrices of the eigenproblem itself. Both are compressed and have the same pattern.
struct FinePencil {
  const HermitianMatrix& S;
  const HermitianMatrix& M;
  double S_scale = 1;
  double M_scale = 1;

  [[nodiscard]] std::int64_t rows() const { return S.cols(); }

  /// K vectors in blocks as in mg_level.h (for K = 1: complex numbers). Sums are double: S x cancels.
  template <int K, class Real>
  void apply(const Real* x, Real* Sx, Real* Mx) const {
    const Index* start = S.outerIndexPtr();
    const Index* row = S.innerIndexPtr();
    const std::complex<double>* s = S.valuePtr();
    const std::complex<double>* m = M.valuePtr();
    parallel_ranges(rows(), mg_grain, [=, this](std::int64_t begin, std::int64_t end) {
      for (std::int64_t j = begin; j < end; ++j) {
        double s_sum[2 * K] = {};
        double m_sum[2 * K] = {};
        for (Index e = start[j]; e < start[j + 1]; ++e) {
          // Row j is the conjugate of column j.
          const double sr = s[e].real();
          const double si = s[e].imag();
          const double mr = m[e].real();
          const double mi = m[e].imag();
          const Real* z = x + 2 * K * std::int64_t{row[e]};
          for (int k = 0; k < K; ++k) s_sum[k] += sr * double{z[k]} + si * double{z[K + k]};
          for (int k = 0; k < K; ++k) s_sum[K + k] += sr * double{z[K + k]} - si * double{z[k]};
          for (int k = 0; k < K; ++k) m_sum[k] += mr * double{z[k]} + mi * double{z[K + k]};
          for (int k = 0; k < K; ++k) m_sum[K + k] += mr * double{z[K + k]} - mi * double{z[k]};
        }
        for (int k = 0; k < 2 * K; ++k) Sx[2 * K * j + k] = static_cast<Real>(S_scale * s_sum[k]);
        for (int k = 0; k < 2 * K; ++k) Mx[2 * K * j + k] = static_cast<Real>(M_scale * m_sum[k]);
      }
    });
  }
};

/// A level of the hierarchy with a diagonal mass.
struct LevelPencil {
  const Level& level;
  const std::vector<float>& mass;

  template <int K>
  void apply(const float* x, float* Sx, float* Mx) const {
    const float* diagonal = level.diagonal.data();
    const float* m = mass.data();
    for_rows<K>(level.off, x, [=](std::int64_t i, const float* sum) {
      for (int k = 0; k < 2 * K; ++k) Sx[2 * K * i + k] = diagonal[i] * x[2 * K * i + k] + sum[k];
      for (int k = 0; k < 2 * K; ++k) Mx[2 * K * i + k] = m[i] * x[2 * K * i + k];
    });
  }
};

}  // namespace alcap::detail
