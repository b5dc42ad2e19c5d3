// SPDX-License-Identifier: MIT
//
// angles_impl.h: kernels/angles.h over arrays, pack by pack. Included by one file per instruction set, as
// entries_impl.h.
#pragma once

#include "kernels/angles.h"

namespace alcap::detail::simd {

template <class P, class T>
void upper_angles_of(long long count, const T* y, const T* x, T* out) {
  constexpr int N = P::size;
  long long i = 0;
  for (; i + N <= count; i += N) kernels::upper_angle(P::load(y + i), P::load(x + i)).store(out + i);
  if (i == count) return;
  T rest[3][N];
  for (int l = 0; l < N; ++l) {
    rest[0][l] = y[i + l < count ? i + l : i];
    rest[1][l] = x[i + l < count ? i + l : i];
  }
  kernels::upper_angle(P::load(rest[0]), P::load(rest[1])).store(rest[2]);
  for (int l = 0; i + l < count; ++l) out[i + l] = rest[2][l];
}

template <class P, class T>
ALCAP_INLINE void units_of_pack(const P& angle, long long count, T* out) {
  T re[P::size], im[P::size];
  const auto unit = kernels::unit_of(angle);
  unit.re.store(re);
  unit.im.store(im);
  for (long long l = 0; l < count; ++l) {
    out[2 * l] = re[l];
    out[2 * l + 1] = im[l];
  }
}

template <class P, class T>
void units_of(long long count, const T* angle, T factor, T* out) {
  constexpr int N = P::size;
  long long i = 0;
  for (; i + N <= count; i += N) units_of_pack(P(factor) * P::load(angle + i), N, out + 2 * i);
  if (i == count) return;
  T rest[N];
  for (int l = 0; l < N; ++l) rest[l] = angle[i + l < count ? i + l : i];
  units_of_pack(P(factor) * P::load(rest), count - i, out + 2 * i);
}

}  // namespace alcap::detail::simd
