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
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "alcap/mesh.h"
#include "alcap/parallel.h"
#include "kernels/pack.h"

namespace alcap::detail {

/// Inverse of the symmetric positive semidefinite [a0 a1 a2; a1 a3 a4; a2 a4 a5] by L D L'. Directions without energy
/// (relative to the diagonal) are left out.
template <class S>
inline void invert_symmetric(const S (&a)[6], S (&out)[6]) {
  constexpr S negligible = 8 * std::numeric_limits<S>::epsilon();
  const auto reciprocal = [](S pivot, S diagonal) { return pivot > negligible * diagonal ? S(1) / pivot : S(0); };
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
inline FaceCoefficients<S> face_coefficients(const S (&cot)[3], const S (&p)[3]) {
  FaceCoefficients<S> c;
  S h[3][3] = {};
  const S sixth = S(1) / 6, half = S(1) / 2;
  c.stiffness = (cot[0] + cot[1] + cot[2]) / 36;
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3, before = (k + 2) % 3;
    c.p[k] = p[k];
    // D' W D has (cot + cot)/2 of the two corners beyond on the diagonal and -cot/2 of the third off it.
    h[k][k] = half * (cot[next] + cot[before]) + (p[k] + p[before]) * (S(2) * sixth);
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

/// A value (m, d, R) per edge.
template <class S>
using EdgeValues = Eigen::Matrix<S, 3, Eigen::Dynamic>;

template <class S>
class CorrectionSystem {
 public:
  /// weights: p per halfedge, zero on the boundary.
  template <class T>
  CorrectionSystem(const Mesh& mesh, const VectorX<T>& cots, const VectorX<T>& weights, bool hold_rho)
      : face_count_(mesh.faces()),
        edge_count_(mesh.edges()),
        faces_(blocks(face_count_)),
        edges_(blocks(edge_count_)),
        slot_(static_cast<std::size_t>(mesh.halfedges())),
        sides_(2 * static_cast<std::size_t>(edge_count_)),
        force_(3 * (static_cast<std::size_t>(mesh.halfedges()) + 1)),
        z_(3 * static_cast<std::size_t>(edge_count_)) {
    parallel_for(edge_count_, [&](std::int64_t e) {
      const Index h = mesh.halfedge(static_cast<Index>(e)), g = mesh.twin(h);
      slot_[static_cast<std::size_t>(h)] = static_cast<Index>(e);
      if (g != none) slot_[static_cast<std::size_t>(g)] = ~static_cast<Index>(e);
      sides_[2 * static_cast<std::size_t>(e)] = h;
      sides_[2 * static_cast<std::size_t>(e) + 1] = g == none ? mesh.halfedges() : g;
    });
    each(faces_, [&](std::int64_t b, FaceBlock& f) {
      for (int l = 0; l < B; ++l) {
        const std::int64_t h = 3 * std::min<std::int64_t>(b * B + l, face_count_ - 1);
        const double cot[3] = {double(cots[h]), double(cots[h + 1]), double(cots[h + 2])};
        const double p[3] = {double(weights[h]), double(weights[h + 1]), double(weights[h + 2])};
        const FaceCoefficients<double> c = face_coefficients(cot, p);
        for (int k = 0; k < 3; ++k) f.p[k][l] = static_cast<S>(c.p[k]);
        for (int k = 0; k < 6; ++k) f.inverse[k][l] = static_cast<S>(c.inverse[k]);
        f.stiffness[l] = static_cast<S>(c.stiffness);
      }
    });
    // The blocks of single edges go from faces to edges through force_, three of their six entries at a time.
    for (int part = 0; part < 2; ++part) {
      each(faces_, [&](std::int64_t b, const FaceBlock& f) { own_blocks(b, f, part); });
      each(edges_, [&](std::int64_t b, EdgeBlock& e) {
        S sum[3][B];
        gather(b, sum, part == 0 ? Parity::mixed : Parity::even);
        for (int k = 0; k < 3; ++k)
          for (int l = 0; l < B; ++l) e.inverse[3 * part + k][l] = sum[k][l];
      });
    }
    each(edges_, [&](std::int64_t, EdgeBlock& e) {
      for (int l = 0; l < B; ++l) {
        S a[6], inverse[6];
        for (int k = 0; k < 6; ++k) a[k] = hold_rho && (k == 2 || k >= 4) ? S(0) : e.inverse[k][l];
        invert_symmetric(a, inverse);
        for (int k = 0; k < 6; ++k) e.inverse[k][l] = inverse[k];
      }
    });
  }

  /// Sets the right-hand side and x = 0; returns r' P r with the preconditioner P, the inverse of the edges' blocks.
  template <class T>
  double start(const EdgeValues<T>& rhs) {
    return reduce(edges_, [&](std::int64_t b, EdgeBlock& e, S(&sums)[B]) {
      const int count = size_of(b, edge_count_);
      for (int k = 0; k < 3; ++k) {
        for (int l = 0; l < B; ++l) e.p[k][l] = e.s[k][l] = e.x[k][l] = e.r[k][l] = 0;
        for (int l = 0; l < count; ++l) e.r[k][l] = static_cast<S>(rhs(k, b * B + l));
      }
      S z[3][B];
      precondition(e, z);
      finish(b, e, z, sums);
    });
  }

  /// Relaxes all faces in the state z = P r; returns z' A z.
  double apply() {
    return reduce(faces_, [&](std::int64_t b, const FaceBlock& f, S(&sums)[B]) {
      S values[9][B];
      const int count = size_of(b, face_count_);
      const Index* const slot = slot_.data() + 3 * b * B;
      for (int l = 0; l < count; ++l)
        for (int k = 0; k < 3; ++k) {
          const Index e = slot[3 * l + k];
          const S sign = e < 0 ? S(-1) : S(1);
          const S* const z = z_.data() + 3 * std::int64_t{e < 0 ? ~e : e};
          values[k][l] = -z[0];
          values[3 + k][l] = -sign * z[1];
          values[6 + k][l] = sign * z[2];
        }
      for (int k = 0; k < 9; ++k)
        for (int l = count; l < B; ++l) values[k][l] = 0;
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
      S* const force = force_.data() + 9 * b * B;
      for (int l = 0; l < count; ++l)
        for (int k = 0; k < 3; ++k) {
          force[9 * l + 3 * k] = -values[k][l];
          force[9 * l + 3 * k + 1] = -values[3 + k][l];
          force[9 * l + 3 * k + 2] = values[6 + k][l];
        }
    });
  }

  /// The rest of a step of conjugate gradients in the form of Chronopoulos and Gear (1989), which needs one pass over
  /// the faces and one over the edges. Returns the new r' P r.
  double step(S alpha, S beta) {
    return reduce(edges_, [&](std::int64_t b, EdgeBlock& e, S(&sums)[B]) {
      S w[3][B], z[3][B];
      gather(b, w, Parity::odd);
      precondition(e, z);
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l < B; ++l) {
          e.p[k][l] = z[k][l] + beta * e.p[k][l];
          e.s[k][l] = w[k][l] + beta * e.s[k][l];
          e.x[k][l] += alpha * e.p[k][l];
          e.r[k][l] -= alpha * e.s[k][l];
        }
      precondition(e, z);
      finish(b, e, z, sums);
    });
  }

  /// After start(): P r.
  template <class T>
  void preconditioned(EdgeValues<T>& z) const {
    parallel_for(edge_count_, [&](std::int64_t e) {
      for (int k = 0; k < 3; ++k) z(k, e) = static_cast<T>(z_[static_cast<std::size_t>(3 * e + k)]);
    });
  }

  /// u += x.
  template <class T>
  void add_solution(EdgeValues<T>& u) const {
    parallel_for(edge_count_, [&](std::int64_t i) {
      const EdgeBlock& e = edges_[static_cast<std::size_t>(i / B)];
      for (int k = 0; k < 3; ++k) u(k, i) += static_cast<T>(e.x[k][i % B]);
    });
  }

 private:
  /// Faces or edges that are worked on together, one array per quantity, so that loops over them become SIMD code.
  static constexpr int B = 64;
  using Lanes = kernels::Pack<S, 16 / static_cast<int>(sizeof(S)), kernels::isa::Sse2>;
  struct FaceBlock {
    S p[3][B], stiffness[B], inverse[6][B];
  };
  struct EdgeBlock {
    S p[3][B], s[3][B], x[3][B], r[3][B], inverse[6][B];
  };
  /// Which of three values change sign when an edge is seen from its other face: the last two (d and R, or [m d] and
  /// [m R]), or none ([d d], [d R], [R R]).
  enum class Parity { odd, mixed = odd, even };

  static std::size_t blocks(Index n) { return static_cast<std::size_t>((n + B - 1) / B); }
  static int size_of(std::int64_t b, Index n) { return static_cast<int>(std::min<std::int64_t>(B, n - b * B)); }

  template <class Block, class Body>
  static void each(std::vector<Block>& all, Body&& body) {
    parallel_for(
        static_cast<std::int64_t>(all.size()), [&](std::int64_t b) { body(b, all[static_cast<std::size_t>(b)]); }, 16);
  }

  /// Sum over fixed chunks of blocks, lane by lane within a chunk: bitwise independent of threads.
  template <class Block, class Body>
  static double reduce(std::vector<Block>& all, Body&& body) {
    constexpr std::int64_t chunk = reduction_chunk / B;
    const auto count = static_cast<std::int64_t>(all.size());
    std::vector<double> partial(static_cast<std::size_t>((count + chunk - 1) / chunk));
    parallel_for(
        static_cast<std::int64_t>(partial.size()),
        [&](std::int64_t c) {
          S sums[B] = {};
          for (std::int64_t b = c * chunk; b < std::min(count, (c + 1) * chunk); ++b)
            body(b, all[static_cast<std::size_t>(b)], sums);
          double total = 0;
          for (const S s : sums) total += double(s);
          partial[static_cast<std::size_t>(c)] = total;
        },
        1);
    double total = 0;
    for (const double p : partial) total += p;
    return total;
  }

  static FaceCoefficients<Lanes> coefficients(const FaceBlock& f, int l) {
    FaceCoefficients<Lanes> c;
    for (int k = 0; k < 3; ++k) c.p[k] = Lanes::load(f.p[k] + l);
    for (int k = 0; k < 6; ++k) c.inverse[k] = Lanes::load(f.inverse[k] + l);
    c.stiffness = Lanes::load(f.stiffness + l);
    return c;
  }

  // Sum over both faces of what force_ holds for the edges of block b.
  void gather(std::int64_t b, S (&w)[3][B], Parity parity) const {
    const S sign = parity == Parity::odd ? S(-1) : S(1);
    const int count = size_of(b, edge_count_);
    const Index* const side = sides_.data() + 2 * b * B;
    for (int l = 0; l < count; ++l) {
      const S* const here = force_.data() + 3 * std::int64_t{side[2 * l]};
      const S* const there = force_.data() + 3 * std::int64_t{side[2 * l + 1]};
      w[0][l] = here[0] + there[0];
      w[1][l] = here[1] + sign * there[1];
      w[2][l] = here[2] + sign * there[2];
    }
    for (int l = count; l < B; ++l) w[0][l] = w[1][l] = w[2][l] = 0;
  }

  static void precondition(const EdgeBlock& e, S (&z)[3][B]) {
    for (int l = 0; l < B; ++l) {
      z[0][l] = e.inverse[0][l] * e.r[0][l] + e.inverse[1][l] * e.r[1][l] + e.inverse[2][l] * e.r[2][l];
      z[1][l] = e.inverse[1][l] * e.r[0][l] + e.inverse[3][l] * e.r[1][l] + e.inverse[4][l] * e.r[2][l];
      z[2][l] = e.inverse[2][l] * e.r[0][l] + e.inverse[4][l] * e.r[1][l] + e.inverse[5][l] * e.r[2][l];
    }
  }

  // Adds r' z and hands z to the faces.
  void finish(std::int64_t b, const EdgeBlock& e, const S (&z)[3][B], S (&sums)[B]) {
    for (int l = 0; l < B; ++l) sums[l] += z[0][l] * e.r[0][l] + z[1][l] * e.r[1][l] + z[2][l] * e.r[2][l];
    S* const out = z_.data() + 3 * b * B;
    const int count = size_of(b, edge_count_);
    for (int l = 0; l < count; ++l)
      for (int k = 0; k < 3; ++k) out[3 * l + k] = z[k][l];
  }

  // What each halfedge's own unknowns do to themselves through its face: [m m] [m d] [m R] in part 0, [d d] [d R] [R R]
  // in part 1.
  void own_blocks(std::int64_t b, const FaceBlock& f, int part) {
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
          for (int i = 0; i < 3; ++i) {
            const auto at = static_cast<std::size_t>(3 * (3 * (b * B + l + lane) + k) + i);
            force_[at] = entry[static_cast<std::size_t>(i)][lane];
          }
      }
    }
  }

  Index face_count_, edge_count_;
  std::vector<FaceBlock> faces_;
  std::vector<EdgeBlock> edges_;
  std::vector<Index> slot_;   // edge of each halfedge, complemented where it runs against the canonical one
  std::vector<Index> sides_;  // both halfedges of each edge; beyond the boundary the one after the last
  std::vector<S> force_, z_;  // three per halfedge (one more stays zero), three per edge
};

/// Preconditioned conjugate gradients from x = 0 until r' P r has fallen by `reduction` squared or `max_iterations` are
/// done. Returns the iterations.
template <class S>
int conjugate_gradients(CorrectionSystem<S>& system, double square, double reduction, int max_iterations) {
  const double target = square * reduction * reduction;
  double beta = 0, alpha = 0;
  int iteration = 0;
  while (square > target && iteration < max_iterations) {
    double curvature = system.apply();
    if (iteration > 0) curvature -= beta * square / alpha;
    if (!(curvature > 0)) break;  // rounding has used up the search directions
    alpha = square / curvature;
    const double next = system.step(static_cast<S>(alpha), static_cast<S>(beta));
    beta = next / square;
    square = next;
    ++iteration;
  }
  return iteration;
}

}  // namespace alcap::detail
