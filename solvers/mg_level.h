// SPDX-License-Identifier: MIT
//
// mg_level.h: the data of one multigrid level and its row-wise products. Internal to solvers/.
//
// Values are single precision: a preconditioner needs no more, and time is memory traffic. Blocks of K vectors lie row
// by row, K real parts and then K imaginary parts, so that the K vectors are the lanes of vector instructions.
#pragma once

#include <complex>
#include <cstdint>
#include <vector>

#include "alcap/conventions.h"
#include "alcap/parallel.h"

namespace alcap::detail {

using ComplexF = std::complex<float>;

/// Rows of a sparse complex matrix.
struct Rows {
  std::vector<std::int64_t> start{0};
  std::vector<Index> column;
  std::vector<ComplexF> value;
  [[nodiscard]] Index rows() const { return static_cast<Index>(start.size()) - 1; }
};

/// One level: the operator, split into its diagonal and the rest, and the way to the next coarser level.
struct Level {
  Rows off;                     ///< off-diagonal entries
  std::vector<float> diagonal;  ///< positive
  std::vector<float> inverse;   ///< 1 / diagonal
  float largest = 2;            ///< bound of the spectrum of D^-1 A
  Rows prolongation;            ///< fine rows; empty on the coarsest level
  Rows restriction;             ///< its adjoint, coarse rows
  [[nodiscard]] Index rows() const { return off.rows(); }
};

/// Rows per task: about 100 microseconds of work.
inline constexpr std::int64_t mg_grain = 4096;

/// use(i, sum) with the 2 K numbers of row i of A x, for all rows in parallel. `x` has 2 K numbers a row.
template <int K, class Use>
void for_rows(const Rows& A, const float* x, Use&& use) {
  const std::int64_t* start = A.start.data();
  const Index* column = A.column.data();
  const auto* value = reinterpret_cast<const float*>(A.value.data());
  parallel_ranges(A.rows(), mg_grain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      float sum[2 * K] = {};
      for (std::int64_t e = start[i]; e < start[i + 1]; ++e) {
        const float ar = value[2 * e];
        const float ai = value[2 * e + 1];
        const float* z = x + 2 * K * std::int64_t{column[e]};
        for (int k = 0; k < K; ++k) sum[k] += ar * z[k] - ai * z[K + k];
        for (int k = 0; k < K; ++k) sum[K + k] += ar * z[K + k] + ai * z[k];
      }
      use(i, sum);
    }
  });
}

}  // namespace alcap::detail
