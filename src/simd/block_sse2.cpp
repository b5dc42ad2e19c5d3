// SPDX-License-Identifier: MIT
//
// block_sse2.cpp: the loops of block_impl.h over packs of 4 floats and of vector_impl.h, compiled with the flags of any
// x86-64.
#include "src/simd/block_impl.h"
#include "src/simd/vector_impl.h"

namespace alcap::detail::simd {

BlockKernels block_kernels_sse2(int K) { return block_kernels<kernels::isa::Sse2, 4>(K); }
VectorKernels vector_kernels_sse2(int K) { return vector_kernels<kernels::isa::Sse2>(K); }

}  // namespace alcap::detail::simd
