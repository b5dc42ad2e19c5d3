// SPDX-License-Identifier: MIT
//
// avx2.cpp: the loops in 32-byte packs, compiled with the flags of AVX2.
#if defined(__x86_64__)
#define ALCAP_SIMD avx2
#define ALCAP_SIMD_BYTES 32
#include "src/simd/loops_impl.h"
#endif
