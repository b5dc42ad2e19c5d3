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
        curvature_(Vector::Zero(mesh.vertices())),
        share_(Vector::Zero(mesh.vertices())) {
    for (std::size_t c = 0; c < lacking_.size(); ++c) lacking_[c] = topology.components[c].euler;
    for (Index v = 0; v < mesh.vertices(); ++v)
      if (mesh.referenced(v)) curvature_[v] = geometry.defect(mesh, v);
    for (Index h = 0; h < mesh.halfedges(); ++h) share_[mesh.tail(h)] += geometry.area(Mesh::face(h)) / 3;
    for (Index v = 0; v < mesh.vertices(); ++v)
      if (mesh.referenced(v)) area_[component(v)] += share_[v];
  }

  void account(const Cone& cone) {
    curvature_[cone.vertex] -= 2 * pi<double> * cone.index;
    lacking_[component(cone.vertex)] -= cone.index;
  }

  [[nodiscard]] bool unbalanced(std::size_t c) const {
    return topology_.components[c].boundary_loops == 0 && std::abs(lacking_[c]) * n_ > 0.5;
  }
  [[nodiscard]] bool done() const {
    for (std::size_t c = 0; c < lacking_.size(); ++c)
      if (unbalanced(c)) return false;
    return true;
  }

  // A component cannot take more cones than it has vertices. This also bounds the work by the input.
  void require_possible() const {
    for (std::size_t c = 0; c < lacking_.size(); ++c) {
      const double needed = std::abs(lacking_[c]) * n_;
      const Index vertices = topology_.components[c].vertices;
      if (unbalanced(c) && !(needed <= double(vertices)))
        throw OptionError("cones", needed,
                          "more cones of 1/" + std::to_string(n_) + " would be needed on component " +
                              std::to_string(c) + ", which has " + std::to_string(vertices) + " vertices");
    }
  }

  // The curvature that cones have not taken, with what is lacking taken evenly off each component.
  [[nodiscard]] MatrixX<double> right_hand_side() const {
    MatrixX<double> b = curvature_;
    for (Index v = 0; v < mesh_.vertices(); ++v) {
      if (topology_.vertex_component[at(v)] == none) continue;
      const std::size_t c = component(v);
      b(v, 0) -= 2 * pi<double> * lacking_[c] * share_[v] / area_[c];
    }
    return b;
  }

  // The next cone of unbalanced component c.
  [[nodiscard]] Cone next(std::size_t c, const MatrixX<double>& phi) const {
    const double sign = lacking_[c] > 0 ? 1 : -1;
    Index best = none;
    for (Index v = 0; v < mesh_.vertices(); ++v)
      if (topology_.vertex_component[at(v)] == static_cast<Index>(c) &&
          (best == none || sign * phi(v, 0) > sign * phi(best, 0)))
        best = v;
    return {.vertex = best, .index = sign / n_};
  }

 private:
  [[nodiscard]] std::size_t component(Index v) const { return at(topology_.vertex_component[at(v)]); }

  const Mesh& mesh_;
  const Topology& topology_;
  int n_;
  std::vector<double> lacking_, area_;
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
