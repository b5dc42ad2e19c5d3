// SPDX-License-Identifier: MIT
//
// construction.cpp: directions of edges and faces in the frames of vertices, by a walk around each vertex.
#include "src/connection/construction.h"

#include "src/base/pages.h"
#include "src/base/parallel.h"

namespace alcap::detail {
namespace {

// Angle between halfedge 'corner' and the direction from its tail to the barycenter of the face.
double barycenter_angle(const Mesh& mesh, const Geometry& geometry, Index corner) {
  const double first = geometry.length(mesh.edge(corner));
  const double second = geometry.length(mesh.edge(Mesh::prev(corner)));
  const double angle = geometry.angle(corner);
  return std::atan2(second * std::sin(angle), first + second * std::cos(angle));
}

// The directions of edges and faces in the frame of vertex v, and the residuals at its corners (LTGD 2016, eqs. 6, 11
// and 12).
void walk_around(const Mesh& mesh, const Geometry& geometry, const VectorX<double>& vertex_curvature,
                 PolarCenter center, Index v, Connection& c, LiftedResiduals& residuals) {
  const bool trivial = c.alpha.size() != 0;
  const auto alpha_of = [&](Index h) { return trivial ? c.alpha[h] : double(0); };
  const bool boundary = mesh.boundary_vertex(v);
  double direction = 0;
  Index last = none;
  mesh.for_each_outgoing(v, [&](Index h) {
    const std::int64_t e = mesh.edge(h);
    if (mesh.halfedge(mesh.edge(h)) == h)
      c.rho_e[2 * e] = direction;
    else
      c.rho_e[2 * e + 1] = direction + pi<double>;
    const Index p = Mesh::prev(h);
    const double angle = geometry.angle(h);
    const double excess = boundary ? double(0) : vertex_curvature[v] * angle / geometry.angle_sum(v);
    const double seen = angle + alpha_of(h) - alpha_of(p);
    // The face's direction lies between its two edges: in the middle of the scaled corner on one side, at `inside`
    // on the other. Both residuals follow without a modulus.
    const double inside = center == PolarCenter::incenter ? angle / 2 : barycenter_angle(mesh, geometry, h);
    residuals.start[h] = excess / 2 + (angle / 2 - inside);
    residuals.end[p] = residuals.start[h] - excess;
    c.rho_t[h] = direction + residuals.start[h] + alpha_of(h) - geometry.direction(h);
    direction += seen + excess;
    last = p;
  });
  if (boundary) c.rho_e[2 * std::int64_t{mesh.edge(last)} + 1] = direction + pi<double>;
}

VectorX<double> angle_defects(const Mesh& mesh, const Geometry& geometry) {
  VectorX<double> defects(mesh.vertices());
  parallel_for(mesh.vertices(), [&](std::int64_t v) { defects[v] = geometry.defect(mesh, static_cast<Index>(v)); });
  return defects;
}

}  // namespace

Connection build_connection(const Mesh& mesh, const Geometry& geometry, const VectorX<double>& vertex_curvature,
                            const VectorX<double>& alpha, PolarCenter center, LiftedResiduals& residuals) {
  Connection c;
  c.alpha = alpha;
  resize_unset(c.rho, mesh.edges());
  resize_unset(c.rho_e, 2 * std::int64_t{mesh.edges()});
  resize_unset(c.rho_t, mesh.halfedges());
  resize_unset(c.eps, mesh.edges());
  resize_unset(residuals.start, mesh.halfedges());
  resize_unset(residuals.end, mesh.halfedges());
  parallel_for(mesh.vertices(), [&](std::int64_t v) {
    walk_around(mesh, geometry, vertex_curvature, center, static_cast<Index>(v), c, residuals);
  });
  // eps = 0: rho_ij is what the directions of the edge at both ends say (LTGD 2016, Sec. 5.1).
  parallel_for(mesh.edges(), [&](std::int64_t e) {
    c.rho[e] = wrap(c.rho_e[2 * e] - c.rho_e[2 * e + 1]);
    c.eps[e] = 0;
  });
  close_faces(mesh, residuals, c);
  return c;
}

Connection polar_start(const Mesh& mesh, const Geometry& geometry, PolarCenter center, LiftedResiduals& residuals) {
  return build_connection(mesh, geometry, angle_defects(mesh, geometry), {}, center, residuals);
}

void close_faces(const Mesh& mesh, const LiftedResiduals& r, Connection& c) {
  resize_unset(c.tau, mesh.halfedges());
  resize_unset(c.K, mesh.faces());
  parallel_for(mesh.faces(), [&](std::int64_t t) {
    double sum = 0;
    for (Index h = static_cast<Index>(3 * t); h < 3 * t + 3; ++h) {
      c.tau[h] = c.eps_along(mesh, h) - r.start[h] + r.end[h];
      sum += c.tau[h];
    }
    c.K[t] = -sum;
  });
}

}  // namespace alcap::detail
