// SPDX-License-Identifier: MIT
//
// connection.cpp: polar and locally optimal connections (LTGD 2016, Secs. 5.1 and 5.2) and the shared construction.
#include "alcap/connection.h"

#include "src/base/parallel.h"

namespace alcap {
namespace detail {
namespace {

// Angle between halfedge 'corner' and the direction from its tail to the barycenter of the face.
double barycenter_angle(const Mesh& mesh, const Geometry& geometry, Index corner) {
  const double first = geometry.length(mesh.edge(corner));
  const double second = geometry.length(mesh.edge(Mesh::prev(corner)));
  const double angle = geometry.angle(corner);
  return std::atan2(second * std::sin(angle), first + second * std::cos(angle));
}

// tau = eps - start + end and K = -(sum of tau) over each face.
void close_faces(const Mesh& mesh, const LiftedResiduals& r, Connection& c) {
  c.tau.resize(mesh.halfedges());
  c.K.resize(mesh.faces());
  parallel_for(mesh.faces(), [&](std::int64_t t) {
    double sum = 0;
    for (Index h = static_cast<Index>(3 * t); h < 3 * t + 3; ++h) {
      c.tau[h] = c.eps_along(mesh, h) - r.start[h] + r.end[h];
      sum += c.tau[h];
    }
    c.K[t] = -sum;
  });
}

}  // namespace

Connection build_connection(const Mesh& mesh, const Geometry& geometry, const VectorX<double>& vertex_curvature,
                            const VectorX<double>& alpha, PolarCenter center, LiftedResiduals& residuals) {
  const bool trivial = alpha.size() != 0;
  const auto alpha_of = [&](Index h) { return trivial ? alpha[h] : double(0); };

  Connection c;
  c.alpha = alpha;
  c.rho.resize(mesh.edges());
  c.rho_e.resize(2 * std::int64_t{mesh.edges()});
  c.rho_t.resize(mesh.halfedges());
  c.eps.resize(mesh.edges());
  residuals.start.resize(mesh.halfedges());
  residuals.end.resize(mesh.halfedges());

  // Walk around each vertex: directions of edges and faces in its frame.
  parallel_for(mesh.vertices(), [&](std::int64_t i) {
    const Index v = static_cast<Index>(i);
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
  });
  parallel_for(mesh.edges(), [&](std::int64_t e) {
    c.rho[e] = wrap(c.rho_e[2 * e] - c.rho_e[2 * e + 1]);
    c.eps[e] = 0;
  });
  close_faces(mesh, residuals, c);
  return c;
}

void optimise_locally(const Mesh& mesh, Connection& c, LiftedResiduals& r) {
  // Fixing each corner in turn makes all tau equal -K/3 (LTGD 2016, eq. 13); the mean of the three solutions turns
  // corner i by (tau_ij - tau_ki) / 3.
  parallel_for(mesh.faces(), [&](std::int64_t t) {
    const Index h = static_cast<Index>(3 * t);
    const double tau[3] = {c.tau[h], c.tau[h + 1], c.tau[h + 2]};
    for (Index k = 0; k < 3; ++k) {
      const double turn = (tau[k] - tau[(k + 2) % 3]) / 3;
      c.rho_t[h + k] += turn;
      r.start[h + k] += turn;
      r.end[h + (k + 2) % 3] += turn;
    }
  });
  close_faces(mesh, r, c);
}

}  // namespace detail

namespace {

VectorX<double> angle_defects(const Mesh& mesh, const Geometry& geometry) {
  VectorX<double> defects(mesh.vertices());
  parallel_for(mesh.vertices(), [&](std::int64_t v) { defects[v] = geometry.defect(mesh, static_cast<Index>(v)); });
  return defects;
}

Connection levi_civita_start(const Mesh& mesh, const Geometry& geometry, PolarCenter center,
                             detail::LiftedResiduals& residuals) {
  return detail::build_connection(mesh, geometry, angle_defects(mesh, geometry), {}, center, residuals);
}

}  // namespace

Connection polar(const Mesh& mesh, const Geometry& geometry, const PolarOptions& options) {
  detail::LiftedResiduals residuals;
  Connection c = levi_civita_start(mesh, geometry, options.center, residuals);
  c.kind = ConnectionKind::polar;
  measure_deviation(mesh, geometry, {}, c);
  return c;
}

Connection locally_optimal(const Mesh& mesh, const Geometry& geometry) {
  detail::LiftedResiduals residuals;
  Connection c = levi_civita_start(mesh, geometry, PolarCenter::incenter, residuals);
  detail::optimise_locally(mesh, c, residuals);
  c.kind = ConnectionKind::local;
  measure_deviation(mesh, geometry, {}, c);
  return c;
}

Connection globally_optimal(const Mesh& mesh, const Geometry& geometry, const GlobalOptions& options) {
  detail::LiftedResiduals residuals;
  Connection c = levi_civita_start(mesh, geometry, PolarCenter::incenter, residuals);
  detail::optimise_globally(mesh, geometry, options, false, c, residuals);
  c.kind = ConnectionKind::global;
  return c;
}

}  // namespace alcap
