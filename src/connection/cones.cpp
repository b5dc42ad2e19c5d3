// SPDX-License-Identifier: MIT
#include "alcap/cones.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "alcap/solve.h"
#include "alcap/topology.h"
#include "src/connection/grounded_laplacian.h"

namespace alcap {
namespace {

using Vector = VectorX<double>;

constexpr double multiple_tolerance = 1e-6;

}  // namespace

std::vector<Cone> balance_cones(const Mesh& mesh, const Geometry& geometry, const std::vector<Cone>& cones,
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
  const SparseMatrix<double> L = detail::grounded_laplacian(mesh, geometry, topology);
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
