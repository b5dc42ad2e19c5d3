// SPDX-License-Identifier: MIT
//
// designer.cpp: variational design by one factorisation: what a designer is asked for, and what of the last solution
// stays true when a control comes, goes or changes.
#include "alcap/designer.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>

#include "src/base/clock.h"
#include "src/design/singularity_parts.h"
#include "src/design/variational/state.h"
#include "src/design/weight_range.h"

namespace alcap {
namespace {

using detail::ControlLoad;
using detail::ControlRow;
using detail::Prepared;
using C = Complex<double>;

// So many changed targets keep solutions of their own; with more, the oldest go back into the common one.
constexpr std::size_t live_targets = 8;

}  // namespace

void Designer::State::touched(const ControlLoad& load) {
  soft_changed |= load.soft() || (singular && !load.rows.empty());
  if (load.target()) common.resize(0, 0);
}

const SingularityTarget& Designer::State::singularity(ControlId id) const {
  const auto at = controls.find(id);
  if (at == controls.end()) throw OptionError("id", static_cast<int>(id), "there is no such control");
  const auto* target = std::get_if<SingularityTarget>(&at->second);
  if (!target) throw OptionError("id", static_cast<int>(id), "this control is not a singularity");
  return *target;
}

void Designer::State::make_live(Prepared& p) {
  std::size_t live = 0;
  Prepared* oldest = nullptr;
  for (auto& [id, q] : prepared) {
    if (q.live_since == 0) continue;
    ++live;
    if (!oldest || q.live_since < oldest->live_since) oldest = &q;
  }
  if (live >= live_targets) {
    oldest->live_since = 0;
    oldest->own.resize(0);
    common.resize(0, 0);
  }
  p.live_since = ++clock;
}

Designer::Designer(const ConnectedSurface& surface, const DesignerOptions& options)
    : state_(controlled(options.control, [&] { return std::make_unique<State>(surface, options); })) {}
Designer::~Designer() = default;
Designer::Designer(Designer&&) noexcept = default;
Designer& Designer::operator=(Designer&&) noexcept = default;

ControlId Designer::add(Control control) {
  State& s = *state_;
  ControlLoad load = controlled(s.options.control, [&] { return std::visit(s.loads, control); });
  const ControlId id{s.next_id++};
  s.touched(load);
  s.prepared.emplace(id, Prepared{.load = std::move(load)});
  s.controls.emplace(id, std::move(control));
  return id;
}

void Designer::set(ControlId id, Control control) {
  State& s = *state_;
  const auto at = s.prepared.find(id);
  if (at == s.prepared.end()) throw OptionError("id", static_cast<int>(id), "there is no such control");
  Prepared& p = at->second;
  ControlLoad load = controlled(s.options.control, [&] { return std::visit(s.loads, control); });
  // Rows that stay the same keep their solved columns: turning a pinned saddle costs a right-hand side.
  const auto same = [](const ControlRow& a, const ControlRow& b) {
    return a.vertex == b.vertex && a.coefficient == b.coefficient;
  };
  if (!std::equal(load.rows.begin(), load.rows.end(), p.load.rows.begin(), p.load.rows.end(), same)) p.forget_rows();
  s.soft_changed |= load.soft() || p.load.soft() || (s.singular && !(load.rows.empty() && p.load.rows.empty()));
  if (load.parts != p.load.parts) p.own.resize(0);
  if (p.live_since == 0) {
    if (p.load.target()) s.common.resize(0, 0);
    if (load.target()) s.make_live(p);
  } else if (!load.target()) {
    p.live_since = 0;
  }
  p.load = std::move(load);
  s.controls.at(id) = std::move(control);
}

void Designer::remove(ControlId id) {
  State& s = *state_;
  const auto at = s.prepared.find(id);
  if (at == s.prepared.end()) throw OptionError("id", static_cast<int>(id), "there is no such control");
  s.soft_changed |= at->second.load.soft() || (s.singular && !at->second.load.rows.empty());
  if (at->second.load.target() && at->second.live_since == 0) s.common.resize(0, 0);
  s.prepared.erase(at);
  s.controls.erase(id);
}

void Designer::move(ControlId id, Index face) {
  const State& s = *state_;
  set(id, controlled(s.options.control,
                     [&] { return detail::moved(s.mesh, s.geometry, s.options.n, s.singularity(id), face); }));
}

std::optional<ControlId> Designer::merge(ControlId id, ControlId other) {
  SingularityTarget sum = state_->singularity(id);
  const SingularityTarget& gone = state_->singularity(other);
  if (id == other) throw OptionError("other", static_cast<int>(other), "is the same control");
  const int index = sum.sign * sum.count + gone.sign * gone.count;
  if (index == 0) {
    remove(id);
    remove(other);
    return std::nullopt;
  }
  sum.sign = index > 0 ? 1 : -1;
  sum.count = std::abs(index);
  set(id, sum);
  remove(other);
  return id;
}

ControlId Designer::split(ControlId id, Index face, int count) {
  const State& s = *state_;
  SingularityTarget rest = s.singularity(id);
  if (count < 1 || count >= rest.count)
    throw OptionError("count", count, "must be 1 to " + std::to_string(rest.count - 1) + ", less than the whole");
  SingularityTarget part = rest;
  part.count = count;
  part = controlled(s.options.control, [&] { return detail::moved(s.mesh, s.geometry, s.options.n, part, face); });
  rest.count -= count;
  const ControlId added = add(part);
  set(id, rest);
  return added;
}

const std::map<ControlId, Control>& Designer::controls() const { return state_->controls; }

void Designer::set_guidance(const ComplexVectorX<double>& u0) {
  State& s = *state_;
  if (!(s.guidance_scale() > 0)) throw OptionError("guidance_weight", "0", "a guidance field needs a weight");
  if (u0.size() != s.mesh.vertices())
    throw OptionError("u0", std::to_string(u0.size()) + " values", "needs one per vertex");
  if (!u0.allFinite()) throw OptionError("u0", "not finite", "every value must be finite");
  controlled(s.options.control, [&] {
    s.u0 = u0;
    s.make_guidance();
  });
}

void Designer::set_guidance_weight(double weight) {
  State& s = *state_;
  State::check_guidance_weight(weight);
  if (!(weight > 0) && s.u0.size() > 0) throw OptionError("guidance_weight", "0", "a guidance field needs a weight");
  controlled(s.options.control, [&] {
    s.reweight([&] {
      s.options.guidance_weight = weight;
      s.options.t.reset();
    });
  });
}

void Designer::set_guidance_weights(const VectorX<double>& weights) {
  State& s = *state_;
  if (weights.size() != s.mesh.vertices())
    throw OptionError("weights", std::to_string(weights.size()) + " values", "needs one per vertex");
  for (Index v = 0; v < s.mesh.vertices(); ++v)
    if (!detail::fit_weight_or_zero(weights[v]))
      throw OptionError("weights", weights[v], "of vertex " + std::to_string(v) + " " + detail::weight_or_zero_rule);
  if (!(weights.maxCoeff() > 0)) throw OptionError("weights", "all 0", "one at least must be positive");
  if (s.options.t)
    throw OptionError("t", *s.options.t, "cannot be combined with weights per vertex; they need guidance_weight");
  controlled(s.options.control, [&] {
    s.reweight([&] {
      s.weighted = s.M;
      const VectorX<double> roots = weights.cwiseSqrt();
      for (Index j = 0; j < s.weighted.outerSize(); ++j)
        for (SparseMatrix<C>::InnerIterator it(s.weighted, j); it; ++it) it.valueRef() *= roots[it.row()] * roots[j];
    });
  });
}

DesignResult Designer::solve() {
  State& s = *state_;
  const detail::Stopwatch watch;
  if (s.controls.empty() && s.guidance.isZero(0)) detail::throw_nothing_asked();
  DesignResult result;
  controlled(s.options.control, [&] {
    result.field.n = s.options.n;
    result.field.frames = s.frames;
    if (s.holds_features()) {
      s.solve_held(result);
    } else {
      s.held_factors.clear();
      s.choose_folding();
      s.factorise();
      const ComplexVectorX<double> load = s.solve_loads(result);
      s.apply_rows(load, result);
      result.solver = s.solver->name();
    }
    s.tell("analysis");
    for (const auto& [id, control] : s.controls) result.controls.push_back(s.judge(id, control, result.field));
  });
  result.seconds = watch.seconds();
  return result;
}

}  // namespace alcap
