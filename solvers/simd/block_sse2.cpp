// SPDX-License-Identifier: MIT
//
// block_sse2.cpp: the loops of block_impl.h over packs of 4 floats, compiled with the flags of any x86-64.
#include "solvers/simd/block_impl.h"

namespace alcap::detail::simd {

BlockKernels block_kernels_sse2(int K) { return block_kernels<kernels::isa::Sse2, 4>(K); }

}  // namespace alcap::detail::simd
