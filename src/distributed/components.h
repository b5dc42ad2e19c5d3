// SPDX-License-Identifier: MIT
//
// components.h: connected components and boundary loops across ranks. Internal to src/distributed.
#pragma once

#include <array>
#include <vector>

#include "src/distributed/patch.h"

namespace alcap::detail::distributed {

struct Components {
  /// Without solutions. The same on all ranks.
  std::vector<DistributedComponent> list;
  std::vector<Index> of_vertex;  ///< per inner vertex, `none` where no face uses it
};

/// Needs the patch's geometry.
[[nodiscard]] Components find_components(const Patch& patch);

/// Boundary loops over all ranks.
struct BoundaryLoops {
  std::vector<Index> component;  ///< of each, in the order of their smallest boundary halfedges; the same on all ranks
  std::vector<Index> of_vertex;  ///< per inner vertex, `none` off the boundary
};
[[nodiscard]] BoundaryLoops find_loops(const Patch& patch, const Components& components);

/// The smallest user's number of the vertices that each inner vertex is joined to by `edges` (pairs of inner vertices)
/// of all ranks; `none` where `used` is 0.
[[nodiscard]] std::vector<Index> smallest_joined(const Patch& patch, const std::vector<std::array<Index, 2>>& edges,
                                                 const std::vector<char>& used);

}  // namespace alcap::detail::distributed
