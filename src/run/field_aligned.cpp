// SPDX-License-Identifier: MIT
#include "src/run/field_aligned.h"

#include <algorithm>
#include <string>
#include <utility>

#include "src/base/array.h"
#include "src/base/clock.h"
#include "src/base/numbers.h"

namespace alcap::detail {
namespace {

constexpr double followed_degrees = ControlTolerances{}.stroke_degrees;

constexpr std::size_t features_named = 8;

}  // namespace

void remark_features(const FieldFeatures& features, const char* none, std::vector<Remark>& remarks) {
  if (features.graph.edges.empty()) {
    remarks.push_back({.code = "no_features", .message = none});
    return;
  }
  if (!features.free_corners.empty()) {
    Remark free{.code = "free_corners", .warning = false, .count = count_of(features.free_corners)};
    free.first.assign(features.free_corners.begin(),
                      features.free_corners.begin() +
                          static_cast<std::ptrdiff_t>(std::min(features_named, features.free_corners.size())));
    free.message = "at " + counted(free.count, "vertex", "vertices") +
                   " features meet at angles that no such field can follow at once; the field is free there";
    remarks.push_back(std::move(free));
  }
  std::int64_t rows = 0, held = 0;
  for (const AlignedPiece& piece : features.pieces) {
    rows += piece.rows;
    held += piece.held;
  }
  if (rows > 0 && held > 0)
    remarks.push_back({.code = "edges_between_free_corners",
                       .warning = false,
                       .message = counted(rows, "feature edge joins", "feature edges join") +
                                  " two vertices that are free, so that the field is only drawn along there; a mesh "
                                  "with vertices between them can follow closer",
                       .count = rows});
}

void judge_followed(FieldFeatures& features, std::vector<Remark>& remarks) {
  const auto& lines = features.report.lines;
  const auto count = std::count_if(lines.begin(), lines.end(),
                                   [](const LineDeviation& line) { return line.mean_degrees > followed_degrees; });
  features.followed = count == 0;
  if (features.followed) return;
  remarks.push_back({.code = "features_not_followed",
                     .message = "the field is more than " + rounded_text(followed_degrees) +
                                " degrees off on average along " + counted(count, "feature line", "feature lines"),
                     .count = count});
}

FeatureGraph features_of(const FieldRunOptions& options, const Surface& surface) {
  const FieldAlignment& align = *options.align;
  if (options.n % 2 != 0)
    throw OptionError("n", options.n, "must be even for alignment: a feature has no sense of direction");
  if (options.s != 0) throw OptionError("s", options.s, "must be 0 for alignment, which uses the Dirichlet energy");
  if (options.modes > 1)
    throw OptionError("modes", options.modes, "must be 1 for alignment, which solves for one field");
  return align.edges.empty() ? sharp_edges(surface, align.features)
                             : feature_graph(surface, edges_between(surface, align.edges), align.features);
}

void solve_aligned(const FieldRunOptions& options, const ConnectedSurface& surface, FeatureGraph graph, double coarser,
                   FieldRun& run) {
  Stopwatch watch;
  const FieldAlignment& align = *options.align;
  FieldFeatures& features = run.features.emplace();
  features.graph = std::move(graph);
  AlignedResult result = aligned_field(surface, features.graph,
                                       {.n = options.n,
                                        .across = align.across,
                                        .weight = align.weight,
                                        .linear = align.max_steps == 0,
                                        .max_steps = align.max_steps,
                                        .finest = coarser * AlignedOptions{}.finest,
                                        .eigen = options.eigen});
  run.field = std::move(result.field);
  features.pieces = std::move(result.pieces);
  features.free_corners = std::move(result.free_corners);
  run.times.eigen = watch.seconds();
}

void judge_aligned(const FieldRunOptions& options, FieldRun& run) {
  FieldFeatures& features = *run.features;
  features.report = measure_features(run.surface, run.field, features.graph, run.singularities, options.align->across);
  Certificate& certificate = run.certificate;
  for (const AlignedPiece& piece : features.pieces) {
    certificate.directions_settled = certificate.directions_settled && piece.settled;
    const bool small = piece.eigen ? within_tolerance(*piece.eigen, options.eigen)
                                   : piece.residual <= options.eigen.residual_tolerance();
    certificate.residual_small = certificate.residual_small && small;
    if (!piece.eigen) continue;
    certificate.eigen_converged = certificate.eigen_converged && piece.eigen->converged;
    if (piece.eigen->smallest == Smallest::refuted) certificate.smallest = Smallest::refuted;
  }
  remark_features(features,
                  "no edge folds enough to be a feature, and there is no boundary; the field is the smoothest one",
                  run.remarks);
  if (!certificate.directions_settled) {
    const auto count = std::count_if(features.pieces.begin(), features.pieces.end(),
                                     [](const AlignedPiece& piece) { return !piece.settled; });
    run.remarks.push_back({.code = "not_settled",
                           .message = "directions still changed when the steps were used up, on " +
                                      counted(count, "component", "components") + "; allow more steps",
                           .count = count});
  }
  judge_followed(features, run.remarks);
}

}  // namespace alcap::detail
