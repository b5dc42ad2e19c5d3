// SPDX-License-Identifier: MIT
//
// system.h: the linear system of the globally optimal connection (LTGD 2016, Sec. 5.3) after every face has optimised
// its own corners, applied without a matrix; conjugate_gradients.h solves it.
//
// Unknowns are corrections: one per corner to rho_{v->t}, one at both ends of every edge to rho_{v->e}, and one per
// edge to rho_ij. Faces meet only in edges, so the corners are eliminated face by face, and an EdgeCorrection remains:
// mean m and difference d of the two at the edge's ends, and the rotation R. Most faces are joined to pairs
// (src/connection/global/pairs.h), and the edge between the two is eliminated as well; the iteration sees outer edges
// only. kernels/face_relaxation.h has the energy and the closed forms. What remains is symmetric positive semidefinite
// (kernel: one gauge angle per vertex) and local: its condition does not grow with the mesh. Right-hand sides and
// search directions are orthogonal to the kernel, so conjugate gradients need no care for it.
//
// The first face of an edge sees the edge's unknowns as (-m, -d, R), which is what they are in here, the second one as
// (-m, d, -R). Conjugate gradients work in variables in which the 3 x 3 block of every single edge is the identity, so
// that their preconditioner costs one product with a triangle on the way out to the faces and one on the way back. A
// step is one pass over faces and one over edges (src/simd/correction_impl.h). The two exchange through one array with
// a row per edge and side: it holds what the face sees, then, in the same place, the forces that it answers with.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "alcap/mesh.h"
#include "kernels/symmetric_inverse.h"
#include "src/base/array.h"
#include "src/base/parallel.h"
#include "src/connection/global/edge_correction.h"
#include "src/connection/global/pairs.h"
#include "src/simd/dispatch.h"

namespace alcap::detail {

/// Whether rho_ij take part or stay, which needs single faces.
enum class Rotations { free, held };

/// For systems whose faces nobody else wants to know.
struct NoVisitor {
  template <class System, class Coefficients>
  void single(const System&, std::int64_t, const Coefficients&) const {}
  template <class System, class Coefficients, class Inverse>
  void pair(const System&, std::int64_t, const Coefficients&, const Inverse&) const {}
};

template <class S>
class CorrectionSystem {
 public:
  using Scalar = S;
  static constexpr int N = simd::group_size;

  /// coefficients(first, c) fills in those of the faces of halfedges first[0 ... N - 1], counted from these on, with
  /// weight zero on the boundary. What was found of N single faces or pairs goes to visitor.single(*this, i, c) or
  /// visitor.pair(*this, i, c, inverse), on several threads.
  template <class Coefficients, class Visitor>
  CorrectionSystem(const Mesh& mesh, const FacePairs& faces, const Coefficients& coefficients, Rotations rotations,
                   const Visitor& visitor, Isa isa = best_isa())
      : mesh_(mesh),
        faces_(faces),
        loops_(simd::correction_loops<S>(isa)),
        groups_(simd::loops(isa).group),
        single_blocks_(blocks(faces.singles)),
        pair_blocks_(blocks(faces.pairs)),
        edge_blocks_(blocks(faces.outer)),
        singles_(single_blocks_),
        pairs_(pair_blocks_),
        edges_(edge_blocks_),
        // Behind the edges' rows, one each that singles and pairs without a face use.
        exchange_(8 * (edge_blocks_ * B + 1)),
        partial_(chunks(single_blocks_, face_chunk) + chunks(pair_blocks_, face_chunk) +
                 chunks(edge_blocks_, edge_chunk)) {
    for (std::int64_t i = 0; i < 8; ++i) exchange_[4 * spare_row() + i] = 0;
    each(edge_blocks_, [&](std::int64_t b) { clear_edges(b); });
    each(single_blocks_, [&](std::int64_t b) { set_up_singles(b, coefficients, visitor); });
    each(pair_blocks_, [&](std::int64_t b) { set_up_pairs(b, coefficients, visitor); });
    each(edge_blocks_, [&](std::int64_t b) { whiten_edges(edges_[b], rotations); });
  }

  /// The row of the exchange where halfedge h sees its edge: twice the number of that among the outer edges, and one
  /// more for the second face.
  [[nodiscard]] std::int64_t row(Index h) const {
    const Index e = mesh_.edge(h);
    return 2 * std::int64_t{faces_.number[e]} + (mesh_.halfedge(e) == h ? 0 : 1);
  }

  /// The same of halfedge k of single face i, and of halfedge k = 1 or 2 of a face of pair i, counted from the one
  /// between the two.
  [[nodiscard]] std::int64_t single_row(std::int64_t i, int k) const { return singles_[i / B].row[k][i % B]; }
  [[nodiscard]] std::int64_t pair_row(std::int64_t i, int side, int k) const {
    return pairs_[i / B].row[side][k - 1][i % B];
  }

