// SPDX-License-Identifier: MIT
//
// correction_avx2.cpp: the loops of correction_impl.h over 32-byte packs, compiled with the flags of AVX2.
#include "src/simd/correction_impl.h"

#if defined(__x86_64__)
namespace alcap::detail::simd {

GroupLoops group_loops_avx2() { return group_loops_of<kernels::isa::Avx2, 4>(); }
CorrectionLoops<float> correction_loops_avx2() { return correction_loops_of<kernels::isa::Avx2, 8, float>(); }

}  // namespace alcap::detail::simd
#endif
