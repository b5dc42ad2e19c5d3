// SPDX-License-Identifier: MIT
//
// entries_sse2.cpp: the loop of entries_impl.h over 16-byte packs, compiled with the flags of any x86-64.
#include "src/simd/entries_impl.h"

#if defined(__x86_64__)
namespace alcap::detail::simd {

void entries_sse2(long long begin, long long end, const RawEntries<float>& e) {
  entries_of_range<kernels::Pack<float, 4, kernels::isa::Sse2>>(begin, end, e);
}
void entries_sse2(long long begin, long long end, const RawEntries<double>& e) {
  entries_of_range<kernels::Pack<double, 2, kernels::isa::Sse2>>(begin, end, e);
}

}  // namespace alcap::detail::simd
#endif
