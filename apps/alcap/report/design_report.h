// SPDX-License-Identifier: MIT
//
// design_report.h: what was asked, what came of it, and what will be solved, as JSON (docs/report.md) and as text.
#pragma once

#include <string>
#include <vector>

#include "alcap/design_run.h"
#include "apps/alcap/commands/command.h"

namespace alcap::app {

/// One entry per outcome: path, name, type, asked, achieved, error_degrees, tolerance_degrees, met.
[[nodiscard]] Json controls_json(const DesignRun& run);

/// Where the guidance field came from, its weight, and what it was scaled by.
[[nodiscard]] Json guidance_json(const DesignRun& run);

/// Method, rows, residual, eigenvalues, backend.
[[nodiscard]] Json solve_json(const DesignRun& run);

/// The design itself, as in its file.
[[nodiscard]] Json design_json(const DesignFile& design);

/// The report of `alcap design` without its `times` and `files`. `asked` is the design as it was given.
[[nodiscard]] Json design_report(const Json& input, const DesignFile& asked, const DesignRun& run,
                                 const std::vector<Remark>& remarks);

/// What will be solved: unknowns, rows, controls with their numbers on this mesh.
[[nodiscard]] Json plan_json(const DesignFile& placed, const Mesh& mesh);
[[nodiscard]] std::string plan_text(const Json& plan);

[[nodiscard]] std::string design_summary(const Json& report);

}  // namespace alcap::app
