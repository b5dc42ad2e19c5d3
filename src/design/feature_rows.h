// SPDX-License-Identifier: MIT
//
// feature_rows.h: what features ask of an n-direction field: directions at vertices, values at the middles of edges.
// Internal to design.
#pragma once

#include <vector>

#include "alcap/aligned.h"
#include "alcap/connected_surface.h"

namespace alcap::detail {

/// a u[i] + b u[j] = target at the middle of an edge, softly.
struct EdgeRow {
  Index i = none, j = none;
  Complex<double> a, b, target;
  double weight = 0;  ///< of |.|^2 in twice the Dirichlet energy

  template <class Vector>
  [[nodiscard]] Complex<double> at(const Vector& u) const {
    return a * u[i] + b * u[j];
  }
};

/// The row of an edge, with its length as weight: value in the frame of a face, target along the edge or across.
[[nodiscard]] EdgeRow edge_row(const Mesh& mesh, const Geometry& geometry, const Connection& connection, int n,
                               bool across, Index e);

/// feature_directions() of a graph and a degree that are checked.
[[nodiscard]] FeatureDirections directions_at_features(const Mesh& mesh, const Connection& connection,
                                                       const FeatureGraph& features, int n, bool across);

/// Throws OptionError for odd n where there are features, and when the graph is one of another surface.
void check_features(const Mesh& mesh, const FeatureGraph& features, int n);

/// What became of features: mean deviation off their corners.
[[nodiscard]] ControlReport judge_features(const ConnectedSurface& surface, const Field& field,
                                           const FeatureAlignment& alignment, const ControlTolerances& tolerances);

/// A feature line as a line of the surface.
[[nodiscard]] SurfacePolyline polyline_of(const Mesh& mesh, const Geometry& geometry, const FeatureLine& line);

}  // namespace alcap::detail
