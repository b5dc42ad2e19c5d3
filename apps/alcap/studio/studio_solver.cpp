// SPDX-License-Identifier: MIT
#include "apps/alcap/studio/studio_solver.h"

#include "apps/alcap/report/design_report.h"
#include "src/base/clock.h"

namespace alcap::app {

const std::string& StudioResult::details() const {
  std::call_once(once_, [&] {
    ViewPack pack;
    pack.meta["result"] = id;
    add_curves(pack, output(), page_curves(output()));
    add_scalars(pack, output());
    details_ = pack.bytes();
  });
  return details_;
}

StudioSolver::StudioSolver(const Surface& surface) : session_(surface) {}

std::shared_ptr<const StudioResult> StudioSolver::solve(const DesignFile& design) {
  const detail::Stopwatch watch;
  if (design.method != DesignMethod::variational)
    throw OptionError("/method", "eigen", "the studio solves variational designs; alcap design solves both");
  DesignRun run = session_.solve(design);
  auto result = std::make_shared<StudioResult>();
  result->surface = std::move(run.surface);
  result->field = std::move(run.field);
  result->singularities = std::move(run.singularities);
  for (const DesignOutcome& outcome : run.outcomes)
    if (outcome.control)
      result->controls.push_back({{"path", outcome.path},
                                  {"met", outcome.met},
                                  {"error_degrees", outcome.error_degrees},
                                  {"tolerance_degrees", tolerance_degrees(outcome.type)}});
  result->id = ++results_;
  result->seconds = watch.seconds();
  return result;
}

}  // namespace alcap::app
