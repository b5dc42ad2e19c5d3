// SPDX-License-Identifier: MIT
#include "src/design/aligned/constraints.h"

#include <cmath>
#include <utility>

#include "src/design/variational/rows.h"

namespace alcap::detail {
namespace {

using C = Complex<double>;

// Weight of an edge between two free corners, as of a stroke: nothing else speaks for it.
constexpr double free_edge_weight = 10;

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

AlignedConstraints find_constraints(const ConnectedSurface& surface, const FeatureGraph& features,
                                    const AlignedOptions& options) {
  const Mesh& mesh = surface.mesh();
  const bool soft = options.weight > 0;
  AlignedConstraints out{.value = ComplexVectorX<double>::Zero(mesh.vertices()),
                         .held = std::vector<char>(static_cast<std::size_t>(mesh.vertices()), 0),
                         .rows = {},
                         .free_corners = {}};
  FeatureDirections directions =
      directions_at_features(mesh, surface.connection(), features, options.n, options.across);
  out.free_corners = std::move(directions.free_corners);
  for (const VertexConstraint& held : directions.held) {
    if (soft) break;
    out.value[held.vertex] = held.value;
    out.held[static_cast<std::size_t>(held.vertex)] = 1;
  }
  hold_fixed(mesh, options, out);
  const double scale =
      stroke_scale * (soft ? options.weight : free_edge_weight) / std::sqrt(surface.geometry().total_area());
  for (const Index e : features.edges) {
    EdgeRow row = edge_row(mesh, surface.geometry(), surface.connection(), options.n, options.across, e);
    const auto held = [&](Index v) { return out.held[static_cast<std::size_t>(v)] != 0; };
    if (soft ? held(row.i) && held(row.j) : held(row.i) || held(row.j)) continue;
    row.weight *= scale;
    out.rows.push_back(row);
  }
  return out;
}

}  // namespace alcap::detail
