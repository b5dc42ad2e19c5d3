// SPDX-License-Identifier: MIT
//
// angles.h: angles of many vectors and unit numbers of many angles (kernels/angles.h), compiled for several instruction
// sets and picked at run time. A result depends neither on its neighbours nor on the instruction set, to the last bit.
#pragma once

#include <complex>
#include <cstdint>

#include "src/simd/dispatch.h"

namespace alcap::detail {

/// out[i] = atan2(y[i], x[i]) for y[i] > 0, to about an ulp. T is float or double. Throws OptionError when `isa` is not
/// available here.
template <class T>
void upper_angles(std::int64_t count, const T* y, const T* x, T* out, Isa isa = best_isa()) {
  simd::element_loops<T>(isa).upper_angles(count, y, x, out);
}

/// out[i] = exp(i factor angles[i]), to about an ulp of 1; for |factor angles[i]| up to 1e5 (float: 1e4).
template <class T>
void unit_numbers(std::int64_t count, const T* angles, T factor, std::complex<T>* out, Isa isa = best_isa()) {
  simd::element_loops<T>(isa).unit_numbers(count, angles, factor, reinterpret_cast<T*>(out));
}

}  // namespace alcap::detail
