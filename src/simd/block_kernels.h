// SPDX-License-Identifier: MIT
//
// block_kernels.h: the loops over blocks of K vectors, and over one beside them, for this machine's instruction set.
// Internal to solvers/.
#pragma once

#include "src/simd/block_raw.h"

namespace alcap::detail {

using simd::BlockKernels;
using simd::VectorKernels;

/// K: 1, 4, 8 or 16; for 1 only `rows`.
template <int K>
[[nodiscard]] const BlockKernels& block_kernels();
/// K: 4, 8 or 16.
template <int K>
[[nodiscard]] const VectorKernels& vector_kernels();

}  // namespace alcap::detail
