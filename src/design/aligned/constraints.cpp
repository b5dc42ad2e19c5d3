// SPDX-License-Identifier: MIT
#include "src/design/aligned/constraints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "src/connection/triangle_frame.h"
#include "src/design/variational/rows.h"

namespace alcap::detail {
namespace {

using C = Complex<double>;

// Features at a corner agree with one direction when none is farther from it than this: held there, each is met as
// closely as eyes can tell, and the corners of 88 or 92 degrees that real parts have still count as right angles.
constexpr double corner_agreement = 5 * pi<double> / 180;
// On a line that goes on, directions whose n-th powers nearly cancel have no mean: 45 degrees for crosses.
constexpr double least_mean = 0.1;
// Weight of an edge between two free corners, as of a stroke: nothing else speaks for it.
constexpr double free_edge_weight = 10;

struct Meeting {
  C sum = 0;
  std::vector<C> directions = {};
};

/// The n-th powers of the directions of the feature edges at every vertex that has some.
std::vector<Meeting> meetings(const ConnectedSurface& surface, const FeatureGraph& features, int n, bool across) {
  const Mesh& mesh = surface.mesh();
  std::vector<Meeting> out(static_cast<std::size_t>(mesh.vertices()));
  for (const Index e : features.edges) {
    const Index h = mesh.halfedge(e);
    const auto add = [&](Index v, double angle) {
      const C z = std::polar(1.0, n * (angle + (across ? pi<double> / 2 : 0)));
      out[static_cast<std::size_t>(v)].sum += z;
      out[static_cast<std::size_t>(v)].directions.push_back(z);
    };
    add(mesh.tail(h), surface.connection().rho_start(mesh, h));
    add(mesh.tip(h), surface.connection().rho_end(mesh, h));
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

void hold_fixed(const Mesh& mesh, const AlignedOptions& options, AlignedConstraints& out) {
  for (const VertexConstraint& fixed : options.fixed) {
    const Index v = fixed.vertex;
    if (v < 0 || v >= mesh.vertices() || !mesh.referenced(v))
      throw OptionError("fixed", v, "must be a vertex that a face uses");
    if (!std::isfinite(std::abs(fixed.value)) || fixed.value == C(0))
      throw OptionError("fixed", v, "needs a direction: a value that is finite and not zero");
    out.value[v] = fixed.value / std::abs(fixed.value);
    out.held[static_cast<std::size_t>(v)] = 1;
  }
}

}  // namespace

EdgeRow edge_row(const ConnectedSurface& surface, int n, bool across, Index e) {
  const Mesh& mesh = surface.mesh();
  const Index h = mesh.halfedge(e), c = h % 3;
  double middle[3] = {0, 0, 0};
  middle[c] = middle[(c + 1) % 3] = 0.5;
  const kernels::TriangleFrame<double> frame =
      triangle_frame(mesh, surface.geometry(), surface.connection(), Mesh::face(h));
  const kernels::BasisAt<double> basis = kernels::basis_at(frame, middle, static_cast<double>(n));
  const auto value = [&](Index corner) { return C(basis.value[corner].re, basis.value[corner].im); };
  return {.i = mesh.tail(h),
          .j = mesh.tip(h),
          .a = value(c),
          .b = value((c + 1) % 3),
          .target = std::polar(1.0, n * (surface.geometry().direction(h) + (across ? pi<double> / 2 : 0))),
          .weight = surface.geometry().length(e)};
}

AlignedConstraints find_constraints(const ConnectedSurface& surface, const FeatureGraph& features,
                                    const AlignedOptions& options) {
  const Mesh& mesh = surface.mesh();
  const bool soft = options.weight > 0;
  AlignedConstraints out{.value = ComplexVectorX<double>::Zero(mesh.vertices()),
                         .held = std::vector<char>(static_cast<std::size_t>(mesh.vertices()), 0),
                         .rows = {},
                         .free_corners = {}};
  const std::vector<Meeting> meeting = meetings(surface, features, options.n, options.across);
  for (Index v = 0; v < mesh.vertices(); ++v) {
    const auto at = static_cast<std::size_t>(v);
    if (meeting[at].directions.empty()) continue;
    if (!agrees(meeting[at], features.vertices[at], options.n)) {
      out.free_corners.push_back(v);
    } else if (!soft) {
      out.value[v] = meeting[at].sum / std::abs(meeting[at].sum);
      out.held[at] = 1;
    }
  }
  hold_fixed(mesh, options, out);
  const double scale =
      stroke_scale * (soft ? options.weight : free_edge_weight) / std::sqrt(surface.geometry().total_area());
  for (const Index e : features.edges) {
    EdgeRow row = edge_row(surface, options.n, options.across, e);
    const auto held = [&](Index v) { return out.held[static_cast<std::size_t>(v)] != 0; };
    if (soft ? held(row.i) && held(row.j) : held(row.i) || held(row.j)) continue;
    row.weight *= scale;
    out.rows.push_back(row);
  }
  return out;
}

}  // namespace alcap::detail
