// SPDX-License-Identifier: MIT
//
// block_impl.h: the loops of block_loops.h over packs of floats. Part of loops_impl.h.
//
// A complex product sum(a z) over pairs [re | im] is kept in two halves, sum(re(a) z) and sum(im(a) z), so that the
// loops need no shuffles; the halves are joined at the end of a row.
#pragma once

#include "kernels/pack.h"
#include "src/simd/block_loops.h"

namespace alcap::detail::simd::ALCAP_SIMD {

/// As many of the 2 K numbers of a row as fit into a register.
template <int K>
using Floats = Pack<float, (2 * K < lanes_of<float> ? 2 * K : lanes_of<float>)>;

/// re + i im of two halves: [re.re - im.im | re.im + im.re], with the second half conjugated if asked.
template <int K, bool conjugate, class T>
ALCAP_INLINE void join(const T* re, const T* im, T* out) {
  for (int k = 0; k < K; ++k) out[k] = conjugate ? re[k] + im[K + k] : re[k] - im[K + k];
  for (int k = 0; k < K; ++k) out[K + k] = conjugate ? re[K + k] - im[k] : re[K + k] + im[k];
}

typedef float Four __attribute__((vector_size(16)));
typedef double Two __attribute__((vector_size(16)));

/// One complex number in the lower half. Pairs travel as doubles: one load each.
inline Four one_pair(const float* from) {
  double pair;
  __builtin_memcpy(&pair, from, sizeof pair);
  return reinterpret_cast<Four>(Two{pair, 0});
}

/// re += [re(a) z], im += [im(a) z] for two complex numbers a and z.
ALCAP_INLINE void add_products(Four a, Four z, Four& re, Four& im) {
  re += __builtin_shufflevector(a, a, 0, 0, 2, 2) * z;
  im += __builtin_shufflevector(a, a, 1, 1, 3, 3) * z;
}

/// One vector: two entries at a time in four lanes, which no wider register would speed up at six entries a row.
inline void rows_single(const RawRows& A, long long begin, long long end, const float* x, float p, const float* u,
                        float q, const float* v, float s, float* y) {
  for (long long i = begin; i < end; ++i) {
    Four re = {}, im = {};
    long long e = A.start[i];
    const long long stop = A.start[i + 1];
    for (; e + 1 < stop; e += 2) {
      Four a;
      __builtin_memcpy(&a, A.value + 2 * e, sizeof a);
      double first, second;
      __builtin_memcpy(&first, x + 2 * static_cast<long long>(A.column[e]), sizeof first);
      __builtin_memcpy(&second, x + 2 * static_cast<long long>(A.column[e + 1]), sizeof second);
      add_products(a, reinterpret_cast<Four>(Two{first, second}), re, im);
    }
    if (e < stop)
      add_products(one_pair(A.value + 2 * e), one_pair(x + 2 * static_cast<long long>(A.column[e])), re, im);
    // Both halves together, then [re.re - im.im | re.im + im.re]; the upper lanes no longer count.
    re += __builtin_shufflevector(re, re, 2, 3, 2, 3);
    im += __builtin_shufflevector(im, im, 2, 3, 2, 3);
    Four out = s * (re + Four{-1, 1, 0, 0} * __builtin_shufflevector(im, im, 1, 0, 1, 0));
    if (u != nullptr) out += p * one_pair(u + 2 * i);
    if (v != nullptr) out += q * one_pair(v + 2 * i);
    __builtin_memcpy(y + 2 * i, &out, sizeof(double));
  }
}

template <int K>
void rows(const RawRows& A, long long begin, long long end, const float* x, float p, const float* u, float q,
          const float* v, float s, float* y) {
  using P = Floats<K>;
  constexpr int N = 2 * K / P::size;
  for (long long i = begin; i < end; ++i) {
    P re[N], im[N];
    for (int n = 0; n < N; ++n) re[n] = im[n] = P(0.0F);
    for (long long e = A.start[i]; e < A.start[i + 1]; ++e) {
      const P ar(A.value[2 * e]), ai(A.value[2 * e + 1]);
      const float* const from = x + 2 * K * static_cast<long long>(A.column[e]);
      for (int n = 0; n < N; ++n) {
        const P z = P::load(from + n * P::size);
        re[n] = re[n] + ar * z;
        im[n] = im[n] + ai * z;
      }
    }
    float real[2 * K], imaginary[2 * K], sum[2 * K];
    for (int n = 0; n < N; ++n) re[n].store(real + n * P::size);
    for (int n = 0; n < N; ++n) im[n].store(imaginary + n * P::size);
    join<K, false>(real, imaginary, sum);
    for (int n = 0; n < N; ++n) {
      P out = P(s) * P::load(sum + n * P::size);
      if (u != nullptr) out = out + P(p) * P::load(u + 2 * K * i + n * P::size);
      if (v != nullptr) out = out + P(q) * P::load(v + 2 * K * i + n * P::size);
      out.store(y + 2 * K * i + n * P::size);
    }
  }
}

template <int K>
void pencil(const RawPencil& A, long long begin, long long end, const float* x, float* Sx, float* Mx) {
  // Eight numbers of a row at a time: the four sums of S and M then stay in registers.
  constexpr int width = 8;
  using P = Pack<double, (lanes_of<double> < width ? lanes_of<double> : width)>;
  constexpr int N = width / P::size;
  for (long long j = begin; j < end; ++j, Sx += 2 * K, Mx += 2 * K) {
    double S_re[2 * K], S_im[2 * K], M_re[2 * K], M_im[2 * K];
    for (int part = 0; part < 2 * K; part += width) {
      P sums[4][N];
      for (auto& sum : sums)
        for (P& lanes : sum) lanes = P(0.0);
      for (long long e = A.start[j]; e < A.start[j + 1]; ++e) {
        const float* const from = x + 2 * K * static_cast<long long>(A.row[e]) + part;
        double z[width];
        for (int k = 0; k < width; ++k) z[k] = static_cast<double>(from[k]);
        const P entry[4] = {P(A.S[2 * e]), P(A.S[2 * e + 1]), P(A.M[2 * e]), P(A.M[2 * e + 1])};
        for (int n = 0; n < N; ++n) {
          const P lanes = P::load(z + n * P::size);
          for (int k = 0; k < 4; ++k) sums[k][n] = sums[k][n] + entry[k] * lanes;
        }
      }
      double* const to[4] = {S_re, S_im, M_re, M_im};
      for (int k = 0; k < 4; ++k)
        for (int n = 0; n < N; ++n) sums[k][n].store(to[k] + part + n * P::size);
    }
    double S_sum[2 * K], M_sum[2 * K];
    join<K, true>(S_re, S_im, S_sum);
    join<K, true>(M_re, M_im, M_sum);
    for (int k = 0; k < 2 * K; ++k) Sx[k] = static_cast<float>(A.S_scale * S_sum[k]);
    for (int k = 0; k < 2 * K; ++k) Mx[k] = static_cast<float>(A.M_scale * M_sum[k]);
  }
}

template <int K>
void gram(const float* left, const float* right, long long rows, double* out) {
  using P = Floats<K>;
  constexpr int N = 2 * K / P::size;
  for (int a = 0; a < K; ++a) {
    P re[N], im[N];
    for (int n = 0; n < N; ++n) re[n] = im[n] = P(0.0F);
    for (long long i = 0; i < rows; ++i) {
      const P lr(left[2 * K * i + a]), li(left[2 * K * i + K + a]);
      for (int n = 0; n < N; ++n) {
        const P z = P::load(right + 2 * K * i + n * P::size);
        re[n] = re[n] + lr * z;
        im[n] = im[n] + li * z;
      }
    }
    float real[2 * K], imaginary[2 * K], sum[2 * K];
    for (int n = 0; n < N; ++n) re[n].store(real + n * P::size);
    for (int n = 0; n < N; ++n) im[n].store(imaginary + n * P::size);
    join<K, true>(real, imaginary, sum);
    for (int b = 0; b < K; ++b) out[K * a + b] += static_cast<double>(sum[b]);
    for (int b = 0; b < K; ++b) out[K * (K + a) + b] += static_cast<double>(sum[K + b]);
  }
}

/// Coefficients as combine uses them: for each of the K vectors what its real and its imaginary part contribute.
template <int K>
ALCAP_INLINE void spread(const float* c, float (&re)[K][2 * K], float (&im)[K][2 * K]) {
  for (int a = 0; a < K; ++a)
    for (int b = 0; b < K; ++b) {
      re[a][b] = im[a][K + b] = c[K * a + b];
      re[a][K + b] = c[K * (K + a) + b];
      im[a][b] = -c[K * (K + a) + b];
    }
}

template <int K>
ALCAP_INLINE void add_combination(const float* row, const float (&re)[K][2 * K], const float (&im)[K][2 * K],
                                  Floats<K>* sum) {
  using P = Floats<K>;
  for (int a = 0; a < K; ++a) {
    const P x(row[a]), y(row[K + a]);
    for (int n = 0; n < 2 * K / P::size; ++n)
      sum[n] = sum[n] + (x * P::load(re[a] + n * P::size) + y * P::load(im[a] + n * P::size));
  }
}

template <int K>
void combine(const float* a, const float* ca, const float* b, const float* cb, long long rows, float* out) {
  using P = Floats<K>;
  constexpr int N = 2 * K / P::size;
  float a_re[K][2 * K], a_im[K][2 * K], b_re[K][2 * K], b_im[K][2 * K];
  spread<K>(ca, a_re, a_im);
  if (b != nullptr) spread<K>(cb, b_re, b_im);
  for (long long i = 0; i < rows; ++i) {
    P sum[N];
    for (int n = 0; n < N; ++n) sum[n] = P(0.0F);
    add_combination<K>(a + 2 * K * i, a_re, a_im, sum);
    if (b != nullptr) add_combination<K>(b + 2 * K * i, b_re, b_im, sum);
    for (int n = 0; n < N; ++n) sum[n].store(out + 2 * K * i + n * P::size);
  }
}

template <int K>
inline constexpr BlockKernels block_kernels = {rows<K>, pencil<K>, gram<K>, combine<K>};

}  // namespace alcap::detail::simd::ALCAP_SIMD
