// SPDX-License-Identifier: MIT
//
// shared_options.h: groups of options that several subcommands have, and reading a mesh as they say.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "alcap/field_run.h"
#include "alcap/mesh_io.h"
#include "alcap/output.h"
#include "apps/alcap/commands/command.h"

namespace alcap::app {

/// Which mesh, and how to read and repair it.
struct MeshChoice {
  std::filesystem::path path = {};
  std::string format = {};       // by content
  bool refuse_polygons = false;  // quads are common; triangulating them is rarely wrong
  RepairOptions repair = {};
  std::filesystem::path lengths = {};  // none: as far apart as the vertices are
};

/// Adds --lengths, for commands that call make_surface().
void add_lengths_option(cli::App& app, MeshChoice& choice);

/// Adds --triangulation and --min-angle, which goes to `min_angle` in radians.
void add_triangulation_options(cli::App& app, Triangulation& triangulation, double& min_angle);

/// Adds MESH (positional), --repair, --input-format and --refuse-polygons.
void add_mesh_options(cli::App& app, MeshChoice& choice);

/// Reads the mesh. Throws FileError.
[[nodiscard]] MeshFile read_choice(const MeshChoice& choice);

/// The surface of a mesh that was read, after the repairs asked for and with the edge lengths asked for. Takes the
/// file's arrays. Appends what the repairs did. Throws MeshError, FileError, OptionError.
[[nodiscard]] Surface make_surface(const MeshChoice& choice, MeshFile& file, std::vector<Remark>& remarks);

/// Appends what repairs did.
void add_remarks(const std::vector<RepairStep>& steps, std::vector<Remark>& remarks);

/// The angle of "--align-features", in radians: of the text in degrees, or the default where it is empty. Throws
/// cli::ValidationError.
[[nodiscard]] double feature_angle(const std::string& text);

/// What is said of features besides --align-features; nothing where a flag was not given.
struct FeatureFlags {
  std::filesystem::path file = {};  // of edges
  bool across = false;
  std::optional<double> weight = {};
  std::optional<double> corner_angle = {}, low_angle = {};  // degrees
  std::optional<double> gap = {}, spur = {};                // in the unit of length of the mesh

  [[nodiscard]] bool any() const {
    return !file.empty() || across || weight || corner_angle || low_angle || gap || spur;
  }
};

/// Adds --features, --align-across, --align-weight, --feature-corner-angle, --feature-low-angle, --feature-gap and
/// --feature-spur. `weight`: what that of --align-weight does.
void add_feature_options(cli::App& app, FeatureFlags& flags, const char* weight);

/// Adds --connection, --cone, --cones, --holonomy, --loop-index, --target and --hold-curvature, which say what
/// connection it is, and those of add_weight_options().
void add_connection_options(cli::App& app, ConnectionOptions& options);

/// The connection to look at a field with: as the flags of add_connection_options() say, or, where none says what
/// connection it is, that of the file, with the weights that were given as flags. Ask after parsing.
[[nodiscard]] ConnectionOptions connection_for(cli::App& app, const ConnectionOptions& flags, const FieldFile& file);

/// Whether the file's connection is taken but not all of it is in the file.
[[nodiscard]] bool connection_lost(cli::App& app, const FieldFile& file);

/// Adds --detail, --length-factor and --tan-cap.
void add_weight_options(cli::App& app, GlobalOptions& options);

/// Adds --solver, --method, --tolerance and --max-iterations.
void add_eigen_options(cli::App& app, EigenOptions& options);

}  // namespace alcap::app
