// SPDX-License-Identifier: MIT
//
// element_impl.h: kernels/stiffness_mass.h and kernels/angles.h over arrays, pack by pack. Part of loops_impl.h.
#pragma once

#include "kernels/angles.h"
#include "kernels/stiffness_mass.h"
#include "src/simd/loops.h"

namespace alcap::detail::simd::ALCAP_SIMD {

/// Triangles first ... first + count - 1, count <= P::size. Missing lanes repeat the last triangle.
template <class P, class T>
ALCAP_INLINE void entries_of_pack(long long first, int count, const RawEntries<T>& e) {
  constexpr int N = P::size;
  T cot[3][N], area[N], curvature[N];
  for (int l = 0; l < N; ++l) {
    const long long f = first + (l < count ? l : count - 1);
    for (int c = 0; c < 3; ++c) cot[c][l] = e.cot[3 * f + c];
    area[l] = e.area[f];
    curvature[l] = e.curvature[f];
  }
  const P packed[3] = {P::load(cot[0]), P::load(cot[1]), P::load(cot[2])};
  const auto r = kernels::stiffness_mass<P>(packed, P::load(area), P(e.n) * P::load(curvature));

  T diagonal[3][N], off[6][N], mass[2][N];
  for (int c = 0; c < 3; ++c) {
    r.stiffness_diagonal[c].store(diagonal[c]);
    r.stiffness_off[c].re.store(off[2 * c]);
    r.stiffness_off[c].im.store(off[2 * c + 1]);
  }
  r.mass_off.re.store(mass[0]);
  r.mass_off.im.store(mass[1]);
  for (int l = 0; l < count; ++l) {
    const long long f = first + l;
    for (int c = 0; c < 3; ++c) e.stiffness_diagonal[3 * f + c] = diagonal[c][l];
    for (int c = 0; c < 6; ++c) e.stiffness_off[6 * f + c] = off[c][l];
    for (int c = 0; c < 2; ++c) e.mass_off[2 * f + c] = mass[c][l];
  }
}

template <class T>
void entries_of_range(long long begin, long long end, const RawEntries<T>& e) {
  using P = Pack<T>;
  constexpr int N = P::size;
  long long f = begin;
  for (; f + N <= end; f += N) entries_of_pack<P>(f, N, e);
  if (f < end) entries_of_pack<P>(f, static_cast<int>(end - f), e);
}

template <class T>
void upper_angles_of(long long count, const T* y, const T* x, T* out) {
  using P = Pack<T>;
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

template <class T>
void units_of(long long count, const T* angle, T factor, T* out) {
  using P = Pack<T>;
  constexpr int N = P::size;
  long long i = 0;
  for (; i + N <= count; i += N) units_of_pack(P(factor) * P::load(angle + i), N, out + 2 * i);
  if (i == count) return;
  T rest[N];
  for (int l = 0; l < N; ++l) rest[l] = angle[i + l < count ? i + l : i];
  units_of_pack(P(factor) * P::load(rest), count - i, out + 2 * i);
}

template <class T>
inline constexpr ElementLoops<T> element_loops = {entries_of_range<T>, upper_angles_of<T>, units_of<T>};

}  // namespace alcap::detail::simd::ALCAP_SIMD
