// SPDX-License-Identifier: MIT
//
// design_place.h: designs on a distributed mesh: what of them needs one machine, and where their controls lie. Internal
// to src/distributed.
#pragma once

#include "alcap/distributed_design.h"
#include "src/distributed/stages.h"

namespace alcap::detail::distributed {

/// Throws OptionError whose field is the JSON path of the first thing that needs one machine. Needs no mesh.
void refuse_what_needs_one_machine(const DesignFile& design);

/// place_design() and its checks. Throws OptionError, on all ranks.
[[nodiscard]] DesignFile place(const DesignFile& design, const MeshSlice& mesh, const Stage& stage);

/// The local number of a face that is this rank's, of a vertex that this rank owns; `none` otherwise.
[[nodiscard]] Index own_face(const Patch& patch, Index face);
[[nodiscard]] Index own_vertex(const Patch& patch, Index vertex);

}  // namespace alcap::detail::distributed
