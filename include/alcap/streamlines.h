// SPDX-License-Identifier: MIT
//
// streamlines.h: integral curves of n-fields on the surface: through given points, evenly spaced over everything, and
// the separatrices that leave singularities.
//
//   const alcap::CurveSet curves = alcap::streamlines(connected, field, {.spacing = 0.01});
//   for (std::int64_t k = 0; k < curves.size(); ++k)
//     for (std::int64_t i = curves.offsets[k]; i < curves.offsets[k + 1]; ++i) draw(curves.points.row(i));
//
// Curves follow one of the n branches of the interpolated field: the closed-form basis of LTGD 2016, Sec. 4.3 (the
// field that FaceField::at evaluates), not one direction per face. Inside a face they are integrated by an adaptive
// Runge-Kutta method of fifth order (Dormand and Prince 1980) in arc length; across an edge a direction is carried by
// the connection's rotation at that point of the edge, so that it is exactly a branch on the other side. Results do not
// depend on the number of threads. Lengths in options are in units of the diagonal of the box around the mesh.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "alcap/control.h"
#include "alcap/field.h"
#include "alcap/singularities.h"
#include "alcap/strokes.h"

namespace alcap {

class ConnectedSurface;

/// Why a curve ends where it does.
enum class CurveEnd {
  seed,         ///< it was to start or end here
  boundary,     ///< at a boundary of the surface
  singularity,  ///< the field vanishes here
  loop,         ///< the curve has come back to itself with the same direction
  length,       ///< max_length is reached
  separation,   ///< the next step would be too close to another curve or to an earlier part of this one
  stuck,        ///< no progress; faces too thin for the precision of the numbers
  budget,       ///< the points that this curve, or all of them together, may have are used up
};
template <>
struct NamesOf<CurveEnd> {
  static constexpr auto table = detail::name_table<CurveEnd>({{CurveEnd::seed, "seed"},
                                                              {CurveEnd::boundary, "boundary"},
                                                              {CurveEnd::singularity, "singularity"},
                                                              {CurveEnd::loop, "loop"},
                                                              {CurveEnd::length, "length"},
                                                              {CurveEnd::separation, "separation"},
                                                              {CurveEnd::stuck, "stuck"},
                                                              {CurveEnd::budget, "budget"}});
};

/// Polylines on a surface, one after the other, each along its branch of the field.
struct CurveSet {
  Positions<double> points;       ///< #P x 3
  Positions<double> barycentric;  ///< #P x 3, in faces[i]; exactly zero opposite to the edge that a point lies on
  /// #P: the segment from point i - 1 to point i lies in faces[i], for the first point of a curve that of the second.
  std::vector<Index> faces;
  std::vector<std::int64_t> offsets{0};  ///< #curves + 1: curve k has the points offsets[k] to offsets[k + 1] - 1
  /// Why each curve starts where it does.
  std::vector<CurveEnd> start_reason, end_reason;  ///< #curves
  /// False when StreamlineOptions::max_points, or the time that curves of very many families may take, was used up
  /// before everything asked for was traced.
  bool complete = true;
  double spacing = 0;  ///< evenly spaced curves: what was asked for, in box diagonals; 0: others
  int n = 0;           ///< evenly spaced curves: degree of the field that they follow; 0: others

