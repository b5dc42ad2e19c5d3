// SPDX-License-Identifier: MIT
//
// cone_options.h: what connections with cones are given, for alcap and alcap-mpi.
#pragma once

#include <vector>

#include "alcap/connection.h"
#include "apps/alcap/options/cli.h"

namespace alcap::app {

/// Adds --cone, which makes the connection trivial unless it is metric.
void add_cone_option(cli::App& app, ConnectionKind& kind, std::vector<Cone>& cones);

/// Adds an option of turns, which does so too.
void add_turns_option(cli::App& app, const char* option, ConnectionKind& kind, std::vector<double>& turns,
                      const char* help);

/// The help of --loop-index.
inline constexpr const char* loop_index_help =
    "Of trivial and metric: index of each boundary loop, in turns; default the least change";

}  // namespace alcap::app
