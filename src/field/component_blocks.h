// SPDX-License-Identifier: MIT
//
// component_blocks.h: what solvers that work component by component need. Internal to design.
#pragma once

#include <vector>

#include "alcap/geometry.h"
#include "alcap/topology.h"

namespace alcap::detail {

/// Vertices of each component, in order.
[[nodiscard]] inline std::vector<std::vector<Index>> vertices_of_components(const Topology& topology) {
  std::vector<std::vector<Index>> vertices(topology.components.size());
  for (std::size_t c = 0; c < vertices.size(); ++c)
    vertices[c].reserve(static_cast<std::size_t>(topology.components[c].vertices));
  for (std::size_t v = 0; v < topology.vertex_component.size(); ++v)
    if (topology.vertex_component[v] != none)
      vertices[static_cast<std::size_t>(topology.vertex_component[v])].push_back(static_cast<Index>(v));
  return vertices;
}

[[nodiscard]] inline std::vector<double> areas_of_components(const Geometry& geometry, const Topology& topology) {
  if (topology.components.size() == 1) return {geometry.total_area()};
  std::vector<double> areas(topology.components.size(), 0.0);
  for (std::size_t t = 0; t < topology.face_component.size(); ++t)
    areas[static_cast<std::size_t>(topology.face_component[t])] += geometry.area(static_cast<Index>(t));
  return areas;
}

}  // namespace alcap::detail
