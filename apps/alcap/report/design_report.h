// SPDX-License-Identifier: MIT
//
// design_report.h: what was asked, what came of it, and what will be solved, as JSON (docs/report.md) and as text.
#pragma once

#include <string>
#include <vector>

#include "alcap/design_file.h"
#include "alcap/field_run.h"
#include "apps/alcap/commands/command.h"

namespace alcap::app {

/// A solved design.
struct DesignRun {
  const DesignFile& design;  ///< placed
  const std::vector<DesignControl>& controls;
  const DesignResult& result;  ///< controls in the same order
  const FieldRun& run;         ///< mesh, topology, geometry, connection, field, indices, singularities; no eigen
};

/// One entry per singularity, fixed vertex, stroke and cone: path, name, type, asked, achieved, error_degrees, met.
[[nodiscard]] Json controls_json(const DesignRun& d);

/// A warning per control that was not met.
[[nodiscard]] std::vector<Remark> unmet_remarks(const Json& controls);

/// The design itself, as in its file.
[[nodiscard]] Json design_json(const DesignFile& design);

/// What will be solved: unknowns, rows, controls with their numbers on this mesh.
[[nodiscard]] Json plan_json(const DesignFile& placed, const Mesh& mesh);
[[nodiscard]] std::string plan_text(const Json& plan);

[[nodiscard]] std::string design_summary(const Json& report);

}  // namespace alcap::app
