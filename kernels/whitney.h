// SPDX-License-Identifier: MIT
//
// whitney.h: the mass matrix of Whitney 1-forms on one triangle, for int_t omega ^ *omega (LTGD 2016, Secs. 5.2
// and 5.3):
//
//   W_(ij)(kl) = A (I_ik g_j.g_l - I_il g_j.g_k - I_jk g_i.g_l + I_jl g_i.g_k),  I = (1 + delta) / 12,  g = d phi
//
// Row and column c belong to the halfedge from corner c to corner c+1; corner c+2 is opposite. With
// A g_i.g_i = (cot_j + cot_k)/2 and A g_i.g_j = -cot_k/2 the area drops out: the matrix depends on angles alone.
#pragma once

#include "kernels/pack.h"

namespace alcap::kernels {

/// A symmetric 3 x 3 matrix: its diagonal, and off[c] in row c, column c+1.
template <class T>
struct Symmetric3 {
  T diagonal[3], off[3];
};

/// int_t phi_(ij).phi_(kl), phi_ij = phi_i d phi_j - phi_j d phi_i. Positive definite. cot: cotangents of the corners.
template <class T>
ALCAP_INLINE Symmetric3<T> whitney_mass(const T (&cot)[3]) {
  using V = Value<T>;
  const T twelfth(V(1.0L / 12)), three(V(3));
  Symmetric3<T> w;
  for (int c = 0; c < 3; ++c) {
    const T &i = cot[c], &j = cot[(c + 1) % 3], &k = cot[(c + 2) % 3];
    w.diagonal[c] = twelfth * (i + j + three * k);
    w.off[c] = twelfth * (j - i - k);
  }
  return w;
}

/// y = W x, one entry per halfedge.
template <class T>
ALCAP_INLINE void multiply(const Symmetric3<T>& w, const T (&x)[3], T (&y)[3]) {
  for (int c = 0; c < 3; ++c) {
    const int next = (c + 1) % 3, previous = (c + 2) % 3;
    y[c] = w.diagonal[c] * x[c] + w.off[c] * x[next] + w.off[previous] * x[previous];
  }
}

}  // namespace alcap::kernels
