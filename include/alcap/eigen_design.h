// SPDX-License-Identifier: MIT
//
// eigen_design.h: the smoothest field that follows strokes and has singularities where and how they are asked for
// (LTGD 2016, Sec. 7.2): per component the smallest eigenpair of
//   (S + w int |d/ds (u - (u.c) c)|^2 ds) u = lambda (M + w int |u.c|^2 ds) u
// for polylines with unit tangent c. The part of the field across the stroke is kept constant along it, the part along
// the stroke is rewarded; the length of the field is not drawn to any value. For n-fields c is its n-th power.
// Singularities reward the flux P u (or Q u, for negative ones) of their faces in the direction asked for, and penalise
// it across. Squares know no sign: a field could follow a stroke to its middle and run back from there, which for even
// n means across it (measured: crosses on a scan at 16 to 20 degrees on average, whatever the weight), and of two
// targets one could come out opposite. So one more square, over the sum of a component's fluxes and of the means along
// its strokes, is added to the right side: everything takes one sign (the same strokes: 1 to 7 degrees).
//
// A pinned zero is a linear condition, sum_i Psi_i(x) u_i = 0, and is met exactly: the field is sought among those that
// meet it. Guidance by a field g of weight w adds w min over real r of int |u - r g|^2 to the left side: the guidance
// of a variational design with a length that is free, since an eigenvector has none of its own. Without other controls
// u is then a multiple of (S - lambda_t M)^-1 M g with lambda_t = lambda - w: the field of Knoeppel et al. 2013 for the
// lambda_t that belongs to this w. It is below the smallest eigenvalue of S for every w, so that there is no limit to
// mind; for w -> 0 the field becomes the smoothest one, for w -> infinity g, of which only the directions count: a g
// longer or shorter everywhere asks for the same. What else has a sign is drawn to r times what it is drawn to in a
// variational design, so that it takes that of the guidance.
//
//   auto line = alcap::stroke_from_space(connected, points);
//   auto result = alcap::eigen_design(
//       connected, {.strokes = {{.line = line}}, .singularities = {{.face = 12, .sign = -1}}}, {.n = 4});
//   result.field.u, result.components[0].lambda, result.strokes[0].mean_degrees ...
//
// A field and its opposite follow a single stroke equally well: of both, the one that agrees with the controls is
// returned.
#pragma once

#include <memory>
#include <vector>

#include "alcap/control.h"
#include "alcap/controls.h"
#include "alcap/smoothest.h"
#include "alcap/strokes.h"

