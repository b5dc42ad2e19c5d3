// SPDX-License-Identifier: MIT
//
// design_solve.h: from a placed design and its controls to the field, by either method, with its guidance field.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "alcap/design_file.h"
#include "alcap/field_run.h"
#include "apps/alcap/commands/command.h"
#include "apps/alcap/report/progress.h"

namespace alcap::app {

/// What a design is solved from. The run has its surface.
struct DesignProblem {
  const DesignFile& design;  ///< placed
  const std::vector<DesignControl>& controls;
  const FieldRun& run;
  std::string solver;
};

struct SolvedDesign {
  DesignResult result;    ///< controls in the order of DesignProblem::controls
  Json guidance = {};     ///< what the report says of the guidance field
  Json solve = {};        ///< and of the solve
  bool converged = true;  ///< every eigenproblem on the way
  double guidance_seconds = 0, prepare_seconds = 0, solve_seconds = 0;
};

[[nodiscard]] SolvedDesign solve_design(const DesignProblem& problem, Progress& progress);

}  // namespace alcap::app
