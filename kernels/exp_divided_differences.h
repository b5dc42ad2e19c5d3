// SPDX-License-Identifier: MIT
//
// exp_divided_differences.h: divided differences of exp at imaginary nodes, the closed form of the integrals over a
// triangle of LTGD 2016, App. A.3, by the formula of Hermite and Genocchi:
//
//   int_t phi_i^a phi_j^b phi_k^c e^l = 2A a! b! c! exp[l_i (a+1 times), l_j (b+1 times), l_k (c+1 times)]
//
// with l linear, l = i x at the corners. Nodes are shifted to the centre of their range. Up to a half-range of 1 the
// Taylor series about the centre is summed: exp[w_a ... w_b] = sum_p h_p(w_a ... w_b) / (b-a+p)!, h_p the complete
// homogeneous symmetric polynomial, whose truncation error is r^p / p! of the leading term for any coincidence of
// nodes. Beyond, the argument is halved first and doubled back: the differences over all windows of a node sequence
// are the entries of exp(Z), Z = diag(w) + the superdiagonal of ones, and exp(2Z) = exp(Z)^2 (McCurdy, Ng and Parlett
// 1984).
#pragma once

#include "kernels/complex.h"
#include "kernels/series.h"

namespace alcap::kernels {

/// Half-ranges of nodes and number of terms for truncation below half an ulp.
template <class V>
struct DifferenceTables;
template <>
struct DifferenceTables<double> {
  static constexpr double small = 0.0625, large = 1;
  static constexpr int short_terms = 9, long_terms = 19;
};
template <>
struct DifferenceTables<float> {
  static constexpr float small = 0.0625f, large = 1;
  static constexpr int short_terms = 5, long_terms = 12;
};

/// d[a][b] = exp[i x_a, ..., i x_b] for a <= b, of a sequence of N nodes.
template <class T, int N>
struct DividedDifferences {
  Cplx<T> d[N][N];
};

namespace detail {

/// 1/0! ... 1/31!.
template <class V>
consteval Polynomial<V, 32> inverse_factorials() {
  Polynomial<V, 32> t{};
  for (int n = 0; n < 32; ++n) t.c[n] = static_cast<V>(inverse_factorial(n));
  return t;
}
template <class V>
inline constexpr Polynomial<V, 32> inverse_factorial_table = inverse_factorials<V>();

/// Row a of the table, columns a ... last, by `Terms` terms of the series.
template <int Terms, class T, int N>
ALCAP_INLINE void difference_row(const T (&w)[N], int a, int last, DividedDifferences<T, N>& out) {
  const auto& f = inverse_factorial_table<Value<T>>.c;
  T h[N];
  for (int b = a; b <= last; ++b) {
    h[b] = T(Value<T>(1));
    out.d[a][b] = {T(f[b - a]), T(Value<T>(0))};
  }
  for (int p = 1; p < Terms; ++p) {
    h[a] = w[a] * h[a];
    for (int b = a + 1; b <= last; ++b) h[b] = mul_add(w[b], h[b], h[b - 1]);
    for (int b = a; b <= last; ++b) {
      const Value<T> c = (p & 2) ? -f[b - a + p] : f[b - a + p];  // i^p = 1, i, -1, -i
      T& part = (p & 1) ? out.d[a][b].im : out.d[a][b].re;
      part = mul_add(T(c), h[b], part);
    }
  }
}

/// From exp[w] to exp[2w] in place: longest windows first, so that each reads only entries not yet replaced.
template <class T, int N, class M>
ALCAP_INLINE void double_argument(DividedDifferences<T, N>& t, const M& active) {
  using V = Value<T>;
  for (int length = N - 1; length >= 0; --length) {
    const T scale(V(1) / static_cast<V>(1 << length));
    for (int a = 0; a + length < N; ++a) {
      const int b = a + length;
      Cplx<T> sum = t.d[a][a] * t.d[a][b];
      for (int m = a + 1; m <= b; ++m) sum = sum + t.d[a][m] * t.d[m][b];
      t.d[a][b] = select(active, scale * sum, t.d[a][b]);
    }
  }
}

/// The whole table for centred nodes of any half-range r. Out of line: rare.
template <class T, int N>
[[gnu::noinline]] void differences_by_doubling(const T (&w)[N], const T& half_range, DividedDifferences<T, N>& out) {
  using V = Value<T>;
  T r = half_range;
  const T one(V(1)), half(V(0.5)), two(V(2));
  T scale = one, scaled[N];
  constexpr int most = 40;  // beyond a range of 2^40 nothing of the phases is left; also ends the loop for infinity
  for (int q = 0; q < most && any(r > one); ++q) {
    scale = select(r > one, scale * half, scale);
    r = select(r > one, r * half, r);
  }
  for (int a = 0; a < N; ++a) scaled[a] = w[a] * scale;
  for (int a = 0; a < N; ++a) difference_row<DifferenceTables<V>::long_terms>(scaled, a, N - 1, out);
  while (any(scale < one)) {
    const auto active = scale < one;
    double_argument(out, active);
    scale = select(active, scale * two, scale);
  }
}

}  // namespace detail

/// The three divided differences that the first-order operators of one corner need, at nodes i x_i, i x_j, i x_k.
template <class T>
struct CornerDifferences {
  Cplx<T> ijk;    ///< exp[i,j,k]:     int e^l             = 2A times this
  Cplx<T> iijjk;  ///< exp[i,i,j,j,k]: int phi_i phi_j e^l = 2A times this
  Cplx<T> iijkk;  ///< exp[i,i,j,k,k]: int phi_i phi_k e^l = 2A times this
};

/// Nodes may coincide and be as far apart as they like. Absolute error a few ulps of 1/2, 1/24, 1/24 (the values at
/// equal nodes) times max(1, largest difference of nodes).
template <class T>
CornerDifferences<T> corner_differences(const T& xi, const T& xj, const T& xk) {
  using V = Value<T>;
  using Tables = DifferenceTables<V>;
  const T low = min(xi, min(xj, xk)), high = max(xi, max(xj, xk));
  const T half(V(0.5)), centre = half * low + half * high, r = half * high - half * low;
  const T wi = xi - centre, wj = xj - centre, wk = xk - centre;
  // The sequence j k i j i k holds {i,j,k}, {i,i,j,j,k} and {i,i,j,k,k} as the windows 0..2, 0..4 and 1..5.
  const T w[6] = {wj, wk, wi, wj, wi, wk};
  DividedDifferences<T, 6> t;
  const auto is_small = r <= T(Tables::small);
  detail::difference_row<Tables::short_terms>(w, 0, 4, t);
  detail::difference_row<Tables::short_terms>(w, 1, 5, t);
  CornerDifferences<T> c = {t.d[0][2], t.d[0][4], t.d[1][5]};
  if (!all(is_small)) {
    detail::difference_row<Tables::long_terms>(w, 0, 4, t);
    detail::difference_row<Tables::long_terms>(w, 1, 5, t);
    const auto take = [&](const auto& mask) {
      c.ijk = select(mask, t.d[0][2], c.ijk);
      c.iijjk = select(mask, t.d[0][4], c.iijjk);
      c.iijkk = select(mask, t.d[1][5], c.iijkk);
    };
    take(!is_small);
    const auto is_large = r > T(Tables::large);
    if (any(is_large)) {
      detail::differences_by_doubling(w, r, t);
      take(is_large);
    }
  }
  const Cplx<T> phase = unit(centre);
  return {phase * c.ijk, phase * c.iijjk, phase * c.iijkk};
}

}  // namespace alcap::kernels
