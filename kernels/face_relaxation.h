// SPDX-License-Identifier: MIT
//
// face_relaxation.h: the energy D_T + lambda D_E of one face, or of two that share an edge, after their own unknowns
// have moved to the optimum (LTGD 2016, Sec. 5.3).
//
// With corner k at the tail of halfedge k, a face sees of each halfedge i -> j
//
//   tau = -rho_{vi->t} + rho_ij + rho_{vj->t}                                                       (eq. 8)
//   r(x) = (1 - x) r_i + x r_j,  r_i = rho_{vi->t} - rho_{vi->e} - rho_{e->t}, r_j likewise         (eqs. 9, 10)
//   mean = (r_i + r_j) / 2,  difference = r_j - r_i
//
// and its energy is, W the Whitney mass matrix (kernels/whitney.h) and p = lambda times the weight of D_E,
//
//   tau' W tau + sum over halfedges of p int_0^1 r(x)^2 dx,   int_0^1 r^2 = mean^2 + difference^2 / 12.
//
// Moving corner k by x_k adds (x_k + x_{k+1}) / 2 to the mean, and x_{k+1} - x_k to difference and tau, of halfedge k.
// The face answers with the forces: half of the energy's derivatives in mean, difference and tau. S is a scalar or a
// pack.
//
// W of a sliver is stiff, but only in ways a face can hide from its neighbours: its rows all sum to s = (sum of
// cotangents)/12, so the Whitney form of curvature -k with least energy is k/3 on each halfedge, with energy s k^2 / 3,
// and the rest is gradients, which the corners take up. relax() uses this: it never multiplies by W and is as accurate
// on slivers as on other faces.
#pragma once

#include "kernels/symmetric_inverse.h"

namespace alcap::kernels {

/// What a face sees of its three halfedges; after relaxing, the forces that it answers with.
template <class S>
struct FaceState {
  S mean[3], difference[3], tau[3];
};

/// What relaxing a face needs to know of it: p of its halfedges, the energy of a unit of curvature, (sum of cot) / 36,
/// and the inverse of the Hessian in its corners.
template <class S>
struct FaceCoefficients {
  S weight[3], stiffness, inverse[6];
};

/// The coefficients of a face from its cotangents and p. The Hessian in the corners is D' W D plus that of D_E, D the
/// differences along halfedges: D' W D is the cotangent Laplacian.
template <class S>
ALCAP_INLINE void face_coefficients(const S (&cot)[3], const S (&p)[3], FaceCoefficients<S>& c) {
  using V = Value<S>;
  S h[3][3];
  const S sixth(V(1) / 6), third(V(1) / 3), half(V(1) / 2);
  c.stiffness = (cot[0] + cot[1] + cot[2]) * S(V(1) / 36);
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3, before = (k + 2) % 3;
    c.weight[k] = p[k];
    // (cot + cot)/2 of the two other corners on the diagonal, -cot/2 of the third one off it.
    h[k][k] = half * (cot[next] + cot[before]) + (p[k] + p[before]) * third;
    h[k][next] = h[next][k] = sixth * p[k] - half * cot[before];
  }
  const S a[6] = {h[0][0], h[0][1], h[0][2], h[1][1], h[1][2], h[2][2]};
  invert_symmetric(a, c.inverse);
}

