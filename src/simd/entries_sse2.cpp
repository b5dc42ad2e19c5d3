// SPDX-License-Identifier: MIT
//
// entries_sse2.cpp: the loops of entries_impl.h and angles_impl.h over 16-byte packs, compiled with the flags of any
// x86-64.
#include "src/simd/angles_impl.h"
#include "src/simd/entries_impl.h"

#if defined(__x86_64__)
namespace alcap::detail::simd {

void entries_sse2(long long begin, long long end, const RawEntries<float>& e) {
  entries_of_range<kernels::Pack<float, 4, kernels::isa::Sse2>>(begin, end, e);
}
void entries_sse2(long long begin, long long end, const RawEntries<double>& e) {
  entries_of_range<kernels::Pack<double, 2, kernels::isa::Sse2>>(begin, end, e);
}

void upper_angles_sse2(long long count, const float* y, const float* x, float* out) {
  upper_angles_of<kernels::Pack<float, 4, kernels::isa::Sse2>>(count, y, x, out);
}
void upper_angles_sse2(long long count, const double* y, const double* x, double* out) {
  upper_angles_of<kernels::Pack<double, 2, kernels::isa::Sse2>>(count, y, x, out);
}

void units_sse2(long long count, const float* angle, float factor, float* out) {
  units_of<kernels::Pack<float, 4, kernels::isa::Sse2>>(count, angle, factor, out);
}
void units_sse2(long long count, const double* angle, double factor, double* out) {
  units_of<kernels::Pack<double, 2, kernels::isa::Sse2>>(count, angle, factor, out);
}

}  // namespace alcap::detail::simd
#endif
