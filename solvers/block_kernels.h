// SPDX-License-Identifier: MIT
//
// block_kernels.h: the loops over blocks of K vectors for this machine's instruction set. Internal to solvers/.
#pragma once

#include "solvers/simd/block_raw.h"

namespace alcap::detail {

using simd::BlockKernels;

/// K: 1, 4, 8 or 16; for 1 only `rows`.
template <int K>
[[nodiscard]] const BlockKernels& block_kernels();

}  // namespace alcap::detail
