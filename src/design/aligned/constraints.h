// SPDX-License-Identifier: MIT
//
// constraints.h: what features ask of an n-direction field: directions held at vertices, rows at the middles of edges.
// Internal to aligned.
#pragma once

#include <vector>

#include "alcap/aligned.h"
#include "alcap/connected_surface.h"
#include "src/design/feature_rows.h"

namespace alcap::detail {

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