  /// Sets the right-hand side, the force rhs(i) on outer edge i, and x = 0; returns r' P r with the preconditioner P,
  /// the inverse of the edges' blocks.
  template <class Rhs>
  double start(const Rhs& rhs) {
    return reduce([&](std::int64_t begin, std::int64_t end, S* sums) {
      for (std::int64_t b = begin; b < end; ++b) {
        auto& residual = edges_[b].iteration.residual;
        const int count = size_of(b, faces_.outer);
        for (int l = 0; l < count; ++l) {
          const EdgeCorrection force = rhs(static_cast<Index>(b * B + l));
          residual[0][l] = -static_cast<S>(force.mean);
          residual[1][l] = -static_cast<S>(force.difference);
          residual[2][l] = static_cast<S>(force.rotation);
        }
        for (auto& values : residual)
          for (int l = count; l < B; ++l) values[l] = 0;
      }
      loops_.begin(&edges_[begin], end - begin, exchange_.data() + 8 * begin * B, sums);
    });
  }

  /// Relaxes all faces in the state z = P r; returns z' A z.
  double apply() {
    const std::int64_t pair_chunks = chunks(pair_blocks_, face_chunk);
    const std::int64_t all = pair_chunks + chunks(single_blocks_, face_chunk);
    parallel_for(
        all,
        [&](std::int64_t c) {
          S sums[B] = {};
          const bool paired = c < pair_chunks;
          const std::int64_t begin = (paired ? c : c - pair_chunks) * face_chunk;
          const std::int64_t end = std::min(begin + face_chunk, paired ? pair_blocks_ : single_blocks_);
          if (paired)
            loops_.pairs(&pairs_[begin], end - begin, exchange_.data(), sums);
          else
            loops_.faces(&singles_[begin], end - begin, exchange_.data(), sums);
          partial_[c] = total(sums);
        },
        1);
    return sum_partial(all);
  }

  /// The rest of a step of conjugate gradients (conjugate_gradients.h), one pass over the edges. Returns the new r' P
  /// r.
  double step(S alpha, S beta) {
    return reduce([&](std::int64_t begin, std::int64_t end, S* sums) {
      loops_.step(&edges_[begin], end - begin, exchange_.data() + 8 * begin * B, alpha, beta, sums);
    });
  }

  /// After start(): P r of outer edge i.
  [[nodiscard]] EdgeCorrection preconditioned(Index i) const { return unwhiten(i, edges_[i / B].iteration.residual); }

  /// x of outer edge i.
  [[nodiscard]] EdgeCorrection solution(Index i) const { return unwhiten(i, edges_[i / B].iteration.solution); }

 private:
  static constexpr int B = simd::block_size;
  /// Blocks per summand of a reduction: so small that 50K triangles still keep two threads equally busy.
  static constexpr std::int64_t face_chunk = reduction_chunk / B / 2, edge_chunk = reduction_chunk / B;
  using FaceBlock = simd::FaceBlock<S>;
  using PairBlock = simd::PairBlock<S>;
  using EdgeBlock = simd::EdgeBlock<S>;

  static std::int64_t blocks(Index n) { return (std::int64_t{n} + B - 1) / B; }
  static std::int64_t chunks(std::int64_t blocks, std::int64_t size) { return (blocks + size - 1) / size; }
  static int size_of(std::int64_t b, Index n) { return static_cast<int>(std::min<std::int64_t>(B, n - b * B)); }

  /// The row of single lanes without a face; the next one is that of pairs.
  [[nodiscard]] std::int64_t spare_row() const { return 2 * edge_blocks_ * B; }

  template <class Body>
  static void each(std::int64_t count, Body&& body) {
    parallel_for(count, body, 16);
  }

  static double total(const S (&sums)[B]) {
    double total = 0;
    for (const S s : sums) total += double(s);
    return total;
  }

  /// Over fixed chunks of blocks, lane by lane within a chunk: bitwise independent of threads.
  template <class Body>
  double reduce(Body&& body) {
    const std::int64_t count = chunks(edge_blocks_, edge_chunk);
    parallel_for(
        count,
        [&](std::int64_t c) {
          S sums[B] = {};
          body(c * edge_chunk, std::min(edge_blocks_, (c + 1) * edge_chunk), sums);
          partial_[c] = total(sums);
        },
        1);
    return sum_partial(count);
  }
  double sum_partial(std::int64_t count) const {
    double sum = 0;
    for (std::int64_t c = 0; c < count; ++c) sum += partial_[c];
    return sum;
  }

  /// Both faces will put here what the edge means to them; without a face it means nothing.
  void clear_edges(std::int64_t b) {
    EdgeBlock& e = edges_[b];
    e.open = 0;
    for (int l = 0; l < B; ++l) {
      const std::int64_t i = b * B + l;
      if (i >= faces_.outer || mesh_.boundary_halfedge(mesh_.halfedge(faces_.edge[i])))
        e.open |= std::uint64_t{1} << static_cast<unsigned>(l);
    }
    for (auto& side : e.own)
      for (auto& values : side)
        for (S& value : values) value = 0;
  }

