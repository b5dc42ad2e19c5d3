// SPDX-License-Identifier: MIT
//
// controls.h: what a design can ask of a field (LTGD 2016, Sec. 7), and what became of it. Used by designer.h
// (variational) and eigen_design.h (smoothest); design_file.h writes them down.
//
//   alcap::SingularityTarget saddle{.face = 1200, .sign = -1, .orientation = 0.3};
//   alcap::Stroke stroke{.line = alcap::stroke_from_space(surface, points), .radius = 0.05};
#pragma once

#include <array>
#include <optional>
#include <variant>
#include <vector>

#include "alcap/conventions.h"
#include "alcap/sharp_edges.h"
#include "alcap/strokes.h"

namespace alcap {

/// A singularity of index sign count / n asked for in a face.
struct SingularityTarget {
  Index face = none;  ///< the face it is to lie in
  int sign = 1;       // +1: source, vortex, spiral (n = 1), wedge; -1: saddle, trisector
  /// So many zeros of index sign/n side by side, in `face` and in faces about three edges from it and from each other,
  /// turned and weighed so that around them is one pattern of index sign count / n: no single face can hold more than
  /// one. At most 8; more than 4 often miss a face.
  int count = 1;
  /// As Singularity::orientation, radians in the face's frame. Index 1 (sign count = n): 0 source, pi/2 vortex, pi
  /// sink. Otherwise the direction of one of the |n - sign count| straight branches of the pattern.
  double orientation = 0;
  /// 1 holds against a guidance field of unit length, on every mesh and in every unit. In [1e-100, 1e12], as every
  /// weight: further apart, the lighter one would keep no digits.
  double strength = 1;
  /// Puts the zero exactly here, inside `face`, whatever the rest of the design wants; the others of a count at the
  /// barycenters of their faces.
  std::optional<std::array<double, 3>> pin = std::nullopt;
};

/// The field at a vertex, as an n-th power in the vertex frame: u[vertex] = value exactly, or, with `direction_only`,
/// a real multiple of it (the report tells when the multiple came out negative).
struct VertexConstraint {
  Index vertex = none;          ///< which vertex
  Complex<double> value = 1;    ///< u there
  bool direction_only = false;  ///< the length is free
};

/// Soft alignment with a polyline on the surface: the field is drawn to unit vectors along it. A line of strokes.h is
/// followed through every face it crosses, at the middle of each segment. Or give points: each speaks for half of its
/// two segments, and its tangent is the mean of theirs, projected to its face.
struct Stroke {
  std::vector<SurfacePoint> points = {};  // at least two, in order
  double weight = 1;                      // in [1e-100, 1e12]; larger follows closer, the report says how close it came
  SurfacePolyline line = {};              // instead of points
  /// Half the width of a hat-shaped footprint, in units of length of the mesh: vertices this close are drawn along too,
  /// less the farther they are. The weight is spread, not multiplied. 0: the line alone. Only with `line`.
  double radius = 0;
};

/// Soft alignment with every boundary loop: along it, or across it. Weights as of a stroke along the boundary.
struct BoundaryAlignment {
  bool normal = false;  ///< across the boundary, not along it
  double weight = 1;    ///< in [1e-100, 1e12]; larger follows closer
};

/// Alignment of a field of even n with edges, usually the creases that sharp_edges() finds. The field is drawn to unit
/// vectors along them, or across them, as by a stroke along every line. With `hold` its direction is exact at their
/// vertices besides, and its length is its own: an n-field never turns away from a feature there. Vertices where
/// features meet that no n-direction follows within 5 degrees stay free: see feature_directions().
struct FeatureAlignment {
  FeatureGraph features = {};  ///< of the surface that the design is for
  bool across = false;         ///< across the features, not along them; the same where n is a multiple of 4
  double weight = 1;           ///< as of Stroke, in [1e-100, 1e12]
  bool hold = true;            ///< directions at vertices are exact, the weight draws lengths to 1
};

/// How far off controls may be and still count as met; the field itself does not depend on it. Degrees, in (0, 180],
/// are those of ControlReport::error_degrees and DesignOutcome::error_degrees; the other two are in (0, 1].
struct ControlTolerances {
  /// Orientation of a singularity, and a direction fixed at a vertex: solved for exactly where nothing else pulls, so
  /// what is left is the influence of other controls, and half a degree of it is not visible.
  double singularity_degrees = 0.5;
  double fixed_degrees = 0.5;  ///< the same of fixed directions
  /// Mean deviation from a stroke, from features and from the boundary: the field is drawn to them, not tied, and ten
  /// degrees off still reads as along.
  double stroke_degrees = 10;
  double boundary_degrees = 10;  ///< the same of the boundary
  /// Curvature of a cone, 360 degrees to index 1. Connections have it up to rounding: a millionth of a turn.
  double cone_degrees = 360e-6;
  /// Vertices whose length is given as well (variational designs): |u - value|, over |value| and the largest |u| added.
  /// Exact up to rounding.
  double fixed_value = 1e-6;
  /// Pinned zeros in design runs: |u| at the pin, over the largest at the corners of its face. Exact up to rounding.
  double pin_length = 1e-6;
};

/// Any of the things that a design can ask for.
using Control = std::variant<SingularityTarget, VertexConstraint, Stroke, BoundaryAlignment, FeatureAlignment>;
/// The name of a control within its Designer.
enum class ControlId : int {};

/// What became of one control.
struct ControlReport {
  ControlId id{};    ///< which control
  bool met = false;  ///< within ControlTolerances
  int index = 0;     ///< targets: index found in the face, or in all faces of its count (n-ths)
  /// Targets: of orientation; strokes, boundary: mean deviation; features: the same off their corners; fixed vertices:
  /// direction.
  double error_degrees = 0;
};

}  // namespace alcap
