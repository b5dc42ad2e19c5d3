// SPDX-License-Identifier: MIT
#include "alcap/transport.h"

#include <cmath>
#include <optional>
#include <string>

#include "src/base/cancel.h"
#include "src/connection/edge_to_face.h"
#include "src/mesh/surface_points.h"

namespace alcap {
namespace {

// How far apart, in barycentric coordinates, the end of a segment and the start of the next one may be.
constexpr double same_point = 1e-6;

Transported carried(Complex<double> z, int n, double turn, double turn_from_path) {
  return {z * std::polar(1.0, n * turn), turn, turn_from_path};
}

/// What the connection has along an edge, in the direction of travel.
struct EdgeRotations {
  double rho, eps, start, end;
};

EdgeRotations rotations(const Mesh& mesh, const Connection& c, Index from, Index to) {
  const Index e = mesh.edge(from, to);
  if (e == none)
    throw OptionError("vertices", std::to_string(from) + " and " + std::to_string(to),
                      "no edge joins these vertices; shortest_path() finds the vertices between them");
  const double near = c.rho_e[2 * std::int64_t{e}], far = c.rho_e[2 * std::int64_t{e} + 1];
  if (mesh.tail(mesh.halfedge(e)) == from) return {c.rho[e], c.eps[e], near, far};
  return {-c.rho[e], -c.eps[e], far - pi<double>, near - pi<double>};
}

// How far components turn along a segment (LTGD 2016, Sec. 4.3): minus the integral of sum tau_ij (phi_i dphi_j - phi_j
// dphi_i), whose integrand is constant along a straight line.
double along(const Connection& connection, const SurfaceSegment& s) {
  double turn = 0;
  for (Index c = 0; c < 3; ++c) {
    const auto i = static_cast<std::size_t>(c), j = static_cast<std::size_t>((c + 1) % 3);
    turn -= connection.tau[3 * s.face + c] * (s.a[i] * s.b[j] - s.a[j] * s.b[i]);
  }
  return turn;
}

bool near(double a, double b) { return std::abs(a - b) <= same_point; }

bool same_coordinates(const SurfacePoint& p, const SurfacePoint& q) {
  return near(p.barycentric[0], q.barycentric[0]) && near(p.barycentric[1], q.barycentric[1]) &&
         near(p.barycentric[2], q.barycentric[2]);
}

/// How far components turn from one face into another, by the connection and, what the corner of a path there is
/// measured with, by unfolding (at a vertex by the connection too). Their difference is small and needs no modulus.
struct Joint {
  double turn = 0, unfolded = 0;
};

// From the face of p into that of q; nothing unless p and q are the same point of the surface.
std::optional<Joint> between(const ConnectedSurface& surface, const SurfacePoint& p, const SurfacePoint& q) {
  if (p.face == q.face) return same_coordinates(p, q) ? std::optional(Joint{}) : std::nullopt;
  const Mesh& mesh = surface.mesh();
  const Geometry& geometry = surface.geometry();
  const Connection& connection = surface.connection();
  for (Index h = 3 * p.face; h < 3 * p.face + 3; ++h) {
    const Index g = mesh.twin(h);
    if (g == none || Mesh::face(g) != q.face) continue;
    const double s = p.barycentric[static_cast<std::size_t>(Mesh::next(h) % 3)];
    if (same_coordinates(p, detail::on_halfedge(h, s)) && same_coordinates(q, detail::on_halfedge(g, 1 - s)))
      return Joint{pi<double> + detail::edge_to_face_at(mesh, connection, h, s) -
                       detail::edge_to_face_at(mesh, connection, g, 1 - s),
                   pi<double> - geometry.direction(h) + geometry.direction(g)};
  }
  for (Index h = 3 * p.face; h < 3 * p.face + 3; ++h)
    for (Index g = 3 * q.face; g < 3 * q.face + 3; ++g)
      if (mesh.tail(h) == mesh.tail(g) && same_coordinates(p, detail::on_halfedge(h, 0)) &&
          same_coordinates(q, detail::on_halfedge(g, 0)))
        return Joint{connection.rho_t[h] - connection.rho_t[g], connection.rho_t[h] - connection.rho_t[g]};
  return std::nullopt;
}

}  // namespace

Transported transport(const ConnectedSurface& surface, const std::vector<Index>& vertices, Complex<double> z, int n) {
  if (vertices.empty()) throw OptionError("vertices", "none", "a path has at least one vertex");
  const Mesh& mesh = surface.mesh();
  for (const Index v : vertices) mesh.check_vertex("vertices", v);
  double turn = 0, turn_from_path = 0;
  std::optional<EdgeRotations> first, last;
  const auto corner = [&](const EdgeRotations& in, const EdgeRotations& out) {
    turn_from_path -= wrap(out.start - in.end);
  };
  for (std::size_t k = 0; k + 1 < vertices.size(); ++k) {
    detail::check_cancelled_at(static_cast<std::int64_t>(k));
    if (vertices[k] == vertices[k + 1]) continue;
    const EdgeRotations edge = rotations(mesh, surface.connection(), vertices[k], vertices[k + 1]);
    if (last) corner(*last, edge);
    turn -= edge.rho;
    turn_from_path -= edge.eps;
    if (!first) first = edge;
    last = edge;
  }
  if (first && vertices.front() == vertices.back()) corner(*last, *first);
  return carried(z, n, turn, turn_from_path);
}

Transported transport(const ConnectedSurface& surface, const SurfacePolyline& path, Complex<double> z, int n) {
  const auto& segments = path.segments;
  if (segments.empty()) throw OptionError("path.segments", "none", "a path has at least one segment");
  const Mesh& mesh = surface.mesh();
  const auto name = [](std::size_t k) { return "path.segments[" + std::to_string(k) + "]"; };
  for (std::size_t k = 0; k < segments.size(); ++k)
    if (segments[k].face < 0 || segments[k].face >= mesh.faces())
      throw OptionError(name(k) + ".face", segments[k].face,
                        "there is no such face; the mesh has " + std::to_string(mesh.faces()));
  double turn = 0, turn_from_path = 0;
  for (std::size_t k = 0; k < segments.size(); ++k) {
    detail::check_cancelled_at(static_cast<std::int64_t>(k));
    const SurfaceSegment& here = segments[k];
    const double inside = along(surface.connection(), here);
    turn += inside;
    turn_from_path += inside;
    if (k + 1 == segments.size() && !path.closed) break;
    const std::size_t after = (k + 1) % segments.size();
    const SurfaceSegment& next = segments[after];
    const auto joint = between(surface, {here.face, here.b}, {next.face, next.a});
    if (!joint)
      throw OptionError(name(after), "face " + std::to_string(next.face), "does not start where the one before ends");
    turn += joint->turn;
    turn_from_path += joint->turn - joint->unfolded;
    turn_from_path -= wrap(std::arg(next.tangent) - std::arg(here.tangent) - joint->unfolded);
  }
  return carried(z, n, turn, turn_from_path);
}

Transported transport(const ConnectedSurface& surface, std::span<const SurfacePoint> points, Complex<double> z, int n) {
  const SurfacePolyline path = polyline_through(surface, {points.begin(), points.end()});
  const Mesh& mesh = surface.mesh();
  const SurfacePoint first = detail::checked_point(mesh, points.front(), 0);
  const SurfacePoint last = detail::checked_point(mesh, points.back(), points.size() - 1);
  // The same point of the surface in both: nothing can go wrong.
  const auto change = [&](const SurfacePoint& p, const SurfacePoint& q) {
    const auto joint = between(surface, p, q);
    return joint ? joint->turn : 0.0;
  };
  if (path.segments.empty()) return carried(z, n, change(first, last), 0);
  const SurfaceSegment &start = path.segments.front(), &end = path.segments.back();
  const Transported inside = transport(surface, path, 1.0, n);
  const double into = change(first, {start.face, start.a});
  const double out = path.closed ? change({start.face, start.a}, last) : change({end.face, end.b}, last);
  return carried(z, n, into + inside.turn + out, inside.turn_from_path);
}

}  // namespace alcap
