// SPDX-License-Identifier: MIT
//
// angles.cpp: picks the loops for this machine. Compiled with baseline flags.
#include "src/simd/angles.h"

#include "src/simd/entries_raw.h"

namespace alcap::detail {

template <class T>
void upper_angles(std::int64_t count, const T* y, const T* x, T* out, Isa isa) {
  require_isa(isa);
  switch (isa) {
#if defined(__x86_64__)
    case Isa::avx512:
      return simd::upper_angles_avx512(count, y, x, out);
    case Isa::avx2:
      return simd::upper_angles_avx2(count, y, x, out);
    case Isa::sse2:
      return simd::upper_angles_sse2(count, y, x, out);
#endif
    default:
      return simd::upper_angles_scalar(count, y, x, out);
  }
}

template <class T>
void unit_numbers(std::int64_t count, const T* angles, T factor, std::complex<T>* out, Isa isa) {
  require_isa(isa);
  T* const reals = reinterpret_cast<T*>(out);
  switch (isa) {
#if defined(__x86_64__)
    case Isa::avx512:
      return simd::units_avx512(count, angles, factor, reals);
    case Isa::avx2:
      return simd::units_avx2(count, angles, factor, reals);
    case Isa::sse2:
      return simd::units_sse2(count, angles, factor, reals);
#endif
    default:
      return simd::units_scalar(count, angles, factor, reals);
  }
}

template void upper_angles(std::int64_t, const float*, const float*, float*, Isa);
template void upper_angles(std::int64_t, const double*, const double*, double*, Isa);
template void unit_numbers(std::int64_t, const float*, float, std::complex<float>*, Isa);
template void unit_numbers(std::int64_t, const double*, double, std::complex<double>*, Isa);

}  // namespace alcap::detail
