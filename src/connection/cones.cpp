// SPDX-License-Identifier: MIT
//
// cones.cpp: cones where curvature lies. The potential phi of L phi = curvature, less what the cones so far take and
// the rest spread evenly, is largest where a cone of that sign is missing most.
#include "alcap/cones.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "alcap/solve.h"
#include "alcap/topology.h"
#include "src/base/array.h"
#include "src/connection/cone_index.h"
#include "src/connection/grounded_laplacian.h"

namespace alcap {
namespace {

using Vector = VectorX<double>;
using detail::at;

// What is still missing of every component's Euler characteristic, and of every vertex's curvature.
class Balance {
 public:
  Balance(const Mesh& mesh, const Geometry& geometry, const Topology& topology, int n)
      : mesh_(mesh),
        topology_(topology),
        n_(n),
        lacking_(topology.components.size()),
        area_(topology.components.size(), 0.0),
        left_(topology.components.size(), 0.0),
        inside_(topology.components.size(), 0),
        curvature_(Vector::Zero(mesh.vertices())),
        share_(Vector::Zero(mesh.vertices())) {
    for (std::size_t c = 0; c < lacking_.size(); ++c) lacking_[c] = static_cast<double>(topology.components[c].euler);
    // Boundary loops take the turning of the boundary itself, to the next multiple; cones take what the inside has.
    for (const Loop& loop : topology.loops) {
      double turning = 0;
      for (const Index h : loop.halfedges) turning += geometry.defect(mesh, mesh.tail(h));
      lacking_[at(loop.component)] -= detail::nearest_multiple(turning / (2 * pi<double>), n);
    }
    for (Index v = 0; v < mesh.vertices(); ++v)
      if (mesh.referenced(v) && !mesh.boundary_vertex(v)) {
        curvature_[v] = geometry.defect(mesh, v);
        left_[component(v)] += curvature_[v];
        ++inside_[component(v)];
      }
    for (Index h = 0; h < mesh.halfedges(); ++h) share_[mesh.tail(h)] += geometry.area(Mesh::face(h)) / 3;
    for (Index v = 0; v < mesh.vertices(); ++v)
      if (mesh.referenced(v)) area_[component(v)] += share_[v];
  }

  void account(const Cone& cone) {
    curvature_[cone.vertex] -= 2 * pi<double> * cone.index;
    left_[component(cone.vertex)] -= 2 * pi<double> * cone.index;
    lacking_[component(cone.vertex)] -= cone.index;
  }

  [[nodiscard]] bool unbalanced(std::size_t c) const { return std::abs(lacking_[c]) * n_ > 0.5; }
  [[nodiscard]] bool done() const {
    for (std::size_t c = 0; c < lacking_.size(); ++c)
      if (unbalanced(c)) return false;
    return true;
  }

  // A component cannot take more cones than it has vertices off its boundary. This also bounds the work by the input.
  // Loops take what is left, where there are any.
  void require_possible() {
    for (std::size_t c = 0; c < lacking_.size(); ++c) {
      const double needed = std::abs(lacking_[c]) * n_;
      if (topology_.components[c].boundary_loops > 0) {
        lacking_[c] = std::copysign(std::min(needed, double(inside_[c])) / n_, lacking_[c]);
        continue;
      }
      if (unbalanced(c) && !(needed <= double(inside_[c])))
        throw OptionError("balance_cones", needed,
                          "more cones of 1/" + std::to_string(n_) + " would be needed on component " +
                              std::to_string(c) + ", which has " + std::to_string(inside_[c]) +
                              " vertices off the boundary");
    }
  }

  // The curvature that cones have not taken, less the same amount spread evenly over each component.
  [[nodiscard]] MatrixX<double> right_hand_side() const {
    MatrixX<double> b = curvature_;
    for (Index v = 0; v < mesh_.vertices(); ++v) {
      if (topology_.vertex_component[at(v)] == none) continue;
      const std::size_t c = component(v);
      b(v, 0) -= left_[c] * share_[v] / area_[c];
    }
    return b;
  }

  // The next cone of unbalanced component c.
  [[nodiscard]] Cone next(std::size_t c, const MatrixX<double>& phi) const {
    const double sign = lacking_[c] > 0 ? 1 : -1;
    Index best = none;
    for (Index v = 0; v < mesh_.vertices(); ++v)
      if (topology_.vertex_component[at(v)] == static_cast<Index>(c) && !mesh_.boundary_vertex(v) &&
          (best == none || sign * phi(v, 0) > sign * phi(best, 0)))
        best = v;
    return {.vertex = best, .index = sign / n_};
  }

 private:
  [[nodiscard]] std::size_t component(Index v) const { return at(topology_.vertex_component[at(v)]); }

  const Mesh& mesh_;
  const Topology& topology_;
  int n_;
  std::vector<double> lacking_, area_, left_;  // of each component: index, area, curvature that cones have not taken
  std::vector<std::int64_t> inside_;           // its vertices off the boundary, where cones can be
  Vector curvature_, share_;
};

void check_cone(const Mesh& mesh, const Cone& cone, int n) {
  if (cone.vertex < 0 || cone.vertex >= mesh.vertices() || !mesh.referenced(cone.vertex))
    throw OptionError("cones", cone.vertex, "must be a vertex that a face uses");
  detail::check_multiple("cones", cone.index, n);
}

}  // namespace

std::vector<Cone> balance_cones(const Mesh& mesh, const Geometry& geometry, const std::vector<Cone>& cones,
                                const BalanceOptions& options) {
  if (options.n < 1) throw OptionError("n", options.n, "the degree of a field is at least 1");
  const Topology topology = find_topology(mesh);
  Balance balance(mesh, geometry, topology, options.n);
  for (const Cone& cone : cones) {
    check_cone(mesh, cone, options.n);
    balance.account(cone);
  }
  std::vector<Cone> all = cones;
  if (balance.done()) return all;
  balance.require_possible();
  const std::unique_ptr<LinearSolver<double>> solver = make_linear_solver<double>({.name = options.solver});
  const SparseMatrix<double> L = detail::grounded_laplacian(mesh, geometry, topology);
  solver->analyse(L);
  solver->factorise(L);
  while (!balance.done()) {
    MatrixX<double> phi(mesh.vertices(), 1);
    (void)solver->solve(balance.right_hand_side(), phi);
    for (std::size_t c = 0; c < topology.components.size(); ++c) {
      if (!balance.unbalanced(c)) continue;
      const Cone cone = balance.next(c, phi);
      const auto same = std::find_if(all.begin() + static_cast<std::ptrdiff_t>(cones.size()), all.end(),
                                     [&](const Cone& other) { return other.vertex == cone.vertex; });
      if (same == all.end())
        all.push_back(cone);
      else
        same->index += cone.index;
      balance.account(cone);
    }
  }
  return all;
}

}  // namespace alcap
