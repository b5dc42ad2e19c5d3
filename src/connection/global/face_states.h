// SPDX-License-Identifier: MIT
//
// face_states.h: the faces' side of the globally optimal connection (src/connection/global/optimise.cpp), in double:
// what each face sees of the turned edges, how its corners relax, and what it then pulls its outer edges with. Pairs of
// faces turn the edge between them as well (src/connection/global/face_pairs.h).
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "alcap/connection.h"
#include "kernels/connection_energy.h"
#include "src/base/parallel.h"
#include "src/connection/global/correction_system.h"
#include "src/connection/global/face_pairs.h"

namespace alcap::detail {

// tan of the angle opposite a halfedge, capped, times the length factor: the weights of D_E. Computed where they are
// needed, which costs less than to store and read them.
class HalfedgeWeights {
 public:
  HalfedgeWeights(const Mesh& mesh, const Geometry& geometry, const GlobalOptions& options)
      : mesh_(mesh), geometry_(geometry), cap_(static_cast<double>(options.tan_cap)), factor_(options.length_factor) {
    if (factor_ != LengthFactor::mean_edge) return;
    Topology topology = find_topology(mesh);
    if (topology.components.size() == 1) {
      const double sum = parallel_sum<double>(
          mesh.edges(), [&](std::int64_t e) { return double(geometry.length(static_cast<Index>(e))); });
      per_length_ = {static_cast<double>(mesh.edges() / sum)};
      return;
    }
    std::vector<double> sum(topology.components.size());
    for (Index e = 0; e < mesh.edges(); ++e)
      sum[static_cast<std::size_t>(topology.face_component[static_cast<std::size_t>(Mesh::face(mesh.halfedge(e)))])] +=
          double(geometry.length(e));
    for (std::size_t c = 0; c < sum.size(); ++c)
      per_length_.push_back(static_cast<double>(topology.components[c].edges / sum[c]));
    face_component_ = std::move(topology.face_component);
  }

  double operator()(Index h) const {
    return kernels::capped_tangent(geometry_.cot(Mesh::prev(h)), cap_) * length_factor(h);
  }

  double cap() const { return cap_; }

  double length_factor(Index h) const {
    if (factor_ == LengthFactor::per_edge) return double(1);
    const double length = geometry_.length(mesh_.edge(h));
    if (factor_ == LengthFactor::metric) return length;
    const Index c = face_component_.empty() ? 0 : face_component_[static_cast<std::size_t>(Mesh::face(h))];
    return length * per_length_[static_cast<std::size_t>(c)];
  }

 private:
  const Mesh& mesh_;
  const Geometry& geometry_;
  double cap_;
  LengthFactor factor_;
  std::vector<double> per_length_;     // 1 over the mean edge length, per component
  std::vector<Index> face_component_;  // empty where there is only one
};

// Three numbers per edge, or per row of the exchange between faces and edges, wherever they lie.
using EdgeValues = Eigen::Matrix<double, 3, Eigen::Dynamic>;
using Values = Eigen::Ref<const EdgeValues>;
using ValuesOut = Eigen::Map<EdgeValues>;

// The lifted state, as the optimisation sees it; at rest, all of it is zero.
struct FaceStates {
  static constexpr int N = simd::group_size;

  const Mesh& mesh;
  const Geometry& geometry;
  const HalfedgeWeights& weights;
  double detail;
  const VectorX<double>& tau;
  const LiftedResiduals& r;
  bool at_rest = false;
  simd::GroupLoops loops = simd::group_loops(best_isa());

  static std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

  // The coefficients of the faces of some halfedges, from there on. Boundaries have p = 0: rho_{v->e} is free there and
  // follows its face.
  void coefficients(const Index (&first)[N], simd::FaceGroup& c) const {
    simd::FaceShapes shapes;
    for (int l = 0; l < N; ++l) {
      Index h = first[l];
      for (int k = 0; k < 3; ++k, h = Mesh::next(h)) {
        shapes.cot[k][l] = double(geometry.cot(h));
        shapes.factor[k][l] = mesh.boundary_halfedge(h) ? 0 : detail * double(weights.length_factor(h));
      }
    }
    loops.coefficients(shapes, double(weights.cap()), c);
  }

  // What halfedge h sees into column k of lane l, with its edge turned by u, which it sees from the other side if
  // `second`.
  void look(Index h, const double* u, bool second, int k, int l, simd::GroupArray (&in)[3][3]) const {
    const double sign = second ? -1.0 : 1.0;
    const double start = at_rest ? 0 : double(r.start[h]), end = at_rest ? 0 : double(r.end[h]);
    in[0][k][l] = (start + end) / 2 - u[0];
    in[1][k][l] = end - start - sign * u[1];
    in[2][k][l] = (at_rest ? 0 : double(tau[h])) + sign * u[2];
  }

