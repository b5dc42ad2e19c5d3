// SPDX-License-Identifier: MIT
//
// design.cpp: a variational design from a mesh in slices, phase by phase, in the order of src/run/design_run.cpp.
#include <algorithm>
#include <cmath>

#include "src/base/array.h"
#include "src/design/tolerances.h"
#include "src/design/variational/free_fields.h"
#include "src/distributed/design_guidance.h"
#include "src/distributed/design_outcomes.h"
#include "src/distributed/design_place.h"
#include "src/distributed/design_system.h"
#include "src/distributed/eigen.h"
#include "src/run/design_stages.h"

namespace alcap {
namespace detail::distributed {
namespace {

using Source = DesignGuidance::Source;

void check_options(const DistributedDesignOptions& o) {
  const auto relative = [](const char* field, double value) {
    if (!(value > 0 && value < 1)) throw OptionError(field, value, "must be in (0, 1)");
  };
  relative("tolerance", o.tolerance);
  relative("residual", o.residual);
  relative("eigen_tolerance", o.eigen_tolerance);
  check_tolerances(o.tolerances);
  if (o.max_iterations < 1) throw OptionError("max_iterations", o.max_iterations, "must be at least 1");
  if (o.gather_below < 100) throw OptionError("gather_below", o.gather_below, "must be at least 100");
}

DistributedOptions field_options(const DesignFile& design, const DistributedDesignOptions& o) {
  const DesignConnection& c = design.connection;
  return {.n = design.n,
          .s = design.s,
          .connection = {c.kind, c.center},
          .global = {.detail = c.detail,
                     .length_factor = c.length_factor,
                     .tan_cap = c.tan_cap,
                     .tolerance = o.connection_tolerance,
                     .max_iterations = o.connection_iterations},
          .cones = c.cones,
          .loop_index = c.loops,
          .tolerance = o.eigen_tolerance,
          .max_iterations = o.max_iterations,
          .seed = o.seed,
          .partition = o.partition,
          .gather_below = o.gather_below};
}

/// As root_mean_square() of alignment.h, over all ranks.
double root_mean_square(const Stage& stage, const ComplexVectorX<double>& u, double total_area) {
  const Patch& patch = stage.patch;
  const Field field = extended(patch, 1, u);
  double total = 0;
  for (Index t = 0; t < patch.mesh.faces(); ++t) {
    if (patch.mine[at(t)] == 0) continue;
    for (Index c = 0; c < 3; ++c) total += patch.geometry.area(t) / 3 * std::norm(field.u[patch.mesh.F()(t, c)]);
  }
  return std::sqrt(sum(total) / total_area);
}

class DesignRunner {
 public:
  DesignRunner(const MeshSlice& mesh, const DistributedDesignOptions& options, DistributedDesign& out)
      : mesh_(mesh), options_(options), out_(out) {}

  void run(const DesignFile& design) {
    field_options_ = field_options(design, options_);
    stage_ = divide(mesh_, options_.partition, meter_, out_);
    for (const DistributedComponent& c : stage_.components.list) total_area_ += c.area;
    out_.design = place(design, mesh_, stage_);
    field_options_.cones = out_.design.connection.cones;
    connect_at_path();
    frames_ = frames_of(stage_);
    controls_ = local_controls(out_.design, stage_, frames_, total_area_);
    matrices_ = assemble(stage_.patch, stage_.connection, design.n, design.s);
    meter_.done("assembly", out_.phases);
    const bool lone = controls_.empty() && design.guidance.source == Source::nothing;
    find_guidance(lone ? Source::smoothest : design.guidance.source);
    meter_.done("guidance", out_.phases);
    if (lone)
      u_ = u0_;
    else
      solve();
    matrices_ = {};
    meter_.done("solve", out_.phases);

    const Field field = extended(stage_.patch, design.n, u_);
    conclude(stage_, frames_, field, mesh_.V.rows(), out_);
    if (!lone) remark_vanishing(field);
    judge(stage_, controls_, field, options_.tolerances, out_);
    certify(stage_.connection, eigen_converged_, u_.allFinite(), options_.residual, out_);
    meter_.done("analysis", out_.phases);
  }

 private:
  void connect_at_path() {
    try {
      connect(stage_, field_options_, meter_, out_);
    } catch (const OptionError& e) {
      if (e.field() != "connection") throw;
      throw OptionError("/connection/kind", e.value(), e.rule());
    }
  }

  /// As find_guidance() of src/run/guidance.cpp.
  void find_guidance(Source source) {
    switch (source) {
      case Source::nothing:
      case Source::zero:
        return;
      case Source::smoothest:
        u0_ = solve_components(stage_.patch, matrices_, stage_.components, field_options_);
        for (const DistributedComponent& c : stage_.components.list) eigen_converged_ &= c.eigen.converged;
        break;
      case Source::curvature:
      case Source::least_curvature:
      case Source::strongest_curvature:
        u0_ = curvature_together(stage_, {.n = out_.design.n,
                                          .smallest = source == Source::least_curvature,
                                          .by_magnitude = source == Source::strongest_curvature});
        break;
      case Source::file:
        u0_ = field_of_file(out_.design.guidance.file.string(), mesh_, stage_, frames_, out_.design.n);
        break;
    }
    const double size = root_mean_square(stage_, u0_, total_area_);
    if (!(size > 0) || !std::isfinite(size)) throw_no_directions(out_.design.guidance, source);
    u0_ /= size;
  }

