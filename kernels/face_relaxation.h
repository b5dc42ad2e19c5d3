// SPDX-License-Identifier: MIT
//
// face_relaxation.h: the energy D_T + detail D_E of one face, or of two that share an edge, after their own unknowns
// have moved to the optimum (LTGD 2016, Sec. 5.3). Unknowns, energy and units:
// src/connection/global/correction_system.h.
//
// A face sees mean, difference and tau on its halfedges k = 0, 1, 2 (corner k at the tail of halfedge k) and answers
// with the forces, half of the energy's derivatives with respect to them. Below v[0] are means, v[1] differences, v[2]
// taus. S is a scalar or a pack.
//
// W of a sliver is stiff, but only in ways a face can hide from its neighbours: its rows all sum to s = (sum of
// cotangents)/12, so the Whitney form of curvature -k with least energy is k/3 on each halfedge, with energy s k^2 / 3,
// and the rest is gradients, which the corners take up. relax() uses this: it never multiplies by W and is as accurate
// on slivers as on other faces.
#pragma once

#include "kernels/pack.h"

namespace alcap::kernels {

/// Inverse of the symmetric positive semidefinite [a0 a1 a2; a1 a3 a4; a2 a4 a5] by L D L'. Directions without energy
/// (relative to the diagonal) are left out.
template <class S>
ALCAP_INLINE void invert_symmetric(const S (&a)[6], S (&out)[6]) {
  using V = Value<S>;
  constexpr V negligible = sizeof(V) == sizeof(float) ? V(1e-6) : V(2e-15);  // 8 ulp
  const auto reciprocal = [](const S& pivot, const S& diagonal) {
    return select(pivot > S(negligible) * diagonal, S(V(1)) / pivot, S(V(0)));
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

/// out = a x for a symmetric matrix as above.
template <class S>
ALCAP_INLINE void multiply_symmetric(const S (&a)[6], const S (&x)[3], S (&out)[3]) {
  out[0] = a[0] * x[0] + a[1] * x[1] + a[2] * x[2];
  out[1] = a[1] * x[0] + a[3] * x[1] + a[4] * x[2];
  out[2] = a[2] * x[0] + a[4] * x[1] + a[5] * x[2];
}

/// What relaxing a face needs to know of it: p of its halfedges, the energy of a unit of curvature, and the inverse of
/// the Hessian in its corners.
template <class S>
struct FaceCoefficients {
  S p[3], stiffness, inverse[6];
};

template <class S>
ALCAP_INLINE void face_coefficients(const S (&cot)[3], const S (&p)[3], FaceCoefficients<S>& c) {
  using V = Value<S>;
  S h[3][3];
  const S sixth(V(1) / 6), third(V(1) / 3), half(V(1) / 2);
  c.stiffness = (cot[0] + cot[1] + cot[2]) * S(V(1) / 36);
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3, before = (k + 2) % 3;
    c.p[k] = p[k];
    // D' W D has (cot + cot)/2 of the two corners beyond on the diagonal and -cot/2 of the third off it.
    h[k][k] = half * (cot[next] + cot[before]) + (p[k] + p[before]) * third;
    h[k][next] = h[next][k] = sixth * p[k] - half * cot[before];
  }
  const S a[6] = {h[0][0], h[0][1], h[0][2], h[1][1], h[1][2], h[2][2]};
  invert_symmetric(a, c.inverse);
}

/// What the face sees becomes what it answers; x is what its corners move by.
template <class S>
ALCAP_INLINE void relax(const FaceCoefficients<S>& c, S (&v)[3][3], S (&x)[3]) {
  using V = Value<S>;
  const S third(V(1) / 3), half(V(1) / 2), twelfth(V(1) / 12);
  auto& [mean, difference, tau] = v;
  const S curvature = tau[0] + tau[1] + tau[2];
  S step[3], pm[3], pd[3], g[3], y[3], pull[3];
  for (int k = 0; k < 3; ++k) step[k] = curvature * third - tau[k];
  for (int k = 0; k < 3; ++k) x[k] = (step[(k + 2) % 3] - step[k]) * third;
  for (int k = 0; k < 3; ++k) {
    mean[k] = mean[k] + (x[k] + x[(k + 1) % 3]) * half;
    difference[k] = difference[k] + step[k];
    pm[k] = c.p[k] * mean[k] * half;
    pd[k] = c.p[k] * difference[k] * twelfth;
  }
  for (int k = 0; k < 3; ++k) g[k] = pm[k] - pd[k] + pm[(k + 2) % 3] + pd[(k + 2) % 3];
  multiply_symmetric(c.inverse, g, y);
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    mean[k] = c.p[k] * (mean[k] - (y[k] + y[next]) * half);
    difference[k] = c.p[k] * (difference[k] - (y[next] - y[k])) * twelfth;
    x[k] = x[k] - y[k];
  }
  // W tau is its mean plus differences that balance the pull of the edges on the corners.
  for (int k = 0; k < 3; ++k) pull[k] = (mean[k] + mean[(k + 2) % 3]) * half - difference[k] + difference[(k + 2) % 3];
  for (int k = 0; k < 3; ++k) tau[k] = c.stiffness * curvature + (pull[k] - pull[(k + 1) % 3]) * third;
}

/// Two faces that share their halfedges 0, seen from both sides: what a sees of the edge between them is (m, d, t), b
/// sees (m, -d, -t). inverse: from invert_between(). `between` is what the edge moves by, in a's eyes. Leaves no force
/// on it, to rounding.
template <class S>
ALCAP_INLINE void relax_pair(const FaceCoefficients<S>& a, const FaceCoefficients<S>& b, const S (&inverse)[6],
                             S (&va)[3][3], S (&vb)[3][3], S (&xa)[3], S (&xb)[3], S (&between)[3]) {
  S wa[3][3], wb[3][3];
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) {
      wa[i][k] = va[i][k];
      wb[i][k] = vb[i][k];
    }
  relax(a, wa, xa);
  relax(b, wb, xb);
  const S force[3] = {wa[0][0] + wb[0][0], wa[1][0] - wb[1][0], wa[2][0] - wb[2][0]};
  multiply_symmetric(inverse, force, between);
  for (int i = 0; i < 3; ++i) {
    between[i] = -between[i];
    va[i][0] = va[i][0] + between[i];
    vb[i][0] = i == 0 ? vb[i][0] + between[i] : vb[i][0] - between[i];
  }
  relax(a, va, xa);
  relax(b, vb, xb);
}

