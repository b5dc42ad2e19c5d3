// SPDX-License-Identifier: MIT
//
// entries_avx512.cpp: the loop of entries_impl.h over 64-byte packs, compiled with the flags of AVX-512.
#include "src/simd/entries_impl.h"

#if defined(__x86_64__)
namespace alcap::detail::simd {

void entries_avx512(long long begin, long long end, const RawEntries<float>& e) {
  entries_of_range<kernels::Pack<float, 16, kernels::isa::Avx512>>(begin, end, e);
}
void entries_avx512(long long begin, long long end, const RawEntries<double>& e) {
  entries_of_range<kernels::Pack<double, 8, kernels::isa::Avx512>>(begin, end, e);
}

}  // namespace alcap::detail::simd
#endif
