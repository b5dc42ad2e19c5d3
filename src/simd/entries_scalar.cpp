// SPDX-License-Identifier: MIT
//
// entries_scalar.cpp: one triangle at a time, on any machine.
#include "kernels/stiffness_mass.h"
#include "src/simd/entries_raw.h"

namespace alcap::detail::simd {
namespace {

template <class T>
void entries_of_range(long long begin, long long end, const RawEntries<T>& e) {
  for (long long f = begin; f < end; ++f) {
    const T cot[3] = {e.cot[3 * f], e.cot[3 * f + 1], e.cot[3 * f + 2]};
    const kernels::TriangleEntries<T> r = kernels::stiffness_mass<T>(cot, e.area[f], e.n * e.curvature[f]);
    for (int c = 0; c < 3; ++c) {
      e.stiffness_diagonal[3 * f + c] = r.stiffness_diagonal[c];
      e.stiffness_off[6 * f + 2 * c] = r.stiffness_off[c].re;
      e.stiffness_off[6 * f + 2 * c + 1] = r.stiffness_off[c].im;
    }
    e.mass_off[2 * f] = r.mass_off.re;
    e.mass_off[2 * f + 1] = r.mass_off.im;
  }
}

}  // namespace

void entries_scalar(long long begin, long long end, const RawEntries<float>& e) { entries_of_range(begin, end, e); }
void entries_scalar(long long begin, long long end, const RawEntries<double>& e) { entries_of_range(begin, end, e); }

}  // namespace alcap::detail::simd
