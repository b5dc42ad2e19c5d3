// SPDX-License-Identifier: MIT
//
// triangle_operators.h: integrated div + i curl (P) and their reflected pair (Q) of the basis over one triangle
// (LTGD 2016, Sec. 6.3, triangle-based integrals, and App. A.3; App. A.1 for n-fields).
//
//   P_i = e^{-i n rho_i} int_t e^l (conj g_i - i K phi_i (phi_j conj g_k - phi_k conj g_j)), Q_i without conj,
//   l = -i n (tau_ij phi_j + tau_ik phi_k)
//
// (P u)_t = sum_i P_i u_i is an (n-1)-vector in the face frame, (Q u)_t an (n+1)-vector.
#pragma once

#include "kernels/exp_divided_differences.h"

namespace alcap::kernels {

/// What a connection says about one triangle, for an n-field.
template <class T>
struct TriangleFrame {
  T rho[3];         ///< per corner, angle from the vertex frame to the face frame
  T tau[3];         ///< per halfedge c -> c+1, lifted; the triangle's curvature is minus their sum
  Cplx<T> grad[3];  ///< gradients of the hat functions as complex numbers in the face frame
};

/// Coefficients of the three corners.
template <class T>
struct TriangleOperator {
  Cplx<T> p[3], q[3];
};

/// area > 0; n: degree of the field, any integer.
template <class T>
TriangleOperator<T> triangle_operator(const TriangleFrame<T>& f, const T& area, const T& n) {
  const T zero(Value<T>(0)), twice_area = area + area;
  const T K = -(n * (f.tau[0] + f.tau[1] + f.tau[2]));
  TriangleOperator<T> op;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    // tau_ik = -tau_ki.
    const CornerDifferences<T> d = corner_differences(zero, -(n * f.tau[i]), n * f.tau[k]);
    const Cplx<T> phase = twice_area * unit(-(n * f.rho[i]));
    const Cplx<T> iKj = times_i(K * d.iijjk), iKk = times_i(K * d.iijkk);
    op.p[i] = phase * (conj(f.grad[i]) * d.ijk - (conj(f.grad[k]) * iKj - conj(f.grad[j]) * iKk));
    op.q[i] = phase * (f.grad[i] * d.ijk - (f.grad[k] * iKj - f.grad[j] * iKk));
  }
  return op;
}

/// Gradients of the hat functions in a frame whose first axis lies along halfedge 0: g_i = i e_jk / 2A, from the three
/// edge vectors e[c] (corner c to c+1) as complex numbers.
template <class T>
ALCAP_INLINE void hat_gradients(const Cplx<T> (&edge)[3], const T& area, Cplx<T> (&grad)[3]) {
  const T scale = T(Value<T>(0.5L)) / area;
  for (int i = 0; i < 3; ++i) grad[i] = times_i(scale * edge[(i + 1) % 3]);
}

}  // namespace alcap::kernels
