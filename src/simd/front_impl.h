// SPDX-License-Identifier: MIT
//
// front_impl.h: the loops of front_loops.h over packs of doubles. Part of loops_impl.h.
#pragma once

#include "kernels/pack.h"
#include "src/simd/front_loops.h"

namespace alcap::detail::simd::ALCAP_SIMD {

/// `count` rows of the panel, side by side so that their divisions overlap.
template <int count>
ALCAP_INLINE void panel_rows(const RawFront& F, const RawPanel& P, long long row) {
  using P_ = Pack<double>;
  constexpr int N = front_panel / P_::size;
  double re[count][front_panel], im[count][front_panel];
  double l_re[count][front_panel], l_im[count][front_panel];
  for (int r = 0; r < count; ++r) {
    const long long at = (row + r) * F.stride + P.first;
    __builtin_memcpy(re[r], F.re + at, sizeof re[r]);
    __builtin_memcpy(im[r], F.im + at, sizeof im[r]);
  }
  for (int p = 0; p < P.depth; ++p) {
    const double* const w_re = P.own_re + front_panel * p;
    const double* const w_im = P.own_im + front_panel * p;
    for (int r = 0; r < count; ++r) {
      const double y_re = re[r][p], y_im = im[r][p];
      P.below_re[p * F.stride + row + r] = y_re;
      P.below_im[p * F.stride + row + r] = y_im;
      l_re[r][p] = y_re * P.inverse_pivots[p];
      l_im[r][p] = y_im * P.inverse_pivots[p];
      const P_ lr(l_re[r][p]), li(l_im[r][p]);
      for (int n = 0; n < N; ++n) {
        const P_ wr = P_::load(w_re + n * P_::size), wi = P_::load(w_im + n * P_::size);
        (P_::load(re[r] + n * P_::size) - (lr * wr + li * wi)).store(re[r] + n * P_::size);
        (P_::load(im[r] + n * P_::size) - (li * wr - lr * wi)).store(im[r] + n * P_::size);
      }
    }
  }
  for (int r = 0; r < count; ++r) {
    const long long at = (row + r) * F.stride + P.first;
    for (int p = 0; p < P.depth; ++p) {
      F.re[at + p] = l_re[r][p];
      F.im[at + p] = l_im[r][p];
    }
  }
}

inline void front_panel_rows(const RawFront& F, const RawPanel& P, long long begin, long long end) {
  long long i = begin;
  for (; i + 3 < end; i += 4) panel_rows<4>(F, P, i);
  for (; i < end; ++i) panel_rows<1>(F, P, i);
}

/// A tile of `count` rows and `packs` packs of columns.
template <int count, int packs>
ALCAP_INLINE void update_tile(const RawFront& F, const RawPanel& P, long long row, long long column) {
  using P_ = Pack<double>;
  P_ re[count][packs], im[count][packs];
  for (int r = 0; r < count; ++r)
    for (int n = 0; n < packs; ++n) {
      const long long at = (row + r) * F.stride + column + n * P_::size;
      re[r][n] = P_::load(F.re + at);
      im[r][n] = P_::load(F.im + at);
    }
  for (int p = 0; p < P.depth; ++p) {
    P_ wr[packs], wi[packs];
    for (int n = 0; n < packs; ++n) {
      wr[n] = P_::load(P.below_re + p * F.stride + column + n * P_::size);
      wi[n] = P_::load(P.below_im + p * F.stride + column + n * P_::size);
    }
    for (int r = 0; r < count; ++r) {
      const long long at = (row + r) * F.stride + P.first + p;
      const P_ lr(F.re[at]), li(F.im[at]);
      for (int n = 0; n < packs; ++n) {
        re[r][n] = re[r][n] - (lr * wr[n] + li * wi[n]);
        im[r][n] = im[r][n] - (li * wr[n] - lr * wi[n]);
      }
    }
  }
  for (int r = 0; r < count; ++r)
    for (int n = 0; n < packs; ++n) {
      const long long at = (row + r) * F.stride + column + n * P_::size;
      re[r][n].store(F.re + at);
      im[r][n].store(F.im + at);
    }
}

template <int count>
ALCAP_INLINE void update_rows(const RawFront& F, const RawPanel& P, long long column, long long row) {
  constexpr int size = Pack<double>::size;
  for (long long j = column; j < row + count; j += size) update_tile<count, 1>(F, P, row, j);
}

inline void front_update(const RawFront& F, const RawPanel& P, long long column, long long begin, long long end) {
  long long i = begin;
  for (; i + 3 < end; i += 4) update_rows<4>(F, P, column, i);
  for (; i < end; ++i) update_rows<1>(F, P, column, i);
}

inline constexpr FrontLoops front_loops = {front_panel_rows, front_update};

}  // namespace alcap::detail::simd::ALCAP_SIMD
