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
void upper_angles_scalar(long long count, const float* y, const float* x, float* out);
void upper_angles_scalar(long long count, const double* y, const double* x, double* out);
void units_scalar(long long count, const float* angle, float factor, float* out);
void units_scalar(long long count, const double* angle, double factor, double* out);
#if defined(__x86_64__)
void entries_sse2(long long begin, long long end, const RawEntries<float>& e);
void entries_sse2(long long begin, long long end, const RawEntries<double>& e);
void upper_angles_sse2(long long count, const float* y, const float* x, float* out);
void upper_angles_sse2(long long count, const double* y, const double* x, double* out);
void units_sse2(long long count, const float* angle, float factor, float* out);
void units_sse2(long long count, const double* angle, double factor, double* out);
void entries_avx2(long long begin, long long end, const RawEntries<float>& e);
void entries_avx2(long long begin, long long end, const RawEntries<double>& e);
void upper_angles_avx2(long long count, const float* y, const float* x, float* out);
void upper_angles_avx2(long long count, const double* y, const double* x, double* out);
void units_avx2(long long count, const float* angle, float factor, float* out);
void units_avx2(long long count, const double* angle, double factor, double* out);
void entries_avx512(long long begin, long long end, const RawEntries<float>& e);
void entries_avx512(long long begin, long long end, const RawEntries<double>& e);
void upper_angles_avx512(long long count, const float* y, const float* x, float* out);
void upper_angles_avx512(long long count, const double* y, const double* x, double* out);
void units_avx512(long long count, const float* angle, float factor, float* out);
void units_avx512(long long count, const double* angle, double factor, double* out);
#endif

}  // namespace alcap::detail::simd
