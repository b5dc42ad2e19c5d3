// SPDX-License-Identifier: MIT
//
// edge_operators.h: integrated div + i curl (P) and their reflected pair (Q) from boundary integrals, per halfedge
// (LTGD 2016, Sec. 6.3, edge-based integrals; App. A.2 the closed form, App. A.1 for n-fields).
//
// For an n-field in the frame of face t, (P u)_t = sum over its halfedges of p_start u_start + p_end u_end, and the
// same with q. P u is an (n-1)-vector and Q u an (n+1)-vector in the face frame. Summed over any patch of a flat
// or curved mesh the integrals (n = 1) telescope to the boundary.
#pragma once

#include "kernels/exp_integrals.h"

namespace alcap::kernels {

/// Coefficients of one halfedge.
template <class T>
struct EdgeOperator {
  Cplx<T> p_start, p_end, q_start, q_end;
};

/// length: of the edge. rho_start, rho_end: angles from the two vertex frames to the direction of the halfedge (for the
/// far vertex that is rho of its own opposite halfedge plus pi). eps: -rho_start + rho_ij + rho_end, lifted.
/// phi: angle of the halfedge in the face frame. n: degree of the field, any integer.
template <class T>
ALCAP_INLINE EdgeOperator<T> edge_operator(const T& length, const T& rho_start, const T& rho_end, const T& eps,
                                           const T& phi, const T& n) {
  const Cplx<T> psi = edge_weight_integral(n * eps);  // psi(-x) = conj psi(x)
  const Cplx<T> start = unit(n * (phi - rho_start)) * psi, end = unit(n * (phi - rho_end)) * conj(psi);
  const Cplx<T> along = length * unit(phi);
  const Cplx<T> p = times_i(conj(along)), q = -times_i(along);
  return {p * start, p * end, q * start, q * end};
}

}  // namespace alcap::kernels
