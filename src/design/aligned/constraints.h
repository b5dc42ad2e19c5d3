// SPDX-License-Identifier: MIT
//
// constraints.h: what features ask of an n-direction field: directions held at vertices, rows at the middles of edges.
// Internal to aligned.
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
[[nodiscard]] EdgeRow edge_row(const ConnectedSurface& surface, int n, bool across, Index e);

struct AlignedConstraints {
  ComplexVectorX<double> value;  ///< #V, of length 1 where held, else 0
  std::vector<char> held;        ///< #V
  std::vector<EdgeRow> rows;
  std::vector<Index> free_corners;
};

/// Throws OptionError for bad fixed vertices.
[[nodiscard]] AlignedConstraints find_constraints(const ConnectedSurface& surface, const FeatureGraph& features,
                                                  const AlignedOptions& options);

}  // namespace alcap::detail
