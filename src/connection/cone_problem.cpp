// SPDX-License-Identifier: MIT
#include "src/connection/cone_problem.h"

#include <algorithm>
#include <cmath>

#include "solvers/dense/hermitian.h"
#include "src/base/array.h"
#include "src/connection/cone_index.h"
#include "src/connection/grounded_laplacian.h"

namespace alcap::detail {

using Vector = ConeProblem::Vector;

VectorX<double> adjustment_across(const Mesh& mesh, const VectorX<double>& x) {
  VectorX<double> alpha(mesh.halfedges());
  parallel_for(mesh.halfedges(), [&](std::int64_t i) {
    const Index h = static_cast<Index>(i);
    const double half = x[mesh.edge(h)] / 2;
    alpha[h] = mesh.canonical(h) ? -half : half;
  });
  return alpha;
}

VectorX<double> cone_weights(const Mesh& mesh, const Geometry& geometry) {
  VectorX<double> weight(mesh.edges());
  for (Index e = 0; e < mesh.edges(); ++e)
    weight[e] = mesh.boundary_halfedge(mesh.halfedge(e)) ? 0.0 : raised_weight(mesh, geometry, e);
  return weight;
}

ConeProblem::ConeProblem(const Mesh& mesh, const Geometry& geometry, const Topology& topology)
    : mesh_(mesh),
      geometry_(geometry),
      topology_(topology),
      weight_(cone_weights(mesh, geometry)),
      defect_(mesh.vertices()) {
  for (Index v = 0; v < mesh.vertices(); ++v) defect_[v] = geometry.defect(mesh, v);
  loop_of_vertex_.assign(at(mesh.vertices()), none);
  for (std::size_t l = 0; l < topology.loops.size(); ++l)
    for (const Index h : topology.loops[l].halfedges) loop_of_vertex_[at(mesh.tail(h))] = static_cast<Index>(l);
}

Index ConeProblem::loop_of(Index v) const { return loop_of_vertex_[at(v)]; }
Index ConeProblem::node(Index v) const { return node_of_vertex_[at(v)]; }

Vector ConeProblem::solve(const Vector& vertex_index, const std::vector<double>& loop_index,
                          const std::vector<Loop>& generators, const ConeWish& wish) {
  number_nodes(!loop_index.empty());
  factorise(wish.solver);
  Vector x = flow(potentials(right_hand_side(vertex_index, loop_index)));
  if (!generators.empty()) add_generators(generators, wish, x);
  return x;
}

// What x must add to the curvature of each node: that of its indices less the angle defects.
Vector ConeProblem::right_hand_side(const Vector& vertex_index, const std::vector<double>& loop_index) const {
  Vector b = Vector::Zero(nodes_);
  for (Index v = 0; v < mesh_.vertices(); ++v)
    if (node(v) != none) b[node(v)] += loop_of(v) == none ? 2 * pi<double> * vertex_index[v] - defect_[v] : -defect_[v];
  if (!loop_index.empty())
    for (std::size_t l = 0; l < loop_index.size(); ++l) {
      const Index loop = node(mesh_.tail(topology_.loops[l].halfedges.front()));
      if (loop != none) b[loop] += 2 * pi<double> * loop_index[l];
    }
  return b;
}

std::vector<double> ConeProblem::loop_turns(const Vector& x) const {
  std::vector<double> turns(topology_.loops.size(), 0.0);
  add_flow_of_loops(
      mesh_, x, [&](Index v) { return loop_of(v); }, turns);
  for (Index v = 0; v < mesh_.vertices(); ++v)
    if (const Index l = loop_of(v); l != none) turns[at(l)] += defect_[v];
  for (double& t : turns) t /= 2 * pi<double>;
  return turns;
}

// Interior vertices, then loops when they are nodes. One node of each component without free loops is the ground.
void ConeProblem::number_nodes(bool loops_are_nodes) {
  std::vector<Index> node_of_loop(topology_.loops.size(), none);
  std::vector<bool> grounded(topology_.components.size(), false);
  if (!loops_are_nodes)
    for (const Loop& loop : topology_.loops) grounded[at(loop.component)] = true;
  node_of_vertex_.assign(at(mesh_.vertices()), none);
  nodes_ = 0;
  const auto take = [&](Index component) -> Index {
    if (grounded[at(component)]) return nodes_++;
    grounded[at(component)] = true;
    return none;
  };
  if (loops_are_nodes)
    for (std::size_t l = 0; l < topology_.loops.size(); ++l) node_of_loop[l] = take(topology_.loops[l].component);
  for (Index v = 0; v < mesh_.vertices(); ++v) {
    if (!mesh_.referenced(v)) continue;
    node_of_vertex_[at(v)] =
        loop_of(v) == none ? take(topology_.vertex_component[at(v)]) : node_of_loop[at(loop_of(v))];
  }
}

void ConeProblem::factorise(const std::string& name) {
  std::vector<Eigen::Triplet<double, Index>> entries;
  entries.reserve(4 * at(mesh_.edges()));
  for (Index e = 0; e < mesh_.edges(); ++e) {
    const Index h = mesh_.halfedge(e);
    if (mesh_.boundary_halfedge(h)) continue;
    const Index i = node(mesh_.tail(h)), j = node(mesh_.tip(h));
    if (i == j) continue;
    if (i != none) entries.emplace_back(i, i, weight_[e]);
    if (j != none) entries.emplace_back(j, j, weight_[e]);
    if (i == none || j == none) continue;
    entries.emplace_back(i, j, -weight_[e]);
    entries.emplace_back(j, i, -weight_[e]);
  }
  SparseMatrix<double> L(nodes_, nodes_);
  L.setFromTriplets(entries.begin(), entries.end());
  if (nodes_ == 0) return;
  solver_ = make_linear_solver<double>({.name = name});
  solver_->analyse(L);
  solver_->factorise(L);
}

Vector ConeProblem::potentials(const Vector& b) const {
  Eigen::MatrixXd X = Eigen::MatrixXd::Zero(nodes_, 1);
  if (nodes_ > 0) (void)solver_->solve(Eigen::MatrixXd(b), X);
  return X.col(0);
}

// w A' mu
Vector ConeProblem::flow(const Vector& mu) const {
  return flow_between(mesh_, weight_, [&](Index v) { return node(v) == none ? 0.0 : mu[node(v)]; });
}

// Signed sum of x over the edges that a strip crosses.
double ConeProblem::across(const Loop& strip, const Vector& x) const {
  double sum = 0;
  for (const Index h : strip.halfedges) sum += mesh_.canonical(h) ? x[mesh_.edge(h)] : -x[mesh_.edge(h)];
  return sum;
}

// A change of x around the generator that no vertex sees: w H' less the flow that balances it.
Vector ConeProblem::harmonic(const Loop& generator) const {
  Vector z = Vector::Zero(mesh_.edges());
  for (const Index h : generator.halfedges)
    z[mesh_.edge(h)] += (mesh_.canonical(h) ? 1.0 : -1.0) * weight_[mesh_.edge(h)];
  Vector b = Vector::Zero(nodes_);
  for (const Index h : generator.halfedges) {
    const Index e = mesh_.edge(h), i = node(mesh_.tail(h)), j = node(mesh_.tip(h));
    if (i != none) b[i] += weight_[e];
    if (j != none) b[j] -= weight_[e];
  }
  return z - flow(potentials(b));
}

// Holonomy = Levi-Civita's minus the sum of x across; wanted is a multiple of 1/n, or what was asked, modulo a turn.
void ConeProblem::add_generators(const std::vector<Loop>& generators, const ConeWish& wish, Vector& x) const {
  const auto count = static_cast<Eigen::Index>(generators.size());
  Eigen::MatrixXd Z(mesh_.edges(), count);
  for (Eigen::Index k = 0; k < count; ++k) Z.col(k) = harmonic(generators[at(k)]);
  Eigen::MatrixXd gram(count, count);
  Vector missing(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Loop& strip = generators[at(k)];
    for (Eigen::Index l = 0; l < count; ++l) gram(k, l) = across(strip, Z.col(l));
    const double now =
        (holonomy(mesh_, geometry_, Connection{}, strip) - across(strip, x)) / (2 * pi<double>);  // Levi-Civita less x
    double wanted = 0;
    if (wish.generator_holonomy.empty()) {
      wanted = nearest_multiple(now, wish.n);
    } else {
      wanted = wish.generator_holonomy[at(k)];
      wanted += std::nearbyint(now - wanted);
      if (wish.n > 0) wanted = nearest_multiple(wanted, wish.n);
    }
    missing[k] = 2 * pi<double> * (now - wanted);
  }
  x += Z * symmetric_solve(gram, missing);
}

}  // namespace alcap::detail
