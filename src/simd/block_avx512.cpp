// SPDX-License-Identifier: MIT
//
// block_avx512.cpp: the loops of block_impl.h over packs of 16 floats and of vector_impl.h, compiled with the flags of
// AVX-512.
#include "src/simd/block_impl.h"
#include "src/simd/vector_impl.h"

#if defined(__x86_64__)
namespace alcap::detail::simd {

BlockKernels block_kernels_avx512(int K) { return block_kernels<kernels::isa::Avx512, 16>(K); }
VectorKernels vector_kernels_avx512(int K) { return vector_kernels<kernels::isa::Avx512>(K); }

}  // namespace alcap::detail::simd
#endif
