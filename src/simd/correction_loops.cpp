// SPDX-License-Identifier: MIT
//
// correction_loops.cpp: see the header. Compiled with baseline flags.
#include "src/simd/correction_loops.h"

namespace alcap::detail::simd {

template <>
CorrectionLoops<float> correction_loops(Isa isa) {
  require_isa(isa);
#if defined(__x86_64__)
  if (isa == Isa::avx512) return correction_loops_avx512();
  if (isa == Isa::avx2) return correction_loops_avx2();
#endif
  return correction_loops_sse2(float{});
}

GroupLoops group_loops(Isa isa) {
  require_isa(isa);
#if defined(__x86_64__)
  if (isa == Isa::avx512) return group_loops_avx512();
  if (isa == Isa::avx2) return group_loops_avx2();
#endif
  return group_loops_sse2();
}

// Rarely needed.
template <>
CorrectionLoops<double> correction_loops(Isa isa) {
  require_isa(isa);
  return correction_loops_sse2(double{});
}

}  // namespace alcap::detail::simd
