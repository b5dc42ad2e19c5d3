// SPDX-License-Identifier: MIT
#include "src/distributed/design_outcomes.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "src/base/array.h"
#include "src/distributed/design_place.h"
#include "src/run/design_stages.h"
#include "src/run/remarks.h"

namespace alcap::detail::distributed {
namespace {

using Type = DesignOutcome::Type;

/// What one rank knows of a fixed vertex.
struct PlainOutcome {
  std::size_t number;
  int met;
  double error_degrees;
};

void judge_fixed_vertices(const std::vector<LocalControl>& controls, const Field& field, double longest,
                          const ControlTolerances& tolerances, std::vector<DesignOutcome>& outcomes) {
  std::vector<PlainOutcome> mine;
  for (std::size_t k = 0; k < controls.size(); ++k) {
    if (controls[k].type != Type::fixed || !controls[k].here) continue;
    const auto& fixed = std::get<VertexConstraint>(*controls[k].here);
    const ControlReport report = judge_fixed(fixed, field.n, field.u[fixed.vertex], longest, tolerances);
    mine.push_back({k, report.met ? 1 : 0, report.error_degrees});
  }
  for (const PlainOutcome& p : gather_all(mine)) {
    outcomes[p.number].met = p.met != 0;
    outcomes[p.number].error_degrees = p.error_degrees;
  }
}

/// What one rank knows of a target.
struct PlainTarget {
  std::size_t number;
  TargetTally tally;
  double length_at_pin;  // 0 where the pin is another rank's
};

void judge_targets(const Stage& stage, const std::vector<LocalControl>& controls, const Field& field,
                   const ControlTolerances& tolerances, std::vector<DesignOutcome>& outcomes) {
  const Mesh& mesh = stage.patch.mesh;
  std::vector<PlainTarget> mine;
  for (std::size_t k = 0; k < controls.size(); ++k) {
    const LocalControl& c = controls[k];
    if (c.type != Type::singularity || !c.here) continue;
    const auto& target = std::get<SingularityTarget>(*c.here);
    PlainTarget& out = mine.emplace_back(PlainTarget{k, {}, 0});
    out.tally.add(mesh, stage.connection, field, target, c.load);
    if (target.pin && target.face != none)
      out.length_at_pin = alcap::detail::length_at_pin(mesh, stage.patch.geometry, stage.connection, field, target);
  }
  std::vector<PlainTarget> all = gather_all(mine);
  std::ranges::stable_sort(all, {}, &PlainTarget::number);
  for (std::size_t i = 0; i < all.size();) {
    PlainTarget sum = all[i];
    for (++i; i < all.size() && all[i].number == sum.number; ++i) {
      sum.tally.index += all[i].tally.index;
      sum.tally.all = sum.tally.all && all[i].tally.all;
      sum.tally.value += all[i].tally.value;
      sum.length_at_pin = std::max(sum.length_at_pin, all[i].length_at_pin);
    }
    const auto& target = std::get<SingularityTarget>(*controls[sum.number].asked);
    const ControlReport report = sum.tally.judge(field.n, target, tolerances);
    DesignOutcome& outcome = outcomes[sum.number];
    outcome.index = report.index;
    outcome.error_degrees = report.error_degrees;
    outcome.met = report.met && (!target.pin || sum.length_at_pin <= tolerances.pin_length);
    outcome.length_at_pin = sum.length_at_pin;
  }
}

/// Cones, on the ranks that own their vertices.
void judge_cones_together(const Stage& stage, const std::vector<Cone>& cones, double tolerance_degrees,
                          std::vector<DesignOutcome>& outcomes) {
  struct Turns {
    std::size_t cone;
    double turns;
  };
  std::vector<Turns> mine;
  for (std::size_t k = 0; k < cones.size(); ++k)
    if (const Index v = own_vertex(stage.patch, cones[k].vertex); v != none)
      mine.push_back({k, vertex_turns(stage.patch.mesh, stage.patch.geometry, stage.connection, v)});
  std::vector<Turns> all = gather_all(mine);
  std::ranges::sort(all, {}, &Turns::cone);
  for (const Turns& t : all) outcomes.push_back(judge_cone(cones, t.cone, t.turns, tolerance_degrees));
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
    const ControlReport report = Deviation{sums[2 * k], sums[2 * k + 1]}.judge(outcomes[k].tolerance_degrees);
    outcomes[k].met = report.met;
    outcomes[k].error_degrees = report.error_degrees;
  }
}

}  // namespace

void judge(const Stage& stage, const std::vector<LocalControl>& controls, const Field& field,
           const ControlTolerances& tolerances, DistributedDesign& out) {
  std::size_t numbers[4] = {};  // of the types that controls have
  for (const LocalControl& c : controls) {
    DesignOutcome& outcome = out.outcomes.emplace_back();
    outcome.type = c.type;
    outcome.number = numbers[static_cast<std::size_t>(c.type)]++;
    outcome.path = c.path;
    outcome.name = c.name;
    outcome.control = c.asked;
    set_tolerance(tolerances, DesignMethod::variational, outcome);
  }
  double longest = 0;
  for (Index v = 0; v < stage.patch.owned; ++v) longest = std::max(longest, std::abs(field.u[v]));
  longest = largest(longest);
  judge_targets(stage, controls, field, tolerances, out.outcomes);
  judge_fixed_vertices(controls, field, longest, tolerances, out.outcomes);
  judge_soft(controls, field, out.outcomes);
  for (DesignOutcome& outcome : out.outcomes) {
    if (outcome.type != Type::singularity) continue;
    const Index face = std::get<SingularityTarget>(*outcome.control).face;
    for (const DistributedSingularity& s : out.singularities)
      if (s.face == face) outcome.found = s;
  }
  judge_cones_together(stage, out.cones, tolerances.cone_degrees, out.outcomes);
}

void certify(const Connection& connection, bool eigen_converged, bool finite, double largest_residual,
             DistributedDesign& out) {
  DesignCertificate& c = out.certificate;
  c.connection_converged = out.connection.converged;
  c.eigen_converged = eigen_converged;
  c.residual_small = out.residual <= largest_residual;  // false for NaN
  c.index_sums_match = std::ranges::all_of(
      out.components, [](const DistributedComponent& d) { return d.indices.sum == d.indices.expected; });
  c.finite = !any(!finite);
  for (const DesignOutcome& outcome : out.outcomes) {
    if (outcome.met) continue;
    Remark remark = unmet(outcome, out.design.n, none);
    if (outcome.type == Type::cone) remark.first = {out.cones[outcome.number].vertex};
    out.remarks.push_back(std::move(remark));
  }
  if (connection.flat && !connection.admits_parallel(out.n)) out.remarks.push_back(not_parallel(out.n));
  const std::string remedy = "; it needs more iterations, or rounding stops it: slivers are the usual reason";
  certificate_remarks(c, {.connection = remedy, .eigen = remedy, .linear = remedy}, out.remarks);
}

}  // namespace alcap::detail::distributed
