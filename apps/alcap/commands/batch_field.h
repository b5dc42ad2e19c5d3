// SPDX-License-Identifier: MIT
//
// batch_field.h: `alcap field --batch`, many meshes in one run, a line of JSON for each.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/alcap/options/shared_options.h"

namespace alcap::app {

struct BatchChoice {
  std::filesystem::path list = {};        ///< file with a mesh a line; empty: no batch
  int jobs = 0;                           ///< meshes at a time, 0: as many as there are threads
  std::filesystem::path lines = {};       ///< where the lines go; empty: stdout
  std::filesystem::path folder = {};      ///< fields go here, as NAME.FORMAT; empty: nowhere
  std::vector<std::string> formats = {};  ///< of the fields
};

/// Adds --batch, --jobs and --lines.
void add_batch_options(cli::App& app, BatchChoice& choice);

/// Computes all meshes of the list. How a mesh is read and repaired is in `mesh`, without its path.
[[nodiscard]] Outcome run_field_batch(const BatchChoice& choice, const MeshChoice& mesh, const FieldRunOptions& field,
                                      const Common& common);

}  // namespace alcap::app
