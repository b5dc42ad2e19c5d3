// SPDX-License-Identifier: MIT
//
// level.h: the data of one multigrid level and its row-wise products. Internal to solvers/.
//
// Values are single precision: a preconditioner needs no more, and time is memory traffic. For the same reason every
// level is scaled to a unit diagonal, A = N^-1 (matrix) N^-1, so that neither diagonals nor their inverses are read.
// Blocks of K vectors lie row by row, K real parts and then K imaginary parts, so that the K vectors are the lanes of
// vector instructions.
#pragma once

#include <complex>
#include <cstdint>

#include "alcap/conventions.h"
#include "src/base/array.h"
#include "src/base/parallel.h"
#include "src/simd/block_kernels.h"

namespace alcap::detail {

using ComplexF = std::complex<float>;

/// An array whose elements start unset: memory is first touched by the threads that fill it.
template <class T>
using Buffer = Array<T>;

/// Rows of a sparse complex matrix.
struct Rows {
  Buffer<std::int64_t> start;  ///< rows + 1
  Buffer<Index> column;
  Buffer<ComplexF> value;
  [[nodiscard]] Index rows() const { return start.size() == 0 ? 0 : static_cast<Index>(start.size() - 1); }
  [[nodiscard]] std::int64_t nonzeros() const { return column.size(); }
};

/// One level: the operator with unit diagonal, and the way to the next coarser level.
struct Level {
  Rows off;                  ///< off-diagonal entries
  Buffer<float> near;        ///< N, the roots of the diagonal before scaling: moduli of the near-null vectors
  Buffer<ComplexF> guide;    ///< see guided(); not kept
  Buffer<float> guide_near;  ///< N of the matrix of the guide
  float largest = 2;         ///< bound of the spectrum
  Rows prolongation;         ///< fine rows; empty on the coarsest level
  Rows restriction;          ///< its adjoint, coarse rows
  [[nodiscard]] Index rows() const { return off.rows(); }
  /// What aggregation and prolongation follow: off-diagonal entries in the pattern of `off`, scaled like it by the
  /// roots of their own diagonal. The operator itself where there is no guide.
  [[nodiscard]] const Buffer<ComplexF>& guided() const { return guide.size() == 0 ? off.value : guide; }
  [[nodiscard]] const Buffer<float>& guided_near() const { return guide.size() == 0 ? near : guide_near; }
};

/// Rows per task: about 50 microseconds of work.
inline constexpr std::int64_t mg_grain = 4096;

/// y_i = p u_i + q v_i + s (A x)_i for all rows, K vectors each; u and v may be null, or y. x may not be y.
template <int K>
void combine_rows(const Rows& A, const float* x, float p, const float* u, float q, const float* v, float s, float* y) {
  static_assert(sizeof(std::int64_t) == sizeof(long long));
  const simd::RawRows raw{reinterpret_cast<const long long*>(A.start.data()), A.column.data(),
                          reinterpret_cast<const float*>(A.value.data())};
  const auto rows = block_kernels<K>().rows;
  parallel_ranges(A.rows(), mg_grain,
                  [=](std::int64_t begin, std::int64_t end) { rows(raw, begin, end, x, p, u, q, v, s, y); });
}

/// y = A x.
template <int K>
void multiply_rows(const Rows& A, const float* x, float* y) {
  combine_rows<K>(A, x, 0, nullptr, 0, nullptr, 1, y);
}

}  // namespace alcap::detail
