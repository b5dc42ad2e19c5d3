// SPDX-License-Identifier: MIT
//
// exp_integrals.h: the moments J_k(K) = int_0^1 t^k e^{iK(1-t)} dt behind S, M and the edge operators.
//
//   M_ij = e^{iR} (A/3) J_3(K);   psi(eps) = int_0^1 (1-x) e^{-i eps x} dx = conj J_1(eps);   S_ij uses J_1 ... J_5.
//
// M and S: LTGD 2016, Sec. 6.2; psi: App. A.2. J_k = k! phi_{k+1}(iK) with the phi functions of exponential integrators
// (Hochbruck and Ostermann 2010). Three ranges, chosen by |K| lane by lane (Sec. 6.3 and Knoeppel et al. 2013): Taylor
// up to `small`, Chebyshev in K^2 of the even and odd parts up to `large`, closed form beyond. The first two give J_5
// and go down, J_{k-1} = (1 + iK J_k) / k, the last gives J_0 and goes up, J_k = (k J_{k-1} - 1) / (iK); each direction
// shrinks errors where it is used.
#pragma once

#include "kernels/complex.h"
#include "kernels/series.h"

namespace alcap::kernels {

/// Ranges of |K| and the polynomials in K^2 of J_5 = even(K^2) + i K odd(K^2).
template <class V>
struct MomentTables;

/// Truncation errors relative to 1/6: 2e-18 (Taylor), 4e-18 (Chebyshev).
template <>
struct MomentTables<double> {
  static constexpr double small = 0.0625;
  static constexpr double large = 4;
  static constexpr auto taylor_even = alternating_series<double, 4>(5, 6);
  static constexpr auto taylor_odd = alternating_series<double, 4>(5, 7);
  static constexpr auto chebyshev_even = economise<double, 10>(alternating_series<long double, 16>(5, 6), 16);
  static constexpr auto chebyshev_odd = economise<double, 10>(alternating_series<long double, 16>(5, 7), 16);
};

/// Truncation errors relative to 1/6: 2e-8 at the end of the Taylor range, 1e-9 (Chebyshev).
template <>
struct MomentTables<float> {
  static constexpr float small = 0.5f;
  static constexpr float large = 4;
  static constexpr auto taylor_even = alternating_series<float, 3>(5, 6);
  static constexpr auto taylor_odd = alternating_series<float, 3>(5, 7);
  static constexpr auto chebyshev_even = economise<float, 6>(alternating_series<long double, 16>(5, 6), 16);
  static constexpr auto chebyshev_odd = economise<float, 6>(alternating_series<long double, 16>(5, 7), 16);
};

/// J_0 ... J_5 at one K.
template <class T>
struct Moments {
  Cplx<T> j[6];
};

namespace detail {

/// J_Low ... J_5 from J_5, for |K| <= 4.
template <int Low, class T>
ALCAP_INLINE void moments_down(const T& K, const Cplx<T>& top, Moments<T>& m) {
  using V = Value<T>;
  m.j[5] = top;
  for (int k = 5; k > Low; --k) {
    const T inverse(V(1) / static_cast<V>(k)), iK = K * inverse;
    m.j[k - 1] = {inverse - iK * m.j[k].im, iK * m.j[k].re};
  }
}

/// J_0 ... J_High from J_0, for |K| >= 4.
template <int High, class T>
void moments_up(const T& K, Moments<T>& m) {
  using V = Value<T>;
  const T one(V(1)), inverse = one / K;
  const Cplx<T> e = unit(K);
  m.j[0] = {inverse * e.im, inverse * (one - e.re)};
  for (int k = 1; k <= High; ++k) {
    const T factor(static_cast<V>(k));
    m.j[k] = {inverse * (factor * m.j[k - 1].im), inverse * (one - factor * m.j[k - 1].re)};
  }
}

}  // namespace detail

/// J_Low ... J_High of K, 0 <= Low <= High <= 5; the other members are not to be used. Relative error a few ulps of
/// |J_k| for k >= 1; of max(|J_0|, 1/|K|) for k = 0, which vanishes at multiples of 2 pi.
template <int Low, int High, class T>
ALCAP_INLINE Moments<T> moments(const T& K) {
  static_assert(0 <= Low && Low <= High && High <= 5);
  using V = Value<T>;
  using Tables = MomentTables<V>;
  const T y = K * K, size = abs(K);
  const auto is_small = size <= T(Tables::small);
  Moments<T> m;
  Cplx<T> top = {horner(Tables::taylor_even, y), K * horner(Tables::taylor_odd, y)};
  if (all(is_small)) [[likely]] {
    detail::moments_down<Low>(K, top, m);
    return m;
  }
  top = select(is_small, top, Cplx<T>{horner(Tables::chebyshev_even, y), K * horner(Tables::chebyshev_odd, y)});
  detail::moments_down<Low>(K, top, m);
  const auto is_large = size > T(Tables::large);
  if (any(is_large)) {
    Moments<T> up;
    detail::moments_up<High>(select(is_large, K, T(Tables::large)), up);
    for (int k = Low; k <= High; ++k) m.j[k] = select(is_large, up.j[k], m.j[k]);
  }
  return m;
}

/// psi(eps) = int_0^1 (1-x) e^{-i eps x} dx = (1 - i eps - e^{-i eps}) / eps^2, the weight of the start vertex in
/// integrals along an edge.
template <class T>
ALCAP_INLINE Cplx<T> edge_weight_integral(const T& eps) {
  return conj(moments<1, 1>(eps).j[1]);
}

}  // namespace alcap::kernels
