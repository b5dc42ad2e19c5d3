// SPDX-License-Identifier: MIT
//
// block_kernels.cpp: picks the loops for this machine. Compiled with baseline flags.
#include "src/simd/block_kernels.h"

#include "src/simd/isa.h"

namespace alcap::detail {
namespace {

BlockKernels pick(int K) {
#if defined(__x86_64__)
  if (best_isa() == Isa::avx512) return simd::block_kernels_avx512(K);
  if (best_isa() == Isa::avx2) return simd::block_kernels_avx2(K);
#endif
  return simd::block_kernels_sse2(K);
}

VectorKernels pick_vector(int K) {
#if defined(__x86_64__)
  if (best_isa() == Isa::avx512) return simd::vector_kernels_avx512(K);
  if (best_isa() == Isa::avx2) return simd::vector_kernels_avx2(K);
#endif
  return simd::vector_kernels_sse2(K);
}

}  // namespace

template <int K>
const BlockKernels& block_kernels() {
  static const BlockKernels picked = pick(K);
  return picked;
}
template const BlockKernels& block_kernels<1>();
template const BlockKernels& block_kernels<4>();
template const BlockKernels& block_kernels<8>();
template const BlockKernels& block_kernels<16>();

template <int K>
const VectorKernels& vector_kernels() {
  static const VectorKernels picked = pick_vector(K);
  return picked;
}
template const VectorKernels& vector_kernels<4>();
template const VectorKernels& vector_kernels<8>();
template const VectorKernels& vector_kernels<16>();

}  // namespace alcap::detail
