// SPDX-License-Identifier: MIT
//
// symmetric_inverse.h: inverses of positive semidefinite 3 x 3 matrices [a0 a1 a2; a1 a3 a4; a2 a4 a5], scalars or
// packs, by L D L'. A direction whose pivot is rounding beside its diagonal entry has no energy and is left out: its
// part of the inverse is zero.
#pragma once

#include <limits>

#include "kernels/pack.h"

namespace alcap::kernels {

/// Pivots up to this part of their diagonal entry are what three subtractions leave of nothing.
template <class V>
inline constexpr V negligible_pivot = 8 * std::numeric_limits<V>::epsilon();

/// out = the inverse of a.
template <class S>
ALCAP_INLINE void invert_symmetric(const S (&a)[6], S (&out)[6]) {
  using V = Value<S>;
  const auto reciprocal = [](const S& pivot, const S& diagonal) {
    return select(pivot > S(negligible_pivot<V>) * diagonal, S(V(1)) / pivot, S(V(0)));
  };
  const S r0 = reciprocal(a[0], a[0]);
  const S l1 = a[1] * r0, l2 = a[2] * r0;
  const S r1 = reciprocal(a[3] - l1 * a[1], a[3]);
  const S b = a[4] - l1 * a[2];
  const S l3 = b * r1;
  const S r2 = reciprocal(a[5] - l2 * a[2] - l3 * b, a[5]);
  // The columns of inv(L) are (1, -l1, l1 l3 - l2), (0, 1, -l3), (0, 0, 1).
  const S m = l1 * l3 - l2;
  out[0] = r0 + l1 * l1 * r1 + m * m * r2;
  out[1] = -l1 * r1 - l3 * m * r2;
  out[2] = m * r2;
  out[3] = r1 + l3 * l3 * r2;
  out[4] = -l3 * r2;
  out[5] = r2;
}

/// u = the lower triangular U, by rows, with U' U = the inverse of a: U = D^(-1/2) inv(L).
template <class S>
ALCAP_INLINE void whiten_symmetric(const S (&a)[6], S (&u)[6]) {
  using V = Value<S>;
  const auto inverse_root = [](const S& pivot, const S& diagonal) {
    return select(pivot > S(negligible_pivot<V>) * diagonal, S(V(1)) / sqrt(pivot), S(V(0)));
  };
  const S s0 = inverse_root(a[0], a[0]);
  const S l1 = a[1] * s0 * s0, l2 = a[2] * s0 * s0;
  const S s1 = inverse_root(a[3] - l1 * a[1], a[3]);
  const S b = a[4] - l1 * a[2];
  const S l3 = b * s1 * s1;
  const S s2 = inverse_root(a[5] - l2 * a[2] - l3 * b, a[5]);
  u[0] = s0;
  u[1] = -l1 * s1;
  u[2] = s1;
  u[3] = (l1 * l3 - l2) * s2;
  u[4] = -l3 * s2;
  u[5] = s2;
}

/// out = a x.
template <class S>
ALCAP_INLINE void multiply_symmetric(const S (&a)[6], const S (&x)[3], S (&out)[3]) {
  out[0] = a[0] * x[0] + a[1] * x[1] + a[2] * x[2];
  out[1] = a[1] * x[0] + a[3] * x[1] + a[4] * x[2];
  out[2] = a[2] * x[0] + a[4] * x[1] + a[5] * x[2];
}

}  // namespace alcap::kernels
