// SPDX-License-Identifier: MIT
//
// near_vertices.h (internal): vertices that lie close to an earlier one.
#pragma once

#include <vector>

#include "alcap/conventions.h"

namespace alcap::detail {

/// Length of the diagonal of the box around finite points; 0 without any.
[[nodiscard]] double box_diagonal(const Positions<double>& V);

/// Per vertex the first vertex within `distance` (positive) that is itself nobody's copy, or the vertex itself. O(V) by
/// a grid. Positions that are not finite are near no other.
[[nodiscard]] std::vector<Index> first_near(const Positions<double>& V, double distance);

}  // namespace alcap::detail
