// SPDX-License-Identifier: MIT
//
// shortest_path.h: the shortest way along edges from one vertex to another.
//
//   const std::vector<alcap::Index> path = alcap::shortest_path(surface, from, to);
//   if (path.empty()) { ... they lie on different components ... }
//   auto stroke = alcap::stroke_along_vertices(surface, path);
#pragma once

#include <vector>

#include "alcap/surface.h"

namespace alcap {

/// The vertices of a shortest path of edges, `from` first and `to` last (Dijkstra 1959); one vertex when they are
/// equal, empty when they lie on different components or a face uses only one of them. The way back is the same path
/// reversed: the search always starts at the smaller number. Of several shortest paths, each vertex is reached from
/// the neighbour that is nearest to that start, and among those equally near from the one with the smallest number.
/// Throws OptionError for a number that is not a vertex. O(k log k) for the k vertices that are nearer than the end.
[[nodiscard]] std::vector<Index> shortest_path(const Surface& surface, Index from, Index to);

}  // namespace alcap
