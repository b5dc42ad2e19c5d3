// SPDX-License-Identifier: MIT
//
// entries_scalar.cpp: one triangle and one angle at a time, on any machine.
#include "kernels/angles.h"
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

}  // namespace

void entries_scalar(long long begin, long long end, const RawEntries<float>& e) { entries_of_range(begin, end, e); }
void entries_scalar(long long begin, long long end, const RawEntries<double>& e) { entries_of_range(begin, end, e); }

void upper_angles_scalar(long long count, const float* y, const float* x, float* out) {
  upper_angles_of(count, y, x, out);
}
void upper_angles_scalar(long long count, const double* y, const double* x, double* out) {
  upper_angles_of(count, y, x, out);
}

void units_scalar(long long count, const float* angle, float factor, float* out) {
  units_of(count, angle, factor, out);
}
void units_scalar(long long count, const double* angle, double factor, double* out) {
  units_of(count, angle, factor, out);
}

}  // namespace alcap::detail::simd
