// SPDX-License-Identifier: MIT
#include "src/run/field_intrinsic.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "alcap/singularities.h"
#include "src/base/array.h"
#include "src/base/cancel.h"
#include "src/base/clock.h"
#include "src/base/numbers.h"
#include "src/base/parallel.h"
#include "src/run/field_aligned.h"
#include "src/run/intrinsic_solve.h"

namespace alcap::detail {
namespace {

void solve_smoothest(const IntrinsicSolve& solve, const FieldRunOptions& options, FieldRun& run) {
  const SmoothestOptions smooth{.n = options.n, .s = options.s, .eigen = options.eigen};
  SmoothestResult result = smoothest_field(solve.surface(), smooth);
  run.field.u = std::move(result.field.u);
  run.eigen = std::move(result.components);
  if (options.modes > 1) {
    run.modes = smoothest_modes(solve.surface(), options.modes, smooth);
    MatrixX<Complex<double>> U(solve.given_vertices(), run.modes.U.cols());
    for (Eigen::Index k = 0; k < U.cols(); ++k) U.col(k) = solve.to_given(run.modes.U.col(k), options.n);
    run.modes.U = std::move(U);
  }
  run.times.assembly = result.assembly_seconds;
  run.times.eigen = result.eigen_seconds + run.modes.seconds;
}

}  // namespace

std::optional<double> solve_on_intrinsic(const FieldRunOptions& options, const Surface& surface, FieldRun& run) {
  Stopwatch watch;
  FeatureGraph graph;
  if (options.align) graph = features_of(options, surface);
  std::optional<IntrinsicTriangulation> now =
      triangulate(surface, options.triangulation, options.min_angle, graph.edges);
  if (!now) return std::nullopt;
  ConnectionOptions connection = options.connection;
  connection.n = options.n;
  const IntrinsicSolve solve(surface, std::move(*now), connection);
  // In closed form: any other would take as long here as this saves.
  if (connection.kind != ConnectionKind::polar) connection.kind = ConnectionKind::local;
  run.surface = connect(surface, connection);
  const double seconds = watch.lap();

  report_phase("solve");
  if (options.progress) options.progress("solve");
  if (options.align) {
    // Zeros are wanted to the triangles of the mesh, not to those that only carry its needles.
    const double coarser =
        static_cast<double>(solve.surface().mesh().vertices()) / static_cast<double>(solve.given_vertices());
    solve_aligned(options, solve.surface(), graph_on(solve.triangulation(), graph.edges, graph), coarser, run);
    run.features->graph = std::move(graph);
    std::erase_if(run.features->free_corners, [&](Index v) { return v >= solve.given_vertices(); });
  } else {
    solve_smoothest(solve, options, run);
  }
  run.field.n = options.n;
  run.field.frames = nullptr;
  run.triangulation = solve.summary(run.field);
  run.field.u = solve.to_given(run.field.u, options.n);
  if (surface.in_space()) run.field.frames = run.surface.frames();
  return seconds;
}

}  // namespace alcap::detail
