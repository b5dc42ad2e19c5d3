// SPDX-License-Identifier: MIT
//
// studio_solver.h: designs to fields, again and again on one surface, keeping what an edit leaves as it was: the
// connection, the guidance field, the factorised system, and the rows and right-hand sides of the other controls.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "alcap/design_file.h"
#include "alcap/singularities.h"
#include "alcap/topology.h"
#include "apps/alcap/commands/command.h"
#include "apps/alcap/page/view_scene.h"

namespace alcap::app {

/// What all designs of a studio share. Immutable.
struct StudioSurface {
  StudioSurface(Positions<double> points, const Faces& F);
  Positions<double> V;
  Mesh mesh;
  Topology topology;
  Geometry geometry;
};

/// A solved design. Immutable, but for what is computed when first asked for.
class StudioResult {
 public:
  std::uint64_t id = 0;  ///< of this run
  std::shared_ptr<const Connection> connection;
  Field field;
  std::vector<Singularity> singularities;
  Json controls = Json::array();  ///< path, met, error_degrees
  double seconds = 0;

  [[nodiscard]] ViewSource source(const StudioSurface& surface) const {
    return {surface.mesh, surface.V, surface.geometry, *connection, field, singularities};
  }
  /// Curves and numbers per face as bytes of a ViewPack; computed once, may be called from several threads.
  [[nodiscard]] const std::string& details(const StudioSurface& surface) const;

 private:
  mutable std::once_flag once_;
  mutable std::string details_;
};

class StudioSolver {
 public:
  explicit StudioSolver(const StudioSurface& surface);
  ~StudioSolver();
  /// The field of a design; without controls and guidance the smoothest one. Throws OptionError, SolveError.
  [[nodiscard]] std::shared_ptr<const StudioResult> solve(const DesignFile& design);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace alcap::app
