// SPDX-License-Identifier: MIT
//
// block_avx2.cpp: the loops of block_impl.h over packs of 8 floats and of vector_impl.h, compiled with the flags of
// AVX2.
#include "src/simd/block_impl.h"
#include "src/simd/vector_impl.h"

#if defined(__x86_64__)
namespace alcap::detail::simd {

BlockKernels block_kernels_avx2(int K) { return block_kernels<kernels::isa::Avx2, 8>(K); }
VectorKernels vector_kernels_avx2(int K) { return vector_kernels<kernels::isa::Avx2>(K); }

}  // namespace alcap::detail::simd
#endif
