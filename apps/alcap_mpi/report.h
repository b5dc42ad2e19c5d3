// SPDX-License-Identifier: MIT
//
// report.h: a distributed field as JSON and in words.
#pragma once

#include <string>

#include "alcap/distributed.h"
#include "apps/alcap/commands/command.h"

namespace alcap::app {

/// The report of `alcap-mpi field`: the keys of `alcap field` (docs/report.md) where they mean the same.
[[nodiscard]] Json distributed_report(const std::string& path, const MeshSlice& mesh, const DistributedField& field,
                                      const DistributedOptions& options);

/// A summary of a report.
[[nodiscard]] std::string distributed_summary(const Json& report);

}  // namespace alcap::app
