// SPDX-License-Identifier: MIT
#include "apps/alcap/studio/studio_solver.h"

#include <algorithm>

#include "apps/alcap/report/design_report.h"
#include "apps/alcap/report/report.h"
#include "src/base/clock.h"

namespace alcap::app {

std::string StudioResult::make(StudioPart which, const RunControl& control) const {
  constexpr double coarse = 3;
  return controlled(control, [&] {
    ViewPack pack;
    pack.meta["result"] = id;
    if (which == StudioPart::colours) {
      add_scalars(pack, output());
    } else if (which == StudioPart::separatrices) {
      add_separatrices(pack, output(), page_separatrices(output()));
    } else {
      const bool far = which == StudioPart::coarse;
      std::shared_ptr<const CurveSet> earlier;
      if (memories_) earlier = (far ? memories_->coarse : memories_->fine).latest();
      // The first ones of a surface go on from its coarse ones, which are on the screen by now.
      if (memories_ && !far && !earlier) earlier = memories_->coarse.latest();
      PageCurves curves = page_even_curves(output(), far ? coarse : 1, {}, earlier.get());
      add_curves(pack, output(), curves);
      if (memories_)
        (far ? memories_->coarse : memories_->fine).keep(std::make_shared<const CurveSet>(std::move(curves.even)));
    }
    return pack.bytes();
  });
}

const std::string& StudioResult::part(StudioPart which, const RunControl& control) const {
  const auto k = static_cast<std::size_t>(which);
  std::call_once(once_[k], [&] { parts_[k] = make(which, control); });
  return parts_[k];
}

StudioSolver::StudioSolver(const Surface& surface, const ControlTolerances& tolerances)
    // What the page shows of a connection is that of the mesh.
    : session_(surface, {.tolerances = tolerances, .triangulation = Triangulation::extrinsic}) {}

namespace {

/// The strokes along features are one control, as far off as the worst of them.
void add_outcomes(const DesignFile& design, const DesignRun& run, StudioResult& result) {
  Json features;
  for (const DesignOutcome& outcome : run.outcomes) {
    if (!outcome.control) continue;
    const bool feature = outcome.type == DesignOutcome::Type::stroke && outcome.number >= design.strokes.size();
    Json entry{{"path", feature ? "/features" : outcome.path},
               {"met", outcome.met},
               {"error_degrees", outcome.error_degrees},
               {"tolerance_degrees", number(outcome.tolerance_degrees)}};
    if (!feature) {
      result.controls.push_back(std::move(entry));
    } else if (features.is_null()) {
      features = std::move(entry);
    } else {
      features["met"] = features["met"].get<bool>() && outcome.met;
      features["error_degrees"] = std::max(features["error_degrees"].get<double>(), outcome.error_degrees);
    }
  }
  if (!features.is_null()) result.controls.push_back(std::move(features));
  if (run.features) result.free_corners = run.features->free_corners.size();
  for (const FeatureLine& line : run.features ? run.features->graph.lines : std::vector<FeatureLine>{}) {
    for (const Index v : line.vertices) result.creases.push_back(static_cast<std::uint32_t>(v));
    result.crease_offsets.push_back(static_cast<std::uint32_t>(result.creases.size()));
  }
}

}  // namespace

std::shared_ptr<StudioResult> StudioSolver::make_result() {
  auto result = std::make_shared<StudioResult>();
  result->memories_ = memories_;
  result->id = ++results_;
  return result;
}

std::shared_ptr<const StudioResult> StudioSolver::solve(const DesignFile& design) {
  const detail::Stopwatch watch;
  DesignRun run = session_.solve(design);
  auto result = make_result();
  add_outcomes(design, run, *result);
  result->surface = std::move(run.surface);
  result->field = std::move(run.field);
  result->singularities = std::move(run.singularities);
  result->seconds = watch.seconds();
  return result;
}

std::shared_ptr<const StudioResult> StudioSolver::mode(const StudioResult& solved, double s, int k) {
  const detail::Stopwatch watch;
  const int n = solved.field.n;
  const int most = static_cast<int>(std::min<Index>(most_modes, solved.surface.mesh().vertices()));
  if (k < 1 || k > most) throw OptionError("mode", k, "must be from 1 to " + std::to_string(most));
  if (modes_n_ != n || modes_s_ != s || &modes_surface_.connection() != &solved.surface.connection()) {
    modes_n_ = 0;
    modes_ = smoothest_modes(solved.surface, most, {.n = n, .s = s});
    modes_surface_ = solved.surface;
    modes_n_ = n;
    modes_s_ = s;
  }
  auto result = make_result();
  result->surface = solved.surface;
  result->field = {.n = n, .u = modes_.U.col(k - 1), .frames = solved.surface.frames()};
  result->singularities = find_singularities(solved.surface, result->field);
  result->mode = k;
  result->eigenvalues.assign(modes_.lambda.data(), modes_.lambda.data() + modes_.lambda.size());
  result->seconds = watch.seconds();
  return result;
}

}  // namespace alcap::app
