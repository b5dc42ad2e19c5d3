// SPDX-License-Identifier: MIT
//
// commands.h: the subcommands, one line each, in the order of `alcap --help`. The line X(name) stands for the file
// name_command.cpp.
#pragma once

#include "apps/alcap/commands/command.h"

// The studio is no part of portable builds.
#ifdef ALCAP_PORTABLE
#define ALCAP_STUDIO_COMMAND(X)
#else
#define ALCAP_STUDIO_COMMAND(X) X(studio)
#endif

#define ALCAP_COMMANDS(X) \
  X(field)                \
  X(design)               \
  X(view)                 \
  ALCAP_STUDIO_COMMAND(X) \
  X(info)                 \
  X(ops)                  \
  X(make)                 \
  X(export_matrices)      \
  X(plan)                 \
  X(tables)

namespace alcap::app {

#define ALCAP_DECLARE(name) extern const Command name##_command;
ALCAP_COMMANDS(ALCAP_DECLARE)
#undef ALCAP_DECLARE

#define ALCAP_ADDRESS(name) &name##_command,
inline constexpr const Command* all_commands[] = {ALCAP_COMMANDS(ALCAP_ADDRESS)};
#undef ALCAP_ADDRESS

}  // namespace alcap::app
