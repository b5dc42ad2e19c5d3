// SPDX-License-Identifier: MIT
//
// design_file_place.cpp: a design on a mesh: nearest faces and vertices, directions of space as angles in frames, and
// the designer's controls.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "alcap/design_file.h"
#include "alcap/errors.h"
#include "src/design_file_problem.h"

namespace alcap {
namespace {

using Row = Eigen::RowVector3d;

constexpr double degree = pi<double> / 180;
// A direction whose tangential part is smaller than this, relative to its length, says nothing.
constexpr double tangential = 1e-6;

Row row(const Vector3& x) { return {x[0], x[1], x[2]}; }

/// The point of the triangle a, b, c nearest to p, in barycentric coordinates: the projection to the plane where it
/// falls inside, else the best of the three sides.
std::array<double, 3> nearest(const Row& p, const Row (&corner)[3]) {
  const Row u = corner[1] - corner[0], v = corner[2] - corner[0], d = p - corner[0];
  const double uu = u.dot(u), uv = u.dot(v), vv = v.dot(v), du = d.dot(u), dv = d.dot(v);
  const double det = uu * vv - uv * uv;
  const double s = (vv * du - uv * dv) / det, t = (uu * dv - uv * du) / det;
  if (s >= 0 && t >= 0 && s + t <= 1) return {1 - s - t, s, t};
  std::array<double, 3> best{1, 0, 0};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    const Row side = corner[next] - corner[k];
    const double x = std::clamp((p - corner[k]).dot(side) / side.squaredNorm(), 0.0, 1.0);
    const double distance = (p - corner[k] - x * side).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    best = {};
    best[k] = 1 - x;
    best[next] = x;
  }
  return best;
}

SurfacePoint nearest_point(const Mesh& mesh, const Positions<double>& V, const Vector3& at) {
  const Row p = row(at);
  SurfacePoint best;
  double least = std::numeric_limits<double>::infinity();
  for (Index t = 0; t < mesh.faces(); ++t) {
    const Row corner[3] = {V.row(mesh.F()(t, 0)), V.row(mesh.F()(t, 1)), V.row(mesh.F()(t, 2))};
    const std::array<double, 3> b = nearest(p, corner);
    const double distance = (p - b[0] * corner[0] - b[1] * corner[1] - b[2] * corner[2]).squaredNorm();
    if (!(distance < least)) continue;
    least = distance;
    best = {t, b};
  }
  return best;
}

Index nearest_vertex(const Mesh& mesh, const Positions<double>& V, const Vector3& at) {
  Index best = none;
  double least = std::numeric_limits<double>::infinity();
  for (Index v = 0; v < mesh.vertices(); ++v) {
    const double distance = (V.row(v) - row(at)).squaredNorm();
    if (!mesh.referenced(v) || !(distance < least)) continue;
    least = distance;
    best = v;
  }
  return best;
}

/// The argument of a component; the direction is named when it is (nearly) normal to the surface.
double direction(const std::string& path, const Vector3& given, Complex<double> component) {
  if (!(std::abs(component) > tangential * row(given).norm()))
    throw OptionError(path,
                      "[" + detail::number_text(given[0]) + "," + detail::number_text(given[1]) + "," +
                          detail::number_text(given[2]) + "]",
                      "is normal to the surface there: it has no part in the tangent plane");
  return std::arg(component);
}

double face_direction(const std::string& path, const Mesh& mesh, const Positions<double>& V, Index t,
                      const Vector3& given) {
  const Row a = V.row(mesh.F()(t, 0)), x = (V.row(mesh.F()(t, 1)) - a).normalized();
  const Row normal = x.cross(V.row(mesh.F()(t, 2)) - a).normalized(), d = row(given);
  return direction(path, given, {d.dot(x), d.dot(normal.cross(x))});
}

double vertex_direction(const std::string& path, const Frames<double>& frames, Index v, const Vector3& given) {
  return direction(path, given, frames.component(v, row(given)));
}

double swirl(SingularityKind kind) {
  return kind == SingularityKind::vortex ? 90 : kind == SingularityKind::sink ? 180 : 0;
}

std::string path(const char* list, std::size_t k) { return std::string("/") + list + "/" + std::to_string(k); }

}  // namespace

std::string detail::label(const DesignSingularity& s) {
  return s.name.empty() ? std::string(name(s.kind)) + " in face " + std::to_string(s.face) : s.name;
}
std::string detail::label(const DesignFixed& f) {
  return f.name.empty() ? "fixed vertex " + std::to_string(f.vertex) : f.name;
}
std::string detail::label(const DesignStroke& s, std::size_t number) {
  return s.name.empty() ? "stroke " + std::to_string(number) : s.name;
}

DesignFile place_design(const DesignFile& design, const Mesh& mesh, const Positions<double>& V) {
  check_design(design, mesh);
  DesignFile placed = design;
  for (DesignSingularity& s : placed.singularities) {
    if (s.at) {
      const SurfacePoint point = nearest_point(mesh, V, *s.at);
      s.face = point.face;
      if (s.pin) s.barycentric = point.barycentric;
      s.at.reset();
    } else if (s.pin && !s.barycentric) {
      s.barycentric = {1.0 / 3, 1.0 / 3, 1.0 / 3};
    }
  }
  for (DesignFixed& f : placed.fixed) {
    if (!f.at) continue;
    f.vertex = nearest_vertex(mesh, V, *f.at);
    f.at.reset();
  }
  for (DesignStroke& s : placed.strokes) {
    for (DesignPoint& p : s.points) {
      if (!p.at) continue;
      const SurfacePoint point = nearest_point(mesh, V, *p.at);
      p = {.face = point.face, .barycentric = point.barycentric};
    }
  }
  check_design(placed, mesh);  // two points may be nearest to one vertex
  return placed;
}

std::vector<DesignControl> design_controls(const DesignFile& design, const Mesh& mesh, const Positions<double>& V,
                                           const Frames<double>& frames) {
  std::vector<DesignControl> controls;
  const int n = design.n;
  for (std::size_t k = 0; k < design.singularities.size(); ++k) {
    const DesignSingularity& s = design.singularities[k];
    const std::string at = path("singularities", k);
    double angle = (s.angle + swirl(s.kind)) * degree;
    if (s.relative_to) angle += face_direction(at + "/relative_to", mesh, V, s.face, *s.relative_to);
    controls.push_back({at, detail::label(s),
                        SingularityTarget{.face = s.face,
                                          .sign = index_of(s.kind),
                                          .orientation = wrap(angle),
                                          .strength = s.strength,
                                          .pin = s.pin ? s.barycentric : std::nullopt}});
  }
  for (std::size_t k = 0; k < design.fixed.size(); ++k) {
    const DesignFixed& f = design.fixed[k];
    const std::string at = path("fixed", k);
    double angle = f.angle.value_or(0.0) * degree;
    if (f.direction) angle += vertex_direction(at + "/direction", frames, f.vertex, *f.direction);
    if (f.relative_to) angle += vertex_direction(at + "/relative_to", frames, f.vertex, *f.relative_to);
    controls.push_back(
        {at, detail::label(f), VertexConstraint{.vertex = f.vertex, .value = std::polar(f.length, n * wrap(angle))}});
  }
  for (std::size_t k = 0; k < design.strokes.size(); ++k) {
    const DesignStroke& s = design.strokes[k];
    Stroke stroke{.points = {}, .weight = s.weight};
    for (const DesignPoint& p : s.points) stroke.points.push_back({p.face, p.barycentric});
    controls.push_back({path("strokes", k), detail::label(s, k), std::move(stroke)});
  }
  return controls;
}

}  // namespace alcap