namespace alcap {

/// How the stroke terms, which are linear over the reals only, are solved.
enum class EigenPath {
  automatic,  ///< low_rank for short strokes, real_view for long ones; plainly complex without strokes
  real_view,  ///< one factorisation of the real 2 #V x 2 #V matrix
  low_rank,   ///< one of the complex matrix, the strokes as an update (Woodbury)
};
template <>
struct NamesOf<EigenPath> {
  static constexpr auto table = detail::name_table<EigenPath>(
      {{EigenPath::automatic, "auto"}, {EigenPath::real_view, "real_view"}, {EigenPath::low_rank, "low_rank"}});
};

/// A stroke of an eigen design.
struct EigenStroke {
  SurfacePolyline line;  ///< the line on the surface
  /// w in units of 10 sqrt(area of the component): 1 means the same on every mesh and in every unit. 1 draws the field
  /// to within a few degrees of the stroke, 100 to what the polyline's own corners leave. In [1e-100, 1e12].
  double weight = 1;
  bool across = false;  ///< across the line, not along it
  /// As Stroke::radius: the terms are integrals over a band of this half width, with the share that every vertex has of
  /// the length for ds. 0: the line alone.
  double radius = 0;
};

/// What an eigen design asks for.
struct EigenControls {
  std::vector<EigenStroke> strokes = {};  ///< lines to follow
  /// Strength 1 outweighs the smoothest field of a surface without targets several times. Pins are exact.
  std::vector<SingularityTarget> singularities = {};
  /// Directions at vertices: the part across is penalised as heavily as that of targets, the part along has the sign of
  /// everything else. Lengths are the field's own, whatever `value` and `direction_only` say.
  std::vector<VertexConstraint> fixed = {};
  /// A stroke along every line. Directions that are held are exact: the field is sought among those that have them,
  /// each vertex with a length of its own. Next to other controls, and where a length would come out negative, which is
  /// another direction, the field is as long at all of them (on its component).
  std::vector<FeatureAlignment> features = {};
  /// g, one value per vertex (same mesh and n), of any length; 0 on a component says nothing of directions there.
  /// Empty: with a weight the field is drawn towards zero, away from everything else that is asked for.
  ComplexVectorX<double> guidance = {};
  /// As DesignerOptions::guidance_weight, in units of 2 lambda_min of a round sphere of the area of the surface against
  /// 2 S: 1 weighs closeness to g like smoothness. 0: no guidance. In [0, 1e12].
  double guidance_weight = 0;
  /// As Designer::set_guidance_weights(): weights at vertices, which multiply that one. Empty: 1.
  VectorX<double> guidance_weights = {};
};

/// How an eigen design is solved.
struct EigenDesignOptions {
  int n = 1;       // 1 vector field, 2 line field, 4 cross field
  double s = 0.0;  // energy family, as SmoothestOptions::s
  /// Adds offset w int |u - (u.c) c|^2 / area to the left side. The two terms of the paper leave a part across the
  /// stroke that is constant along it free: fields at a constant angle to a stroke cost nothing, and on flat surfaces a
  /// stroke then aligns nothing. 1 is enough to remove it, and adds no pull on the length of the field. 0: as in the
  /// paper.
  double offset = 1;
  EigenOptions eigen = {};                // tolerance, backend; `method` is used by components without strokes
  EigenPath path = EigenPath::automatic;  ///< how the constrained eigenproblem is solved
  ControlTolerances tolerances = {};      // what counts as met
  int largest_rank = 64;  // automatic: rows kept as an update (two per face); beyond, the real factorisation is cheaper
  /// Phases "assembly", "solve", "analysis". EigenOptions::cancel is honoured in the whole call as well.
  RunControl control = {};
};

/// How well a stroke is followed, means over its length.
struct EigenStrokeReport {
  double mean_degrees = 0;     ///< angle between the stroke and the nearest branch of the field
  double largest_degrees = 0;  ///< the largest one
  double magnitude = 0;        ///< mean |u| along the stroke over the root mean square of |u| on its component
  bool met = false;            ///< mean within ControlTolerances::stroke_degrees
};

/// What eigen_design() returns.
struct EigenDesignResult {
  Field field;  ///< int |u|^2 = 1 on every component
  /// One per component, in the order of topology.h. Eigenvalues are those of the whole problem, controls and guidance
  /// included, and what residuals are relative to grows with the weight of guidance.
  std::vector<EigenReport> components;
  std::vector<EigenStrokeReport> strokes;    ///< what became of each stroke
  std::vector<ControlReport> singularities;  ///< as of designer.h; ids are their positions
  std::vector<ControlReport> fixed;          ///< the same
  std::vector<ControlReport> features;       ///< the same
  double assembly_seconds = 0;               ///< wall clock
  double eigen_seconds = 0;                  ///< wall clock
};

/// Solves; without controls as smoothest_field(). Throws OptionError for n < 1, s outside [-1, 1], bad weights,
/// guidance of another size or without a weight, or strokes, singularities, fixed directions and features that are
/// empty or name faces, vertices or edges that the mesh does not have. Non-convergence is reported. O(factorisation);
/// the derivative along the stroke is the difference quotient of the part across it between the middles of its pieces
/// (one per face, where the tangent is that of the smooth curve to second order), everything else is the closed-form
/// basis integrated by three Gauss points per segment.
[[nodiscard]] EigenDesignResult eigen_design(const ConnectedSurface& surface, const EigenControls& controls,
                                             const EigenDesignOptions& options = {});

}  // namespace alcap
