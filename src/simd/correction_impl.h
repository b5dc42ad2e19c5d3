// SPDX-License-Identifier: MIT
//
// correction_impl.h: the loops of correction_raw.h over packs of L numbers. Included by one file per instruction set,
// each compiled with its own flags; the tag keeps the instantiations apart. Every lane does the same operations in the
// same order whatever the width, so that all machines get the same bits.
#pragma once

#include "kernels/connection_energy.h"
#include "kernels/face_relaxation.h"
#include "kernels/pack_rows.h"
#include "src/simd/correction_raw.h"

namespace alcap::detail::simd {

using kernels::Pack;

/// Asks for the memory of a block ahead of its use: the order in which blocks are read hides from the hardware that
/// they follow each other.
template <class Tag>
ALCAP_INLINE void prefetch(const void* from, unsigned long long bytes) {
  for (unsigned long long i = 0; i < bytes; i += 64) __builtin_prefetch(static_cast<const char*>(from) + i);
}

template <class P, class S, int size>
ALCAP_INLINE void load_coefficients(const FaceArrays<S, size>& f, int l, kernels::FaceCoefficients<P>& c) {
  for (int k = 0; k < 3; ++k) c.p[k] = P::load(f.p[k] + l);
  for (int k = 0; k < 6; ++k) c.inverse[k] = P::load(f.inverse[k] + l);
  c.stiffness = P::load(f.stiffness + l);
}

/// What P::size halfedges see, into column k of v; `row` becomes where they see it.
template <class P, class S>
ALCAP_INLINE void look(S* exchange, const std::uint32_t* rows, int k, S* (&row)[P::size], P (&v)[3][3]) {
  const S* from[P::size];
  for (int i = 0; i < P::size; ++i) from[i] = row[i] = exchange + 4 * static_cast<unsigned long long>(rows[i]);
  P seen[4];
  kernels::load_rows(from, seen);
  for (int i = 0; i < 3; ++i) v[i][k] = seen[i];
}

/// Writes column k of v, and returns its product with what was there.
template <class P, class S>
ALCAP_INLINE P answer(S* const (&row)[P::size], int k, const P (&before)[3][3], const P (&v)[3][3]) {
  const P column[3] = {v[0][k], v[1][k], v[2][k]};
  kernels::store_rows(column, row);
  return before[0][k] * column[0] + before[1][k] * column[1] + before[2][k] * column[2];
}

template <class Tag, int L, class S>
void relax_faces(const FaceBlock<S>* blocks, long long count, S* exchange, S* sums) {
  using P = Pack<S, L, Tag>;
  for (long long b = 0; b < count; ++b) {
    if (b + 1 < count) prefetch<Tag>(blocks + b + 1, sizeof(FaceBlock<S>));
    for (int l = 0; l < block_size; l += L) {
      kernels::FaceCoefficients<P> c;
      load_coefficients(blocks[b].face, l, c);
      P v[3][3], before[3][3], x[3], sum = P::load(sums + l);
      S* row[3][L];
      for (int k = 0; k < 3; ++k) look<P>(exchange, blocks[b].row[k] + l, k, row[k], v);
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) before[i][k] = v[i][k];
      kernels::relax(c, v, x);
      for (int k = 0; k < 3; ++k) sum = sum + answer<P>(row[k], k, before, v);
      sum.store(sums + l);
    }
  }
}

template <class Tag, int L, class S>
void relax_pairs(const PairBlock<S>* blocks, long long count, S* exchange, S* sums) {
  using P = Pack<S, L, Tag>;
  constexpr int ahead = 16;
  for (long long b = 0; b < count; ++b) {
    if (b + 1 < count) prefetch<Tag>(blocks + b + 1, sizeof(PairBlock<S>));
    for (int l = 0; l < block_size; l += L) {
      // Rows of pairs to come: where a mesh does not fit into the cache, they are what a step waits for.
      if (const long long later = b * block_size + l + ahead; later < count * block_size)
        for (int k = 0; k < 4; ++k) {
          const std::uint32_t* const rows = blocks[later / block_size].row[k / 2][k % 2] + later % block_size;
          for (int i = 0; i < L; ++i) __builtin_prefetch(exchange + 4ULL * rows[i]);
        }
      kernels::FaceCoefficients<P> c[2];
      P inverse[6], v[2][3][3], before[2][3][3], x[2][3], between[3], sum = P::load(sums + l);
      S* row[2][2][L];
      for (int k = 0; k < 6; ++k) inverse[k] = P::load(blocks[b].inverse[k] + l);
      for (int f = 0; f < 2; ++f) {
        load_coefficients(blocks[b].face[f], l, c[f]);
        for (int k = 0; k < 2; ++k) look<P>(exchange, blocks[b].row[f][k] + l, k + 1, row[f][k], v[f]);
        for (int i = 0; i < 3; ++i) {
          v[f][i][0] = P(S(0));
          for (int k = 0; k < 3; ++k) before[f][i][k] = v[f][i][k];
        }
      }
      kernels::relax_pair(c[0], c[1], inverse, v[0], v[1], x[0], x[1], between);
      for (int f = 0; f < 2; ++f)
        for (int k = 0; k < 2; ++k) sum = sum + answer<P>(row[f][k], k + 1, before[f], v[f]);
      sum.store(sums + l);
    }
  }
}

