// SPDX-License-Identifier: MIT
//
// design_loads.h: the controls of a placed design as loads and rows, each on the ranks whose faces and vertices it
// names, by src/design/variational/rows.h. Internal to src/distributed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "alcap/distributed_design.h"
#include "src/design/variational/rows.h"
#include "src/distributed/stages.h"

namespace alcap::detail::distributed {

/// What this rank has of one control; vertices and faces are local ones, all inner.
struct LocalControl {
  DesignOutcome::Type type{};
  std::string path, name;
  std::optional<Control> asked;  ///< on every rank, in users' numbers: singularities and fixed vertices
  std::optional<Control> here;   ///< the same in local numbers, on the rank that has it
  ControlLoad load;              ///< of strokes and the boundary the rows that are this rank's
  Index component = none;        ///< on the rank that has it
};

/// In the order of design_controls(). Throws OptionError, on all ranks.
[[nodiscard]] std::vector<LocalControl> local_controls(const DesignFile& placed, const Stage& stage,
                                                       const Frames& frames, double total_area);

}  // namespace alcap::detail::distributed
