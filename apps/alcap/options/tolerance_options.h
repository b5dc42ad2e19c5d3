// SPDX-License-Identifier: MIT
//
// tolerance_options.h: how far off controls of a design may be, as a flag of everything that judges them.
#pragma once

#include "alcap/controls.h"
#include "apps/alcap/commands/command.h"

namespace alcap::app {

/// Adds --tolerance-of KIND:VALUE, which may be given several times. The library checks the values.
void add_tolerance_options(cli::App& app, ControlTolerances& tolerances);

}  // namespace alcap::app
