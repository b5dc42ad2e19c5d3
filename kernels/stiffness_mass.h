// SPDX-License-Identifier: MIT
//
// stiffness_mass.h: stiffness S and mass M of the basis Psi on one triangle (LTGD 2016, Sec. 6.2),
//
//   M_ij = int conj(Psi_i) Psi_j = int phi_i phi_j e^{i (K phi_k + R)},  S_ij = int conj(nabla Psi_i) . nabla Psi_j,
//
// with nabla Psi_i from Sec. 6.1. Integrating along phi_k = s leaves one integral over s (kernels/exp_integrals.h):
//
//   M_ij = e^{iR} (A/3) int_0^1 (1-s)^3 e^{iKs} ds
//   S_ij = e^{iR} 2A int_0^1 (1-s) e^{iKs} { g_i.g_j - iK [ (1-s)^2 |g_k|^2 / 6 + s (1-s) (|g_i|^2 + |g_j|^2) / 2 ]
//          - K^2 [ s (1-s)^3 |g_k|^2 / 12 + (1-s)^4 |g_k|^2 / 30 + s^2 (1-s)^2 g_i.g_j / 6 ] } ds
//   S_ii = A |g_i|^2 + K^2 A / 90 (|g_j|^2 + |g_k|^2 - g_j.g_k),  g = d phi
//
// Entries are returned without the transport phase: the full ones are S_ij = e^{iR} off[c], M_ij = e^{iR} (...), with
// i = c, j = c+1 and R = n rho_ij; row i, column j, and S_ji the conjugate. Then u* S u = int_t |nabla u|^2.
// S depends on angles and K only, M is the area times a function of K.
#pragma once

#include "kernels/exp_integrals.h"

namespace alcap::kernels {

/// Entries of one triangle. Pairs are (0,1), (1,2), (2,0).
template <class T>
struct TriangleEntries {
  T stiffness_diagonal[3];
  Cplx<T> stiffness_off[3];  ///< S_ij e^{-iR}
  T mass_diagonal;           ///< M_ii, the same for the three corners: A/6
  Cplx<T> mass_off;          ///< M_ij e^{-iR}, the same for the three pairs: (A/3) J_3(K)
};

/// cot: cotangents of the three corners; area > 0; K: the curvature the field sees, n times the triangle's lifted K.
template <class T>
ALCAP_INLINE TriangleEntries<T> stiffness_mass(const T (&cot)[3], const T& area, const T& K) {
  using V = Value<T>;
  const T half(V(0.5L));
  const Moments<T> m = moments<1, 5>(K);
  const Cplx<T>(&J)[6] = m.j;

  TriangleEntries<T> e;
  e.mass_diagonal = area * T(V(1.0L / 6));
  e.mass_off = (area * T(V(1.0L / 3))) * J[3];

  // G_i = A |g_i|^2; A g_i.g_j = -cot_k / 2.
  const T G[3] = {half * (cot[1] + cot[2]), half * (cot[2] + cot[0]), half * (cot[0] + cot[1])};
  const T K2 = K * K, K2_90 = K2 * T(V(1.0L / 90));
  // S_ij e^{-iR} = cot_k C + G_k D + (G_i + G_j) E with, for t = 1 - s,
  //   C = -int (t - K^2 s^2 t^3 / 6),  D = -int (iK t^3 / 3 + K^2 (s t^4 / 6 + t^5 / 15)),  E = -int iK s t^2,
  // all times e^{iKs}, from 2A (1-s) {...} of the formula above.
  const Cplx<T> s2t3 = J[3] - (J[4] + J[4]) + J[5];
  const Cplx<T> C = K2 * T(V(1.0L / 6)) * s2t3 - J[1];
  const Cplx<T> iD = (K * T(V(1.0L / 3))) * J[3];
  const Cplx<T> D = -(times_i(iD) + K2 * (T(V(1.0L / 6)) * J[4] - T(V(1.0L / 10)) * J[5]));
  const Cplx<T> E = times_i(K * (J[3] - J[2]));
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    e.stiffness_diagonal[i] = G[i] + K2_90 * (G[j] + G[k] + half * cot[i]);
    e.stiffness_off[i] = cot[k] * C + G[k] * D + (G[i] + G[j]) * E;
  }
  return e;
}

}  // namespace alcap::kernels
