// SPDX-License-Identifier: MIT
#include "src/design/feature_rows.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "src/connection/triangle_frame.h"

namespace alcap {
namespace detail {
namespace {

using C = Complex<double>;

// Features at a corner agree with one direction when none is farther from it than this: held there, each is met as
// closely as eyes can tell, and the corners of 88 or 92 degrees that real parts have still count as right angles.
constexpr double corner_agreement = 5 * pi<double> / 180;
// On a line that goes on, directions whose n-th powers nearly cancel have no mean: 45 degrees for crosses.
constexpr double least_mean = 0.1;

struct Meeting {
  C sum = 0;
  std::vector<C> directions = {};
};

/// The n-th powers of the directions of the feature edges at every vertex that has some.
std::vector<Meeting> meetings(const Mesh& mesh, const Connection& connection, const FeatureGraph& features, int n,
                              bool across) {
  std::vector<Meeting> out(static_cast<std::size_t>(mesh.vertices()));
  for (const Index e : features.edges) {
    const Index h = mesh.halfedge(e);
    const auto add = [&](Index v, double angle) {
      const C z = std::polar(1.0, n * (angle + (across ? pi<double> / 2 : 0)));
      out[static_cast<std::size_t>(v)].sum += z;
      out[static_cast<std::size_t>(v)].directions.push_back(z);
    };
    add(mesh.tail(h), connection.rho_start(mesh, h));
    add(mesh.tip(h), connection.rho_end(mesh, h));
  }
  return out;
}

bool agrees(const Meeting& meeting, FeatureVertex kind, int n) {
  const auto count = static_cast<double>(meeting.directions.size());
  if (!(std::abs(meeting.sum) > least_mean * count)) return false;
  return kind != FeatureVertex::corner || std::all_of(meeting.directions.begin(), meeting.directions.end(), [&](C z) {
           return std::abs(std::arg(z * std::conj(meeting.sum))) <= n * corner_agreement;
         });
}

}  // namespace

EdgeRow edge_row(const Mesh& mesh, const Geometry& geometry, const Connection& connection, int n, bool across,
                 Index e) {
  const Index h = mesh.halfedge(e), c = h % 3;
  double middle[3] = {0, 0, 0};
  middle[c] = middle[(c + 1) % 3] = 0.5;
  const kernels::TriangleFrame<double> frame = triangle_frame(mesh, geometry, connection, Mesh::face(h));
  const kernels::BasisAt<double> basis = kernels::basis_at(frame, middle, static_cast<double>(n));
  const auto value = [&](Index corner) { return C(basis.value[corner].re, basis.value[corner].im); };
  return {.i = mesh.tail(h),
          .j = mesh.tip(h),
          .a = value(c),
          .b = value((c + 1) % 3),
          .target = std::polar(1.0, n * (geometry.direction(h) + (across ? pi<double> / 2 : 0))),
          .weight = geometry.length(e)};
}

FeatureDirections directions_at_features(const Mesh& mesh, const Connection& connection, const FeatureGraph& features,
                                         int n, bool across) {
  const std::vector<Meeting> meeting = meetings(mesh, connection, features, n, across);
  FeatureDirections out;
  for (Index v = 0; v < mesh.vertices(); ++v) {
    const auto at = static_cast<std::size_t>(v);
    if (meeting[at].directions.empty()) continue;
    if (agrees(meeting[at], features.vertices[at], n))
      out.held.push_back({.vertex = v, .value = meeting[at].sum / std::abs(meeting[at].sum), .direction_only = true});
    else
      out.free_corners.push_back(v);
  }
  return out;
}

void check_features(const Mesh& mesh, const FeatureGraph& features, int n) {
  if (n % 2 != 0 && !features.edges.empty())
    throw OptionError("n", n, "must be even: a feature has no sense of direction");
  if (features.vertices.size() != static_cast<std::size_t>(mesh.vertices()))
    throw OptionError("features", std::to_string(features.vertices.size()) + " vertices",
                      "must be a graph of this surface");
  for (const Index e : features.edges)
    if (e < 0 || e >= mesh.edges()) throw OptionError("features", e, "there is no such edge");
}

ControlReport judge_features(const ConnectedSurface& surface, const Field& field, const FeatureAlignment& alignment,
                             const ControlTolerances& tolerances) {
  ControlReport report;
  if (!alignment.features.edges.empty())
    report.error_degrees = measure_features(surface, field, alignment.features, {}, alignment.across).all.mean_degrees;
  report.met = report.error_degrees <= tolerances.stroke_degrees;
  return report;
}

SurfacePolyline polyline_of(const Mesh& mesh, const Geometry& geometry, const FeatureLine& line) {
  SurfacePolyline out{.segments = {}, .closed = line.closed};
  for (std::size_t k = 0; k < line.edges.size(); ++k) {
    const Index h = mesh.halfedge(line.edges[k]);
    const bool forward = mesh.tail(h) == line.vertices[k];
    const C tangent = std::polar(1.0, geometry.direction(h));
    out.segments.push_back({.face = Mesh::face(h),
                            .a = on_halfedge(h, forward ? 0 : 1).barycentric,
                            .b = on_halfedge(h, forward ? 1 : 0).barycentric,
                            .tangent = forward ? tangent : -tangent,
                            .length = geometry.length(line.edges[k])});
  }
  return out;
}

}  // namespace detail

FeatureDirections feature_directions(const ConnectedSurface& surface, const FeatureGraph& features, int n,
                                     bool across) {
  if (n < 1) throw OptionError("n", n, "the degree of a field is at least 1");
  detail::check_features(surface.mesh(), features, n);
  return detail::directions_at_features(surface.mesh(), surface.connection(), features, n, across);
}

}  // namespace alcap
