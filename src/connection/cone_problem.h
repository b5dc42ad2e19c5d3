// SPDX-License-Identifier: MIT
//
// cone_problem.h: the rotations across edges that make a connection trivial (LTGD 2016, Sec. 5.4; Crane et al. 2010).
//
// x per edge is the extra rotation across it. Among all x that give every vertex its curvature (A x = b) and every
// generator its holonomy (H x = c), the one that minimises sum x^2 / w is x = w (A' mu + H' nu). The mu come from
// Poisson solves with A w A', the nu from a dense system of one row per generator. A boundary loop is one node, or none
// when its index is free (mu = 0 there).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "alcap/connection.h"
#include "alcap/solve.h"
#include "src/base/array.h"
#include "src/base/parallel.h"

namespace alcap::detail {

/// What generators shall have, and how systems are solved.
struct ConeWish {
  int n = 1;                                      // generators take the nearest multiples of 1/n
  const std::vector<double>& generator_holonomy;  // or, where this is not empty, these turns
  const std::string& solver;
};

/// The adjustment angle of every halfedge for rotations x across the edges: half of them on each side.
[[nodiscard]] VectorX<double> adjustment_across(const Mesh& mesh, const VectorX<double>& x);

/// #E: the weight w of each edge inside, zero on the boundary.
[[nodiscard]] VectorX<double> cone_weights(const Mesh& mesh, const Geometry& geometry);

/// x = w A' mu, with the potential mu(v) at each vertex.
template <class Potential>
[[nodiscard]] VectorX<double> flow_between(const Mesh& mesh, const VectorX<double>& weight, const Potential& mu) {
  VectorX<double> x(mesh.edges());
  parallel_for(mesh.edges(), [&](std::int64_t e) {
    const Index h = mesh.halfedge(static_cast<Index>(e));
    x[e] = weight[e] * (mu(mesh.tail(h)) - mu(mesh.tip(h)));
  });
  return x;
}

/// Adds to turns[l], in radians, what x takes from the vertices v with loop_of(v) = l; `none` for those that do not
/// count.
template <class LoopOf>
void add_flow_of_loops(const Mesh& mesh, const VectorX<double>& x, const LoopOf& loop_of, std::vector<double>& turns) {
  for (Index e = 0; e < mesh.edges(); ++e) {
    const Index h = mesh.halfedge(e);
    if (mesh.boundary_halfedge(h)) continue;
    if (const Index l = loop_of(mesh.tail(h)); l != none) turns[at(l)] += x[e];
    if (const Index l = loop_of(mesh.tip(h)); l != none) turns[at(l)] -= x[e];
  }
}

/// The Poisson problem over interior vertices and boundary loops.
class ConeProblem {
 public:
  using Vector = Eigen::VectorXd;

  ConeProblem(const Mesh& mesh, const Geometry& geometry, const Topology& topology);

  /// x of least norm for the wanted vertex indices (turns); loops get theirs, or stay free when `loop_index` is empty.
  /// Without generators their holonomies are what the rest gives.
  [[nodiscard]] Vector solve(const Vector& vertex_index, const std::vector<double>& loop_index,
                             const std::vector<Loop>& generators, const ConeWish& wish);

  /// Turns that each boundary loop has under x.
  [[nodiscard]] std::vector<double> loop_turns(const Vector& x) const;

 private:
  [[nodiscard]] Index loop_of(Index v) const;
  [[nodiscard]] Index node(Index v) const;
  void number_nodes(bool loops_are_nodes);
  void factorise(const std::string& name);
  [[nodiscard]] Vector right_hand_side(const Vector& vertex_index, const std::vector<double>& loop_index) const;
  [[nodiscard]] Vector potentials(const Vector& b) const;
  [[nodiscard]] Vector flow(const Vector& mu) const;
  [[nodiscard]] double across(const Loop& strip, const Vector& x) const;
  [[nodiscard]] Vector harmonic(const Loop& generator) const;
  void add_generators(const std::vector<Loop>& generators, const ConeWish& wish, Vector& x) const;

  const Mesh& mesh_;
  const Geometry& geometry_;
  const Topology& topology_;
  Vector weight_, defect_;
  std::vector<Index> loop_of_vertex_, node_of_vertex_;
  Index nodes_ = 0;
  std::unique_ptr<LinearSolver<double>> solver_;
};

}  // namespace alcap::detail
