// SPDX-License-Identifier: MIT
#include "src/distributed/design_outcomes.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "src/base/array.h"
#include "src/run/design_stages.h"

namespace alcap::detail::distributed {
namespace {

using Type = DesignOutcome::Type;

/// What one rank knows of a control.
struct PlainOutcome {
  std::size_t number;
  int met, index;
  double error_degrees, length_at_pin;
};

PlainOutcome judge_here(const Stage& stage, std::size_t number, const LocalControl& c, const Field& field,
                        double longest) {
  const Mesh& mesh = stage.patch.mesh;
  ControlReport report;
  double length_at_pin = 0;
  if (const auto* target = std::get_if<SingularityTarget>(&*c.here)) {
    report = judge_target(mesh, stage.connection, field, *target, c.load);
    if (target->pin) {
      length_at_pin = alcap::detail::length_at_pin(mesh, stage.patch.geometry, stage.connection, field, *target);
      report.met = report.met && length_at_pin <= pinned_length;
    }
  } else {
    const auto& fixed = std::get<VertexConstraint>(*c.here);
    report = judge_fixed(fixed, field.n, field.u[fixed.vertex], longest);
  }
  return {number, report.met ? 1 : 0, report.index, report.error_degrees, length_at_pin};
}

/// The deviations of strokes and the boundary, summed over the ranks.
void judge_soft(const std::vector<LocalControl>& controls, const Field& field, std::vector<DesignOutcome>& outcomes) {
  std::vector<double> sums(2 * controls.size(), 0);
  for (std::size_t k = 0; k < controls.size(); ++k) {
    if (controls[k].type != Type::stroke && controls[k].type != Type::boundary) continue;
    Deviation deviation;
    for (const ControlRow& row : controls[k].load.rows) deviation.add(row, row.at(field.u), field.n);
    sums[2 * k] = deviation.radians;
    sums[2 * k + 1] = deviation.weights;
  }
  sum_all(sums);
  for (std::size_t k = 0; k < controls.size(); ++k) {
    if (controls[k].type != Type::stroke && controls[k].type != Type::boundary) continue;
    const ControlReport report = Deviation{sums[2 * k], sums[2 * k + 1]}.judge();
    outcomes[k].met = report.met;
    outcomes[k].error_degrees = report.error_degrees;
  }
}

}  // namespace

void judge(const Stage& stage, const std::vector<LocalControl>& controls, const Field& field, DistributedDesign& out) {
  std::size_t numbers[4] = {};
  for (const LocalControl& c : controls) {
    DesignOutcome& outcome = out.outcomes.emplace_back();
    outcome.type = c.type;
    outcome.number = numbers[static_cast<std::size_t>(c.type)]++;
    outcome.path = c.path;
    outcome.name = c.name;
    outcome.control = c.asked;
  }
  double longest = 0;
  for (Index v = 0; v < stage.patch.owned; ++v) longest = std::max(longest, std::abs(field.u[v]));
  longest = largest(longest);
  std::vector<PlainOutcome> mine;
  for (std::size_t k = 0; k < controls.size(); ++k)
    if (controls[k].here) mine.push_back(judge_here(stage, k, controls[k], field, longest));
  for (const PlainOutcome& p : gather_all(mine)) {
    DesignOutcome& outcome = out.outcomes[p.number];
    outcome.met = p.met != 0;
    outcome.index = p.index;
    outcome.error_degrees = p.error_degrees;
    outcome.length_at_pin = p.length_at_pin;
  }
  judge_soft(controls, field, out.outcomes);
  for (DesignOutcome& outcome : out.outcomes) {
    if (outcome.type != Type::singularity) continue;
    const Index face = std::get<SingularityTarget>(*outcome.control).face;
    for (const DistributedSingularity& s : out.singularities)
      if (s.face == face) outcome.found = s;
  }
}

void certify(bool eigen_converged, bool finite, double largest_residual, DistributedDesign& out) {
  DesignCertificate& c = out.certificate;
  c.connection_converged = out.connection.converged;
  c.eigen_converged = eigen_converged;
  c.residual_small = out.residual <= largest_residual;  // false for NaN
  c.index_sums_match = std::ranges::all_of(
      out.components, [](const DistributedComponent& d) { return d.indices.sum == d.indices.expected; });
  c.finite = !any(!finite);
  for (const DesignOutcome& outcome : out.outcomes)
    if (!outcome.met) out.remarks.push_back(unmet(outcome, none));
  certificate_remarks(c, "; it needs more iterations, or rounding stops it: slivers are the usual reason", out.remarks);
}

}  // namespace alcap::detail::distributed
