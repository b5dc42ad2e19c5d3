// SPDX-License-Identifier: MIT
//
// aligned.h: n-direction fields that run along features: creases, boundaries, fixed vertices. Everything else is free.
//
//   const alcap::FeatureGraph creases = alcap::sharp_edges(surface);
//   alcap::AlignedResult result = alcap::aligned_field(connected, creases, {.n = 4});
//   const auto zeros = alcap::find_singularities(connected, result.field);
//   alcap::FeatureReport how = alcap::measure_features(connected, result.field, creases, zeros);
//
// Where features say nothing, a harmonic field fades: away from them u decays like exp(-sqrt(lambda_1) d), and its
// zeros crowd where it is weakest. So the harmonic field is only the start. Steps of renormalising and diffusing,
//   v = u / |u|,   (M + tau L) u = M v   with the features held,
// lower the Ginzburg-Landau energy (Merriman, Bence and Osher 1992; Viertel and Osting 2019), which has the zeros where
// the field of unit length turns least. tau starts at 1/lambda_1, so that distant zeros feel each other, and falls in
// factors of four to a few squared edge lengths; below that a zero would stay pinned to its face. Every tau is one
// factorisation, every step one solve.
//
// Directions come from the angles of the connection around each vertex, so that a field folds over a crease.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "alcap/control.h"
#include "alcap/controls.h"
#include "alcap/field.h"
#include "alcap/sharp_edges.h"
#include "alcap/singularities.h"
#include "alcap/solve.h"

namespace alcap {

class ConnectedSurface;

/// How a field is aligned. A bad value throws OptionError.
struct AlignedOptions {
  int n = 4;            // degree; even, because a feature has no sense of direction
  bool across = false;  // across the features instead of along; the same where n is a multiple of 4
  /// 0: directions are held at the vertices of features. Above 0, at most 1e12: features draw, with the weight per
  /// length of a Stroke.
  double weight = 0;
  /// Vertices at which the direction of `value` is held; its length does not matter. They win over features.
  std::vector<VertexConstraint> fixed = {};
  bool linear = false;   // true: the harmonic field alone, without steps
  int max_steps = 1000;  // of all tau together; CAD parts take 3 to 60, a disk of 30,000 vertices 230
  /// A tau has settled when a step changes no direction by more than this times tau lambda_1: over a time of
  /// 1/lambda_1, whatever the steps, as much would change. What is left to move is then a small part of a zero's core.
  double settled_degrees = 1;
  /// The last tau, in squared edge lengths (if all triangles were alike). With 6, 2.4 edges of diffusion, the zeros of
  /// a disk of 5,000 vertices come within 0.015 of their place; with 2 they take twice the steps, at 1 they stick.
  double finest = 6;
  /// Of pieces without features. Its solver is the linear backend of all others, too.
  EigenOptions eigen = {};
  RunControl control = {};  // phases "assembly", "harmonic", "diffuse"
};

/// One step of renormalising and diffusing.
struct AlignedStep {
  double tau = 0;              ///< the time it diffuses for, length^2
  double energy = 0;           ///< 1/2 int |grad v|^2 of the unit directions before the step, plus the soft features'
  double largest_degrees = 0;  ///< largest |u_new - u_old| / n over the vertices, where 1 is a radian
  double rms_degrees = 0;      ///< root mean square of the same
};

/// How one connected component was solved.
struct AlignedPiece {
  Index held = 0;                                   ///< vertices whose direction is held
  Index rows = 0;                                   ///< feature edges that draw softly
  double lambda = 0;                                ///< lambda_1 of the piece with the features held at 0, 1/length^2
  std::vector<AlignedStep> steps = {};              ///< in order
  bool settled = false;                             ///< whether the last tau settled; linear: true
  double residual = 0;                              ///< relative, of the last system, recomputed
  std::string solver = {};                          ///< the linear backend and its choices
  std::optional<EigenReport> eigen = std::nullopt;  ///< a piece without features gets its smoothest field
};

/// What aligned_field() returns.
struct AlignedResult {
  /// |u| is 1 along held features and near it elsewhere, and small at zeros. Pieces without features: root mean square
  /// length 1.
  Field field;
  std::vector<AlignedPiece> pieces;  ///< per connected component, in the order of topology.h
  std::vector<Index> free_corners;   ///< see FeatureDirections
  /// Largest angle between a fixed vertex's direction and the field, degrees.
  double fixed_degrees = 0;
};

/// What features ask of the vertices on them.
struct FeatureDirections {
  std::vector<VertexConstraint> held;  ///< ascending; `value` of length 1, the length of the field is free
  /// Feature vertices that are left free because the features that meet there differ by more than 5 degrees from any
  /// direction of an n-field, ascending.
  std::vector<Index> free_corners;
};

/// The direction of an n-field at every vertex of features, along them or across. Throws OptionError for odd n where
/// there are features, and when the graph is one of another surface.
[[nodiscard]] FeatureDirections feature_directions(const ConnectedSurface& surface, const FeatureGraph& features, int n,
                                                   bool across = false);

/// The field. Throws OptionError (n below 1 or odd where there are features, bad options, a fixed vertex that no face
/// uses, `value` zero or not finite), SolveError, Cancelled. That directions did not settle is reported. Corners where
/// features meet are held where all of them agree with one n-direction (within 5 degrees), free otherwise; feature
/// edges between two free corners draw softly.
[[nodiscard]] AlignedResult aligned_field(const ConnectedSurface& surface, const FeatureGraph& features,
                                          const AlignedOptions& options = {});

/// How well a field follows one line: angles between an edge and the nearest branch at the middle of the edge. Edges
/// that touch a corner are told apart: no n-field may be able to follow all features there.
struct LineDeviation {
  Index edges = 0;                  ///< that touch no corner
  Index corner_edges = 0;           ///< that touch one
  double length = 0;                ///< of all of them
  double mean_degrees = 0;          ///< over the length of `edges`; 0 when there are none
  double p95_degrees = 0;           ///< 95 % of `edges` are below
  double worst_degrees = 0;         ///< of `edges`
  double corner_worst_degrees = 0;  ///< of `corner_edges`
  Index singularities = 0;          ///< in faces at its edges that have no corner
};

/// How well a field follows features.
struct FeatureReport {
  std::vector<LineDeviation> lines;    ///< as in the graph
  LineDeviation all;                   ///< of all edges together
  Index singularities_at_corners = 0;  ///< in faces with a corner
};

/// Measures a field of even n, whatever made it. `singularities` are those of find_singularities(). Throws OptionError
/// when the graph is one of another surface.
[[nodiscard]] FeatureReport measure_features(const ConnectedSurface& surface, const Field& field,
                                             const FeatureGraph& features,
                                             const std::vector<Singularity>& singularities, bool across = false);

}  // namespace alcap