/// How the corners of a face are pulled by a unit (m, d, t) on halfedge k before they move: pull[0], [1] and [2].
template <class S>
ALCAP_INLINE void unit_pulls(const FaceCoefficients<S>& c, int k, S (&pull)[3][3]) {
  using V = Value<S>;
  const int next = (k + 1) % 3, before = (k + 2) % 3;
  const S twelfth(V(1) / 12), eighteenth(V(1) / 18), ninth(V(1) / 9);
  pull[0][k] = pull[0][next] = c.p[k] * S(V(1) / 2);
  pull[1][next] = c.p[k] * twelfth;
  pull[1][k] = -pull[1][next];
  pull[0][before] = pull[1][before] = S(V(0));
  pull[2][k] = c.p[k] * eighteenth + c.p[before] * ninth;
  pull[2][next] = -(c.p[k] * eighteenth + c.p[next] * ninth);
  pull[2][before] = (c.p[before] - c.p[next]) * eighteenth;
}

template <class S>
ALCAP_INLINE S dot(const S (&x)[3], const S (&y)[3]) {
  return x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
}

/// The forces of a relaxed face on halfedge k for units on the same: [mm md mt dd dt tt]. `pull` of unit_pulls().
template <class S>
ALCAP_INLINE void own_block(const FaceCoefficients<S>& c, int k, const S (&pull)[3][3], S (&own)[6]) {
  using V = Value<S>;
  S move[3][3];
  for (int u = 0; u < 3; ++u) multiply_symmetric(c.inverse, pull[u], move[u]);
  const S zero(V(0)), held[6] = {c.p[k],
                                 zero,
                                 zero,
                                 c.p[k] * S(V(1) / 12),
                                 c.p[k] * S(-V(1) / 18),
                                 c.stiffness + (c.p[0] + c.p[1] + c.p[2]) * S(V(1) / 27)};
  for (int u = 0, i = 0; u < 3; ++u)
    for (int w = u; w < 3; ++w, ++i) own[i] = held[i] - dot(pull[u], move[w]);
}

/// The forces u on halfedge k = 1 or 2 for units w on halfedge 0, with the pulls of both.
template <class S>
ALCAP_INLINE void cross_block(const FaceCoefficients<S>& c, int k, const S (&pull)[3][3], const S (&pull_0)[3][3],
                              S (&cross)[3][3]) {
  using V = Value<S>;
  // A tau moves the mean of the next halfedge by -1/6 and of the one before by 1/6.
  const S zero(V(0)), sixth(k == 1 ? -V(1) / 6 : V(1) / 6), small(V(1) / 36);
  const S held[3][3] = {{zero, zero, c.p[k] * sixth},
                        {zero, zero, c.p[k] * small},
                        {-(c.p[0] * sixth), c.p[0] * small, c.stiffness - (c.p[0] + c.p[1] + c.p[2]) * S(V(1) / 54)}};
  for (int w = 0; w < 3; ++w) {
    S move[3];
    multiply_symmetric(c.inverse, pull_0[w], move);
    for (int u = 0; u < 3; ++u) cross[u][w] = held[u][w] - dot(pull[u], move);
  }
}

/// The inverse for relax_pair().
template <class S>
ALCAP_INLINE void invert_between(const FaceCoefficients<S>& a, const FaceCoefficients<S>& b, S (&inverse)[6]) {
  S pull[3][3], own_a[6], own_b[6], sum[6];
  unit_pulls(a, 0, pull);
  own_block(a, 0, pull, own_a);
  unit_pulls(b, 0, pull);
  own_block(b, 0, pull, own_b);
  for (int i = 0; i < 6; ++i) sum[i] = i == 1 || i == 2 ? own_a[i] - own_b[i] : own_a[i] + own_b[i];
  invert_symmetric(sum, inverse);
}

/// own_block() of halfedges 1 and 2 of face a of a pair, or of b with `second`, once the edge between has moved.
template <class S>
ALCAP_INLINE void outer_blocks(const FaceCoefficients<S>& c, const S (&inverse)[6], bool second, S (&outer)[2][6]) {
  S pull_0[3][3];
  unit_pulls(c, 0, pull_0);
  for (int k = 1; k < 3; ++k) {
    S pull[3][3], cross[3][3], move[3][3];
    unit_pulls(c, k, pull);
    own_block(c, k, pull, outer[k - 1]);
    cross_block(c, k, pull, pull_0, cross);
    for (int u = 0; u < 3; ++u) {
      for (int w = 1; w < 3; ++w) cross[u][w] = second ? -cross[u][w] : cross[u][w];
      multiply_symmetric(inverse, cross[u], move[u]);
    }
    for (int u = 0, i = 0; u < 3; ++u)
      for (int w = u; w < 3; ++w, ++i) outer[k - 1][i] = outer[k - 1][i] - dot(cross[u], move[w]);
  }
}

}  // namespace alcap::kernels
