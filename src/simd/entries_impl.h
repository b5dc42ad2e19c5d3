// SPDX-License-Identifier: MIT
//
// entries_impl.h: the loop over packs of triangles. Included by one file per instruction set, each compiled with its
// own flags; the tag in P keeps the instantiations apart.
#pragma once

#include "kernels/stiffness_mass.h"
#include "src/simd/entries_raw.h"

namespace alcap::detail::simd {

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

template <class P, class T>
void entries_of_range(long long begin, long long end, const RawEntries<T>& e) {
  constexpr int N = P::size;
  long long f = begin;
  for (; f + N <= end; f += N) entries_of_pack<P>(f, N, e);
  if (f < end) entries_of_pack<P>(f, static_cast<int>(end - f), e);
}

}  // namespace alcap::detail::simd
