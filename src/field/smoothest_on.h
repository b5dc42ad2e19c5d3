// SPDX-License-Identifier: MIT
//
// smoothest_on.h: the smoothest field of some components only.
#pragma once

#include <vector>

#include "alcap/smoothest.h"

namespace alcap::detail {

/// smoothest_field() of the components whose `wanted` (#components) is not 0; zero elsewhere.
[[nodiscard]] SmoothestResult smoothest_on(const ConnectedSurface& surface, const std::vector<char>& wanted,
                                           const SmoothestOptions& options);

}  // namespace alcap::detail