/// What the face sees becomes the forces it answers with; moved is what its corners move by. First tau takes its best
/// form, curvature / 3 on each halfedge, then the corners follow the pull of the edges from there.
template <class S>
ALCAP_INLINE void relax(const FaceCoefficients<S>& c, FaceState<S>& v, S (&moved)[3]) {
  using V = Value<S>;
  const S third(V(1) / 3), half(V(1) / 2), twelfth(V(1) / 12);
  auto& [mean, difference, tau] = v;
  const S curvature = tau[0] + tau[1] + tau[2];
  S step[3], pm[3], pd[3], g[3], y[3], pull[3];
  for (int k = 0; k < 3; ++k) step[k] = curvature * third - tau[k];
  for (int k = 0; k < 3; ++k) moved[k] = (step[(k + 2) % 3] - step[k]) * third;
  for (int k = 0; k < 3; ++k) {
    mean[k] = mean[k] + (moved[k] + moved[(k + 1) % 3]) * half;
    difference[k] = difference[k] + step[k];
    pm[k] = c.weight[k] * mean[k] * half;
    pd[k] = c.weight[k] * difference[k] * twelfth;
  }
  for (int k = 0; k < 3; ++k) g[k] = pm[k] - pd[k] + pm[(k + 2) % 3] + pd[(k + 2) % 3];
  multiply_symmetric(c.inverse, g, y);
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    mean[k] = c.weight[k] * (mean[k] - (y[k] + y[next]) * half);
    difference[k] = c.weight[k] * (difference[k] - (y[next] - y[k])) * twelfth;
    moved[k] = moved[k] - y[k];
  }
  // W tau is its mean plus differences that balance the pull of the edges on the corners.
  for (int k = 0; k < 3; ++k) pull[k] = (mean[k] + mean[(k + 2) % 3]) * half - difference[k] + difference[(k + 2) % 3];
  for (int k = 0; k < 3; ++k) tau[k] = c.stiffness * curvature + (pull[k] - pull[(k + 1) % 3]) * third;
}

/// Two faces that share their halfedges 0, seen from both sides: what a sees of the edge between them is (m, d, t), b
/// sees (m, -d, -t). inverse: from invert_between(). `between` is what the edge moves by, in a's eyes: mean,
/// difference, tau. Leaves no force on it, to rounding.
template <class S>
ALCAP_INLINE void relax_pair(const FaceCoefficients<S>& a, const FaceCoefficients<S>& b, const S (&inverse)[6],
                             FaceState<S>& va, FaceState<S>& vb, S (&moved_a)[3], S (&moved_b)[3], S (&between)[3]) {
  FaceState<S> wa = va, wb = vb;
  relax(a, wa, moved_a);
  relax(b, wb, moved_b);
  const S force[3] = {wa.mean[0] + wb.mean[0], wa.difference[0] - wb.difference[0], wa.tau[0] - wb.tau[0]};
  multiply_symmetric(inverse, force, between);
  for (S& move : between) move = -move;
  va.mean[0] = va.mean[0] + between[0];
  vb.mean[0] = vb.mean[0] + between[0];
  va.difference[0] = va.difference[0] + between[1];
  vb.difference[0] = vb.difference[0] - between[1];
  va.tau[0] = va.tau[0] + between[2];
  vb.tau[0] = vb.tau[0] - between[2];
  relax(a, va, moved_a);
  relax(b, vb, moved_b);
}

/// How the corners of a face are pulled by a unit (m, d, t) on halfedge k before they move: pull[0], [1] and [2].
template <class S>
ALCAP_INLINE void unit_pulls(const FaceCoefficients<S>& c, int k, S (&pull)[3][3]) {
  using V = Value<S>;
  const int next = (k + 1) % 3, before = (k + 2) % 3;
  const S twelfth(V(1) / 12), eighteenth(V(1) / 18), ninth(V(1) / 9);
  pull[0][k] = pull[0][next] = c.weight[k] * S(V(1) / 2);
  pull[1][next] = c.weight[k] * twelfth;
  pull[1][k] = -pull[1][next];
  pull[0][before] = pull[1][before] = S(V(0));
  pull[2][k] = c.weight[k] * eighteenth + c.weight[before] * ninth;
  pull[2][next] = -(c.weight[k] * eighteenth + c.weight[next] * ninth);
  pull[2][before] = (c.weight[before] - c.weight[next]) * eighteenth;
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
  const S zero(V(0)), held[6] = {c.weight[k],
                                 zero,
                                 zero,
                                 c.weight[k] * S(V(1) / 12),
                                 c.weight[k] * S(-V(1) / 18),
                                 c.stiffness + (c.weight[0] + c.weight[1] + c.weight[2]) * S(V(1) / 27)};
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
  const S held[3][3] = {{zero, zero, c.weight[k] * sixth},
                        {zero, zero, c.weight[k] * small},
                        {-(c.weight[0] * sixth), c.weight[0] * small,
                         c.stiffness - (c.weight[0] + c.weight[1] + c.weight[2]) * S(V(1) / 54)}};
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
