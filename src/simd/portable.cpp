// SPDX-License-Identifier: MIT
//
// portable.cpp: the loops in 16-byte packs, compiled with baseline flags, for any processor.
#define ALCAP_SIMD portable
#define ALCAP_SIMD_BYTES 16
#include "src/simd/loops_impl.h"