  /// As Designer::State::check_t().
  void check_t(double t, double unit) {
    if (t < 0) return;
    Components components = stage_.components;
    if (out_.design.guidance.source != Source::smoothest) {
      DistributedOptions few_digits = field_options_;
      few_digits.tolerance = 1e-6;
      (void)solve_components(stage_.patch, matrices_, components, few_digits);
    }
    double lambda = HUGE_VAL;
    for (const DistributedComponent& c : components.list) lambda = std::min(lambda, c.eigen.lambda);
    const double limit = 2 * lambda / unit;
    if (!(t < limit * (1 - 1e-6))) throw_above_smallest(t, limit);
  }

  void solve() {
    const DesignGuidance& g = out_.design.guidance;
    const double unit = guidance_unit(out_.design.n, total_area_);
    const double weight = g.source != Source::nothing && !g.t ? g.weight : 0.0;
    if (g.t) check_t(*g.t, unit);
    DesignTerms terms{.n = out_.design.n,
                      .total_area = total_area_,
                      .mass_weight = (g.t ? -*g.t : weight) * unit,
                      .guidance_scale = (g.t ? 1.0 : weight) * unit,
                      .guidance_weight = weight,
                      .u0 = u0_};
    if (!g.weights.empty()) {
      terms.vertex_weights.resize(stage_.patch.owned);
      for (Index v = 0; v < stage_.patch.owned; ++v)
        terms.vertex_weights[v] = g.weights[at(stage_.patch.vertex[at(v)])];
    }
    DesignSolution found = solve_design(stage_, matrices_, controls_, terms, options_);
    u_ = std::move(found.u);
    out_.rows = found.rows;
    out_.solves = found.solves;
    out_.iterations = found.iterations;
    out_.residual = found.residual;
    out_.solver = std::move(found.solver);
    fill_pieces();
  }

  /// Components without control and guidance get their smoothest field, as long as the designed field in the mean.
  void fill_pieces() {
    if (u0_.size() > 0 || stage_.components.list.size() < 2) return;
    std::vector<char> empty = touched_components(stage_, controls_);
    for (char& c : empty) c = c != 0 ? 0 : 1;
    if (std::ranges::find(empty, char{1}) == empty.end()) return;
    const ComplexVectorX<double> pieces =
        solve_components(stage_.patch, matrices_, stage_.components, field_options_, empty);
    for (std::size_t k = 0; k < empty.size(); ++k)
      if (empty[k] != 0) eigen_converged_ &= stage_.components.list[k].eigen.converged;
    const double designed = root_mean_square(stage_, u_, total_area_),
                 filled = root_mean_square(stage_, pieces, total_area_);
    if (filled > 0) u_ += (designed > 0 ? designed / filled : 1.0) * pieces;
    out_.remarks.push_back(remark_pieces(empty));
  }

  /// As remark_vanishing() of src/run/design_outcomes.cpp.
  void remark_vanishing(const Field& field) {
    const Patch& patch = stage_.patch;
    const std::vector<Index>& component = stage_.components.of_vertex;
    std::vector<double> longest(stage_.components.list.size(), 0);
    for (Index v = 0; v < patch.owned; ++v)
      if (component[at(v)] != none)
        longest[at(component[at(v)])] = std::max(longest[at(component[at(v)])], std::abs(field.u[v]));
    largest_all(longest);
    const double least = vanishing_length(out_.residual, options_.residual);
    std::vector<Index> gone;
    std::int64_t count = 0;
    for (Index v = 0; v < patch.owned; ++v) {
      const Index c = component[at(v)];
      if (c == none || !(std::abs(field.u[v]) < least * longest[at(c)])) continue;
      ++count;
      if (gone.size() < 8) gone.push_back(patch.vertex[at(v)]);
    }
    gone = gather_all(gone);
    std::ranges::sort(gone);
    gone.resize(std::min<std::size_t>(gone.size(), 8));
    detail::remark_vanishing({.code = "field_vanishes", .count = sum(count), .first = gone}, 0, out_.remarks);
  }

  const MeshSlice& mesh_;
  const DistributedDesignOptions& options_;
  DistributedDesign& out_;
  Meter meter_;
  DistributedOptions field_options_;
  Stage stage_;
  Frames frames_;  // of local vertices
  double total_area_ = 0;
  std::vector<LocalControl> controls_;
  Matrices matrices_;
  ComplexVectorX<double> u0_, u_;  // guidance, and the field, at owned vertices
  bool eigen_converged_ = true;
};

}  // namespace
}  // namespace detail::distributed

bool DistributedDesign::met() const {
  return std::ranges::all_of(outcomes, [](const DesignOutcome& o) { return o.met; });
}

DistributedDesign distributed_design(const MeshSlice& mesh, const DesignFile& design,
                                     const DistributedDesignOptions& options) {
  using namespace detail::distributed;
  const detail::petsc::Session session;
  agreed([&] {
    check_options(options);
    check_slice_size(mesh);
    check_design(design);
    refuse_what_needs_one_machine(design);
  });
  DistributedDesign out;
  out.n = design.n;
  out.phases = mesh.phases;
  DesignRunner(mesh, options, out).run(design);
  return out;
}

}  // namespace alcap
