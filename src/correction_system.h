// SPDX-License-Identifier: MIT
//
// correction_system.h: the linear system of the globally optimal connection (LTGD 2016, Sec. 5.3) after every face has
// optimised its own corners, applied without a matrix, and conjugate gradients on it.
//
// Unknowns are corrections: X per corner to rho_{v->t}, y at both ends of every edge to rho_{v->e}, R per edge to
// rho_ij. Faces meet only in edges, so X is eliminated face by face, and three numbers per edge remain: the mean m of
// its two y, their difference d along the canonical halfedge, and R. With the lifted state of a face (tau, and mean
// and difference of the residuals of its halfedges) the energy of a face is, for p = detail * halfedge weight,
//
//   tau' W tau + sum over its halfedges of p (mean^2 + difference^2 / 12),
//
// from D_T and Q(r, s) = (r^2 + r s + s^2)/3. What remains is symmetric positive semidefinite (kernel: one gauge angle
// per vertex) and local: its condition does not grow with the mesh. Right-hand sides and search directions are
// orthogonal to the kernel, so conjugate gradients need no care for it.
//
// W of a sliver is stiff, but only in ways a face can hide from its neighbours: its rows all sum to s = (sum of
// cotangents)/12, so the Whitney form of curvature -k with least energy is k/3 on each halfedge, with energy s k^2 / 3,
// and the rest is gradients, which X takes up. relax() uses this: it never multiplies by W and is as accurate on
// slivers as on other faces.
//
// Conjugate gradients work in variables in which the 3 x 3 block of every single edge is the identity, so that their
// preconditioner costs one product with a triangle on the way out to the faces and one on the way back. A step is one
// pass over faces and one over edges. The two exchange through one array with a slot per edge and side: it holds what
// the face sees, then, in the same place, what it answers.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "alcap/mesh.h"
#include "alcap/parallel.h"
#include "kernels/pack.h"
#include "src/large_array.h"

namespace alcap::detail {

/// Inverse of the symmetric positive semidefinite [a0 a1 a2; a1 a3 a4; a2 a4 a5] by L D L'. Directions without energy
/// (relative to the diagonal) are left out. S is a scalar or a pack.
template <class S>
ALCAP_INLINE void invert_symmetric(const S (&a)[6], S (&out)[6]) {
  using V = kernels::Value<S>;
  constexpr V negligible = 8 * std::numeric_limits<V>::epsilon();
  const auto reciprocal = [](const S& pivot, const S& diagonal) {
    return kernels::select(pivot > S(negligible) * diagonal, S(V(1)) / pivot, S(V(0)));
  };
  const S r0 = reciprocal(a[0], a[0]);
  const S l1 = a[1] * r0, l2 = a[2] * r0;
  const S r1 = reciprocal(a[3] - l1 * a[1], a[3]);
  const S b = a[4] - l1 * a[2];
  const S l3 = b * r1;
  const S r2 = reciprocal(a[5] - l2 * a[2] - l3 * b, a[5]);
  // The columns of inv(L) are (1, -l1, l1 l3 - l2), (0, 1, -l3), (0, 0, 1).
  const S m = l1 * l3 - l2;
  out[0] = r0 + l1 * l1 * r1 + m * m * r2;
  out[1] = -l1 * r1 - l3 * m * r2;
  out[2] = m * r2;
  out[3] = r1 + l3 * l3 * r2;
  out[4] = -l3 * r2;
  out[5] = r2;
}

/// What relaxing a face needs to know of it: p of its halfedges, the energy of a unit of curvature, and the inverse of
/// the Hessian in its corners. S is a scalar or a pack.
template <class S>
struct FaceCoefficients {
  S p[3], stiffness, inverse[6];
};

template <class S>
ALCAP_INLINE FaceCoefficients<S> face_coefficients(const S (&cot)[3], const S (&p)[3]) {
  FaceCoefficients<S> c;
  using V = kernels::Value<S>;
  S h[3][3];
  const S sixth(V(1) / 6), third(V(1) / 3), half(V(1) / 2);
  c.stiffness = (cot[0] + cot[1] + cot[2]) * S(V(1) / 36);
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3, before = (k + 2) % 3;
    c.p[k] = p[k];
    // D' W D has (cot + cot)/2 of the two corners beyond on the diagonal and -cot/2 of the third off it.
    h[k][k] = half * (cot[next] + cot[before]) + (p[k] + p[before]) * third;
    h[k][next] = h[next][k] = sixth * p[k] - half * cot[before];
  }
  const S a[6] = {h[0][0], h[0][1], h[0][2], h[1][1], h[1][2], h[2][2]};
  invert_symmetric(a, c.inverse);
  return c;
}

