// SPDX-License-Identifier: MIT
//
// distributed_output.h: fields over all ranks as pieces for ParaView. See distributed.h.
#pragma once

#include <string>

#include "alcap/distributed.h"

namespace alcap {

/// PATH, a .pvtp, and beside it a piece STEM_r.vtp of every rank r that has faces in its slice: those faces and the
/// vertices they use, with the point data of write_field()'s .vtp, and per face its index and the user's number. The
/// .pvtp comes last, when all pieces are complete. Adds its phase. Throws FileError.
void write_distributed_pvtp(const std::string& path, const MeshSlice& mesh, DistributedField& field);

}  // namespace alcap
