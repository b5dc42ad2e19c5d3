// SPDX-License-Identifier: MIT
//
// series.h: polynomial tables made at compile time, and Horner's rule over scalars and packs.
#pragma once

#include "kernels/pack.h"

namespace alcap::kernels {

/// Coefficients c[0] + c[1] y + ... A plain aggregate: tables are data, no code of theirs reaches the linker.
template <class T, int N>
struct Polynomial {
  T c[N];
};

/// The polynomial at y.
template <class T, class V, int N>
ALCAP_INLINE T horner(const Polynomial<V, N>& p, const T& y) {
  T sum = T(p.c[N - 1]);
  for (int i = N - 2; i >= 0; --i) sum = mul_add(sum, y, T(p.c[i]));
  return sum;
}

/// 1 / n!.
consteval long double inverse_factorial(int n) {
  long double f = 1;
  for (int i = 2; i <= n; ++i) f *= i;
  return 1 / f;
}

/// The first N coefficients of sum_p (-1)^p k! / (2p + first)! y^p.
template <class V, int N>
consteval Polynomial<V, N> alternating_series(int k, int first) {
  Polynomial<V, N> t{};
  for (int p = 0; p < N; ++p) {
    t.c[p] = static_cast<V>((p % 2 ? -1 : 1) * inverse_factorial(2 * p + first) / inverse_factorial(k));
  }
  return t;
}

/// Chebyshev economisation on 0 <= y <= y_max: the N-term polynomial got by expanding `full` in shifted Chebyshev
/// polynomials, dropping those of degree >= N, and collecting powers of y again. Its error is about 4^(1-N) of
/// the error of cutting `full` itself after N terms.
template <class V, int N, int Full>
consteval Polynomial<V, N> economise(const Polynomial<long double, Full>& full, long double y_max) {
  // z^n = 2^(1-2n) sum_{k<=n} binomial(2n, k) T*_{n-k}(z), the term of T*_0 halved; z = y / y_max.
  long double cheb[Full] = {};
  long double scale = 1;
  for (int n = 0; n < Full; ++n, scale *= y_max / 4) {
    long double binomial = 1;
    for (int k = 0; k <= n; ++k) {
      cheb[n - k] += (k == n ? 1 : 2) * binomial * scale * full.c[n];
      binomial *= static_cast<long double>(2 * n - k) / (k + 1);
    }
  }
  // T*_{m+1} = (4z - 2) T*_m - T*_{m-1}.
  long double before[N] = {}, now[N] = {}, sum[N] = {};
  now[0] = 1;
  for (int m = 0; m < N; ++m) {
    for (int i = 0; i <= m; ++i) sum[i] += cheb[m] * now[i];
    long double next[N] = {};
    for (int i = 0; i < N; ++i) {
      next[i] = (m == 0 ? -1 : -2) * now[i] + (i > 0 ? (m == 0 ? 2 : 4) * now[i - 1] : 0) - (m == 0 ? 0 : before[i]);
    }
    for (int i = 0; i < N; ++i) before[i] = now[i], now[i] = next[i];
  }
  Polynomial<V, N> out{};
  long double power = 1;
  for (int i = 0; i < N; ++i, power *= y_max) out.c[i] = static_cast<V>(sum[i] / power);
  return out;
}

}  // namespace alcap::kernels
