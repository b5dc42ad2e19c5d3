// SPDX-License-Identifier: MIT
#include "src/connection/face_curvature.h"

#include <algorithm>
#include <vector>

#include "alcap/solve.h"
#include "src/base/array.h"
#include "src/base/parallel.h"
#include "src/connection/grounded_laplacian.h"

namespace alcap::detail {
namespace {

// One over the cotangent weight of each edge: what a rotation along it costs in D_T.
VectorX<double> edge_weights(const Mesh& mesh, const Geometry& geometry) {
  VectorX<double> w(mesh.edges());
  parallel_for(mesh.edges(), [&](std::int64_t i) {
    const auto e = static_cast<Index>(i);
    const Index h = mesh.halfedge(e), g = mesh.twin(h);
    const double cot = geometry.cot(Mesh::prev(h)) + (g == none ? 0.0 : geometry.cot(Mesh::prev(g)));
    w[e] = 1 / std::max(least_cotangent_weight, cot / 2);
  });
  return w;
}

// The Laplacian of the faces, joined across edges; the first face of each closed component tied to the ground.
SparseMatrix<double> face_laplacian(const Mesh& mesh, const Topology& topology, const VectorX<double>& w) {
  std::vector<Eigen::Triplet<double, Index>> entries;
  entries.reserve(4 * at(mesh.edges()) + topology.components.size());
  for (Index e = 0; e < mesh.edges(); ++e) {
    const Index h = mesh.halfedge(e), g = mesh.twin(h), t = Mesh::face(h);
    entries.emplace_back(t, t, w[e]);
    if (g == none) continue;
    const Index s = Mesh::face(g);
    entries.emplace_back(s, s, w[e]);
    entries.emplace_back(t, s, -w[e]);
    entries.emplace_back(s, t, -w[e]);
  }
  for (const ComponentInfo& component : topology.components) {
    if (component.boundary_loops > 0) continue;
    const Index t = component.first_face;
    entries.emplace_back(t, t, w[mesh.edge(3 * t)]);
  }
  SparseMatrix<double> L(mesh.faces(), mesh.faces());
  L.setFromTriplets(entries.begin(), entries.end());
  return L;
}

}  // namespace

void set_face_curvature(const Mesh& mesh, const Geometry& geometry, const Topology& topology,
                        const VectorX<double>& curvature, const std::string& solver, const LiftedResiduals& residuals,
                        Connection& connection) {
  const VectorX<double> w = edge_weights(mesh, geometry);
  const SparseMatrix<double> L = face_laplacian(mesh, topology, w);
  const auto backend = make_linear_solver<double>({.name = solver});
  backend->analyse(L);
  backend->factorise(L);
  // Twice: the second solve takes away what rounding, or an iterative backend, has left.
  for (int pass = 0; pass < 2; ++pass) {
    MatrixX<double> phi = MatrixX<double>::Zero(mesh.faces(), 1);
    (void)backend->solve(MatrixX<double>(connection.K - curvature), phi);
    parallel_for(mesh.edges(), [&](std::int64_t e) {
      const Index h = mesh.halfedge(static_cast<Index>(e)), g = mesh.twin(h);
      const double delta = w[e] * (phi(Mesh::face(h), 0) - (g == none ? 0.0 : phi(Mesh::face(g), 0)));
      connection.rho[e] += delta;
      connection.eps[e] += delta;
    });
    close_faces(mesh, residuals, connection);
  }
}

}  // namespace alcap::detail
