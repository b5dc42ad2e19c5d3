// SPDX-License-Identifier: MIT
#include "apps/alcap/commands/design_solve.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "alcap/alignment.h"
#include "alcap/eigen_design.h"
#include "alcap/output.h"
#include "apps/alcap/report/report.h"

namespace alcap::app {
namespace {

using Clock = std::chrono::steady_clock;
using Source = DesignGuidance::Source;

double seconds(Clock::time_point from) { return std::chrono::duration<double>(Clock::now() - from).count(); }

ComplexVectorX<double> read_guidance(const DesignProblem& p) {
  const std::string path = p.design.guidance.file.string();
  const FieldFile field = read_field(p.design.guidance.file);
  const auto refuse = [&](const std::string& why) {
    throw Failure(Exit::input, fmt::format("guidance {}: {}", path, why), {{"path", path}});
  };
  if (field.field.n != p.design.n)
    refuse(fmt::format("holds a field of n = {}, and the design has n = {}", field.field.n, p.design.n));
  if (field.V.rows() != p.run.surface.V().rows() || field.F.rows() != p.run.mesh().faces() ||
      !((p.run.surface.V() - field.V).cwiseAbs().maxCoeff() <= 1e-6 * p.run.surface.V().cwiseAbs().maxCoeff()))
    refuse("holds a field on another mesh; give one that was computed on this mesh");
  return on_frames(field.field, p.run.surface.frames()).u;
}

/// The guidance field, scaled to root mean square length 1 over the surface; empty: none, or zero.
ComplexVectorX<double> find_guidance(const DesignProblem& p, SolvedDesign& out) {
  const DesignGuidance& guidance = p.design.guidance;
  const Source source = guidance.source;
  out.guidance = {{"field", source == Source::file ? guidance.file.string() : name(source)},
                  {"weight", source == Source::none || guidance.t ? Json(0) : number(guidance.weight)},
                  {"t", guidance.t ? number(*guidance.t) : Json(nullptr)},
                  {"scale", nullptr}};
  ComplexVectorX<double> u0;
  if (source == Source::none || source == Source::zero) return u0;
  if (source == Source::smoothest) {
    SmoothestResult smooth =
        smoothest_field(p.run.surface, {.n = p.design.n, .s = p.design.s, .eigen = {.solver = p.solver}});
    out.converged = std::all_of(smooth.components.begin(), smooth.components.end(),
                                [](const EigenReport& e) { return e.converged; });
    u0 = std::move(smooth.field.u);
  } else if (source == Source::file) {
    u0 = read_guidance(p);
  } else {
    u0 = curvature_field(p.run.surface, {.n = p.design.n, .smallest = source == Source::least_curvature}).u;
  }
  const double size = root_mean_square(p.run.surface, u0);
  if (!(size > 0) || !std::isfinite(size))
    throw Failure(Exit::input,
                  source == Source::file
                      ? fmt::format("guidance {}: the field is zero or not finite everywhere", guidance.file.string())
                      : fmt::format("guidance {}: this surface has no such directions", name(source)));
  u0 /= size;
  out.guidance["scale"] = number(1 / size);
  return u0;
}

/// What a design that is solved once solves for: one system for all targets, one for every pin and vertex. 0 where
/// strokes need more than can be told from here.
int right_hand_sides(const std::vector<DesignControl>& controls) {
  int count = 1;
  for (const DesignControl& c : controls) {
    const auto* const target = std::get_if<SingularityTarget>(&c.control);
    if (target == nullptr && !std::holds_alternative<VertexConstraint>(c.control)) return 0;
    if (target == nullptr || target->pin) ++count;
  }
  return count;
}

void solve_variational(const DesignProblem& p, Progress& progress, SolvedDesign& out) {
  progress.phase("finding the guidance field");
  auto lap = Clock::now();
  const ComplexVectorX<double> u0 = find_guidance(p, out);
  out.guidance_seconds = seconds(lap);

  progress.phase("preparing");
  lap = Clock::now();
  const DesignGuidance& guidance = p.design.guidance;
  const bool guided = guidance.source != Source::none;
  Designer designer(p.run.surface, {.n = p.design.n,
                                    .guidance_weight = guided && !guidance.t ? guidance.weight : 0.0,
                                    .t = guidance.t,
                                    .s = p.design.s,
                                    .solver = p.solver,
                                    .right_hand_sides = right_hand_sides(p.controls)});
  for (const DesignControl& c : p.controls) {
    try {
      (void)designer.add(c.control);
    } catch (const OptionError& e) {
      const std::string head = OptionError(e.field(), e.value(), "").what();
      throw OptionError(c.path, e.field() + " " + e.value(), std::string(e.what()).substr(head.size()));
    }
  }
  if (u0.size() > 0) designer.set_guidance(u0);
  if (!guidance.weights.empty())
    designer.set_guidance_weights(
        Eigen::Map<const VectorX<double>>(guidance.weights.data(), static_cast<Eigen::Index>(guidance.weights.size())));
  out.prepare_seconds = seconds(lap);

  progress.phase("solving");
  out.result = designer.solve();
  out.solve_seconds = out.result.seconds;
  out.solve = {{"method", "variational"},
               {"rows", out.result.rows},
               {"residual", number(out.result.residual)},
               {"lambda", nullptr},
               {"solver", out.result.solver}};
}

void solve_eigen(const DesignProblem& p, Progress& progress, SolvedDesign& out) {
  out.guidance = {{"field", "none"}, {"weight", 0}, {"t", nullptr}, {"scale", nullptr}};
  EigenControls controls;
  for (const DesignControl& c : p.controls) {
    if (const auto* target = std::get_if<SingularityTarget>(&c.control)) controls.singularities.push_back(*target);
    if (const auto* stroke = std::get_if<Stroke>(&c.control))
      controls.strokes.push_back({.line = stroke->line, .weight = stroke->weight});
  }
  progress.phase("solving");
  EigenDesignResult result =
      eigen_design(p.run.surface, controls, {.n = p.design.n, .s = p.design.s, .eigen = {.solver = p.solver}});
  out.prepare_seconds = result.assembly_seconds;
  out.solve_seconds = result.eigen_seconds;
  out.result.field = std::move(result.field);
  out.result.controls = std::move(result.singularities);
  for (const EigenStrokeReport& stroke : result.strokes)
    out.result.controls.push_back({.met = stroke.met, .error_degrees = stroke.mean_degrees});
  Json lambda = Json::array();
  std::string solver;
  for (const EigenReport& e : result.components) {
    out.converged = out.converged && e.converged;
    out.result.residual = std::max(out.result.residual, e.residual);
    lambda.push_back(number(e.lambda));
    solver = e.solver;
  }
  out.solve = {{"method", "eigen"},
               {"rows", 0},
               {"residual", number(out.result.residual)},
               {"lambda", std::move(lambda)},
               {"solver", solver}};
}

}  // namespace

SolvedDesign solve_design(const DesignProblem& problem, Progress& progress) {
  SolvedDesign out;
  if (problem.design.method == DesignMethod::eigen)
    solve_eigen(problem, progress, out);
  else
    solve_variational(problem, progress, out);
  return out;
}

}  // namespace alcap::app