/// A face that sees mean[k], difference[k] and tau[k] on its halfedges (with X = 0) moves its corners to the optimum.
/// On return they hold the forces, half of the energy's derivatives with respect to them. Returns X.
template <class S>
ALCAP_INLINE std::array<S, 3> relax(const FaceCoefficients<S>& c, S (&mean)[3], S (&difference)[3], S (&tau)[3]) {
  using V = kernels::Value<S>;
  const S third(V(1) / 3), half(V(1) / 2), twelfth(V(1) / 12);
  const S curvature = tau[0] + tau[1] + tau[2];
  S step[3], x[3], pm[3], pd[3], g[3];
  for (int k = 0; k < 3; ++k) step[k] = curvature * third - tau[k];
  for (int k = 0; k < 3; ++k) x[k] = (step[(k + 2) % 3] - step[k]) * third;
  for (int k = 0; k < 3; ++k) {
    mean[k] = mean[k] + (x[k] + x[(k + 1) % 3]) * half;
    difference[k] = difference[k] + step[k];
    pm[k] = c.p[k] * mean[k] * half;
    pd[k] = c.p[k] * difference[k] * twelfth;
  }
  for (int k = 0; k < 3; ++k) g[k] = pm[k] - pd[k] + pm[(k + 2) % 3] + pd[(k + 2) % 3];
  const S y[3] = {-(c.inverse[0] * g[0] + c.inverse[1] * g[1] + c.inverse[2] * g[2]),
                  -(c.inverse[1] * g[0] + c.inverse[3] * g[1] + c.inverse[4] * g[2]),
                  -(c.inverse[2] * g[0] + c.inverse[4] * g[1] + c.inverse[5] * g[2])};
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    mean[k] = c.p[k] * (mean[k] + (y[k] + y[next]) * half);
    difference[k] = c.p[k] * (difference[k] + y[next] - y[k]) * twelfth;
  }
  // W tau is its mean plus differences that balance the pull of the edges on the corners.
  S pull[3];
  for (int k = 0; k < 3; ++k) pull[k] = (mean[k] + mean[(k + 2) % 3]) * half - difference[k] + difference[(k + 2) % 3];
  for (int k = 0; k < 3; ++k) tau[k] = c.stiffness * curvature + (pull[k] - pull[(k + 1) % 3]) * third;
  return {x[0] + y[0], x[1] + y[1], x[2] + y[2]};
}

/// U, lower triangular by rows, with U' U the inverse that invert_symmetric gives.
template <class S>
inline void whiten_symmetric(const S (&a)[6], S (&u)[6]) {
  constexpr S negligible = 8 * std::numeric_limits<S>::epsilon();
  const auto root = [](S pivot, S diagonal) { return pivot > negligible * diagonal ? S(1) / std::sqrt(pivot) : S(0); };
  const S s0 = root(a[0], a[0]);
  const S l1 = a[1] * s0 * s0, l2 = a[2] * s0 * s0;
  const S s1 = root(a[3] - l1 * a[1], a[3]);
  const S b = a[4] - l1 * a[2];
  const S l3 = b * s1 * s1;
  const S s2 = root(a[5] - l2 * a[2] - l3 * b, a[5]);
  u[0] = s0;
  u[1] = -l1 * s1;
  u[2] = s1;
  u[3] = (l1 * l3 - l2) * s2;
  u[4] = -l3 * s2;
  u[5] = s2;
}

/// Lanes of double for what needs its precision.
using DoubleLanes = kernels::Pack<double, 2, kernels::isa::Sse2>;

/// A value (m, d, R) per edge.
template <class S>
using EdgeValues = Eigen::Matrix<S, 3, Eigen::Dynamic>;

