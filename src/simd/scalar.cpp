// SPDX-License-Identifier: MIT
//
// scalar.cpp: one triangle and one angle at a time, to compare the packs with; the other loops are the portable ones.
#include "kernels/angles.h"
#include "kernels/stiffness_mass.h"
#include "src/simd/loops.h"

namespace alcap::detail::simd {
namespace portable {
const Loops& loops();
}

namespace scalar {
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

template <class T>
void upper_angles_of(long long count, const T* y, const T* x, T* out) {
  for (long long i = 0; i < count; ++i) out[i] = kernels::upper_angle(y[i], x[i]);
}

template <class T>
void units_of(long long count, const T* angle, T factor, T* out) {
  for (long long i = 0; i < count; ++i) {
    const kernels::Cplx<T> unit = kernels::unit_of(factor * angle[i]);
    out[2 * i] = unit.re;
    out[2 * i + 1] = unit.im;
  }
}

template <class T>
constexpr ElementLoops<T> element_loops = {entries_of_range<T>, upper_angles_of<T>, units_of<T>};

}  // namespace

const Loops& loops() {
  static const Loops table = [] {
    Loops some = portable::loops();
    some.elements_float = element_loops<float>;
    some.elements_double = element_loops<double>;
    return some;
  }();
  return table;
}

}  // namespace scalar
}  // namespace alcap::detail::simd
