// SPDX-License-Identifier: MIT
//
// design_guidance.h: guidance besides the smoothest field, at owned vertices. Internal to src/distributed.
#pragma once

#include <string>

#include "alcap/alignment.h"
#include "src/distributed/stages.h"

namespace alcap::detail::distributed {

/// curvature_field(). Throws OptionError.
[[nodiscard]] ComplexVectorX<double> curvature_together(const Stage& stage, const CurvatureOptions& options);

/// The field of a file that write_field() or write_distributed_ply() wrote, in these frames of the local vertices:
/// every rank reads its slice. Throws FileError, on all ranks, also where the file has another degree or mesh.
[[nodiscard]] ComplexVectorX<double> field_of_file(const std::string& path, const MeshSlice& mesh, const Stage& stage,
                                                   const Frames& frames, int n);

}  // namespace alcap::detail::distributed