template <class S>
class CorrectionSystem {
 public:
  /// cot(h) and p(h) of each halfedge, p zero on the boundary.
  template <class Cot, class Weight>
  CorrectionSystem(const Mesh& mesh, const Cot& cot, const Weight& p, bool hold_rho)
      : face_count_(mesh.faces()),
        edge_count_(mesh.edges()),
        face_blocks_(blocks(face_count_)),
        edge_blocks_(blocks(edge_count_)),
        faces_(at(face_blocks_)),
        edges_(at(edge_blocks_)),
        exchange_(at(2 * edge_blocks_)),
        partial_(static_cast<std::size_t>((std::max(face_blocks_, edge_blocks_) + chunk - 1) / chunk)) {
    each(face_blocks_, [&](std::int64_t b) {
      FaceBlock& f = faces_[at(b)];
      double cots[3][B], weights[3][B];
      for (int l = 0; l < B; ++l) {
        // The last block is filled up with copies of the last face, whose answers go nowhere.
        const Index h = static_cast<Index>(3 * std::min<std::int64_t>(b * B + l, face_count_ - 1));
        for (Index k = 0; k < 3; ++k) {
          cots[k][l] = double(cot(h + k));
          weights[k][l] = double(p(h + k));
          f.slot[k][l] = slot(mesh.edge(h + k), mesh.canonical(h + k) ? 0 : 1);
        }
      }
      for (int l = 0; l < B; l += DoubleLanes::size) {
        DoubleLanes c_in[3], p_in[3];
        for (int k = 0; k < 3; ++k) {
          c_in[k] = DoubleLanes::load(cots[k] + l);
          p_in[k] = DoubleLanes::load(weights[k] + l);
        }
        const FaceCoefficients<DoubleLanes> c = face_coefficients(c_in, p_in);
        for (int lane = 0; lane < DoubleLanes::size; ++lane) {
          for (int k = 0; k < 3; ++k) f.p[k][l + lane] = static_cast<S>(c.p[k][lane]);
          for (int k = 0; k < 6; ++k) f.inverse[k][l + lane] = static_cast<S>(c.inverse[k][lane]);
          f.stiffness[l + lane] = static_cast<S>(c.stiffness[lane]);
        }
      }
    });
    each(edge_blocks_, [&](std::int64_t b) {
      EdgeBlock& e = edges_[at(b)];
      e.open = 0;
      for (int l = 0; l < B; ++l) {
        const std::int64_t i = b * B + l;
        if (i >= edge_count_ || mesh.boundary_halfedge(mesh.halfedge(static_cast<Index>(i))))
          e.open |= std::uint64_t{1} << l;
      }
      for (int side = 0; side < 2; ++side)
        for (auto& row : exchange_[at(2 * b + side)].v)
          for (S& value : row) value = 0;
    });
    // The blocks of single edges go from faces to edges through the exchange, three of their six entries at a time.
    for (int part = 0; part < 2; ++part) {
      each(face_blocks_, [&](std::int64_t b) { own_blocks(b, part); });
      each(edge_blocks_, [&](std::int64_t b) {
        // [m d] and [m R] change sign when an edge is seen from its other face, [d d], [d R] and [R R] do not.
        S sum[3][B];
        gather(b, sum, part == 0 ? S(-1) : S(1));
        for (int k = 0; k < 3; ++k)
          for (int l = 0; l < B; ++l) edges_[at(b)].u[3 * part + k][l] = sum[k][l];
      });
    }
    each(edge_blocks_, [&](std::int64_t b) {
      EdgeBlock& e = edges_[at(b)];
      for (int l = 0; l < B; ++l) {
        S a[6], u[6];
        for (int k = 0; k < 6; ++k) a[k] = hold_rho && (k == 2 || k >= 4) ? S(0) : e.u[k][l];
        whiten_symmetric(a, u);
        for (int k = 0; k < 6; ++k) e.u[k][l] = u[k];
      }
    });
  }

