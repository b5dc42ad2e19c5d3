// SPDX-License-Identifier: MIT
#include "src/design/variational/rows.h"

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <utility>

#include "src/connection/triangle_frame.h"
#include "src/design/feature_rows.h"
#include "src/design/singularity_parts.h"
#include "src/design/stroke_band.h"
#include "src/design/weight_range.h"
#include "src/mesh/position.h"

namespace alcap::detail {
namespace {

using C = Complex<double>;

void check_positive(const char* name, double value) {
  if (!(value > 0) || !std::isfinite(value)) throw OptionError(name, value, "must be positive and finite");
}

void check_weight(const char* name, double value) {
  if (!fit_weight(value)) throw OptionError(name, value, weight_rule);
}

ControlRow vertex_row(Index v, C target, double weight) {
  ControlRow row{.target = target, .weight = weight};
  row.vertex.fill(v);
  row.coefficient[0] = 1;
  return row;
}

}  // namespace

void check_surface_point(const Mesh& mesh, const SurfacePoint& p, const char* name) {
  if (p.face < 0 || p.face >= mesh.faces())
    throw OptionError(name, p.face, "there is no such face; the mesh has " + std::to_string(mesh.faces()));
  const double sum = p.barycentric[0] + p.barycentric[1] + p.barycentric[2];
  for (const double b : p.barycentric)
    if (!(b >= -1e-9) || !(std::abs(sum - 1) <= 1e-6))
      throw OptionError(name, b, "barycentric coordinates are not negative and sum to 1");
}

void check_target(const Mesh& mesh, const SingularityTarget& target) {
  check_surface_point(mesh, {target.face, target.pin.value_or(std::array<double, 3>{1, 0, 0})}, "face");
  if (target.sign != 1 && target.sign != -1) throw OptionError("sign", target.sign, "a target has index +1/n or -1/n");
  if (target.count < 1 || target.count > largest_count)
    throw OptionError("count", target.count, "must be 1 to " + std::to_string(largest_count));
  check_weight("strength", target.strength);
  if (!std::isfinite(target.orientation)) throw OptionError("orientation", target.orientation, "must be finite");
}

ControlRow point_row(const Mesh& mesh, const Geometry& geometry, const Connection& connection, int n,
                     const SurfacePoint& p) {
  const kernels::TriangleFrame<double> frame = triangle_frame(mesh, geometry, connection, p.face);
  const double b[3] = {p.barycentric[0], p.barycentric[1], p.barycentric[2]};
  const kernels::BasisAt<double> basis = kernels::basis_at(frame, b, double(n));
  ControlRow row;
  for (Index c = 0; c < 3; ++c) {
    row.vertex[static_cast<std::size_t>(c)] = mesh.F()(p.face, c);
    row.coefficient[static_cast<std::size_t>(c)] = {basis.value[c].re, basis.value[c].im};
  }
  return row;
}

ControlRow pin_row(const Mesh& mesh, const Geometry& geometry, const Connection& connection, int n,
                   const SingularityTarget& target, Index face) {
  constexpr std::array<double, 3> middle = {1.0 / 3, 1.0 / 3, 1.0 / 3};
  return point_row(mesh, geometry, connection, n, {face, face == target.face ? *target.pin : middle});
}

std::vector<ControlRow> pin_rows(const Mesh& mesh, const Geometry& geometry, const Connection& connection, int n,
                                 const SingularityTarget& target) {
  std::vector<ControlRow> rows;
  if (!target.pin) return rows;
  for (const SingularityPart& zero : singularity_parts(mesh, geometry, n, target))
    rows.push_back(pin_row(mesh, geometry, connection, n, target, zero.face));
  return rows;
}

double ControlLoads::stroke_weight(double weight) const {
  check_weight("weight", weight);
  return weight * stroke_scale / std::sqrt(total_area);
}

ControlLoad ControlLoads::operator()(const SingularityTarget& target) const {
  check_target(mesh, target);
  const double area = geometry.area(target.face);
  ControlLoad out{.density = target_density(target, area)};
  for (const SingularityPart& zero : singularity_parts(mesh, geometry, n, target)) add_part(zero, target, area, out);
  return out;
}

C ControlLoads::target_density(const SingularityTarget& target, double area) const {
  // Turning the pattern by beta turns (d, c) by (n-1) beta, s by (n+1) beta; a swirl angle (n = 1) is (d, c)'s own.
  const double flux = target.strength * target_flux * 2 * pi<double> * std::sqrt(area);
  return std::polar(flux / area, target_turns(n, target) * target.orientation);
}

void ControlLoads::add_part(const SingularityPart& zero, const SingularityTarget& target, double area,
                            ControlLoad& load) const {
  const ComplexVectorX<double>& coefficients = target.sign > 0 ? operators.p : operators.q;
  TargetPart part{.face = zero.face};
  // All zeros of a target have the same flux.
  const C factor = std::conj(zero.factor) * std::sqrt(area / geometry.area(zero.face));
  for (Index c = 0; c < 3; ++c)
    part.coefficient[static_cast<std::size_t>(c)] = factor * coefficients[3 * zero.face + c];
  load.parts.push_back(part);
  if (target.pin) load.rows.push_back(pin_row(mesh, geometry, connection, n, target, zero.face));
}

ControlLoad ControlLoads::operator()(const VertexConstraint& constraint) const {
  const Index v = constraint.vertex;
  if (v < 0 || v >= mesh.vertices() || !mesh.referenced(v))
    throw OptionError("vertex", v, "must be a vertex that a face uses");
  if (!std::isfinite(constraint.value.real()) || !std::isfinite(constraint.value.imag()))
    throw OptionError("value", "not finite", "must be a finite complex number");
  if (constraint.direction_only && constraint.value == C(0)) throw OptionError("value", "0", "zero has no direction");
  ControlRow row = vertex_row(v, constraint.value, 0);
  row.direction_only = constraint.direction_only;
  return {.rows = {row}};
}

ControlLoad ControlLoads::operator()(const Stroke& stroke) const {
  if (!(stroke.radius >= 0) || !std::isfinite(stroke.radius))
    throw OptionError("radius", stroke.radius, "must be finite and not negative");
  if (stroke.line.segments.empty()) {
    if (stroke.radius > 0) throw OptionError("radius", stroke.radius, "needs a line");
    return along_points(stroke);
  }
  if (!stroke.points.empty())
    throw OptionError("points", std::to_string(stroke.points.size()) + " points", "a stroke has points or a line");
  for (const SurfaceSegment& segment : stroke.line.segments) {
    check_surface_point(mesh, {segment.face, segment.at(0.5)}, "line");
    check_positive("line", segment.length);
  }
  return stroke.radius > 0 ? footprint(stroke) : along_line(stroke);
}

ControlRow ControlLoads::segment_row(const SurfaceSegment& segment, double weight) const {
  ControlRow row = point_row({segment.face, segment.at(0.5)});
  row.target = std::polar(1.0, n * std::arg(segment.tangent));
  row.weight = stroke_weight(weight) * segment.length;
  return row;
}

ControlLoad ControlLoads::along_line(const Stroke& stroke) const {
  ControlLoad out;
  for (const SurfaceSegment& segment : stroke.line.segments) out.rows.push_back(segment_row(segment, stroke.weight));
  return out;
}

ControlLoad ControlLoads::along_points(const Stroke& stroke) const {
  if (stroke.points.size() < 2)
    throw OptionError("points", std::to_string(stroke.points.size()) + " points", "a stroke has at least two");
  if (V.rows() == 0)
    throw OptionError("points", std::to_string(stroke.points.size()) + " points",
                      "need a surface that lies in space; give a line");
  const double scale = stroke_weight(stroke.weight);
  std::vector<Eigen::RowVector3d> at;
  for (const SurfacePoint& p : stroke.points) {
    check_surface_point(mesh, p, "points");
    at.push_back(position(mesh, V, p));
  }
  ControlLoad out;
  for (std::size_t k = 0; k < at.size(); ++k) {
    Eigen::RowVector3d tangent = Eigen::RowVector3d::Zero();
    double length = 0;
    const auto segment = [&](const Eigen::RowVector3d& s) {
      length += s.norm() / 2;
      if (s.norm() > 0) tangent += s.normalized();
    };
    if (k > 0) segment(at[k] - at[k - 1]);
    if (k + 1 < at.size()) segment(at[k + 1] - at[k]);
    const Index t = stroke.points[k].face;
    const Eigen::RowVector3d a = V.row(mesh.F()(t, 0)), first = V.row(mesh.F()(t, 1)) - a;
    const Eigen::RowVector3d normal = first.cross(V.row(mesh.F()(t, 2)) - a).normalized(), x = first.normalized();
    const C direction(tangent.dot(x), tangent.dot(normal.cross(x)));
    if (!(std::abs(direction) > 1e-9) || !(length > 0)) continue;  // repeated points, a cusp: no tangent to follow
    ControlRow row = point_row(stroke.points[k]);
    row.target = std::polar(1.0, n * std::arg(direction));
    row.weight = scale * length;
    out.rows.push_back(row);
  }
  if (out.rows.empty()) throw OptionError("points", "all at one place", "a stroke needs some length");
  return out;
}

// Every vertex within the radius is drawn to the stroke's direction there.
ControlLoad ControlLoads::footprint(const Stroke& stroke) const {
  const double scale = stroke_weight(stroke.weight);
  ControlLoad out;
  for (const BandVertex& at : stroke_band(mesh, geometry, connection, stroke.line, stroke.radius))
    out.rows.push_back(vertex_row(at.vertex, std::polar(1.0, n * at.angle), scale * at.share));
  return out;
}

std::vector<ControlRow> ControlLoads::boundary_rows(const BoundaryAlignment& alignment) const {
  const double scale = stroke_weight(alignment.weight);
  std::vector<C> direction(static_cast<std::size_t>(mesh.vertices()), 0);
  std::vector<double> length(static_cast<std::size_t>(mesh.vertices()), 0);
  for (Index h = 0; h < 3 * mesh.faces(); ++h) {
    if (mesh.twin(h) != none) continue;
    const auto add = [&](Index v, double angle) {
      const auto at = static_cast<std::size_t>(v);
      const double half = geometry.length(mesh.edge(h)) / 2;
      direction[at] += std::polar(half, n * (angle + (alignment.normal ? pi<double> / 2 : 0)));
      length[at] += half;
    };
    add(mesh.tail(h), connection.rho_start(mesh, h));
    add(mesh.tip(h), connection.rho_end(mesh, h));
  }
  std::vector<ControlRow> rows;
  for (Index v = 0; v < mesh.vertices(); ++v) {
    const auto at = static_cast<std::size_t>(v);
    // Where the two sides ask for opposites, as crosses do at corners of 45 degrees, none is right.
    if (!(std::abs(direction[at]) > 1e-6 * length[at])) continue;
    rows.push_back(vertex_row(v, direction[at] / std::abs(direction[at]), scale * length[at]));
  }
  return rows;
}

ControlLoad ControlLoads::operator()(const BoundaryAlignment& alignment) const {
  ControlLoad out{.rows = boundary_rows(alignment)};
  if (out.rows.empty()) throw OptionError("boundary", "none", "this mesh has no boundary to align with");
  return out;
}

ControlLoad ControlLoads::operator()(const FeatureAlignment& alignment) const {
  check_features(mesh, alignment.features, n);
  if (alignment.features.edges.empty()) throw OptionError("features", "none", "needs feature edges to align with");
  const double scale = stroke_weight(alignment.weight);
  ControlLoad out;
  for (const Index e : alignment.features.edges) {
    const EdgeRow row = edge_row(mesh, geometry, connection, n, alignment.across, e);
    out.rows.push_back({.vertex = {row.i, row.j, row.i},
                        .coefficient = {row.a, row.b, 0},
                        .target = row.target,
                        .weight = scale * row.weight});
  }
  if (alignment.hold) out.held = directions_at_features(mesh, connection, alignment.features, n, alignment.across).held;
  return out;
}

}  // namespace alcap::detail
