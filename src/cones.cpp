// SPDX-License-Identifier: MIT
#include "alcap/cones.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "alcap/solve.h"
#include "alcap/topology.h"

namespace alcap {
namespace {

using Vector = VectorX<double>;

// As in connection_trivial.cpp: obtuse angles must not make weights negative.
constexpr double least_weight = 1e-3;
constexpr double multiple_tolerance = 1e-6;

// Cotangent Laplacian with one vertex per component tied to the ground, and ones for unreferenced vertices.
SparseMatrix<double> grounded_laplacian(const Mesh& mesh, const Geometry<double>& geometry, const Topology& topology) {
  std::vector<Eigen::Triplet<double, Index>> entries;
  entries.reserve(4 * static_cast<std::size_t>(mesh.edges()) + static_cast<std::size_t>(mesh.vertices()));
  std::vector<double> largest(topology.components.size(), 0);
  for (Index e = 0; e < mesh.edges(); ++e) {
    const Index h = mesh.halfedge(e), g = mesh.twin(h);
    double w = geometry.cot(Mesh::prev(h)) / 2;
    if (g != none) w += geometry.cot(Mesh::prev(g)) / 2;
    w = std::max(w, least_weight);
    const Index i = mesh.tail(h), j = mesh.tip(h);
    entries.emplace_back(i, i, w);
    entries.emplace_back(j, j, w);
    entries.emplace_back(i, j, -w);
    entries.emplace_back(j, i, -w);
    double& most = largest[static_cast<std::size_t>(topology.vertex_component[static_cast<std::size_t>(i)])];
    most = std::max(most, w);
  }
  std::vector<bool> grounded(topology.components.size(), false);
  for (Index v = 0; v < mesh.vertices(); ++v) {
    const Index c = topology.vertex_component[static_cast<std::size_t>(v)];
    if (c == none) {
      entries.emplace_back(v, v, 1.0);
    } else if (!grounded[static_cast<std::size_t>(c)]) {
      entries.emplace_back(v, v, largest[static_cast<std::size_t>(c)]);
      grounded[static_cast<std::size_t>(c)] = true;
    }
  }
  SparseMatrix<double> L(mesh.vertices(), mesh.vertices());
  L.setFromTriplets(entries.begin(), entries.end());
  return L;
}

}  // namespace

std::vector<Cone> balance_cones(const Mesh& mesh, const Geometry<double>& geometry, const std::vector<Cone>& cones,
                                const BalanceOptions& options) {
  if (options.n < 1) throw OptionError("n", std::to_string(options.n), "the degree of a field is at least 1");
  const Topology topology = find_topology(mesh);
  std::vector<double> lacking(topology.components.size()), area(topology.components.size(), 0.0);
  for (std::size_t c = 0; c < lacking.size(); ++c) lacking[c] = topology.components[c].euler;
  Vector curvature = Vector::Zero(mesh.vertices()), share = Vector::Zero(mesh.vertices());
  for (Index v = 0; v < mesh.vertices(); ++v)
    if (mesh.referenced(v)) curvature[v] = geometry.defect(mesh, v);
  for (Index h = 0; h < mesh.halfedges(); ++h) share[mesh.tail(h)] += geometry.area(Mesh::face(h)) / 3;
  for (Index v = 0; v < mesh.vertices(); ++v)
    if (mesh.referenced(v))
      area[static_cast<std::size_t>(topology.vertex_component[static_cast<std::size_t>(v)])] += share[v];
  const auto account = [&](const Cone& cone) {
    curvature[cone.vertex] -= 2 * pi<double> * cone.index;
    lacking[static_cast<std::size_t>(topology.vertex_component[static_cast<std::size_t>(cone.vertex)])] -= cone.index;
  };
  for (const Cone& cone : cones) {
    const std::string name = std::to_string(cone.vertex);
    if (cone.vertex < 0 || cone.vertex >= mesh.vertices() || !mesh.referenced(cone.vertex))
      throw OptionError("cones", name, "must be a vertex that a face uses");
    if (!(std::abs(cone.index * options.n - std::nearbyint(cone.index * options.n)) <= multiple_tolerance))
      throw OptionError("cones", std::to_string(cone.index), "must be a multiple of 1/" + std::to_string(options.n));
    account(cone);
  }

  std::vector<Cone> all = cones;
  const auto unbalanced = [&](std::size_t c) {
    return topology.components[c].boundary_loops == 0 && std::abs(lacking[c]) * options.n > 0.5;
  };
  const auto open = [&] {
    for (std::size_t c = 0; c < lacking.size(); ++c)
      if (unbalanced(c)) return true;
    return false;
  };
  if (!open()) return all;
  const std::unique_ptr<LinearSolver<double>> solver = make_linear_solver<double>({.name = options.solver});
  const SparseMatrix<double> L = grounded_laplacian(mesh, geometry, topology);
  solver->analyse(L);
  solver->factorise(L);
  while (open()) {
    MatrixX<double> b = curvature, phi(mesh.vertices(), 1);
    for (Index v = 0; v < mesh.vertices(); ++v) {
      const Index c = topology.vertex_component[static_cast<std::size_t>(v)];
      if (c == none) continue;
      b(v, 0) -= 2 * pi<double> * lacking[static_cast<std::size_t>(c)] * share[v] / area[static_cast<std::size_t>(c)];
    }
    (void)solver->solve(b, phi);
    for (std::size_t c = 0; c < lacking.size(); ++c) {
      if (!unbalanced(c)) continue;
      const double sign = lacking[c] > 0 ? 1 : -1;
      Index best = none;
      for (Index v = 0; v < mesh.vertices(); ++v)
        if (topology.vertex_component[static_cast<std::size_t>(v)] == static_cast<Index>(c) &&
            (best == none || sign * phi(v, 0) > sign * phi(best, 0)))
          best = v;
      const Cone cone{.vertex = best, .index = sign / options.n};
      const auto same = std::find_if(all.begin() + static_cast<std::ptrdiff_t>(cones.size()), all.end(),
                                     [&](const Cone& other) { return other.vertex == best; });
      if (same == all.end())
        all.push_back(cone);
      else
        same->index += cone.index;
      account(cone);
    }
  }
  return all;
}

}  // namespace alcap