  /// How many curves.
  [[nodiscard]] std::int64_t size() const { return static_cast<std::int64_t>(offsets.size()) - 1; }
  /// Length of curve k: the sum of its segments.
  [[nodiscard]] double length(std::int64_t k) const;
  /// The points of curve k as points of the surface, each of which shares a face with the next: what transport() of
  /// transport.h carries vectors along, and polyline_through() makes a stroke of. Throws OptionError for a k that is no
  /// curve's.
  [[nodiscard]] std::vector<SurfacePoint> path(std::int64_t k) const;
  /// Appends the curves of another set.
  void append(const CurveSet& other);
};

/// Where a curve starts, and along which branch: the one whose direction is nearest to the angle, in radians, in the
/// frame of the face (halfedge 3 t).
struct CurveSeed {
  SurfacePoint point;  ///< where the curve starts
  double angle = 0;    ///< direction there, radians in the frame of the face
};

/// From a seed: along the branch, against it, or both ways in one curve.
enum class CurveSides { both, forward, backward };
template <>
struct NamesOf<CurveSides> {
  static constexpr auto table = detail::name_table<CurveSides>(
      {{CurveSides::both, "both"}, {CurveSides::forward, "forward"}, {CurveSides::backward, "backward"}});
};

/// How curves are traced and spaced.
struct StreamlineOptions {
  /// Distance between neighbouring curves of one family, in box diagonals, so that a picture of the whole shows the
  /// same density on every mesh. 0.01: some sixty curves across a compact shape, distinct at 1000 pixels.
  double spacing = 0.01;
  /// A curve ends where it comes closer than this to another one, as a fraction of `spacing`. 0.5 is what Jobard and
  /// Lefer (1997) recommend: larger gives shorter curves, smaller visibly uneven ones.
  double separation = 0.5;
  double min_length = 0.02;  // two spacings; shorter curves are noise. streamlines() drops them, others keep them
  double max_length = 5.0;   // box diagonals on each side of the seed; five times around a compact shape
  /// Error of one step of the integration, relative to the step. Steps are no longer than a face, on which fields turn
  /// little: 1e-6 costs hardly more than 1e-3 and closes loops to about 1e-6 of their length.
  double tolerance = 1e-6;
  /// A curve ends within this distance of a zero, in mean edge lengths: not visible, and far from rounding.
  double singularity_radius = 0.01;
  /// update_streamlines() keeps what the field is still within so many degrees of: a tenth of the spacing over ten
  /// spacings of length, which nobody sees. In [0, 45].
  double drift = 0.5;
  CurveSides sides = CurveSides::both;  // of trace_curves(): streamlines run both ways
  std::int64_t max_curves = 1'000'000;  // of streamlines(): a bound on memory when `spacing` is too small for the mesh
  /// Points (and steps between them) of all curves together, a bound on time and memory where thin faces make curves
  /// wind without end; a single curve gets a part of them. The ends of each curve may come on top. 0: some for every
  /// face and for every sample that `spacing` asks for, about 20 million and two per face at most. Curves that reach it
  /// end as CurveEnd::budget.
  std::int64_t max_points = 0;
  RunControl control = {};  // phase "curves"
};

/// Evenly spaced curves of all families over the whole surface, in the manner of Jobard and Lefer (1997). A cross field
/// has two families, an n-field n / 2 (n odd: n); curves of different families may cross. Distances are measured in
/// space between points whose normals differ by less than a right angle, to within a tenth of `spacing`. Seeds are
/// taken in a fixed order in rounds, traced in parallel, and accepted in that order. Every sample is compared with
/// those near it, of all families: beyond n = 70 or so, the comparisons are limited, and `complete` may be false.
/// Throws OptionError for bad options, sizes that do not match, values that are not finite, and on a surface that lies
/// in no space.
[[nodiscard]] CurveSet streamlines(const ConnectedSurface& surface, const Field& field,
                                   const StreamlineOptions& options = {});

/// The same after the field has changed a little, or only somewhere: what still follows it of the curves that an
/// earlier call returned is taken over as it is and goes on where it was cut, and only the room that is left is filled,
/// which costs what the change does. The earlier curves may be further apart; then they are refined. Which curves there
/// are depends on the earlier ones. What is said of them does not: they follow the field, to within `drift`, and keep
/// their distance. Throws OptionError as above, and for earlier curves that are not of this surface.
[[nodiscard]] CurveSet update_streamlines(const ConnectedSurface& surface, const Field& field, const CurveSet& earlier,
                                          const StreamlineOptions& options = {});

/// One curve per seed, in order, whatever the distances. A curve whose seed lies at a zero of the field has this one
/// point. Throws OptionError as above, and naming the seed when it is not a point of the surface.
[[nodiscard]] CurveSet trace_curves(const ConnectedSurface& surface, const Field& field,
                                    std::span<const CurveSeed> seeds, const StreamlineOptions& options = {});

/// The curves that leave singularities straight: from each singularity, in order, one for every direction in which the
/// field near it points away from its centre, or, for odd n, also towards it. A singularity of index k n-ths has
/// |n - k| of them (for odd n of either kind) when it is as round as its index allows; a flattened one of positive
/// index can have more. Where n = k (sources, sinks and centres of vector fields) no direction is special: none. Points
/// are in the order of tracing, from the singularity.
[[nodiscard]] CurveSet separatrices(const ConnectedSurface& surface, const Field& field,
                                    std::span<const Singularity> singularities, const StreamlineOptions& options = {});

}  // namespace alcap