/// Adds r' P r of lanes l ... and shows P r to both faces.
template <class P, class S>
ALCAP_INLINE void show(int l, const P (&r)[3], const P (&u)[6], S* exchange, S* sums) {
  (P::load(sums + l) + (r[0] * r[0] + r[1] * r[1] + r[2] * r[2])).store(sums + l);
  const P z[3] = {u[0] * r[0] + u[1] * r[1] + u[3] * r[2], u[2] * r[1] + u[4] * r[2], u[5] * r[2]};
  const P other[3] = {z[0], -z[1], -z[2]};
  S *here[P::size], *there[P::size];
  for (int i = 0; i < P::size; ++i) {
    here[i] = exchange + 8LL * (l + i);
    there[i] = here[i] + 4;
  }
  kernels::store_rows(z, here);
  kernels::store_rows(other, there);
}

template <class P>
ALCAP_INLINE void whiten(const P (&u)[6], const P (&w)[3], P (&out)[3]) {
  out[0] = u[0] * w[0];
  out[1] = u[1] * w[0] + u[2] * w[1];
  out[2] = u[3] * w[0] + u[4] * w[1] + u[5] * w[2];
}

template <class Tag, int L, class S>
void begin_edges(EdgeBlock<S>* blocks, long long count, S* exchange, S* sums) {
  using P = Pack<S, L, Tag>;
  for (long long b = 0; b < count; ++b, exchange += 8LL * block_size) {
    EdgeBlock<S>& e = blocks[b];
    for (int l = 0; l < block_size; l += L) {
      P u[6], w[3], r[3];
      for (int k = 0; k < 6; ++k) u[k] = P::load(e.u[k] + l);
      for (int k = 0; k < 3; ++k) w[k] = P::load(e.r[k] + l);
      whiten(u, w, r);
      for (int k = 0; k < 3; ++k) {
        r[k].store(e.r[k] + l);
        P(S(0)).store(e.p[k] + l);
        P(S(0)).store(e.s[k] + l);
        P(S(0)).store(e.x[k] + l);
      }
      show(l, r, u, exchange, sums);
    }
  }
}

template <class Tag, int L, class S>
void step_edges(EdgeBlock<S>* blocks, long long count, S* exchange, S alpha, S beta, S* sums) {
  using P = Pack<S, L, Tag>;
  for (long long b = 0; b < count; ++b, exchange += 8LL * block_size) {
    EdgeBlock<S>& e = blocks[b];
    if (b + 1 < count) {
      prefetch<Tag>(blocks + b + 1, sizeof(EdgeBlock<S>));
      prefetch<Tag>(exchange + 8LL * block_size, sizeof(S) * 8 * block_size);
    }
    for (std::uint64_t open = e.open; open != 0; open &= open - 1) {
      S* const there = exchange + 8LL * __builtin_ctzll(open) + 4;
      for (int i = 0; i < 3; ++i) there[i] = 0;
    }
    for (int l = 0; l < block_size; l += L) {
      const S *from_here[L], *from_there[L];
      for (int i = 0; i < L; ++i) {
        from_here[i] = exchange + 8LL * (l + i);
        from_there[i] = from_here[i] + 4;
      }
      P here[4], there[4], u[6], ours[3], r[3];
      kernels::load_rows(from_here, here);
      kernels::load_rows(from_there, there);
      for (int k = 0; k < 6; ++k) u[k] = P::load(e.u[k] + l);
      const P w[3] = {here[0] + there[0], here[1] - there[1], here[2] - there[2]};
      whiten(u, w, ours);
      for (int k = 0; k < 3; ++k) {
        r[k] = P::load(e.r[k] + l);
        const P p = r[k] + P(beta) * P::load(e.p[k] + l);
        const P s = ours[k] + P(beta) * P::load(e.s[k] + l);
        r[k] = r[k] - P(alpha) * s;
        p.store(e.p[k] + l);
        s.store(e.s[k] + l);
        (P::load(e.x[k] + l) + P(alpha) * p).store(e.x[k] + l);
        r[k].store(e.r[k] + l);
      }
      show(l, r, u, exchange, sums);
    }
  }
}

