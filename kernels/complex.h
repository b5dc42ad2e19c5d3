// SPDX-License-Identifier: MIT
//
// complex.h: a complex number over scalars or packs. std::complex is unspecified for packs, and its product checks
// for NaN.
#pragma once

#include "kernels/pack.h"

namespace alcap::kernels {

/// re + i im.
template <class T>
struct Cplx {
  T re, im;

  ALCAP_INLINE friend Cplx operator+(const Cplx& a, const Cplx& b) { return {a.re + b.re, a.im + b.im}; }
  ALCAP_INLINE friend Cplx operator-(const Cplx& a, const Cplx& b) { return {a.re - b.re, a.im - b.im}; }
  ALCAP_INLINE friend Cplx operator-(const Cplx& a) { return {-a.re, -a.im}; }
  ALCAP_INLINE friend Cplx operator*(const T& s, const Cplx& a) { return {s * a.re, s * a.im}; }
  ALCAP_INLINE friend Cplx operator*(const Cplx& a, const Cplx& b) {
    return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
  }
};

template <class T>
ALCAP_INLINE Cplx<T> conj(const Cplx<T>& a) {
  return {a.re, -a.im};
}
/// i a.
template <class T>
ALCAP_INLINE Cplx<T> times_i(const Cplx<T>& a) {
  return {-a.im, a.re};
}
/// e^{i angle}.
template <class T>
ALCAP_INLINE Cplx<T> unit(const T& angle) {
  Cplx<T> e;
  sincos(angle, e.im, e.re);
  return e;
}
template <class M, class T>
ALCAP_INLINE Cplx<T> select(const M& mask, const Cplx<T>& yes, const Cplx<T>& no) {
  return {select(mask, yes.re, no.re), select(mask, yes.im, no.im)};
}

}  // namespace alcap::kernels
