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
  /// The same in local numbers, on the ranks that have a part of it; a target's face is `none` where only other parts
  /// are.
  std::optional<Control> here;
  ControlLoad load;              ///< the parts and rows that are this rank's
  std::vector<Index> row_order;  ///< number of each exact row among those of the control; empty: as they come
  Index component = none;        ///< on the ranks that have a part
};

/// In the order of design_controls(). Throws OptionError, on all ranks.
[[nodiscard]] std::vector<LocalControl> local_controls(const DesignFile& placed, const Stage& stage,
                                                       const Frames& frames, double total_area);

}  // namespace alcap::detail::distributed