template <class P, int N, class Array>
ALCAP_INLINE void load_each(const Array (&from)[N], int l, P (&to)[N]) {
  for (int k = 0; k < N; ++k) to[k] = P::load(from[k] + l);
}

template <class P, int N, class Array>
ALCAP_INLINE void store_each(const P (&from)[N], int l, Array (&to)[N]) {
  for (int k = 0; k < N; ++k) from[k].store(to[k] + l);
}

template <class P>
void group_coefficients(const FaceShapes& shapes, double cap, FaceGroup& out) {
  for (int l = 0; l < group_size; l += P::size) {
    P cot[3], factor[3], p[3];
    load_each(shapes.cot, l, cot);
    load_each(shapes.factor, l, factor);
    for (int k = 0; k < 3; ++k) p[k] = kernels::capped_tangent(cot[(k + 2) % 3], P(cap)) * factor[k];
    kernels::FaceCoefficients<P> c;
    kernels::face_coefficients(cot, p, c);
    store_each(c.p, l, out.p);
    store_each(c.inverse, l, out.inverse);
    c.stiffness.store(out.stiffness + l);
  }
}

template <class P>
void group_own_blocks(const FaceGroup& faces, GroupArray (&out)[3][6]) {
  for (int l = 0; l < group_size; l += P::size) {
    kernels::FaceCoefficients<P> c;
    load_coefficients(faces, l, c);
    for (int k = 0; k < 3; ++k) {
      P pull[3][3], own[6];
      kernels::unit_pulls(c, k, pull);
      kernels::own_block(c, k, pull, own);
      store_each(own, l, out[k]);
    }
  }
}

template <class P>
void group_between(const FaceGroup (&faces)[2], GroupArray (&out)[6]) {
  for (int l = 0; l < group_size; l += P::size) {
    kernels::FaceCoefficients<P> c[2];
    P inverse[6];
    for (int side = 0; side < 2; ++side) load_coefficients(faces[side], l, c[side]);
    kernels::invert_between(c[0], c[1], inverse);
    store_each(inverse, l, out);
  }
}

template <class P>
void group_outer_blocks(const FaceGroup (&faces)[2], const GroupArray (&between)[6], GroupArray (&out)[2][2][6]) {
  for (int l = 0; l < group_size; l += P::size) {
    P inverse[6], outer[2][6];
    load_each(between, l, inverse);
    for (int side = 0; side < 2; ++side) {
      kernels::FaceCoefficients<P> c;
      load_coefficients(faces[side], l, c);
      kernels::outer_blocks(c, inverse, side == 1, outer);
      for (int k = 0; k < 2; ++k) store_each(outer[k], l, out[side][k]);
    }
  }
}

template <class P>
void group_relax(const FaceGroup& faces, GroupArray (&seen)[3][3], GroupArray (&moved)[3]) {
  for (int l = 0; l < group_size; l += P::size) {
    kernels::FaceCoefficients<P> c;
    P v[3][3], x[3];
    load_coefficients(faces, l, c);
    for (int i = 0; i < 3; ++i) load_each(seen[i], l, v[i]);
    kernels::relax(c, v, x);
    for (int i = 0; i < 3; ++i) store_each(v[i], l, seen[i]);
    store_each(x, l, moved);
  }
}

template <class P>
void group_relax_pair(const FaceGroup (&faces)[2], const GroupArray (&between)[6], GroupArray (&seen)[2][3][3],
                      GroupArray (&moved)[2][3], GroupArray (&turned)[3]) {
  for (int l = 0; l < group_size; l += P::size) {
    kernels::FaceCoefficients<P> c[2];
    P inverse[6], v[2][3][3], x[2][3], turn[3];
    load_each(between, l, inverse);
    for (int side = 0; side < 2; ++side) {
      load_coefficients(faces[side], l, c[side]);
      for (int i = 0; i < 3; ++i) load_each(seen[side][i], l, v[side][i]);
    }
    kernels::relax_pair(c[0], c[1], inverse, v[0], v[1], x[0], x[1], turn);
    for (int side = 0; side < 2; ++side) {
      for (int i = 0; i < 3; ++i) store_each(v[side][i], l, seen[side][i]);
      store_each(x[side], l, moved[side]);
    }
    store_each(turn, l, turned);
  }
}

template <class Tag, int L>
GroupLoops group_loops_of() {
  using P = Pack<double, L, Tag>;
  return {group_coefficients<P>, group_own_blocks<P>, group_between<P>,
          group_outer_blocks<P>, group_relax<P>,      group_relax_pair<P>};
}

template <class Tag, int L, class S>
CorrectionLoops<S> correction_loops_of() {
  return {relax_faces<Tag, L, S>, relax_pairs<Tag, L, S>, begin_edges<Tag, L, S>, step_edges<Tag, L, S>};
}

}  // namespace alcap::detail::simd
