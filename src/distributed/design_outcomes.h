// SPDX-License-Identifier: MIT
//
// design_outcomes.h: what became of the controls of a distributed design. Internal to src/distributed.
#pragma once

#include <vector>

#include "src/distributed/design_loads.h"

namespace alcap::detail::distributed {

/// In the order of the controls. `field` is right at inner vertices; `out` has the singularities.
void judge(const Stage& stage, const std::vector<LocalControl>& controls, const Field& field,
           const ControlTolerances& tolerances, DistributedDesign& out);

/// Certificate and remarks, from everything else. `finite`: of this rank's values.
void certify(const Connection& connection, bool eigen_converged, bool finite, double largest_residual,
             DistributedDesign& out);

}  // namespace alcap::detail::distributed
