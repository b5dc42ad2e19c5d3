// SPDX-License-Identifier: MIT
//
// prove_option.h: whether eigenvalues are proven to be the smallest, as a flag of all commands that look for them.
#pragma once

#include "alcap/solve.h"
#include "apps/alcap/options/cli.h"

namespace alcap::app {

/// Adds --prove and --no-prove.
void add_prove_option(cli::App& app, Prove& prove);

}  // namespace alcap::app
