// SPDX-License-Identifier: MIT
//
// correction_sse2.cpp: the loops of correction_impl.h over 16-byte packs, compiled with the flags of any machine.
#include "src/simd/correction_impl.h"

namespace alcap::detail::simd {

GroupLoops group_loops_sse2() { return group_loops_of<kernels::isa::Sse2, 2>(); }
CorrectionLoops<float> correction_loops_sse2(float) { return correction_loops_of<kernels::isa::Sse2, 4, float>(); }
CorrectionLoops<double> correction_loops_sse2(double) { return correction_loops_of<kernels::isa::Sse2, 2, double>(); }

}  // namespace alcap::detail::simd
