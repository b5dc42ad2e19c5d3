// SPDX-License-Identifier: MIT
//
// studio_solver.h: designs to fields, again and again on one surface (DesignSession), and what the page shows of them.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "alcap/design_run.h"
#include "alcap/output.h"
#include "alcap/singularities.h"
#include "apps/alcap/commands/command.h"
#include "apps/alcap/page/view_scene.h"

namespace alcap::app {

/// A solved design. Immutable, but for what is computed when first asked for.
class StudioResult {
 public:
  std::uint64_t id = 0;  ///< of this run
  ConnectedSurface surface;
  Field field;
  std::vector<Singularity> singularities;
  Json controls = Json::array();  ///< path, met, error_degrees, tolerance_degrees
  double seconds = 0;

  /// What pages and files are made of; refers to this.
  [[nodiscard]] FieldOutput output() const {
    return {.surface = surface, .field = field, .singularities = singularities};
  }
  /// Curves and numbers per face as bytes of a ViewPack; computed once, may be called from several threads.
  [[nodiscard]] const std::string& details() const;

 private:
  mutable std::once_flag once_;
  mutable std::string details_;
};

class StudioSolver {
 public:
  explicit StudioSolver(const Surface& surface);
  /// The field of a design; without controls and guidance the smoothest one. Throws OptionError, SolveError.
  [[nodiscard]] std::shared_ptr<const StudioResult> solve(const DesignFile& design);

 private:
  DesignSession session_;
  std::uint64_t results_ = 0;
};

}  // namespace alcap::app
