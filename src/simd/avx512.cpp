// SPDX-License-Identifier: MIT
//
// avx512.cpp: the loops in 64-byte packs, compiled with the flags of AVX-512.
#if defined(__x86_64__)
#define ALCAP_SIMD avx512
#define ALCAP_SIMD_BYTES 64
#include "src/simd/loops_impl.h"
#endif
