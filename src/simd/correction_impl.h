// SPDX-License-Identifier: MIT
//
// correction_impl.h: the loops of correction_loops.h over packs. Part of loops_impl.h.
#pragma once

#include "kernels/connection_energy.h"
#include "kernels/face_relaxation.h"
#include "kernels/pack_rows.h"
#include "src/simd/correction_loops.h"

namespace alcap::detail::simd::ALCAP_SIMD {

/// Asks for the memory of a block ahead of its use: the order in which blocks are read hides from the hardware that
/// they follow each other.
ALCAP_INLINE void prefetch(const void* from, unsigned long long bytes) {
  for (unsigned long long i = 0; i < bytes; i += 64) __builtin_prefetch(static_cast<const char*>(from) + i);
}

template <class P, class S, int size>
ALCAP_INLINE void load_coefficients(const FaceArrays<S, size>& f, int l, kernels::FaceCoefficients<P>& c) {
  for (int k = 0; k < 3; ++k) c.weight[k] = P::load(f.weight[k] + l);
  for (int k = 0; k < 6; ++k) c.inverse[k] = P::load(f.inverse[k] + l);
  c.stiffness = P::load(f.stiffness + l);
}

/// What P::size faces see of their halfedges k, into v; `row` becomes where they see it.
template <class P, class S>
ALCAP_INLINE void gather(S* exchange, const ExchangeRow* rows, int k, S* (&row)[P::size], kernels::FaceState<P>& v) {
  const S* from[P::size];
  for (int i = 0; i < P::size; ++i) from[i] = row[i] = exchange + 4 * static_cast<unsigned long long>(rows[i]);
  P seen[4];
  kernels::load_rows(from, seen);
  v.mean[k] = seen[0];
  v.difference[k] = seen[1];
  v.tau[k] = seen[2];
}

/// Writes the forces on halfedges k in the place of what the faces saw there, and returns the product of both.
template <class P, class S>
ALCAP_INLINE P scatter(S* const (&row)[P::size], int k, const kernels::FaceState<P>& seen,
                       const kernels::FaceState<P>& force) {
  const P column[3] = {force.mean[k], force.difference[k], force.tau[k]};
  kernels::store_rows(column, row);
  return seen.mean[k] * column[0] + seen.difference[k] * column[1] + seen.tau[k] * column[2];
}

template <class S>
void relax_faces(const FaceBlock<S>* blocks, long long count, S* exchange, S* sums) {
  using P = Pack<S>;
  constexpr int L = P::size;
  for (long long b = 0; b < count; ++b) {
    if (b + 1 < count) prefetch(blocks + b + 1, sizeof(FaceBlock<S>));
    for (int l = 0; l < block_size; l += L) {
      kernels::FaceCoefficients<P> c;
      load_coefficients(blocks[b].face, l, c);
      kernels::FaceState<P> v;
      P moved[3], sum = P::load(sums + l);
      S* row[3][L];
      for (int k = 0; k < 3; ++k) gather<P>(exchange, blocks[b].row[k] + l, k, row[k], v);
      const kernels::FaceState<P> seen = v;
      kernels::relax(c, v, moved);
      for (int k = 0; k < 3; ++k) sum = sum + scatter<P>(row[k], k, seen, v);
      sum.store(sums + l);
    }
  }
}

/// Asks for the rows of the exchange that pairs a little ahead will read: where a mesh does not fit into the cache,
/// they are what a step waits for.
template <class S>
ALCAP_INLINE void prefetch_rows(const PairBlock<S>* blocks, long long from, long long end, int count,
                                const S* exchange) {
  constexpr int ahead = 16;  // pairs, some hundred cycles of work
  const long long later = from + ahead;
  if (later >= end) return;
  for (int k = 0; k < 4; ++k) {
    const ExchangeRow* const rows = blocks[later / block_size].row[k / 2][k % 2] + later % block_size;
    for (int i = 0; i < count; ++i) __builtin_prefetch(exchange + 4ULL * rows[i]);
  }
}

template <class S>
void relax_pairs(const PairBlock<S>* blocks, long long count, S* exchange, S* sums) {
  using P = Pack<S>;
  constexpr int L = P::size;
  for (long long b = 0; b < count; ++b) {
    if (b + 1 < count) prefetch(blocks + b + 1, sizeof(PairBlock<S>));
    for (int l = 0; l < block_size; l += L) {
      prefetch_rows(blocks, b * block_size + l, count * block_size, L, exchange);
      kernels::FaceCoefficients<P> c[2];
      kernels::FaceState<P> v[2], seen[2];
      P inverse[6], moved[2][3], between[3], sum = P::load(sums + l);
      S* row[2][2][L];
      for (int k = 0; k < 6; ++k) inverse[k] = P::load(blocks[b].inverse[k] + l);
      for (int f = 0; f < 2; ++f) {
        load_coefficients(blocks[b].face[f], l, c[f]);
        for (int k = 0; k < 2; ++k) gather<P>(exchange, blocks[b].row[f][k] + l, k + 1, row[f][k], v[f]);
        v[f].mean[0] = v[f].difference[0] = v[f].tau[0] = P(S(0));
        seen[f] = v[f];
      }
      kernels::relax_pair(c[0], c[1], inverse, v[0], v[1], moved[0], moved[1], between);
      for (int f = 0; f < 2; ++f)
        for (int k = 0; k < 2; ++k) sum = sum + scatter<P>(row[f][k], k + 1, seen[f], v[f]);
      sum.store(sums + l);
    }
  }
}

/// Adds r' P r of lanes l ... and writes P r where both faces of the edges see it, in their signs.
template <class P, class S>
ALCAP_INLINE void scatter_preconditioned(int l, const P (&r)[3], const P (&u)[6], S* exchange, S* sums) {
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

/// The forces of both faces on the edges of lanes l ..., joined in the signs of the first.
template <class P, class S>
ALCAP_INLINE void gather_forces(int l, const S* exchange, P (&force)[3]) {
  const S *from_here[P::size], *from_there[P::size];
  for (int i = 0; i < P::size; ++i) {
    from_here[i] = exchange + 8LL * (l + i);
    from_there[i] = from_here[i] + 4;
  }
  P here[4], there[4];
  kernels::load_rows(from_here, here);
  kernels::load_rows(from_there, there);
  force[0] = here[0] + there[0];
  force[1] = here[1] - there[1];
  force[2] = here[2] - there[2];
}

/// out = U w.
template <class P>
ALCAP_INLINE void whiten(const P (&u)[6], const P (&w)[3], P (&out)[3]) {
  out[0] = u[0] * w[0];
  out[1] = u[1] * w[0] + u[2] * w[1];
  out[2] = u[3] * w[0] + u[4] * w[1] + u[5] * w[2];
}

template <class S>
void begin_edges(EdgeBlock<S>* blocks, long long count, S* exchange, S* sums) {
  using P = Pack<S>;
  for (long long b = 0; b < count; ++b, exchange += 8LL * block_size) {
    IterationArrays<S>& cg = blocks[b].iteration;
    for (int l = 0; l < block_size; l += P::size) {
      P u[6], w[3], r[3];
      for (int k = 0; k < 6; ++k) u[k] = P::load(blocks[b].whitening[k] + l);
      for (int k = 0; k < 3; ++k) w[k] = P::load(cg.residual[k] + l);
      whiten(u, w, r);
      for (int k = 0; k < 3; ++k) {
        r[k].store(cg.residual[k] + l);
        P(S(0)).store(cg.direction[k] + l);
        P(S(0)).store(cg.image[k] + l);
        P(S(0)).store(cg.solution[k] + l);
      }
      scatter_preconditioned(l, r, u, exchange, sums);
    }
  }
}

/// Chronopoulos and Gear (1989): w = A P r is known, so that with p = P r + beta p its image s = A p is w + beta s.
template <class S>
void step_edges(EdgeBlock<S>* blocks, long long count, S* exchange, S alpha, S beta, S* sums) {
  using P = Pack<S>;
  for (long long b = 0; b < count; ++b, exchange += 8LL * block_size) {
    IterationArrays<S>& cg = blocks[b].iteration;
    if (b + 1 < count) {
      prefetch(blocks + b + 1, sizeof(EdgeBlock<S>));
      prefetch(exchange + 8LL * block_size, sizeof(S) * 8 * block_size);
    }
    for (std::uint64_t open = blocks[b].open; open != 0; open &= open - 1) {
      S* const there = exchange + 8LL * __builtin_ctzll(open) + 4;
      for (int i = 0; i < 3; ++i) there[i] = 0;
    }
    for (int l = 0; l < block_size; l += P::size) {
      P u[6], force[3], w[3], r[3];
      gather_forces(l, exchange, force);
      for (int k = 0; k < 6; ++k) u[k] = P::load(blocks[b].whitening[k] + l);
      whiten(u, force, w);
      for (int k = 0; k < 3; ++k) {
        r[k] = P::load(cg.residual[k] + l);
        const P p = r[k] + P(beta) * P::load(cg.direction[k] + l);
        const P s = w[k] + P(beta) * P::load(cg.image[k] + l);
        r[k] = r[k] - P(alpha) * s;
        p.store(cg.direction[k] + l);
        s.store(cg.image[k] + l);
        (P::load(cg.solution[k] + l) + P(alpha) * p).store(cg.solution[k] + l);
        r[k].store(cg.residual[k] + l);
      }
      scatter_preconditioned(l, r, u, exchange, sums);
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

inline void group_coefficients(const FaceShapes& shapes, double cap, FaceGroup& out) {
  using P = Pack<double>;
  for (int l = 0; l < group_size; l += P::size) {
    P cot[3], factor[3], weight[3];
    load_each(shapes.cot, l, cot);
    load_each(shapes.factor, l, factor);
    for (int k = 0; k < 3; ++k) weight[k] = kernels::capped_tangent(cot[(k + 2) % 3], P(cap)) * factor[k];
    kernels::FaceCoefficients<P> c;
    kernels::face_coefficients(cot, weight, c);
    store_each(c.weight, l, out.weight);
    store_each(c.inverse, l, out.inverse);
    c.stiffness.store(out.stiffness + l);
  }
}

inline void group_own_blocks(const FaceGroup& faces, GroupArray (&out)[3][6]) {
  using P = Pack<double>;
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

inline void group_between(const FaceGroup (&faces)[2], GroupArray (&out)[6]) {
  using P = Pack<double>;
  for (int l = 0; l < group_size; l += P::size) {
    kernels::FaceCoefficients<P> c[2];
    P inverse[6];
    for (int side = 0; side < 2; ++side) load_coefficients(faces[side], l, c[side]);
    kernels::invert_between(c[0], c[1], inverse);
    store_each(inverse, l, out);
  }
}

inline void group_outer_blocks(const FaceGroup (&faces)[2], const GroupArray (&between)[6],
                               GroupArray (&out)[2][2][6]) {
  using P = Pack<double>;
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

ALCAP_INLINE void load_state(const GroupState& from, int l, kernels::FaceState<Pack<double>>& v) {
  load_each(from.mean, l, v.mean);
  load_each(from.difference, l, v.difference);
  load_each(from.tau, l, v.tau);
}

ALCAP_INLINE void store_state(const kernels::FaceState<Pack<double>>& v, int l, GroupState& to) {
  store_each(v.mean, l, to.mean);
  store_each(v.difference, l, to.difference);
  store_each(v.tau, l, to.tau);
}

inline void group_relax(const FaceGroup& faces, GroupState& state, GroupArray (&moved)[3]) {
  using P = Pack<double>;
  for (int l = 0; l < group_size; l += P::size) {
    kernels::FaceCoefficients<P> c;
    kernels::FaceState<P> v;
    P x[3];
    load_coefficients(faces, l, c);
    load_state(state, l, v);
    kernels::relax(c, v, x);
    store_state(v, l, state);
    store_each(x, l, moved);
  }
}

inline void group_relax_pair(const FaceGroup (&faces)[2], const GroupArray (&between)[6], GroupState (&state)[2],
                             GroupArray (&moved)[2][3], GroupArray (&turned)[3]) {
  using P = Pack<double>;
  for (int l = 0; l < group_size; l += P::size) {
    kernels::FaceCoefficients<P> c[2];
    kernels::FaceState<P> v[2];
    P inverse[6], x[2][3], turn[3];
    load_each(between, l, inverse);
    for (int side = 0; side < 2; ++side) {
      load_coefficients(faces[side], l, c[side]);
      load_state(state[side], l, v[side]);
    }
    kernels::relax_pair(c[0], c[1], inverse, v[0], v[1], x[0], x[1], turn);
    for (int side = 0; side < 2; ++side) {
      store_state(v[side], l, state[side]);
      store_each(x[side], l, moved[side]);
    }
    store_each(turn, l, turned);
  }
}

inline constexpr GroupLoops group_loops = {group_coefficients, group_own_blocks, group_between,
                                           group_outer_blocks, group_relax,      group_relax_pair};

template <class S>
inline constexpr CorrectionLoops<S> correction_loops = {relax_faces<S>, relax_pairs<S>, begin_edges<S>, step_edges<S>};

}  // namespace alcap::detail::simd::ALCAP_SIMD
