// SPDX-License-Identifier: MIT
//
// designer.h: variational design (LTGD 2016, Sec. 7.1), prepared once and edited cheaply: the n-vector field that
// minimises
//   1/2 int |div u - d|^2 + |curl u - c|^2 + |reflected pair - s|^2 + w |u - u0|^2
// for targets (d, c) and s on chosen faces and a guidance field u0, i.e. (2 S + w M) u = P' (d + ic) + Q' s + w M u0,
// with pinned zeros, fixed vertices and strokes as extra rows.
//
//   alcap::Designer designer(mesh, V, geometry, connection, {.n = 4});
//   auto saddle = designer.add(alcap::SingularityTarget{.face = 1200, .sign = -1, .orientation = 0.3});
//   auto source = designer.add(alcap::SingularityTarget{.face = 77});
//   alcap::DesignResult result = designer.solve();
//   designer.set(saddle, {.face = 1200, .sign = -1, .orientation = 0.4});   // a new right-hand side, nothing else
//   result = designer.solve();
//
// The matrix is factorised once. Targets change the right-hand side only; pins, fixed vertices and strokes are low-rank
// (one backsolve per row, kept until the control changes), and beyond DesignerOptions::largest_rank strokes are folded
// into the matrix, which is then factorised again.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "alcap/field.h"
#include "alcap/operators.h"
#include "alcap/solve.h"
#include "alcap/strokes.h"

namespace alcap {

/// A singularity of index sign/n asked for in a face.
struct SingularityTarget {
  Index face = none;
  int sign = 1;  // +1: source, vortex, spiral (n = 1), wedge; -1: saddle, trisector
  /// As Singularity::orientation, radians in the face's frame. n = 1, positive: 0 source, pi/2 vortex, pi sink.
  /// Otherwise the direction of one of the |n - sign| straight branches of the pattern.
  double orientation = 0;
  double strength = 1;  // 1 holds against a guidance field of unit length, on every mesh and in every unit
  /// Puts the zero exactly here, inside `face`, whatever the rest of the design wants.
  std::optional<std::array<double, 3>> pin = std::nullopt;
};

/// The field at a vertex, as an n-th power in the vertex frame: u[vertex] = value exactly.
struct VertexConstraint {
  Index vertex = none;
  Complex<double> value = 1;
};

/// Soft alignment with a polyline on the surface: the field is drawn to unit vectors along it. Each point speaks for
/// half of its two segments; its tangent is the mean of theirs, projected to its face. A line of strokes.h in place of
/// points is followed through every face it crosses, at the middle of each segment.
struct Stroke {
  std::vector<SurfacePoint> points = {};  // at least two, in order
  double weight = 1;                      // larger follows closer; the report says how close it came
  SurfacePolyline line = {};              // instead of points
};

struct DesignerOptions {
  int n = 1;
  /// Weight of the guidance field, in units of 2 lambda_min of a round sphere of the same area: 1 weighs closeness to
  /// u0 like smoothness. 0: no guidance; the system is then singular on flat and trivial connections, which is refused.
  double guidance_weight = 0;
  // How targets are integrated. The area form is the one S itself is made of, so a lone target is met exactly; with the
  // edge form a few faces of very coarse meshes miss theirs.
  OperatorKind kind = OperatorKind::triangle;
  int largest_rank = 256;       // rows of strokes kept as an update; beyond, refactorising is cheaper
  std::string solver = "auto";  // linear backend
};

using Control = std::variant<SingularityTarget, VertexConstraint, Stroke>;
enum class ControlId : int {};

/// What became of one control.
struct ControlReport {
  ControlId id{};
  bool met = false;
  int index = 0;             ///< targets: index found in the face (n-ths)
  double error_degrees = 0;  ///< targets: of orientation; strokes: mean deviation; fixed vertices: of direction
};

struct DesignResult {
  Field<double> field;
  std::vector<ControlReport> controls;  ///< in the order of their ids
  int rows = 0;                         ///< low-rank rows in this solve
  double residual = 0;                  ///< relative residual of the solve before the rows, recomputed
  double seconds = 0;
};

class Designer {
 public:
  /// Keeps references: mesh, V, geometry and connection must outlive it. Throws OptionError for bad options, SolveError
  /// when the system is singular (a parallel field exists and there is no guidance weight).
  Designer(const Mesh& mesh, const Positions<double>& V, const Geometry<double>& geometry,
           const Connection<double>& connection, const DesignerOptions& options = {});
  ~Designer();
  Designer(Designer&&) noexcept;
  Designer& operator=(Designer&&) noexcept;

  /// Adds a control; throws OptionError naming what is wrong with it.
  ControlId add(Control control);
  /// Replaces a control.
  void set(ControlId id, Control control);
  void remove(ControlId id);
  [[nodiscard]] const std::map<ControlId, Control>& controls() const;

  /// The field to stay close to (same mesh and n; its frames are not read). Throws OptionError without a guidance
  /// weight.
  void set_guidance(const ComplexVectorX<double>& u0);

  /// Solves the design. Without any control or guidance the answer would be zero: throws OptionError instead.
  [[nodiscard]] DesignResult solve();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace alcap
