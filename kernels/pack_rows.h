// SPDX-License-Identifier: MIT
//
// pack_rows.h: packs of N lanes from N rows of four values, one row a lane, and back; rows lie anywhere.
#pragma once

#include "kernels/pack.h"

namespace alcap::kernels {
namespace detail {

template <int... I>
struct Lanes {};
template <int N, int... I>
struct CountLanes : CountLanes<N - 1, N - 1, I...> {};
template <int... I>
struct CountLanes<0, I...> {
  using type = Lanes<I...>;
};

/// In every group of four lanes {a, b, c, d} of it in x (0 to 3) and y (4 to 7).
template <int a, int b, int c, int d, class P, int... I>
ALCAP_INLINE P shuffle_fours(const P& x, const P& y, Lanes<I...>) {
  constexpr int N = P::size;
  constexpr int from[4] = {a < 4 ? a : N + a - 4, b < 4 ? b : N + b - 4, c < 4 ? c : N + c - 4, d < 4 ? d : N + d - 4};
  return P::from(__builtin_shufflevector(x.v, y.v, (from[I % 4] + I / 4 * 4)...));
}

template <int a, int b, int c, int d, class P>
ALCAP_INLINE P shuffle_fours(const P& x, const P& y) {
  return shuffle_fours<a, b, c, d>(x, y, typename CountLanes<P::size>::type{});
}

/// Transposes the 4 x 4 values that four packs have in each group of four lanes.
template <class P>
ALCAP_INLINE void transpose_fours(P (&p)[4]) {
  const P a = shuffle_fours<0, 4, 1, 5>(p[0], p[1]), b = shuffle_fours<0, 4, 1, 5>(p[2], p[3]);
  const P c = shuffle_fours<2, 6, 3, 7>(p[0], p[1]), d = shuffle_fours<2, 6, 3, 7>(p[2], p[3]);
  p[0] = shuffle_fours<0, 1, 4, 5>(a, b);
  p[1] = shuffle_fours<2, 3, 6, 7>(a, b);
  p[2] = shuffle_fours<0, 1, 4, 5>(c, d);
  p[3] = shuffle_fours<2, 3, 6, 7>(c, d);
}

/// A pack of the rows r, 4 + r, 8 + r ... of `row`.
template <class T, int N, class Isa>
ALCAP_INLINE Pack<T, N, Isa> every_fourth(const T* const* row) {
  if constexpr (N == 4) {
    return Pack<T, 4, Isa>::load(row[0]);
  } else if constexpr (N == 8) {
    const auto low = every_fourth<T, 4, Isa>(row), high = every_fourth<T, 4, Isa>(row + 4);
    return Pack<T, 8, Isa>::from(__builtin_shufflevector(low.v, high.v, 0, 1, 2, 3, 4, 5, 6, 7));
  } else {
    static_assert(N == 16);
    const auto low = every_fourth<T, 8, Isa>(row), high = every_fourth<T, 8, Isa>(row + 8);
    return Pack<T, 16, Isa>::from(
        __builtin_shufflevector(low.v, high.v, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15));
  }
}

template <class T, int N, class Isa>
ALCAP_INLINE void to_every_fourth(const Pack<T, N, Isa>& p, T* const* row) {
  if constexpr (N == 4) {
    p.store(row[0]);
  } else if constexpr (N == 8) {
    Pack<T, 4, Isa>::from(__builtin_shufflevector(p.v, p.v, 0, 1, 2, 3)).store(row[0]);
    Pack<T, 4, Isa>::from(__builtin_shufflevector(p.v, p.v, 4, 5, 6, 7)).store(row[4]);
  } else {
    static_assert(N == 16);
    to_every_fourth(Pack<T, 8, Isa>::from(__builtin_shufflevector(p.v, p.v, 0, 1, 2, 3, 4, 5, 6, 7)), row);
    to_every_fourth(Pack<T, 8, Isa>::from(__builtin_shufflevector(p.v, p.v, 8, 9, 10, 11, 12, 13, 14, 15)), row + 8);
  }
}

}  // namespace detail

/// Lane l of p[i] is row[l][i].
template <class T, int N, class Isa>
ALCAP_INLINE void load_rows(const T* const (&row)[N], Pack<T, N, Isa> (&p)[4]) {
  if constexpr (N % 4 == 0) {
    for (int i = 0; i < 4; ++i) p[i] = detail::every_fourth<T, N, Isa>(row + i);
    detail::transpose_fours(p);
  } else {
    for (int i = 0; i < 4; ++i) {
      T column[N];
      for (int l = 0; l < N; ++l) column[l] = row[l][i];
      p[i] = Pack<T, N, Isa>::load(column);
    }
  }
}

/// The reverse; the fourth value of each row becomes 0.
template <class T, int N, class Isa>
ALCAP_INLINE void store_rows(const Pack<T, N, Isa> (&p)[3], T* const (&row)[N]) {
  if constexpr (N % 4 == 0) {
    Pack<T, N, Isa> q[4] = {p[0], p[1], p[2], Pack<T, N, Isa>(T(0))};
    detail::transpose_fours(q);
    for (int i = 0; i < 4; ++i) detail::to_every_fourth(q[i], row + i);
  } else {
    for (int l = 0; l < N; ++l) {
      for (int i = 0; i < 3; ++i) row[l][i] = p[i].v[l];
      row[l][3] = 0;
    }
  }
}

}  // namespace alcap::kernels
