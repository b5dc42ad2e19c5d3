// SPDX-License-Identifier: MIT
#include "alcap/alignment.h"

#include <Eigen/Geometry>
#include <cmath>
#include <string>

#include "alcap/connected_surface.h"
#include "src/base/parallel.h"
#include "src/field/curvature_means.h"

namespace alcap {
namespace {

using C = Complex<double>;
using Row = Eigen::RowVector3d;

Row normal_of(const Mesh& mesh, const Positions<double>& V, Index t) {
  const Row a = V.row(mesh.F()(t, 0));
  return (V.row(mesh.F()(t, 1)) - a).cross(V.row(mesh.F()(t, 2)) - a).normalized();
}

// Angle between the normals on both sides of h, positive on convex edges.
double dihedral(const Mesh& mesh, const Positions<double>& V, Index h) {
  const Row m = normal_of(mesh, V, Mesh::face(h)), n = normal_of(mesh, V, Mesh::face(mesh.twin(h)));
  const Row along = (V.row(mesh.tip(h)) - V.row(mesh.tail(h))).normalized();
  return std::atan2(m.cross(n).dot(along), m.dot(n));
}

double third_of_faces(const Mesh& mesh, const Geometry& geometry, Index v) {
  double area = 0;
  mesh.for_each_outgoing(v, [&](Index h) { area += geometry.area(Mesh::face(h)) / 3; });
  return area;
}

}  // namespace

namespace detail {

void check_curvature_options(const CurvatureOptions& options) {
  if (options.n < 2 || options.n % 2 != 0)
    throw OptionError("n", options.n, "principal directions are lines: n must be even");
  if (options.rings < 0) throw OptionError("rings", options.rings, "must not be negative");
}

CurvatureMeans curvature_at_vertices(const Mesh& mesh, const Positions<double>& V, const Geometry& geometry,
                                     const Connection& connection) {
  const Index count = mesh.vertices();
  VectorX<double> bending(mesh.edges());
  CurvatureMeans means{VectorX<double>(count), ComplexVectorX<double>(count), VectorX<double>::Zero(count)};
  parallel_for(mesh.edges(), [&](std::int64_t e) {
    const Index h = mesh.halfedge(static_cast<Index>(e));
    bending[e] = mesh.boundary_halfedge(h) ? 0.0 : dihedral(mesh, V, h) * geometry.length(static_cast<Index>(e));
  });
  // The tensor of an edge is bending (x x') for x across it; half of it belongs to each end, and half of its square
  // x^2 is what is left without the trace. Its integral over a vertex's share is divided by that share.
  parallel_for(count, [&](std::int64_t i) {
    const auto v = static_cast<Index>(i);
    means.area[v] = third_of_faces(mesh, geometry, v);
    C sum = 0;
    const auto add = [&](Index e, double angle) { sum -= bending[e] / 4 * std::polar(1.0, 2 * angle); };
    mesh.for_each_outgoing(v, [&](Index h) {
      add(mesh.edge(h), connection.rho_start(mesh, h));
      means.mean[v] += bending[mesh.edge(h)];
    });
    means.q[v] = means.area[v] > 0 ? sum / means.area[v] : C(0);
  });
  return means;
}

void average_over_ring(const Mesh& mesh, const Connection& connection, CurvatureMeans& means) {
  const auto transported = [&](Index h, double sign) {
    return std::polar(1.0, sign * 2 * connection.rho_along(mesh, h));
  };
  const ComplexVectorX<double> before = means.q;
  const VectorX<double> mean_before = means.mean;
  parallel_for(mesh.vertices(), [&](std::int64_t i) {
    const auto v = static_cast<Index>(i);
    C sum = means.area[v] * before[v];
    double weight = means.area[v];
    const auto add = [&](Index other, C phase) {
      sum += means.area[other] * phase * before[other];
      means.mean[v] += mean_before[other];
      weight += means.area[other];
    };
    mesh.for_each_outgoing(v, [&](Index h) {
      add(mesh.tip(h), transported(h, 1));
      const Index back = Mesh::prev(h);
      if (mesh.boundary_halfedge(back)) add(mesh.tail(back), transported(back, -1));
    });
    means.q[v] = weight > 0 ? sum / weight : C(0);
  });
}

ComplexVectorX<double> curvature_components(const CurvatureMeans& means, const CurvatureOptions& options) {
  ComplexVectorX<double> u(means.q.size());
  const int turns = options.n / 2;
  const double offset = options.smallest ? turns * pi<double> : 0.0;
  for (Eigen::Index v = 0; v < u.size(); ++v) {
    const double other = options.by_magnitude && means.mean[v] < 0 ? turns * pi<double> : 0.0;
    u[v] = std::polar(std::abs(means.q[v]), turns * std::arg(means.q[v]) + offset + other);
  }
  return u;
}

}  // namespace detail

Field curvature_field(const ConnectedSurface& surface, const CurvatureOptions& options) {
  detail::check_curvature_options(options);
  const Positions<double>& V = surface.positions();
  const Mesh& mesh = surface.mesh();
  detail::CurvatureMeans means = detail::curvature_at_vertices(mesh, V, surface.geometry(), surface.connection());
  for (int ring = 0; ring < options.rings; ++ring) detail::average_over_ring(mesh, surface.connection(), means);
  return {.n = options.n, .u = detail::curvature_components(means, options), .frames = surface.frames()};
}

double root_mean_square(const Mesh& mesh, const Geometry& geometry, const ComplexVectorX<double>& u) {
  double sum = 0;
  for (Index t = 0; t < mesh.faces(); ++t)
    for (Index c = 0; c < 3; ++c) sum += geometry.area(t) / 3 * std::norm(u[mesh.F()(t, c)]);
  return std::sqrt(sum / geometry.total_area());
}

}  // namespace alcap
