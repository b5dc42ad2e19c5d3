// SPDX-License-Identifier: MIT
//
// entries_avx2.cpp: the loop of entries_impl.h over 32-byte packs, compiled with the flags of AVX2.
#include "src/simd/entries_impl.h"

#if defined(__x86_64__)
namespace alcap::detail::simd {

void entries_avx2(long long begin, long long end, const RawEntries<float>& e) {
  entries_of_range<kernels::Pack<float, 8, kernels::isa::Avx2>>(begin, end, e);
}
void entries_avx2(long long begin, long long end, const RawEntries<double>& e) {
  entries_of_range<kernels::Pack<double, 4, kernels::isa::Avx2>>(begin, end, e);
}

}  // namespace alcap::detail::simd
#endif
