// SPDX-License-Identifier: MIT
//
// basis.h: the basis Psi_i of one triangle (LTGD 2016, Sec. 4.3) and its covariant derivative (Sec. 6.1) at a point.
//
//   Psi_i = phi_i Phi_i,  Phi_i = exp(-i n (rho_i + tau_ij phi_j + tau_ik phi_k))
//   nabla Psi_i = Phi_i (d phi_i - i n K phi_i (phi_j d phi_k - phi_k d phi_j))
//
// in the face frame. With D_1, D_2 the derivatives along its axes, div + i curl is D_1 - i D_2 and the reflected pair
// D_1 + i D_2, twice the Cauchy-Riemann derivative: the four parts of LTGD 2016, eq. 4.
#pragma once

#include "kernels/triangle_operators.h"

namespace alcap::kernels {

/// Values and derivatives of the three basis functions.
template <class T>
struct BasisAt {
  Cplx<T> value[3], d1[3], d2[3];
};

/// b: barycentric coordinates, summing to 1. n: degree of the field, any integer.
template <class T>
BasisAt<T> basis_at(const TriangleFrame<T>& f, const T (&b)[3], const T& n) {
  const T K = -(n * (f.tau[0] + f.tau[1] + f.tau[2]));
  BasisAt<T> out;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const Cplx<T> phase = unit(-(n * (f.rho[i] + f.tau[i] * b[j] - f.tau[k] * b[k])));
    const T bend = -(K * b[i]);
    out.value[i] = b[i] * phase;
    out.d1[i] = phase * Cplx<T>{f.grad[i].re, bend * (b[j] * f.grad[k].re - b[k] * f.grad[j].re)};
    out.d2[i] = phase * Cplx<T>{f.grad[i].im, bend * (b[j] * f.grad[k].im - b[k] * f.grad[j].im)};
  }
  return out;
}

/// A field and its first derivatives at a point.
template <class T>
struct FieldAt {
  Cplx<T> value, d1, d2;
  Cplx<T> div_curl() const { return d1 - times_i(d2); }   ///< div + i curl
  Cplx<T> reflected() const { return d1 + times_i(d2); }  ///< reflected div + i reflected curl
};

/// u = sum_i u_i Psi_i and nabla u at a point, u_i in the frames of the three vertices.
template <class T>
FieldAt<T> field_at(const TriangleFrame<T>& f, const Cplx<T> (&u)[3], const T (&b)[3], const T& n) {
  const BasisAt<T> basis = basis_at(f, b, n);
  FieldAt<T> out = {u[0] * basis.value[0], u[0] * basis.d1[0], u[0] * basis.d2[0]};
  for (int i = 1; i < 3; ++i) {
    out.value = out.value + u[i] * basis.value[i];
    out.d1 = out.d1 + u[i] * basis.d1[i];
    out.d2 = out.d2 + u[i] * basis.d2[i];
  }
  return out;
}

}  // namespace alcap::kernels
