// SPDX-License-Identifier: MIT
//
// block_kernels.h: the loops over blocks of K vectors, and over one beside them, for this machine's instruction set.
// Internal to solvers/.
#pragma once

#include "src/simd/dispatch.h"

namespace alcap::detail {

using simd::BlockKernels;
using simd::VectorKernels;

/// K: 1, 4, 8 or 16; for 1 only `rows`.
template <int K>
[[nodiscard]] const BlockKernels& block_kernels() {
  static_assert(K == 1 || K == 4 || K == 8 || K == 16);
  const simd::Loops& loops = simd::loops();
  if constexpr (K == 1) return loops.block_1;
  if constexpr (K == 4) return loops.block_4;
  if constexpr (K == 8) return loops.block_8;
  if constexpr (K == 16) return loops.block_16;
}

/// K: 4, 8 or 16.
template <int K>
[[nodiscard]] const VectorKernels& vector_kernels() {
  static_assert(K == 4 || K == 8 || K == 16);
  const simd::Loops& loops = simd::loops();
  if constexpr (K == 4) return loops.vector_4;
  if constexpr (K == 8) return loops.vector_8;
  if constexpr (K == 16) return loops.vector_16;
}

}  // namespace alcap::detail
