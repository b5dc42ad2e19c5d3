// SPDX-License-Identifier: MIT
//
// design_aligned.cpp: designs that ask for nothing but directions along or across the boundary, and at vertices. One
// linear solve fades away from them, and zeros crowd where it does: a round disk gets eight instead of four. So they
// are solved as aligned fields are (aligned.h).
#include <algorithm>
#include <cmath>
#include <variant>

#include "alcap/aligned.h"
#include "src/base/clock.h"
#include "src/base/numbers.h"
#include "src/run/design_stages.h"

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

bool follows_boundary_alone(const DesignFile& placed) {
  return placed.boundary.wanted && placed.method == DesignMethod::variational && placed.n % 2 == 0 && placed.s == 0 &&
         placed.guidance.source == DesignGuidance::Source::nothing && !placed.guidance.t &&
         placed.singularities.empty() && placed.strokes.empty() &&
         std::all_of(placed.fixed.begin(), placed.fixed.end(), [](const DesignFixed& f) { return f.free_length; });
}

bool solve_along_boundary(const ConnectedSurface& surface, const FeatureGraph& graph, double coarser,
                          const DesignRunOptions& options, const std::vector<DesignControl>& controls,
                          std::vector<ControlReport>& reports, DesignRun& run) {
  const Stopwatch watch;
  if (surface.topology().loops.empty())
    throw OptionError("/boundary", "none", "this mesh has no boundary to align with");
  const DesignBoundary& boundary = run.design.boundary;
  AlignedOptions aligned{.n = run.design.n,
                         .across = boundary.normal,
                         .weight = boundary.weight,
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
  const double degrees = measure_features(surface, run.field, graph, {}, boundary.normal).all.mean_degrees;
  for (const DesignControl& c : controls) {
    const auto* const fixed = std::get_if<VertexConstraint>(&c.control);
    const double error = fixed == nullptr ? degrees : direction_error(*fixed, run.field);
    reports.push_back(
        {.met = error <= (fixed == nullptr ? stroke_met_degrees : target_met_degrees), .error_degrees = error});
  }
  run.times.solve = watch.seconds();
  return converged;
}

}  // namespace alcap::detail
