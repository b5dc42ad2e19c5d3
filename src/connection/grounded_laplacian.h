// SPDX-License-Identifier: MIT
//
// grounded_laplacian.h: the cotangent Laplacian made definite. Internal to connections and cones.
#pragma once

#include <algorithm>
#include <vector>

#include "alcap/geometry.h"
#include "alcap/mesh.h"
#include "alcap/solve.h"
#include "alcap/topology.h"
#include "src/base/array.h"

namespace alcap::detail {

/// Cotangent weights, of order 1, are raised to this where angles are obtuse: any positive weight gives a definite
/// matrix and a valid connection.
inline constexpr double least_cotangent_weight = 1e-3;

/// The cotangent weight of edge e, raised.
[[nodiscard]] inline double raised_weight(const Mesh& mesh, const Geometry& geometry, Index e) {
  const Index h = mesh.halfedge(e), g = mesh.twin(h);
  double w = geometry.cot(Mesh::prev(h)) / 2;
  if (g != none) w += geometry.cot(Mesh::prev(g)) / 2;
  return std::max(w, least_cotangent_weight);
}

/// Cotangent Laplacian, #V x #V, one vertex of each component tied to the ground, ones for unreferenced vertices.
[[nodiscard]] inline SparseMatrix<double> grounded_laplacian(const Mesh& mesh, const Geometry& geometry,
                                                             const Topology& topology) {
  std::vector<Eigen::Triplet<double, Index>> entries;
  entries.reserve(4 * at(mesh.edges()) + at(mesh.vertices()));
  std::vector<double> largest(topology.components.size(), 0);
  for (Index e = 0; e < mesh.edges(); ++e) {
    const Index h = mesh.halfedge(e), i = mesh.tail(h), j = mesh.tip(h);
    const double w = raised_weight(mesh, geometry, e);
    entries.emplace_back(i, i, w);
    entries.emplace_back(j, j, w);
    entries.emplace_back(i, j, -w);
    entries.emplace_back(j, i, -w);
    double& most = largest[at(topology.vertex_component[at(i)])];
    most = std::max(most, w);
  }
  std::vector<bool> grounded(topology.components.size(), false);
  for (Index v = 0; v < mesh.vertices(); ++v) {
    const Index c = topology.vertex_component[at(v)];
    if (c == none) {
      entries.emplace_back(v, v, 1.0);
    } else if (!grounded[at(c)]) {
      entries.emplace_back(v, v, largest[at(c)]);
      grounded[at(c)] = true;
    }
  }
  SparseMatrix<double> L(mesh.vertices(), mesh.vertices());
  L.setFromTriplets(entries.begin(), entries.end());
  return L;
}

}  // namespace alcap::detail
