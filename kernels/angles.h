// SPDX-License-Identifier: MIT
//
// angles.h: angles of vectors and unit vectors of angles, for scalars and packs alike, by polynomials instead of the C
// library: no branches, so that packs stay packs. Right to about an ulp.
#pragma once

#include "kernels/complex.h"
#include "kernels/pack.h"

namespace alcap::kernels {

/// atan2(y, x) for y > 0, in (0, pi). NaN for NaN.
template <class T>
ALCAP_INLINE T upper_angle(const T& y, const T& x) {
  using V = Value<T>;
  // atan(t) / t in powers of t^2 on |t| <= tan(pi/8): the polynomial with the least relative error, 1.2e-18.
  constexpr V coefficient[] = {V(1),
                               V(-0.33333333333333129135),
                               V(0.19999999999942737138),
                               V(-0.142857142794172279),
                               V(0.11111110752675482984),
                               V(-0.090908970193419675312),
                               V(0.076920488865085629149),
                               V(-0.066629904359344324537),
                               V(0.058471478599799511571),
                               V(-0.05036270919748911596),
                               V(0.037993884638238400137),
                               V(-0.017835688356684968844)};
  constexpr V tan_eighth = V(0.41421356237309504880), quarter = V(0.78539816339744830962),
              half = V(1.5707963267948966192), whole = V(3.1415926535897932385);
  const T width = abs(x);
  const auto steep = y > width;
  const T low = select(steep, width, y), high = select(steep, y, width);
  // atan(t) = pi/4 + atan((t - 1) / (t + 1))
  const auto middle = low > T(tan_eighth) * high;
  const T t = select(middle, low - high, low) / select(middle, low + high, high);
  const T s = t * t;
  T p = T(coefficient[11]);
  for (int k = 10; k >= 0; --k) p = mul_add(p, s, T(coefficient[k]));
  const T flat = select(middle, T(quarter), T(V(0))) + t * p;
  const T right = select(steep, T(half) - flat, flat);
  return select(x < T(V(0)), T(whole) - right, right);
}

/// cos(angle) + i sin(angle). For |angle| up to 1e5 in double, 1e4 in float; digits are lost slowly beyond.
template <class T>
ALCAP_INLINE Cplx<T> unit_of(const T& angle) {
  using V = Value<T>;
  constexpr bool is_float = sizeof(V) == sizeof(float);
  // Adding and subtracting this rounds to the nearest whole number.
  const T rounder = T(is_float ? V(12582912) : V(6755399441055744));
  const T quarters = (angle * T(V(0.63661977236758134308)) + rounder) - rounder;
  // pi/2 in three parts, the first two of which have zeros at their ends: their products with `quarters` are exact.
  constexpr V half_pi[] = {is_float ? V(1.5703125) : V(1.57079632673412561417e+00),
                           is_float ? V(4.837512969970703125e-4) : V(6.07710050630396597660e-11),
                           is_float ? V(7.549789948768648e-8) : V(2.02226624879595063154e-21)};
  const T x = ((angle - quarters * T(half_pi[0])) - quarters * T(half_pi[1])) - quarters * T(half_pi[2]);
  const T s = x * x;
  // Taylor: on |x| <= pi/4 what is left out is below 1e-17.
  T sine = T(V(-1.0 / 1307674368000.0)), cosine = T(V(1.0 / 20922789888000.0));
  sine = mul_add(sine, s, T(V(1.0 / 6227020800.0)));
  sine = mul_add(sine, s, T(V(-1.0 / 39916800.0)));
  sine = mul_add(sine, s, T(V(1.0 / 362880.0)));
  sine = mul_add(sine, s, T(V(-1.0 / 5040.0)));
  sine = mul_add(sine, s, T(V(1.0 / 120.0)));
  sine = mul_add(sine, s, T(V(-1.0 / 6.0)));
  sine = mul_add(sine * s, x, x);
  cosine = mul_add(cosine, s, T(V(-1.0 / 87178291200.0)));
  cosine = mul_add(cosine, s, T(V(1.0 / 479001600.0)));
  cosine = mul_add(cosine, s, T(V(-1.0 / 3628800.0)));
  cosine = mul_add(cosine, s, T(V(1.0 / 40320.0)));
  cosine = mul_add(cosine, s, T(V(-1.0 / 720.0)));
  cosine = mul_add(cosine, s, T(V(1.0 / 24.0)));
  cosine = mul_add(cosine, s, T(V(-0.5)));
  cosine = mul_add(cosine, s, T(V(1)));
  // quarters modulo 4, in -2 ... 2
  const T turns = (quarters * T(V(0.25)) + rounder) - rounder;
  const T turn = quarters - T(V(4)) * turns;
  const T one_half = T(V(0.5)), more = T(V(1.5)), size = abs(turn);
  const auto odd = (size > one_half) & (size < more);
  const T c = select(odd, sine, cosine), d = select(odd, cosine, sine);
  return {select((turn > one_half) | (turn < -more), -c, c), select((turn < -one_half) | (turn > more), -d, d)};
}

}  // namespace alcap::kernels