  /// Sets the right-hand side, rhs(e) = {m, d, R} of edge e, and x = 0; returns r' P r with the preconditioner P, the
  /// inverse of the edges' blocks.
  template <class Rhs>
  double start(const Rhs& rhs) {
    return reduce(edge_blocks_, [&](std::int64_t b, S(&sums)[B]) {
      EdgeBlock& e = edges_[at(b)];
      const int count = size_of(b, edge_count_);
      S w[3][B] = {};
      for (int l = 0; l < count; ++l) {
        const auto value = rhs(static_cast<Index>(b * B + l));
        for (int k = 0; k < 3; ++k) w[k][l] = static_cast<S>(value[static_cast<std::size_t>(k)]);
      }
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l < B; ++l) e.p[k][l] = e.s[k][l] = e.x[k][l] = 0;
      for (int l = 0; l < B; ++l) {
        e.r[0][l] = e.u[0][l] * w[0][l];
        e.r[1][l] = e.u[1][l] * w[0][l] + e.u[2][l] * w[1][l];
        e.r[2][l] = e.u[3][l] * w[0][l] + e.u[4][l] * w[1][l] + e.u[5][l] * w[2][l];
      }
      finish(b, sums);
    });
  }

  /// Relaxes all faces in the state z = P r; returns z' A z.
  double apply() {
    return reduce(face_blocks_, [&](std::int64_t b, S(&sums)[B]) {
      const FaceBlock& f = faces_[at(b)];
      prefetch(faces_, b + 1, face_blocks_);
      S values[9][B];
      const int count = size_of(b, face_count_);
      for (int k = 0; k < 3; ++k) {
        for (int l = 0; l < count; ++l) {
          const S* const from = seen(f.slot[k][l]);
          values[k][l] = from[0];
          values[3 + k][l] = from[B];
          values[6 + k][l] = from[std::ptrdiff_t{2} * B];
        }
        for (int l = count; l < B; ++l) values[k][l] = values[3 + k][l] = values[6 + k][l] = 0;
      }
      for (int l = 0; l < B; l += Lanes::size) {
        const FaceCoefficients<Lanes> c = coefficients(f, l);
        Lanes v[3][3], before[3][3], sum = Lanes::load(sums + l);
        for (int i = 0; i < 3; ++i)
          for (int k = 0; k < 3; ++k) v[i][k] = before[i][k] = Lanes::load(values[3 * i + k] + l);
        relax(c, v[0], v[1], v[2]);
        for (int i = 0; i < 3; ++i)
          for (int k = 0; k < 3; ++k) {
            sum = sum + before[i][k] * v[i][k];
            v[i][k].store(values[3 * i + k] + l);
          }
        sum.store(sums + l);
      }
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l < count; ++l) {
          S* const to = seen(f.slot[k][l]);
          to[0] = values[k][l];
          to[B] = values[3 + k][l];
          to[std::ptrdiff_t{2} * B] = values[6 + k][l];
        }
    });
  }

  /// The rest of a step of conjugate gradients in the form of Chronopoulos and Gear (1989), which needs one pass over
  /// the faces and one over the edges. Returns the new r' P r.
  double step(S alpha, S beta) {
    return reduce(edge_blocks_, [&](std::int64_t b, S(&sums)[B]) {
      EdgeBlock& e = edges_[at(b)];
      prefetch(edges_, b + 1, edge_blocks_);
      prefetch(exchange_, 2 * b + 2, 2 * edge_blocks_);
      prefetch(exchange_, 2 * b + 3, 2 * edge_blocks_);
      S w[3][B];
      // Faces see -m, -d and R and answer alike, the second one with d and R against the edge.
      gather(b, w, S(-1));
      for (int l = 0; l < B; ++l) {
        const S a[3] = {-w[0][l], -w[1][l], w[2][l]};
        const S ours[3] = {e.u[0][l] * a[0], e.u[1][l] * a[0] + e.u[2][l] * a[1],
                           e.u[3][l] * a[0] + e.u[4][l] * a[1] + e.u[5][l] * a[2]};
        for (int k = 0; k < 3; ++k) {
          e.p[k][l] = e.r[k][l] + beta * e.p[k][l];
          e.s[k][l] = ours[k] + beta * e.s[k][l];
          e.x[k][l] += alpha * e.p[k][l];
          e.r[k][l] -= alpha * e.s[k][l];
        }
      }
      finish(b, sums);
    });
  }

  /// After start(): P r of edge e.
  [[nodiscard]] std::array<S, 3> preconditioned(Index e) const { return unwhiten(e, edges_[at(e / B)].r); }

  /// x of edge e.
  [[nodiscard]] std::array<S, 3> solution(Index e) const { return unwhiten(e, edges_[at(e / B)].x); }

 private:
  /// Faces or edges that are worked on together, one array per quantity, so that loops over them become SIMD code.
  static constexpr int B = 64;
  /// Blocks per summand of a reduction.
  static constexpr std::int64_t chunk = reduction_chunk / B;
  using Lanes = kernels::Pack<S, 16 / static_cast<int>(sizeof(S)), kernels::isa::Sse2>;
  struct FaceBlock {
    S p[3][B], stiffness[B], inverse[6][B];
    std::uint32_t slot[3][B];  // where its halfedges see their edges
  };
  struct EdgeBlock {
    S p[3][B], s[3][B], x[3][B], r[3][B], u[6][B];
    std::uint64_t open;  // bit l: edge l has no second face
  };
  struct Side {
    S v[3][B];
  };

  static std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }
  static std::int64_t blocks(Index n) { return (std::int64_t{n} + B - 1) / B; }
  static int size_of(std::int64_t b, Index n) { return static_cast<int>(std::min<std::int64_t>(B, n - b * B)); }

  // A Side's number and, in the low bits, the lane.
  static std::uint32_t slot(Index e, std::uint32_t side) {
    const auto edge = static_cast<std::uint32_t>(e);
    return (2 * (edge / B) + side) * B + edge % B;
  }
  // Row 0 of what it names; rows are B apart. This is &exchange_[slot / B].v[0][slot % B] in fewer instructions.
  S* seen(std::uint32_t slot) const {
    return &exchange_[0].v[0][0] + (std::size_t{slot} + 2 * std::size_t{slot & ~std::uint32_t{B - 1}});
  }

  // Asks for the memory of a block ahead of its use: the order in which blocks are read hides from the hardware that
  // they follow each other.
  template <class Block>
  static void prefetch(const LargeArray<Block>& all, std::int64_t b, std::int64_t count) {
    if (b >= count) return;
    const char* const from = reinterpret_cast<const char*>(&all[at(b)]);
    for (std::size_t i = 0; i < sizeof(Block); i += 64) __builtin_prefetch(from + i);
  }

  template <class Body>
  static void each(std::int64_t count, Body&& body) {
    parallel_for(count, body, 16);
  }

  /// Sum over fixed chunks of blocks, lane by lane within a chunk: bitwise independent of threads.
  template <class Body>
  double reduce(std::int64_t count, Body&& body) {
    const std::int64_t chunks = (count + chunk - 1) / chunk;
    parallel_for(
        chunks,
        [&](std::int64_t c) {
          S sums[B] = {};
          for (std::int64_t b = c * chunk; b < std::min(count, (c + 1) * chunk); ++b) body(b, sums);
          double total = 0;
          for (const S s : sums) total += double(s);
          partial_[at(c)] = total;
        },
        1);
    double total = 0;
    for (std::int64_t c = 0; c < chunks; ++c) total += partial_[at(c)];
    return total;
  }

  static FaceCoefficients<Lanes> coefficients(const FaceBlock& f, int l) {
    FaceCoefficients<Lanes> c;
    for (int k = 0; k < 3; ++k) c.p[k] = Lanes::load(f.p[k] + l);
    for (int k = 0; k < 6; ++k) c.inverse[k] = Lanes::load(f.inverse[k] + l);
    c.stiffness = Lanes::load(f.stiffness + l);
    return c;
  }

  // Sum over both faces of what they left for the edges of block b, the last two values of the second one times `sign`.
  void gather(std::int64_t b, S (&w)[3][B], S sign) {
    const Side& here = exchange_[at(2 * b)];
    Side& there = exchange_[at(2 * b + 1)];
    for (std::uint64_t open = edges_[at(b)].open; open != 0; open &= open - 1)
      for (auto& row : there.v) row[__builtin_ctzll(open)] = 0;
    for (int l = 0; l < B; ++l) {
      w[0][l] = here.v[0][l] + there.v[0][l];
      w[1][l] = here.v[1][l] + sign * there.v[1][l];
      w[2][l] = here.v[2][l] + sign * there.v[2][l];
    }
  }

  // Adds r' P r and shows P r to the faces.
  void finish(std::int64_t b, S (&sums)[B]) {
    const EdgeBlock& e = edges_[at(b)];
    Side &here = exchange_[at(2 * b)], &there = exchange_[at(2 * b + 1)];
    for (int l = 0; l < B; ++l) {
      const S r[3] = {e.r[0][l], e.r[1][l], e.r[2][l]};
      sums[l] += r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
      const S m = e.u[0][l] * r[0] + e.u[1][l] * r[1] + e.u[3][l] * r[2];
      const S d = e.u[2][l] * r[1] + e.u[4][l] * r[2];
      const S R = e.u[5][l] * r[2];
      here.v[0][l] = -m;
      here.v[1][l] = -d;
      here.v[2][l] = R;
      there.v[0][l] = -m;
      there.v[1][l] = d;
      there.v[2][l] = -R;
    }
  }

  std::array<S, 3> unwhiten(Index e, const S (&v)[3][B]) const {
    const auto& u = edges_[at(e / B)].u;
    const int l = e % B;
    return {u[0][l] * v[0][l] + u[1][l] * v[1][l] + u[3][l] * v[2][l], u[2][l] * v[1][l] + u[4][l] * v[2][l],
            u[5][l] * v[2][l]};
  }

  // What each halfedge's own unknowns do to themselves through its face: [m m] [m d] [m R] in part 0, [d d] [d R] [R R]
  // in part 1.
  void own_blocks(std::int64_t b, int part) {
    const FaceBlock& f = faces_[at(b)];
    const int count = size_of(b, face_count_);
    for (int l = 0; l < count; l += Lanes::size) {
      const FaceCoefficients<Lanes> c = coefficients(f, l);
      for (int k = 0; k < 3; ++k) {
        // The face sees -m, -d and R, and answers with -(force on m), -(force on d) and the force on R.
        const auto column = [&](int unknown) {
          Lanes v[3][3];
          for (auto& row : v)
            for (Lanes& value : row) value = S(0);
          v[unknown][k] = unknown == 2 ? S(1) : S(-1);
          relax(c, v[0], v[1], v[2]);
          return std::array<Lanes, 3>{-v[0][k], -v[1][k], v[2][k]};
        };
        std::array<Lanes, 3> entry = column(part);
        if (part == 1) entry = {entry[1], entry[2], column(2)[2]};
        for (int lane = 0; lane < Lanes::size && l + lane < count; ++lane)
          for (int i = 0; i < 3; ++i)
            seen(f.slot[k][l + lane])[std::ptrdiff_t{i} * B] = entry[static_cast<std::size_t>(i)][lane];
      }
    }
  }

  Index face_count_, edge_count_;
  std::int64_t face_blocks_, edge_blocks_;
  LargeArray<FaceBlock> faces_;
  LargeArray<EdgeBlock> edges_;
  LargeArray<Side> exchange_;
  std::vector<double> partial_;
};

/// Preconditioned conjugate gradients from x = 0 until r' P r has fallen by `reduction` squared or `max_iterations` are
/// done. They also end where rounding has left r a part in the kernel that is no longer small beside the rest: from
/// there on search directions grow along the kernel, and so would r. Returns the iterations.
template <class S>
int conjugate_gradients(CorrectionSystem<S>& system, double square, double reduction, int max_iterations) {
  constexpr double growth = 100;  // of r' P r above its least value; it oscillates, but far less
  const double target = square * reduction * reduction;
  double beta = 0, alpha = 0, least = square;
  int iteration = 0;
  while (square > target && square <= growth * least && iteration < max_iterations) {
    double curvature = system.apply();
    if (iteration > 0) curvature -= beta * square / alpha;
    if (!(curvature > 0)) break;  // rounding has used up the search directions
    alpha = square / curvature;
    const double next = system.step(static_cast<S>(alpha), static_cast<S>(beta));
    beta = next / square;
    square = next;
    least = std::min(least, square);
    ++iteration;
  }
  return iteration;
}

}  // namespace alcap::detail
