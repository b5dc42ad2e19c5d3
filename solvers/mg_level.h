// SPDX-License-Identifier: MIT
//
// mg_level.h: the data of one multigrid level and its row-wise products. Internal to solvers/.
//
// Values are single precision: a preconditioner needs no more, and time is memory traffic. For the same reason every
// level is scaled to a unit diagonal, A = N^-1 (matrix) N^-1, so that neither diagonals nor their inverses are read.
// Blocks of K vectors lie row by row, K real parts and then K imaginary parts, so that the K vectors are the lanes of
// vector instructions.
#pragma once

#include <complex>
#include <cstdint>
#include <memory>

#include "alcap/conventions.h"
#include "alcap/parallel.h"

namespace alcap::detail {

using ComplexF = std::complex<float>;

/// An array whose elements start unset: memory is first touched by the threads that fill it.
template <class T>
class Buffer {
 public:
  Buffer() = default;
  explicit Buffer(std::int64_t size)
      : data_(std::make_unique_for_overwrite<T[]>(static_cast<std::size_t>(size))), size_(size) {}
  [[nodiscard]] T* data() { return data_.get(); }
  [[nodiscard]] const T* data() const { return data_.get(); }
  [[nodiscard]] std::int64_t size() const { return size_; }
  [[nodiscard]] T& operator[](std::int64_t i) { return data_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] const T& operator[](std::int64_t i) const { return data_[static_cast<std::size_t>(i)]; }

 private:
  std::unique_ptr<T[]> data_;
  std::int64_t size_ = 0;
};

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
  Rows off;            ///< off-diagonal entries
  Buffer<float> near;  ///< N, the roots of the diagonal before scaling: moduli of the near-null vectors
  float largest = 2;   ///< bound of the spectrum
  Rows prolongation;   ///< fine rows; empty on the coarsest level
  Rows restriction;    ///< its adjoint, coarse rows
  [[nodiscard]] Index rows() const { return off.rows(); }
};

/// Rows per task: about 50 microseconds of work.
inline constexpr std::int64_t mg_grain = 4096;

/// use(i, sum) with the 2 K numbers of row i of A x, for all rows in parallel. `x` has 2 K numbers a row.
template <int K, class Use>
void for_rows(const Rows& A, const float* x, Use&& use) {
  const std::int64_t* const start = A.start.data();
  const Index* const column = A.column.data();
  const auto* const value = reinterpret_cast<const float*>(A.value.data());
  parallel_ranges(A.rows(), mg_grain, [=, &use](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      float sum[2 * K] = {};
      for (std::int64_t e = start[i]; e < start[i + 1]; ++e) {
        const float ar = value[2 * e];
        const float ai = value[2 * e + 1];
        const float* const z = x + 2 * K * std::int64_t{column[e]};
        for (int k = 0; k < K; ++k) sum[k] += ar * z[k] - ai * z[K + k];
        for (int k = 0; k < K; ++k) sum[K + k] += ar * z[K + k] + ai * z[k];
      }
      use(i, sum);
    }
  });
}

}  // namespace alcap::detail
