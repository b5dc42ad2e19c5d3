// SPDX-License-Identifier: MIT
//
// block_avx512.cpp: the loops of block_impl.h over packs of 16 floats, compiled with the flags of AVX-512.
#include "solvers/simd/block_impl.h"

#if defined(__x86_64__)
namespace alcap::detail::simd {

BlockKernels block_kernels_avx512(int K) { return block_kernels<kernels::isa::Avx512, 16>(K); }

}  // namespace alcap::detail::simd
#endif
