// SPDX-License-Identifier: MIT
//
// designer.h: variational design (LTGD 2016, Sec. 7.1), prepared once and edited cheaply: the n-vector field that
// minimises
//   1/2 int |div u - d|^2 + |curl u - c|^2 + |reflected pair - s|^2 + w |u - u0|^2
// for targets (d, c) and s on chosen faces and a guidance field u0, i.e. (2 S + w M) u = P' (d + ic) + Q' s + w M u0,
// with pinned zeros, fixed vertices and strokes as extra rows.
//
//   alcap::Designer designer(connected, {.n = 4});
//   auto saddle = designer.add(alcap::SingularityTarget{.face = 1200, .sign = -1, .orientation = 0.3});
//   auto source = designer.add(alcap::SingularityTarget{.face = 77});
//   alcap::DesignResult result = designer.solve();
//   designer.set(saddle, {.face = 1200, .sign = -1, .orientation = 0.4});   // a new right-hand side, nothing else
//   designer.move(saddle, 1300);                        // likewise merge() and split()
//   result = designer.solve();
//
// The matrix is factorised once. Targets change the right-hand side only, and one that has been changed before keeps
// its own solution, so that turning it costs no solve, pinned or not; pins, fixed vertices and strokes are low-rank
// (one backsolve per row, kept until the control changes), and beyond DesignerOptions::largest_rank strokes are folded
// into the matrix, which is then factorised again. One thread at a time.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "alcap/control.h"
#include "alcap/controls.h"
#include "alcap/field.h"
#include "alcap/operators.h"
#include "alcap/solve.h"

namespace alcap {

class ConnectedSurface;

/// What a Designer is prepared for.
struct DesignerOptions {
  int n = 1;  ///< 1 vector field, 2 line field, 4 cross field
  /// Weight of the guidance field, in units of 2 lambda_min of a round sphere of the same area: 1 weighs closeness to
  /// u0 like smoothness. 0: no guidance; on flat and trivial connections the field must then be held or drawn
  /// somewhere (pins, fixed vertices, strokes, boundary): targets alone do not determine it. In [0, 1e12].
  double guidance_weight = 0;
  /// The guidance field in the form of Knoeppel et al. 2013, (S - lambda_t M) u = M u0, instead of guidance_weight: t
  /// is lambda_t in units of lambda_min of a round sphere of the same area. -1 is guidance_weight = 1, smaller is
  /// closer to u0, and towards lambda_1 the field becomes the smoothest one. Must be below lambda_1, which is checked.
  std::optional<double> t = std::nullopt;
  double s = 0;  // energy family in [-1, 1], see SmoothestOptions::s; 0 is the Dirichlet energy
  // How targets are integrated. The area form is the one S itself is made of, so a lone target is met exactly; with the
  // edge form a few faces of very coarse meshes miss theirs.
  OperatorKind kind = OperatorKind::triangle;  ///< edge- or triangle-based targets
  ControlTolerances tolerances = {};           // what counts as met; cones and pins are not judged here
  int largest_rank = 256;                      // rows of strokes kept as an update; beyond, refactorising is cheaper
  std::string solver = "auto";                 // linear backend
  /// As SolverOptions::right_hand_sides, for a design that is solved once: one for all targets and one for each pin and
  /// vertex. 0: controls will come and go.
  int right_hand_sides = 0;
  /// Called on the calling thread when a phase starts: "assembly", "analyse", "factorise", "rows" (several times),
  /// "solve", "analysis". An exception thrown here ends the call and reaches the caller; the designer stays as it was
  /// and can be used again.
  std::function<void(std::string_view phase)> progress = {};
  /// Stopping, watching and threads of every call of the designer; its phases are those of `progress`. After Cancelled
  /// the designer stays as it was and can be used again.
  RunControl control = {};
};

/// What Designer::solve() returns.
struct DesignResult {
  Field field;                          ///< the field
  std::vector<ControlReport> controls;  ///< in the order of their ids
  int rows = 0;                         ///< low-rank rows in this solve
  int solves = 0;                       ///< right-hand sides solved for by this call
  double residual = 0;                  ///< relative residual of the system with its rows, recomputed
  std::string solver;                   ///< the linear backend and its choices
  double seconds = 0;                   ///< wall clock
};

/// A design that is prepared once and edited cheaply, see the top of this file.
class Designer {
 public:
  /// Shares the surface. Throws OptionError for bad options and for t not below lambda_1. On a surface that lies in no
  /// space fields have no frames, and strokes are given as lines.
  explicit Designer(const ConnectedSurface& surface, const DesignerOptions& options = {});
  ~Designer();
  Designer(Designer&&) noexcept;
  /// Moves the prepared system.
  Designer& operator=(Designer&&) noexcept;

  /// Adds a control; throws OptionError naming what is wrong with it.
  ControlId add(Control control);
  /// Replaces a control.
  void set(ControlId id, Control control);
  /// Removes a control; throws OptionError when there is none with this id.
  void remove(ControlId id);
  /// Moves a singularity to another face. Its direction is carried along the shortest strip of faces, unfolded; a pin
  /// goes to the barycenter. The same as setting it there: a new right-hand side. Throws OptionError for a control that
  /// is not a singularity and a face that cannot be reached.
  void move(ControlId id, Index face);
  /// Two singularities become one, in the place of the first and with its direction: the indices add, the second one is
  /// gone. Where they cancel both are gone, and there is no id. Throws OptionError for controls that are not two
  /// singularities.
  std::optional<ControlId> merge(ControlId id, ControlId other);
  /// `count` n-ths of a singularity of index +-k/n, k > count, go to another face, as a new control, whose direction is
  /// carried there. Throws OptionError.
  ControlId split(ControlId id, Index face, int count = 1);
  /// The controls by id.
  [[nodiscard]] const std::map<ControlId, Control>& controls() const;

  /// The field to stay close to (same mesh and n; its frames are not read). Throws OptionError without a guidance
  /// weight or t.
  void set_guidance(const ComplexVectorX<double>& u0);
  /// Another weight, in the units of the option: a numeric factorisation, no analysis. Throws OptionError as the
  /// constructor does, and leaves the old weight then. Ends the use of `t`.
  void set_guidance_weight(double weight);
  /// Weights per vertex (#V, none negative, not all zero) that multiply the guidance weight: w int |u - u0|^2 becomes w
  /// int |sum_i sqrt(weights_i) Psi_i (u_i - u0_i)|^2. A numeric factorisation. Throws OptionError.
  void set_guidance_weights(const VectorX<double>& weights);

  /// Solves the design. Without any control or guidance the answer would be zero: throws OptionError instead, and where
  /// the system is singular: the connection has parallel fields, and there is neither a guidance weight nor a row that
  /// holds or draws the field. Connected pieces that no row touches are then drawn towards zero.
  [[nodiscard]] DesignResult solve();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace alcap
