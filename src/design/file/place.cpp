// SPDX-License-Identifier: MIT
//
// place.cpp: a design on a mesh: nearest faces and vertices, directions of space as angles in frames, and
// the designer's controls.
#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <optional>

#include "alcap/design_file.h"
#include "alcap/errors.h"
#include "alcap/mesh_io.h"
#include "src/design/file/problem.h"

namespace alcap {
namespace {

using Row = Eigen::RowVector3d;

constexpr double degree = pi<double> / 180;
// A unit direction whose tangential part is smaller than this says nothing.
constexpr double tangential = 1e-6;

Row row(const Vector3& x) { return {x[0], x[1], x[2]}; }

/// Of length 1, also where the squares of the coordinates overflow or vanish.
Row unit(const Vector3& direction) {
  const Row d = row(direction);
  return (d / d.cwiseAbs().maxCoeff()).normalized();
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

/// The argument of a unit direction's component; the direction is named when it is (nearly) normal to the surface.
double direction(const std::string& path, const Vector3& given, Complex<double> component) {
  if (!(std::abs(component) > tangential))
    throw OptionError(path,
                      "[" + detail::number_text(given[0]) + "," + detail::number_text(given[1]) + "," +
                          detail::number_text(given[2]) + "]",
                      "is normal to the surface there: it has no part in the tangent plane");
  return std::arg(component);
}

double face_direction(const std::string& path, const Mesh& mesh, const Positions<double>& V, Index t,
                      const Vector3& given) {
  const Row a = V.row(mesh.F()(t, 0)), x = (V.row(mesh.F()(t, 1)) - a).normalized();
  const Row normal = x.cross(V.row(mesh.F()(t, 2)) - a).normalized(), d = unit(given);
  return direction(path, given, {d.dot(x), d.dot(normal.cross(x))});
}

double vertex_direction(const std::string& path, const Frames& frames, Index v, const Vector3& given) {
  return direction(path, given, frames.component(v, unit(given)));
}

double swirl(SingularityKind kind) {
  return kind == SingularityKind::vortex ? 90 : kind == SingularityKind::sink ? 180 : 0;
}

SurfacePolyline traced(const std::string& path, const Surface& surface, const DesignStroke& stroke) {
  SurfacePolyline line;
  detail::at_path(path, [&] {
    std::vector<SurfacePoint> points;
    for (const DesignPoint& p : stroke.points) points.push_back({p.face, p.barycentric});
    line = stroke.vertices.empty() ? stroke_through_points(surface, points)
                                   : stroke_along_vertices(surface, stroke.vertices);
  });
  return line;
}

}  // namespace

std::string detail::path_of(const char* list, std::size_t k) {
  return std::string("/") + list + "/" + std::to_string(k);
}

std::string detail::label(const DesignSingularity& s) {
  return s.name.empty() ? std::string(name(s.kind)) + " in face " + std::to_string(s.face) : s.name;
}
std::string detail::label(const DesignFixed& f) {
  return f.name.empty() ? "fixed vertex " + std::to_string(f.vertex) : f.name;
}
std::string detail::label(const DesignStroke& s, std::size_t number) {
  return s.name.empty() ? "stroke " + std::to_string(number) : s.name;
}
std::string detail::label(const DesignBoundary& b) { return b.normal ? "across the boundary" : "along the boundary"; }

std::string detail::label(const DesignFeatures& f) { return f.across ? "across features" : "along features"; }

void detail::place_points(DesignFile& design, const Nearest& nearest) {
  for (const DesignConeAt& cone : design.connection.cones_at)
    design.connection.cones.push_back({.vertex = nearest.vertex(cone.at), .index = cone.index});
  design.connection.cones_at.clear();
  for (DesignSingularity& s : design.singularities) {
    if (s.at) {
      const SurfacePoint point = nearest.point(*s.at);
      s.face = point.face;
      if (s.pin) s.barycentric = point.barycentric;
      s.at.reset();
    } else if (s.pin && !s.barycentric) {
      s.barycentric = {1.0 / 3, 1.0 / 3, 1.0 / 3};
    }
  }
  for (DesignFixed& f : design.fixed) {
    if (!f.at) continue;
    f.vertex = nearest.vertex(*f.at);
    f.at.reset();
  }
  for (DesignStroke& s : design.strokes) {
    for (DesignPoint& p : s.points) {
      if (!p.at) continue;
      const SurfacePoint point = nearest.point(*p.at);
      p = {.face = point.face, .barycentric = point.barycentric};
    }
    for (const Vector3& x : s.path) {
      const SurfacePoint point = nearest.point(x);
      s.points.push_back({.face = point.face, .barycentric = point.barycentric});
    }
    s.path.clear();
  }
}

std::vector<DesignStroke> feature_strokes(const FeatureGraph& features, double weight) {
  std::vector<DesignStroke> strokes;
  for (const FeatureLine& line : features.lines)
    strokes.push_back(
        {.name = "feature line " + std::to_string(strokes.size()), .vertices = line.vertices, .weight = weight});
  return strokes;
}

FeatureGraph design_features(const DesignFile& design, const Surface& surface) {
  const DesignFeatures& f = design.features;
  const SharpEdgeOptions options{.angle = f.angle * degree,
                                 .corner_angle = f.corner_angle * degree,
                                 .boundary = f.boundary,
                                 .low_angle = f.low_angle * degree,
                                 .gap = f.gap,
                                 .spur = f.spur};
  if (f.file.empty() && f.edges.empty()) return sharp_edges(surface, options);
  std::vector<Index> edges;
  if (!f.file.empty()) {
    const auto pairs = read_feature_edges(surface.F(), surface.mesh().vertices(), f.file);
    detail::at_path("/features/file", [&] { edges = edges_between(surface, pairs); });
  }
  for (std::size_t k = 0; k < f.edges.size(); ++k)
    detail::at_path(detail::path_of("features/edges", k),
                    [&] { edges.push_back(edges_between(surface, {f.edges[k]}).front()); });
  return feature_graph(surface, std::move(edges), options);
}

namespace {

/// Strokes for features that draw along them; the others by their edges, none where there are none.
void place_features(const Surface& surface, DesignFile& placed) {
  const DesignFeatures asked = placed.features;
  const FeatureGraph graph = design_features(placed, surface);
  placed.features = {};
  if (!asked.hold && !asked.across) {
    for (DesignStroke& s : feature_strokes(graph, asked.weight)) placed.strokes.push_back(std::move(s));
    return;
  }
  if (graph.edges.empty()) return;
  placed.features = {.wanted = true,
                     .weight = asked.weight,
                     .hold = asked.hold,
                     .across = asked.across,
                     .corner_angle = asked.corner_angle};
  for (const Index e : graph.edges) {
    const Index h = surface.mesh().halfedge(e);
    placed.features.edges.push_back({surface.mesh().tail(h), surface.mesh().tip(h)});
  }
}

}  // namespace

DesignFile place_design(const DesignFile& design, const Surface& surface) {
  const Mesh& mesh = surface.mesh();
  const Positions<double>& V = surface.positions();
  check_design(design, mesh);
  DesignFile placed = design;
  if (design.features.wanted) place_features(surface, placed);
  std::optional<SurfaceLocator> locator;  // made when a point of space is met
  detail::place_points(placed, {.point =
                                    [&](const Vector3& at) {
                                      if (!locator) locator.emplace(surface);
                                      return locator->closest(row(at));
                                    },
                                .vertex = [&](const Vector3& at) { return nearest_vertex(mesh, V, at); }});
  detail::apply_edits(surface, placed);
  check_design(placed, mesh);  // two points may be nearest to one vertex
  return placed;
}

ConnectionOptions connection_options(const DesignFile& design) {
  const DesignConnection& c = design.connection;
  return {.kind = c.kind,
          .polar = {.center = c.center},
          .global = {.detail = c.detail, .length_factor = c.length_factor, .tan_cap = c.tan_cap},
          .cones = c.cones,
          .balance_cones = c.balance,
          .generator_holonomy = c.holonomy,
          .loop_index = c.loops,
          .n = design.n,
          .target = c.target,
          .spread = c.spread};
}

SingularityTarget detail::target_of(const DesignSingularity& s, const std::string& path, const Mesh& mesh,
                                    const Positions<double>& V) {
  double angle = (s.angle + swirl(s.kind)) * degree;
  if (s.relative_to) angle += face_direction(path + "/relative_to", mesh, V, s.face, *s.relative_to);
  return {.face = s.face,
          .sign = index_of(s.kind),
          .count = s.count,
          .orientation = wrap(angle),
          .strength = s.strength,
          .pin = s.pin ? s.barycentric : std::nullopt};
}

VertexConstraint detail::constraint_of(const DesignFixed& f, const std::string& path, int n, const Frames& frames) {
  double angle = f.angle.value_or(0.0) * degree;
  if (f.direction) angle += vertex_direction(path + "/direction", frames, f.vertex, *f.direction);
  if (f.relative_to) angle += vertex_direction(path + "/relative_to", frames, f.vertex, *f.relative_to);
  return {.vertex = f.vertex, .value = std::polar(f.length, n * wrap(angle)), .direction_only = f.free_length};
}

std::vector<DesignControl> design_controls(const DesignFile& design, const ConnectedSurface& surface) {
  const std::shared_ptr<const Frames> frames = surface.frames();
  std::vector<DesignControl> controls;
  for (std::size_t k = 0; k < design.singularities.size(); ++k) {
    const DesignSingularity& s = design.singularities[k];
    const std::string path = detail::path_of("singularities", k);
    controls.push_back({path, detail::label(s), detail::target_of(s, path, surface.mesh(), surface.V())});
  }
  for (std::size_t k = 0; k < design.fixed.size(); ++k) {
    const DesignFixed& f = design.fixed[k];
    const std::string path = detail::path_of("fixed", k);
    controls.push_back({path, detail::label(f), detail::constraint_of(f, path, design.n, *frames)});
  }
  for (std::size_t k = 0; k < design.strokes.size(); ++k) {
    const DesignStroke& s = design.strokes[k];
    const std::string path = detail::path_of("strokes", k);
    controls.push_back(
        {path, detail::label(s, k), Stroke{.weight = s.weight, .line = traced(path, surface, s), .radius = s.radius}});
  }
  if (design.boundary.wanted)
    controls.push_back({"/boundary", detail::label(design.boundary),
                        BoundaryAlignment{.normal = design.boundary.normal, .weight = design.boundary.weight}});
  if (const DesignFeatures& f = design.features; f.wanted)
    controls.push_back({"/features", detail::label(f),
                        FeatureAlignment{.features = design_features(design, surface.surface()),
                                         .across = f.across,
                                         .weight = f.weight,
                                         .hold = f.hold}});
  return controls;
}

}  // namespace alcap
