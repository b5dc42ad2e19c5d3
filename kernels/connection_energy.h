// SPDX-License-Identifier: MIT
//
// connection_energy.h: how far a connection is from Levi-Civita (LTGD 2016, Sec. 5.3), per triangle, D_T = int_t omega
// ^ *omega, and per halfedge, D_E = w int_e (rho_{e->t}(p) - rho_{e->t})^2 dl with the two angles of eqs. 9 and 10.
#pragma once

#include "kernels/whitney.h"

namespace alcap::kernels {

/// D_T of one triangle: tau^T W tau, tau[c] the angle (eq. 8) of the halfedge from corner c to c+1. K^2 (sum cot)/36
/// when the three angles are equal (LTGD 2016, Sec. 5.2).
template <class T>
ALCAP_INLINE T triangle_energy(const T (&cot)[3], const T (&tau)[3]) {
  const Symmetric3<T> w = whitney_mass(cot);
  T product[3];
  multiply(w, tau, product);
  return tau[0] * product[0] + tau[1] * product[1] + tau[2] * product[2];
}

/// The gradient of triangle_energy in tau: 2 W tau.
template <class T>
ALCAP_INLINE void triangle_energy_gradient(const T (&cot)[3], const T (&tau)[3], T (&gradient)[3]) {
  multiply(whitney_mass(cot), tau, gradient);
  for (T& g : gradient) g = g + g;
}

/// w of D_E (LTGD 2016, Sec. 5.3): tan of the angle opposite a halfedge from its cotangent, at most `cap`, and `cap`
/// for right and obtuse angles.
template <class T>
ALCAP_INLINE T capped_tangent(const T& cot_opposite, const T& cap) {
  const T one(Value<T>(1));
  const auto above = cot_opposite * cap > one;
  return select(above, one / select(above, cot_opposite, one), cap);
}

/// D_E of one halfedge: weight int_0^1 ((1-x) r_start + x r_end)^2 dx, r the differences of eqs. 9 and 10 at its two
/// ends.
template <class T>
ALCAP_INLINE T halfedge_energy(const T& weight, const T& r_start, const T& r_end) {
  return weight * (r_start * r_start + r_start * r_end + r_end * r_end) * T(Value<T>(1.0L / 3));
}

/// The gradient of halfedge_energy in its two residuals.
template <class T>
ALCAP_INLINE void halfedge_energy_gradient(const T& weight, const T& r_start, const T& r_end, T& d_start, T& d_end) {
  const T third = weight * T(Value<T>(1.0L / 3));
  d_start = third * (r_start + r_start + r_end);
  d_end = third * (r_start + r_end + r_end);
}

}  // namespace alcap::kernels
