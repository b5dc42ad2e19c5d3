// SPDX-License-Identifier: MIT
//
// studio_solver.h: designs to fields, again and again on one surface (DesignSession), and what the page shows of them.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "alcap/design_run.h"
#include "alcap/output.h"
#include "alcap/singularities.h"
#include "alcap/smoothest.h"
#include "alcap/streamlines.h"
#include "apps/alcap/commands/command.h"
#include "apps/alcap/page/view_scene.h"

namespace alcap::app {

/// What a page can ask for of a field besides the field, one at a time. Nothing is computed that nobody looks at.
enum class StudioPart {
  coarse,        ///< curves three times as far apart: soon there on large meshes
  curves,        ///< evenly spaced
  separatrices,  ///< leaving the singularities
  colours,       ///< numbers per face
};
inline constexpr std::array<std::string_view, 4> part_names{"coarse", "curves", "separatrices", "colours"};

/// The evenly spaced curves that were traced last on a surface, of whatever field: those of the next one begin with
/// what still follows it.
class CurveMemory {
 public:
  /// Null where there are none.
  [[nodiscard]] std::shared_ptr<const CurveSet> latest() const {
    const std::lock_guard lock(mutex_);
    return latest_;
  }
  void keep(std::shared_ptr<const CurveSet> curves) {
    const std::lock_guard lock(mutex_);
    latest_ = std::move(curves);
  }

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<const CurveSet> latest_;
};

/// A solved design. Immutable, but for what is computed when first asked for.
class StudioResult {
 public:
  std::uint64_t id = 0;  ///< of this run
  ConnectedSurface surface;
  Field field;
  std::vector<Singularity> singularities;
  Json controls = Json::array();  ///< path, met, error_degrees, tolerance_degrees
  /// Vertices of the lines that a design with `features` follows, one after the other; line k is [offsets[k], ...).
  std::vector<std::uint32_t> creases, crease_offsets{0};
  /// Vertices where such lines meet and no field follows them all; where they are held, they are free there.
  std::size_t free_corners = 0;
  double seconds = 0;
  int mode = 0;                     ///< the field is this one of the smoothest, from 1; 0: it is that of the design
  std::vector<double> eigenvalues;  ///< of the modes, where it is one of them

  /// What pages and files are made of; refers to this.
  [[nodiscard]] FieldOutput output() const {
    return {.surface = surface, .field = field, .singularities = singularities};
  }
  /// Bytes of a ViewPack; computed once, may be called from several threads. Throws Cancelled.
  [[nodiscard]] const std::string& part(StudioPart which, const RunControl& control = {}) const;

 private:
  [[nodiscard]] std::string make(StudioPart which, const RunControl& control) const;

  friend class StudioSolver;
  /// Of the coarse curves and of the others.
  struct Memories {
    CurveMemory coarse, fine;
  };
  std::shared_ptr<Memories> memories_;  // null: nothing to begin with
  mutable std::array<std::once_flag, part_names.size()> once_;
  mutable std::array<std::string, part_names.size()> parts_;
};

class StudioSolver {
 public:
  explicit StudioSolver(const Surface& surface, const ControlTolerances& tolerances = {});
  /// The field of a design; without controls and guidance the smoothest one. Throws OptionError, SolveError.
  [[nodiscard]] std::shared_ptr<const StudioResult> solve(const DesignFile& design);
  /// The k-th smoothest field, 1 to most_modes, on the connection of a solved design. Throws OptionError.
  [[nodiscard]] std::shared_ptr<const StudioResult> mode(const StudioResult& solved, double s, int k);

  static constexpr int most_modes = 8;

 private:
  /// With a number and what is kept from one result to the next.
  [[nodiscard]] std::shared_ptr<StudioResult> make_result();

  DesignSession session_;
  std::shared_ptr<StudioResult::Memories> memories_ = std::make_shared<StudioResult::Memories>();
  /// The modes that were asked for last, and of what.
  EigenModes modes_;
  ConnectedSurface modes_surface_;
  int modes_n_ = 0;
  double modes_s_ = 0;
  std::uint64_t results_ = 0;
};

}  // namespace alcap::app
