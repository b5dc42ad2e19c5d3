// SPDX-License-Identifier: MIT
#include "alcap/surface_path.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "src/base/array.h"
#include "src/base/cancel.h"
#include "src/mesh/position.h"
#include "src/mesh/surface_points.h"

namespace alcap {
namespace detail {
namespace {

// Coordinates below this are zero: the point is put on the edge or the vertex.
constexpr double on_edge = 1e-9;
// Segments shorter than this, relative to their face, are rounding.
constexpr double no_length = 1e-12;

/// The vector from a to b in the frame of face t.
Complex<double> difference(const Geometry& geometry, const Mesh& mesh, Index t, const std::array<double, 3>& a,
                           const std::array<double, 3>& b) {
  const double l = geometry.length(mesh.edge(3 * t)), m = geometry.length(mesh.edge(3 * t + 2));
  return (b[1] - a[1]) * Complex<double>(l) + (b[2] - a[2]) * std::polar(m, geometry.angle(3 * t));
}

/// The segment from p to q in a face that holds both: that of q where it does, or that of p.
bool join(const Surface& surface, const SurfacePoint& p, const SurfacePoint& q, SurfacePolyline& line) {
  const Mesh& mesh = surface.mesh();
  const auto try_face = [&](const SurfacePoint& a, const SurfacePoint& b) {
    if (a.face != b.face) return false;
    append_segment(line, mesh, surface.geometry(), a.face, a.barycentric, b.barycentric);
    return true;
  };
  const std::vector<SurfacePoint> starts = representations(mesh, p), ends = representations(mesh, q);
  for (const SurfacePoint& a : starts)
    if (try_face(a, q)) return true;
  for (const SurfacePoint& a : starts)
    for (const SurfacePoint& b : ends)
      if (try_face(a, b)) return true;
  return false;
}

}  // namespace

SurfacePoint checked_point(const Mesh& mesh, const SurfacePoint& p, std::size_t k) {
  const auto name = [&] { return "points[" + std::to_string(k) + "]"; };
  if (p.face < 0 || p.face >= mesh.faces())
    throw OptionError(name(), p.face, "there is no such face; the mesh has " + std::to_string(mesh.faces()));
  SurfacePoint q = p;
  double sum = 0;
  for (double& b : q.barycentric) {
    if (!(b >= -1e-6 && b <= 1 + 1e-6))
      throw OptionError(name(), b, "barycentric coordinates are not negative and sum to 1");
    sum += b;
    if (b < on_edge) b = 0;
  }
  if (!(std::abs(sum - 1) <= 1e-6))
    throw OptionError(name(), sum, "barycentric coordinates are not negative and sum to 1");
  sum = q.barycentric[0] + q.barycentric[1] + q.barycentric[2];
  for (double& b : q.barycentric) b /= sum;
  return q;
}

std::vector<SurfacePoint> representations(const Mesh& mesh, const SurfacePoint& p) {
  std::vector<SurfacePoint> all{p};
  const auto zero = [&](Index c) { return p.barycentric[detail::at(c % 3)] == 0; };
  for (Index c = 0; c < 3; ++c) {
    if (zero(c + 1) && zero(c + 2)) {
      const Index v = mesh.F()(p.face, c);
      mesh.for_each_outgoing(v, [&](Index h) {
        if (h / 3 != p.face) all.push_back(on_halfedge(h, 0));
      });
      return all;
    }
  }
  for (Index c = 0; c < 3; ++c) {
    const Index h = 3 * p.face + c, g = mesh.twin(h);
    if (!zero(c + 2) || g == none) continue;
    SurfacePoint q{g / 3, {}};
    q.barycentric[detail::at(Mesh::next(g) % 3)] = p.barycentric[detail::at(c)];
    q.barycentric[detail::at(g % 3)] = p.barycentric[detail::at(Mesh::next(h) % 3)];
    all.push_back(q);
  }
  return all;
}

bool same_point(const Mesh& mesh, const SurfacePoint& p, const SurfacePoint& q) {
  for (const SurfacePoint& r : representations(mesh, p))
    if (r.face == q.face && std::abs(r.barycentric[0] - q.barycentric[0]) <= no_length &&
        std::abs(r.barycentric[1] - q.barycentric[1]) <= no_length &&
        std::abs(r.barycentric[2] - q.barycentric[2]) <= no_length)
      return true;
  return false;
}

void append_segment(SurfacePolyline& line, const Mesh& mesh, const Geometry& geometry, Index t,
                    const std::array<double, 3>& a, const std::array<double, 3>& b) {
  const Complex<double> d = difference(geometry, mesh, t, a, b);
  const double length = std::abs(d);
  if (!(length > no_length * std::sqrt(geometry.area(t)))) return;
  line.segments.push_back({t, a, b, d / length, length});
}

}  // namespace detail

double SurfacePolyline::length() const {
  double sum = 0;
  for (const SurfaceSegment& s : segments) sum += s.length;
  return sum;
}

SurfacePolyline SurfacePolyline::reversed() const {
  SurfacePolyline out{segments, closed};
  std::reverse(out.segments.begin(), out.segments.end());
  for (SurfaceSegment& s : out.segments) {
    std::swap(s.a, s.b);
    s.tangent = -s.tangent;
  }
  return out;
}

Eigen::RowVector3d position(const Surface& surface, const SurfacePoint& point) {
  const Positions<double>& positions = surface.positions();
  const Index faces = surface.mesh().faces();
  if (point.face < 0 || point.face >= faces)
    throw OptionError("point.face", point.face, "there is no such face; the mesh has " + std::to_string(faces));
  return detail::position(surface.mesh(), positions, point);
}

SurfacePolyline polyline_through(const Surface& surface, const std::vector<SurfacePoint>& points) {
  if (points.empty()) throw OptionError("points", "none", "a path has at least one point");
  const Mesh& mesh = surface.mesh();
  SurfacePolyline line;
  const SurfacePoint first = detail::checked_point(mesh, points[0], 0);
  SurfacePoint here = first;
  for (std::size_t k = 1; k < points.size(); ++k) {
    detail::check_cancelled_at(static_cast<std::int64_t>(k));
    const SurfacePoint next = detail::checked_point(mesh, points[k], k);
    if (!detail::join(surface, here, next, line))
      throw OptionError("points", std::to_string(k - 1) + " and " + std::to_string(k),
                        "no face holds both points; stroke_through_points() finds those between");
    here = next;
  }
  line.closed = line.segments.size() > 1 && detail::same_point(mesh, first, here);
  return line;
}

}  // namespace alcap
