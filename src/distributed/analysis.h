// SPDX-License-Identifier: MIT
//
// analysis.h: singularities and sums of indices of a distributed field. Internal to src/distributed.
#pragma once

#include "src/distributed/components.h"

namespace alcap::detail::distributed {

/// Singularities of the whole mesh, by users' faces; fills in the components' index sums. `field`: values at all local
/// vertices, right at inner ones.
[[nodiscard]] std::vector<DistributedSingularity> analyse(const Patch& patch, const Connection& connection,
                                                          const Field& field, Components& components);

}  // namespace alcap::detail::distributed
