// SPDX-License-Identifier: MIT
//
// entries_raw.h: what crosses from the dispatcher to the loops compiled for one instruction set. Only pointers and
// numbers: these files must not pull in inline functions that the linker could share with baseline code.
#pragma once

namespace alcap::detail::simd {

/// TriangleInputs and TriangleOutputs with complex numbers as pairs of reals.
template <class T>
struct RawEntries {
  const T* cot;
  const T* area;
  const T* curvature;
  T n;
  T* stiffness_diagonal;
  T* stiffness_off;
  T* mass_off;
};

void entries_scalar(long long begin, long long end, const RawEntries<float>& e);
void entries_scalar(long long begin, long long end, const RawEntries<double>& e);
#if defined(__x86_64__)
void entries_sse2(long long begin, long long end, const RawEntries<float>& e);
void entries_sse2(long long begin, long long end, const RawEntries<double>& e);
void entries_avx2(long long begin, long long end, const RawEntries<float>& e);
void entries_avx2(long long begin, long long end, const RawEntries<double>& e);
void entries_avx512(long long begin, long long end, const RawEntries<float>& e);
void entries_avx512(long long begin, long long end, const RawEntries<double>& e);
#endif

}  // namespace alcap::detail::simd
