// SPDX-License-Identifier: MIT
//
// ranks_fixture.h: a field on one machine, to which the ranks' is compared. Every rank computes it.
#pragma once

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "alcap/distributed.h"
#include "alcap/frames.h"
#include "alcap/generators.h"
#include "alcap/smoothest.h"

namespace alcap::test {

struct OneMachine {
  OneMachine(const MeshData& data, ConnectionKind kind, int n, double s = 0)
      : OneMachine(data, {.n = n, .s = s, .connection = {kind}}) {}
  OneMachine(const MeshData& data, const DistributedOptions& o) : mesh(data.F, data.V.rows()), geometry(mesh, data.V) {
    const ConnectionKind kind = o.connection.kind;
    connection = kind == ConnectionKind::polar    ? polar(mesh, geometry)
                 : kind == ConnectionKind::local  ? locally_optimal(mesh, geometry)
                 : kind == ConnectionKind::global ? globally_optimal(mesh, geometry, o.global)
                 : kind == ConnectionKind::trivial
                     ? trivial(mesh, geometry, o.cones, {.n = o.n, .loop_index = o.loop_index, .global = o.global})
                     : metric_connection(mesh, geometry, o.cones, {.loop_index = o.loop_index, .global = o.global});
    frames = vertex_frames(mesh, data.V, geometry, connection);
    found = smoothest_field(mesh, geometry, connection, nullptr, {.n = o.n, .s = o.s, .eigen = {.tolerance = 1e-9}});
    singularities = find_singularities(mesh, geometry, connection, found.field);
    topology = find_topology(mesh);
    sums = index_sums(mesh, geometry, connection, found.field, face_indices(mesh, connection, found.field), topology);
  }
  Mesh mesh;
  Geometry geometry;
  Connection connection;
  Frames frames;
  SmoothestResult found;
  std::vector<Singularity> singularities;
  Topology topology;
  std::vector<IndexSum> sums;
};

/// Meshes side by side as one.
inline MeshData side_by_side(const std::vector<MeshData>& parts) {
  Eigen::Index vertices = 0, faces = 0;
  for (const MeshData& p : parts) {
    vertices += p.V.rows();
    faces += p.F.rows();
  }
  MeshData all{Positions<double>(vertices, 3), Faces(faces, 3)};
  vertices = faces = 0;
  for (const MeshData& p : parts) {
    all.V.middleRows(vertices, p.V.rows()) = p.V;
    all.F.middleRows(faces, p.F.rows()) = p.F.array() + static_cast<Index>(vertices);
    vertices += p.V.rows();
    faces += p.F.rows();
  }
  return all;
}

/// Without the faces around some vertices: a boundary loop for each.
inline MeshData punctured(const MeshData& data, const std::vector<Index>& holes) {
  MeshData open{data.V, Faces(data.F.rows(), 3)};
  Eigen::Index kept = 0;
  for (Eigen::Index t = 0; t < data.F.rows(); ++t) {
    bool hit = false;
    for (const Index v : holes) hit = hit || (data.F.row(t).array() == v).any();
    if (!hit) open.F.row(kept++) = data.F.row(t);
  }
  open.F.conservativeResize(kept, 3);
  return open;
}

/// Everything that does not depend on which vector of a cluster was found.
inline void check_alike(const OneMachine& one, const DistributedField& all) {
  CHECK(all.connection.converged);
  CHECK(all.connection.D_T == doctest::Approx(one.connection.report.D_T).epsilon(1e-10));
  CHECK(all.connection.D_E == doctest::Approx(one.connection.report.D_E).epsilon(1e-10));
  REQUIRE(all.components.size() == one.topology.components.size());
  for (std::size_t k = 0; k < all.components.size(); ++k) {
    CAPTURE(k);
    const DistributedComponent& c = all.components[k];
    const ComponentInfo& info = one.topology.components[k];
    CHECK(c.vertices == info.vertices);
    CHECK(c.edges == info.edges);
    CHECK(c.faces == info.faces);
    CHECK(c.first_face == info.first_face);
    CHECK(c.euler == info.euler);
    CHECK(c.boundary_loops == info.boundary_loops);
    CHECK(c.eigen.converged);
    CHECK(c.eigen.residual <= 1e-9);
    const double lambda = one.found.components[k].lambda;
    CHECK(std::abs(c.eigen.lambda - lambda) <= 1e-8 * std::max(lambda, 1 / c.area));
    CHECK(c.indices.sum == c.indices.expected);
  }
}

/// Where every first eigenvalue is simple: the same field at this rank's slice, and the same singularities.
inline void check_same_field(const OneMachine& one, const MeshSlice& slice, const DistributedField& all) {
  const auto rows = all.u.size();
  const ComplexVectorX<double> u = one.found.field.u.segment(slice.first_vertex, rows);
  const double size = one.found.field.u.cwiseAbs().maxCoeff();
  CHECK((rows == 0 || (all.u - u).cwiseAbs().maxCoeff() <= 1e-5 * size));
  CHECK((rows == 0 || (all.frames.X - one.frames.X.middleRows(slice.first_vertex, rows)).cwiseAbs().maxCoeff() < 1e-8));
  CHECK(
      (rows == 0 || (all.frames.N - one.frames.N.middleRows(slice.first_vertex, rows)).cwiseAbs().maxCoeff() < 1e-12));
  REQUIRE(all.singularities.size() == one.singularities.size());
  for (std::size_t k = 0; k < all.singularities.size(); ++k) {
    const Singularity &a = all.singularities[k], &b = one.singularities[k];
    CHECK(a.face == b.face);
    CHECK(a.index == b.index);
    CHECK(a.located == b.located);
    for (std::size_t c = 0; c < 3; ++c) CHECK(std::abs(a.barycentric[c] - b.barycentric[c]) < 1e-4);
  }
}

}  // namespace alcap::test
