// SPDX-License-Identifier: MIT
//
// shared_options.h: groups of options that several subcommands have, and reading a mesh as they say.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "alcap/field_run.h"
#include "alcap/mesh_io.h"
#include "apps/alcap/commands/command.h"

namespace alcap::app {

/// Which mesh, and how to read and repair it.
struct MeshChoice {
  std::filesystem::path path = {};
  std::string format = {};       // by content
  bool refuse_polygons = false;  // quads are common; triangulating them is rarely wrong
  std::vector<Repair> repairs = {};
};

/// Adds MESH (positional), --repair, --input-format and --refuse-polygons.
void add_mesh_options(cli::App& app, MeshChoice& choice);

/// Reads the mesh. Throws FileError.
[[nodiscard]] MeshFile read_choice(const MeshChoice& choice);

/// Adds --connection, --cone, --cones and --detail, which set kind, polar.center, cones, balance_cones and
/// global.detail.
void add_connection_options(cli::App& app, ConnectionOptions& options);

/// Adds --solver, --method, --tolerance and --max-iterations.
void add_eigen_options(cli::App& app, EigenOptions& options);

}  // namespace alcap::app
