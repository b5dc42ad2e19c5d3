// SPDX-License-Identifier: MIT
//
// report.h: a distributed field or design as JSON and in words.
#pragma once

#include <string>

#include "alcap/distributed_design.h"
#include "apps/alcap/commands/command.h"

namespace alcap::app {

/// The report of `alcap-mpi field`: the keys of `alcap field` (docs/report.md) where they mean the same.
[[nodiscard]] Json distributed_report(const std::string& path, const MeshSlice& mesh, const DistributedField& field,
                                      const DistributedOptions& options);

/// A summary of a report.
[[nodiscard]] std::string distributed_summary(const Json& report);

/// The report of `alcap-mpi design`, likewise. `asked` is the design as it was given.
[[nodiscard]] Json distributed_report(const std::string& path, const MeshSlice& mesh, const DesignFile& asked,
                                      const DistributedDesign& design);
[[nodiscard]] std::string distributed_design_summary(const Json& report);

/// What both have: program, input, mesh, connection, n, components, singularities, ranks, phases.
void add_field(const std::string& path, const MeshSlice& mesh, const DistributedField& field, Json& report);
/// Lines about the mesh, the ranks and the connection; about singularities, seconds, bytes and memory.
[[nodiscard]] std::string mesh_summary(const Json& report);
[[nodiscard]] std::string costs_summary(const Json& report);

}  // namespace alcap::app
