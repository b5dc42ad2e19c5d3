// SPDX-License-Identifier: MIT
//
// vector_impl.h: the loops over one vector in double beside K of single precision, of the last digits of an eigenpair.
// Part of loops_impl.h. Four lanes whatever the instruction set, so that sums across lanes have one order on all
// machines.
#pragma once

#include "kernels/pack.h"
#include "src/simd/block_loops.h"

namespace alcap::detail::simd::ALCAP_SIMD {

using Doubles = Pack<double, 4>;

/// Four floats as doubles.
ALCAP_INLINE Doubles widen(const float* from) {
  typedef float Floats __attribute__((vector_size(16)));
  Floats f;
  __builtin_memcpy(&f, from, sizeof f);
  return Doubles::from(__builtin_convertvector(f, Doubles::Native));
}

inline void pencil_single(const RawPencil& A, long long begin, long long end, const double* x, double* Sx, double* Mx) {
  using P = Doubles;
  for (long long j = begin; j < end; ++j, Sx += 2, Mx += 2) {
    // Lanes: S times re, S times im, the same of M. As in block_impl.h the two halves are joined at the end of a row.
    P re(0.0), im(0.0);
    for (Index e = A.start[j]; e < A.start[j + 1]; ++e) {
      const double* const s = A.S + 2 * static_cast<long long>(e);
      const double* const m = A.M + 2 * static_cast<long long>(e);
      const double* const from = x + 2 * static_cast<long long>(A.row[e]);
      const P z = P::from(P::Native{from[0], from[1], from[0], from[1]});
      re = re + P::from(P::Native{s[0], s[0], m[0], m[0]}) * z;
      im = im + P::from(P::Native{s[1], s[1], m[1], m[1]}) * z;
    }
    Sx[0] = A.S_scale * (re[0] + im[1]);
    Sx[1] = A.S_scale * (re[1] - im[0]);
    Mx[0] = A.M_scale * (re[2] + im[3]);
    Mx[1] = A.M_scale * (re[3] - im[2]);
  }
}

template <int K>
void neighbour_products(const float* y, const double* s, const double* m, long long rows, double* out) {
  using P = Doubles;
  for (int part = 0; part < K; part += P::size) {
    P S_re(0.0), S_im(0.0), M_re(0.0), M_im(0.0);
    for (long long i = 0; i < rows; ++i) {
      const P re = widen(y + 2 * K * i + part), im = widen(y + 2 * K * i + K + part);
      S_re = S_re + (re * P(s[2 * i]) + im * P(s[2 * i + 1]));
      S_im = S_im + (re * P(s[2 * i + 1]) - im * P(s[2 * i]));
      M_re = M_re + (re * P(m[2 * i]) + im * P(m[2 * i + 1]));
      M_im = M_im + (re * P(m[2 * i + 1]) - im * P(m[2 * i]));
    }
    const P* const sums[4] = {&S_re, &S_im, &M_re, &M_im};
    for (int q = 0; q < 4; ++q) (P::load(out + q * K + part) + *sums[q]).store(out + q * K + part);
  }
}

template <int K>
void advance(const double* own, const double* of_y, const float* y, const double* w, long long rows, double* p,
             double* x) {
  using P = Doubles;
  constexpr int N = K / P::size;
  P c_re[N], c_im[N];
  for (int n = 0; n < N; ++n) {
    c_re[n] = P::load(of_y + n * P::size);
    c_im[n] = P::load(of_y + K + n * P::size);
  }
  for (long long i = 0; i < rows; ++i) {
    P re(0.0), im(0.0);
    for (int n = 0; n < N; ++n) {
      const P y_re = widen(y + 2 * K * i + n * P::size), y_im = widen(y + 2 * K * i + K + n * P::size);
      re = re + (c_re[n] * y_re - c_im[n] * y_im);
      im = im + (c_re[n] * y_im + c_im[n] * y_re);
    }
    const auto times = [](const double* c, const double* z, double* to) {
      to[0] = c[0] * z[0] - c[1] * z[1];
      to[1] = c[0] * z[1] + c[1] * z[0];
    };
    double of_x[2], of_w[2], of_p[2];
    times(own, x + 2 * i, of_x);
    times(own + 2, w + 2 * i, of_w);
    times(own + 4, p + 2 * i, of_p);
    p[2 * i] = of_w[0] + of_p[0] + ((re[0] + re[1]) + (re[2] + re[3]));
    p[2 * i + 1] = of_w[1] + of_p[1] + ((im[0] + im[1]) + (im[2] + im[3]));
    x[2 * i] = of_x[0] + p[2 * i];
    x[2 * i + 1] = of_x[1] + p[2 * i + 1];
  }
}

template <int K>
inline constexpr VectorKernels vector_kernels = {pencil_single, neighbour_products<K>, advance<K>};

}  // namespace alcap::detail::simd::ALCAP_SIMD
