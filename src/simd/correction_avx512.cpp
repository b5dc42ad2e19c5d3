// SPDX-License-Identifier: MIT
//
// correction_avx512.cpp: the loops of correction_impl.h over 64-byte packs, compiled with the flags of AVX-512.
#include "src/simd/correction_impl.h"

#if defined(__x86_64__)
namespace alcap::detail::simd {

GroupLoops group_loops_avx512() { return group_loops_of<kernels::isa::Avx512, 8>(); }
CorrectionLoops<float> correction_loops_avx512() { return correction_loops_of<kernels::isa::Avx512, 16, float>(); }

}  // namespace alcap::detail::simd
#endif
