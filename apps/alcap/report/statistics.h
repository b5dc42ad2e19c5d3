// SPDX-License-Identifier: MIT
//
// statistics.h: what can be counted and measured on any list of triangles, however broken: for `alcap info`.
#pragma once

#include <cstdint>

#include "alcap/conventions.h"

namespace alcap::app {

struct Statistics {
  std::int64_t vertices = 0, referenced = 0, faces = 0;
  std::int64_t edges = 0;               ///< pairs of vertices that some face joins
  std::int64_t boundary_edges = 0;      ///< those with one face
  std::int64_t components = 0;          ///< of faces that share vertices
  std::int64_t duplicate_vertices = 0;  ///< vertices at exactly the position of an earlier one
  /// Over the faces whose corners are three finite, distinct points; infinite or NaN when there are none.
  double edge_min = 0, edge_mean = 0, edge_max = 0;
  double angle_min = 0, angle_max = 0;  ///< radians
  double area = 0;
  Eigen::RowVector3d box_min, box_max;  ///< of the finite referenced vertices
};

/// Faces with indices out of range or repeated vertices are counted as faces and otherwise left out. O(F log F).
[[nodiscard]] Statistics measure(const Positions<double>& V, const Faces& F);

}  // namespace alcap::app