  // The first halfedges of single faces i, i + 1, ...; beyond the last one, lanes repeat it.
  static void singles(const FacePairs& faces, std::int64_t i, Index (&first)[N]) {
    for (int l = 0; l < N; ++l) first[l] = 3 * faces.single[at(std::min<std::int64_t>(i + l, faces.singles - 1))];
  }

  // Both sides of the edges between pairs i, i + 1, ...
  void pairs(const FacePairs& faces, std::int64_t i, Index (&first)[2][N]) const {
    for (int l = 0; l < N; ++l) {
      first[0][l] = mesh.halfedge(faces.between[at(std::min<std::int64_t>(i + l, faces.pairs - 1))]);
      first[1][l] = mesh.twin(first[0][l]);
    }
  }
};

// What faces do with the edges, by their number, turned by u: parts = the pull of each face on its outer edges, x =
// what its relaxed corners move by. Edges between paired faces are turned to their optimum.
struct Pull {
  static constexpr int N = simd::group_size;
  using Inverse = simd::GroupArray[6];

  const FaceStates& states;
  const FacePairs& faces;
  ValuesOut& u;
  ValuesOut& parts;
  double* x;

  static std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

  template <class System>
  void all(const System& system) const {
    constexpr std::int64_t grain = 256;  // groups: 50K triangles keep two threads equally busy
    parallel_for((std::int64_t{faces.singles} + N - 1) / N,
                 [&](std::int64_t group) {
                   Index first[N];
                   simd::FaceGroup c;
                   states.singles(faces, group * N, first);
                   states.coefficients(first, c);
                   single(system, group * N, c);
                 },
                 grain);
    parallel_for((std::int64_t{faces.pairs} + N - 1) / N,
                 [&](std::int64_t group) {
                   Index first[2][N];
                   simd::FaceGroup c[2];
                   Inverse inverse;
                   states.pairs(faces, group * N, first);
                   for (int side = 0; side < 2; ++side) states.coefficients(first[side], c[side]);
                   states.loops.between(c, inverse);
                   pair(system, group * N, c, inverse);
                 },
                 grain);
  }

  // Single faces i, i + 1, ...
  template <class System>
  void single(const System& system, std::int64_t i, const simd::FaceGroup& c) const {
    const auto count = static_cast<int>(std::min<std::int64_t>(N, faces.singles - i));
    Index first[N];
    simd::GroupArray v[3][3], moved[3];
    std::int64_t row[3][N];
    states.singles(faces, i, first);
    for (int l = 0; l < N; ++l)
      for (int k = 0; k < 3; ++k) {
        row[k][l] = system.single_row(i + std::min(l, count - 1), k);
        states.look(first[l] + k, &u(0, row[k][l] / 2), row[k][l] % 2 != 0, k, l, v);
      }
    states.loops.relax(c, v, moved);
    for (int l = 0; l < count; ++l)
      for (int k = 0; k < 3; ++k) {
        answer(row[k][l], k, l, v);
        x[first[l] + k] = moved[k][l];
      }
  }

  // Pairs i, i + 1, ...
  template <class System>
  void pair(const System& system, std::int64_t i, const simd::FaceGroup (&c)[2], const Inverse& inverse) const {
    const auto count = static_cast<int>(std::min<std::int64_t>(N, faces.pairs - i));
    Index first[2][N];
    simd::GroupArray v[2][3][3], moved[2][3], turned[3];
    std::int64_t row[2][3][N];
    states.pairs(faces, i, first);
    for (int side = 0; side < 2; ++side)
      for (int l = 0; l < N; ++l) {
        const std::int64_t last = i + std::min(l, count - 1);
        Index h = first[side][l];
        row[side][0][l] = 2 * (faces.outer + last) + side;
        for (int k = 1; k < 3; ++k) row[side][k][l] = system.pair_row(last, side, k);
        for (int k = 0; k < 3; ++k, h = Mesh::next(h))
          states.look(h, &u(0, row[side][k][l] / 2), row[side][k][l] % 2 != 0, k, l, v[side]);
      }
    states.loops.relax_pair(c, inverse, v, moved, turned);
    for (int l = 0; l < count; ++l) {
      double* const between = &u(0, faces.outer + i + l);
      between[0] -= turned[0][l];
      between[1] -= turned[1][l];
      between[2] += turned[2][l];
      for (int side = 0; side < 2; ++side) {
        Index h = first[side][l];
        for (int k = 0; k < 3; ++k, h = Mesh::next(h)) {
          if (k > 0) answer(row[side][k][l], k, l, v[side]);
          x[h] = moved[side][k][l];
        }
      }
    }
  }

 private:
  void answer(std::int64_t row, int k, int lane, const simd::GroupArray (&v)[3][3]) const {
    for (int i = 0; i < 3; ++i) parts(i, row) = v[i][k][lane];
  }
};

}  // namespace alcap::detail
