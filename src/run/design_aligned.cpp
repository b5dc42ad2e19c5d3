// SPDX-License-Identifier: MIT
//
// design_aligned.cpp: designs that ask for nothing but directions along or across the boundary or features, and at
// vertices. One linear solve fades away from them, and zeros crowd where it does: a round disk gets eight instead of
// four. So they are solved as aligned fields are (aligned.h). And what is said of the features of any design.
#include <algorithm>
#include <cmath>
#include <variant>

#include "alcap/aligned.h"
#include "src/base/clock.h"
#include "src/base/numbers.h"
#include "src/run/design_stages.h"
#include "src/run/field_aligned.h"

namespace alcap::detail {
namespace {

/// The least angle between a fixed direction and the field at its vertex, in degrees.
double direction_error(const VertexConstraint& fixed, const Field& field) {
  return std::abs(std::arg(field.u[fixed.vertex] * std::conj(fixed.value))) / field.n * 180 / pi<double>;
}

void remark_free_pieces(const AlignedResult& result, DesignRun& run) {
  std::vector<char> free;
  for (const AlignedPiece& piece : result.pieces) free.push_back(piece.eigen ? 1 : 0);
  if (std::count(free.begin(), free.end(), 1) > 0) run.remarks.push_back(remark_pieces(free));
}

}  // namespace

AlignedAlone aligned_alone(const DesignFile& placed) {
  const bool one_kind = placed.boundary.wanted != placed.features.wanted;
  const bool alone =
      one_kind && placed.method == DesignMethod::variational && placed.n % 2 == 0 && placed.s == 0 &&
      placed.guidance.source == DesignGuidance::Source::nothing && !placed.guidance.t && placed.singularities.empty() &&
      placed.strokes.empty() &&
      std::all_of(placed.fixed.begin(), placed.fixed.end(), [](const DesignFixed& f) { return f.free_length; });
  if (!alone) return AlignedAlone::no;
  return placed.boundary.wanted ? AlignedAlone::boundary : AlignedAlone::features;
}

bool solve_along(AlignedAlone what, const ConnectedSurface& surface, const FeatureGraph& graph, double coarser,
                 const DesignRunOptions& options, const std::vector<DesignControl>& controls,
                 std::vector<ControlReport>& reports, DesignRun& run) {
  const Stopwatch watch;
  const DesignBoundary& boundary = run.design.boundary;
  const DesignFeatures& features = run.design.features;
  const bool rim = what == AlignedAlone::boundary, across = rim ? boundary.normal : features.across;
  if (rim && surface.topology().loops.empty())
    throw OptionError("/boundary", "none", "this mesh has no boundary to align with");
  AlignedOptions aligned{.n = run.design.n,
                         .across = across,
                         .weight = rim             ? boundary.weight
                                   : features.hold ? 0
                                                   : features.weight,
                         .finest = coarser * AlignedOptions{}.finest,
                         .eigen = {.solver = options.solver}};
  for (const DesignControl& c : controls)
    if (const auto* fixed = std::get_if<VertexConstraint>(&c.control)) aligned.fixed.push_back(*fixed);
  AlignedResult result = aligned_field(surface, graph, aligned);
  run.field = std::move(result.field);
  remark_free_pieces(result, run);
  bool settled = true, converged = true;
  for (const AlignedPiece& piece : result.pieces) {
    run.rows += piece.rows;
    run.solves += static_cast<int>(piece.steps.size());
    run.residual = std::max(run.residual, piece.residual);
    run.solver = piece.solver;
    settled = settled && piece.settled;
    converged = converged && (!piece.eigen || piece.eigen->converged);
  }
  if (!settled)
    run.remarks.push_back({.code = "not_settled", .message = "directions still changed when the steps were used up"});
  const double degrees = measure_features(surface, run.field, graph, {}, across).all.mean_degrees;
  for (const DesignControl& c : controls) {
    const auto* const fixed = std::get_if<VertexConstraint>(&c.control);
    const double error = fixed == nullptr ? degrees : direction_error(*fixed, run.field);
    reports.push_back({.met = error <= (fixed != nullptr ? options.tolerances.fixed_degrees
                                        : rim            ? options.tolerances.boundary_degrees
                                                         : options.tolerances.stroke_degrees),
                       .error_degrees = error});
  }
  if (run.features && !rim) run.features->pieces = std::move(result.pieces);
  run.times.solve = watch.seconds();
  return converged;
}

void judge_design_features(const DesignFile& asked, DesignRun& run) {
  FieldFeatures& features = *run.features;
  features.report = measure_features(run.surface, run.field, features.graph, run.singularities, asked.features.across);
  if (features.graph.edges.empty() || asked.features.hold)
    remark_features(features, "no edge folds enough to be a feature; the design is solved without", run.remarks);
  // What is drawn along strokes is told of each of them.
  std::vector<Remark> told;
  judge_followed(features, run.design.features.wanted ? run.remarks : told);
}

}  // namespace alcap::detail