  template <class Coefficients, class Visitor>
  void set_up_singles(std::int64_t b, const Coefficients& coefficients, const Visitor& visitor) {
    FaceBlock& f = singles_[b];
    const int count = size_of(b, faces_.singles);
    for (int l = 0; l < B; l += N) {
      Index first[N];
      for (int i = 0; i < N; ++i) first[i] = 3 * faces_.single[b * B + std::min(l + i, count - 1)];
      simd::FaceGroup c;
      coefficients(first, c);
      simd::GroupArray own[3][6];
      groups_.own_blocks(c, own);
      for (int i = 0; i < N; ++i) {
        const bool used = l + i < count;
        store(c, i, f.face, l + i, used);
        for (int k = 0; k < 3; ++k) {
          f.row[k][l + i] = static_cast<simd::ExchangeRow>(used ? row(first[i] + k) : spare_row());
          if (used) put_own_block(own[k], i, f.row[k][l + i]);
        }
      }
      if (l < count) visitor.single(*this, b * B + l, c);
    }
  }

  template <class Coefficients, class Visitor>
  void set_up_pairs(std::int64_t b, const Coefficients& coefficients, const Visitor& visitor) {
    PairBlock& f = pairs_[b];
    const int count = size_of(b, faces_.pairs);
    for (int l = 0; l < B; l += N) {
      Index first[2][N];
      for (int i = 0; i < N; ++i) {
        first[0][i] = mesh_.halfedge(faces_.between[b * B + std::min(l + i, count - 1)]);
        first[1][i] = mesh_.twin(first[0][i]);
      }
      simd::FaceGroup c[2];
      for (int side = 0; side < 2; ++side) coefficients(first[side], c[side]);
      simd::GroupArray inverse[6], outer[2][2][6];
      groups_.between(c, inverse);
      groups_.outer_blocks(c, inverse, outer);
      for (int i = 0; i < N; ++i) {
        const bool used = l + i < count;
        for (int k = 0; k < 6; ++k) f.inverse[k][l + i] = used ? static_cast<S>(inverse[k][i]) : S(0);
        for (int side = 0; side < 2; ++side) {
          store(c[side], i, f.face[side], l + i, used);
          Index h = first[side][i];
          for (int k = 0; k < 2; ++k) {
            h = Mesh::next(h);
            f.row[side][k][l + i] = static_cast<simd::ExchangeRow>(used ? row(h) : spare_row() + 1);
            if (used) put_own_block(outer[side][k], i, f.row[side][k][l + i]);
          }
        }
      }
      if (l < count) visitor.pair(*this, b * B + l, c, inverse);
    }
  }

  static void whiten_edges(EdgeBlock& e, Rotations rotations) {
    for (int l = 0; l < B; ++l) {
      S a[6], u[6];
      // [m d] and [m t] change sign when an edge is seen from its other face, [m m], [d d], [d t] and [t t] do not.
      for (int k = 0; k < 6; ++k)
        a[k] = k == 1 || k == 2 ? e.own[0][k][l] - e.own[1][k][l] : e.own[0][k][l] + e.own[1][k][l];
      if (rotations == Rotations::held) a[2] = a[4] = a[5] = 0;
      kernels::whiten_symmetric(a, u);
      for (int k = 0; k < 6; ++k) e.whitening[k][l] = u[k];
    }
  }

  static void store(const simd::FaceGroup& c, int lane, simd::FaceArrays<S>& f, int l, bool used) {
    for (int k = 0; k < 3; ++k) f.weight[k][l] = used ? static_cast<S>(c.weight[k][lane]) : S(0);
    for (int k = 0; k < 6; ++k) f.inverse[k][l] = used ? static_cast<S>(c.inverse[k][lane]) : S(0);
    f.stiffness[l] = used ? static_cast<S>(c.stiffness[lane]) : S(0);
  }

  void put_own_block(const simd::GroupArray (&own)[6], int lane, simd::ExchangeRow row) {
    auto& side = edges_[row / (2 * B)].own[row % 2];
    for (int k = 0; k < 6; ++k) side[k][row / 2 % B] = static_cast<S>(own[k][lane]);
  }

  [[nodiscard]] EdgeCorrection unwhiten(Index i, const S (&v)[3][B]) const {
    const auto& u = edges_[i / B].whitening;
    const auto l = static_cast<int>(i % B);
    const S mean = -(u[0][l] * v[0][l] + u[1][l] * v[1][l] + u[3][l] * v[2][l]);
    const S difference = -(u[2][l] * v[1][l] + u[4][l] * v[2][l]);
    return {double(mean), double(difference), double(u[5][l] * v[2][l])};
  }

  const Mesh& mesh_;
  const FacePairs& faces_;
  const simd::CorrectionLoops<S>& loops_;
  const simd::GroupLoops& groups_;
  std::int64_t single_blocks_, pair_blocks_, edge_blocks_;
  Array<FaceBlock> singles_;
  Array<PairBlock> pairs_;
  Array<EdgeBlock> edges_;
  Array<S> exchange_;
  Array<double> partial_;
};

}  // namespace alcap::detail
