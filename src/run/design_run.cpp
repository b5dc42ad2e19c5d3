// SPDX-License-Identifier: MIT
//
// design_run.cpp: the stages of a design in order: connection, guidance, designer, solve, analysis.
#include "alcap/design_run.h"

#include <algorithm>
#include <utility>
#include <variant>

#include "alcap/aligned.h"
#include "alcap/alignment.h"
#include "alcap/cones.h"
#include "alcap/eigen_design.h"
#include "alcap/strokes.h"
#include "src/base/array.h"
#include "src/base/clock.h"
#include "src/base/numbers.h"
#include "src/base/parallel.h"
#include "src/design/file/problem.h"
#include "src/design/tolerances.h"
#include "src/field/smoothest_on.h"
#include "src/run/design_stages.h"

namespace alcap {
namespace detail {
namespace {

using Source = DesignGuidance::Source;

// The text of a design with nothing but these parts.

std::string connection_key(const DesignFile& design) {
  DesignFile part;
  // Cones are multiples of 1/n; other connections serve every n.
  if (design.connection.kind == ConnectionKind::trivial) part.n = design.n;
  part.connection = design.connection;
  return design_text(part);
}

std::string guidance_key(const DesignFile& design, Source source) {
  DesignFile part;
  part.n = design.n;
  part.s = design.s;
  part.connection = design.connection;
  part.guidance.source = source;
  if (source == Source::file) part.guidance.file = design.guidance.file;
  return design_text(part);
}

std::string designer_key(const DesignFile& design) {
  DesignFile part = design;
  part.singularities.clear();
  part.fixed.clear();
  part.strokes.clear();
  part.boundary = {};
  part.features = {};
  return design_text(part);
}

/// One text per control, in the order of design_controls(); equal texts are equal controls.
std::vector<std::string> control_keys(const DesignFile& design) {
  std::vector<std::string> keys;
  const auto add = [&](auto list, const auto& element) {
    DesignFile part;
    part.n = design.n;
    (part.*list).push_back(element);
    keys.push_back(design_text(part));
  };
  for (const auto& s : design.singularities) add(&DesignFile::singularities, s);
  for (const auto& f : design.fixed) add(&DesignFile::fixed, f);
  for (const auto& s : design.strokes) add(&DesignFile::strokes, s);
  if (design.boundary.wanted) {
    DesignFile part;
    part.n = design.n;
    part.boundary = design.boundary;
    keys.push_back(design_text(part));
  }
  if (design.features.wanted) {
    DesignFile part;
    part.n = design.n;
    part.features = design.features;
    keys.push_back(design_text(part));
  }
  return keys;
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

}  // namespace

DesignStages::DesignStages(Surface surface, DesignRunOptions options, bool once)
    : surface_(std::move(surface)), options_(std::move(options)), once_(once) {
  if (options_.threads < 0 || options_.threads > most_threads)
    throw OptionError("threads", options_.threads, "must be 0 (all of the machine) or 1 to 4096");
  if (!(options_.residual > 0 && options_.residual < 1))
    throw OptionError("residual", options_.residual, "must be in (0, 1)");
  check_tolerances(options_.tolerances);
}

void DesignStages::forget() {
  designer_.reset();
  designer_text_.clear();
  guidance_text_.clear();
  held_.clear();
  pieces_.clear();
}

void DesignStages::connect(const DesignFile& placed) {
  std::string text = connection_key(placed);
  if (text == connection_text_) return;
  forget();
  connection_text_.clear();
  const ConnectionOptions options = connection_options(placed);
  if (!connect_intrinsic(options)) given_ = connected_ = alcap::connect(surface_, options);
  connection_text_ = std::move(text);
}

void DesignStages::guide(const DesignFile& placed, Source source) {
  std::string text = guidance_key(placed, source);
  if (text == guidance_text_) return;
  forget();
  const bool on_mesh = solve_ && source != Source::smoothest;  // curvature, files
  guidance_ = find_guidance(on_mesh ? given_ : connected_, placed, source, options_.solver);
  if (on_mesh) carry_guidance(placed.n);
  guidance_text_ = std::move(text);
}

VectorX<double> DesignStages::guidance_weights(const DesignGuidance& g) const {
  const VectorX<double> weights =
      Eigen::Map<const VectorX<double>>(g.weights.data(), static_cast<Eigen::Index>(g.weights.size()));
  return solve_ && weights.size() > 0 ? solve_->from_given(weights) : weights;
}

void DesignStages::prepare(const DesignFile& placed, const std::vector<DesignControl>& controls) {
  std::string text = designer_key(placed);
  if (text == designer_text_ && designer_) return;
  const DesignGuidance& g = placed.guidance;
  const bool guided = g.source != Source::nothing;
  held_.clear();
  designer_text_.clear();
  designer_ = std::make_unique<Designer>(connected_,
                                         DesignerOptions{.n = placed.n,
                                                         .guidance_weight = guided && !g.t ? g.weight : 0.0,
                                                         .t = g.t,
                                                         .s = placed.s,
                                                         .tolerances = options_.tolerances,
                                                         .solver = options_.solver,
                                                         .right_hand_sides = once_ ? right_hand_sides(controls) : 0});
  if (guidance_.u) designer_->set_guidance(*guidance_.u);
  if (!g.weights.empty()) designer_->set_guidance_weights(guidance_weights(g));
  designer_text_ = std::move(text);
}

void DesignStages::put(const std::vector<DesignControl>& controls, std::vector<std::string> keys) {
  while (held_.size() > controls.size()) {
    designer_->remove(held_.back().id);
    held_.pop_back();
  }
  for (std::size_t k = 0; k < controls.size(); ++k) {
    const DesignControl& c = controls[k];
    at_path(c.path, [&] {
      if (k == held_.size()) {
        held_.push_back({std::move(keys[k]), designer_->add(c.control)});
      } else if (held_[k].key != keys[k]) {
        designer_->set(held_[k].id, c.control);
        held_[k].key = std::move(keys[k]);
      }
    });
  }
}

bool DesignStages::solve_variational(const std::vector<DesignControl>& controls, std::vector<ControlReport>& reports,
                                     DesignRun& run) {
  Stopwatch watch;
  try {
    say("prepare");
    prepare(run.design, controls);
    put(controls, control_keys(run.design));
    run.times.prepare = watch.lap();
    say("solve");
    DesignResult result = designer_->solve();
    run.field = std::move(result.field);
    run.rows = result.rows;
    run.solves = result.solves;
    run.residual = result.residual;
    run.solver = std::move(result.solver);
    run.times.solve = result.seconds;
    for (const Held& held : held_)
      for (const ControlReport& report : result.controls)
        if (report.id == held.id) reports.push_back(report);
  } catch (...) {
    forget();  // a control may be half replaced
    throw;
  }
  return true;
}

bool DesignStages::fill_pieces(const std::vector<DesignControl>& controls, DesignRun& run) {
  const Topology& topology = connected_.topology();
  const std::size_t count = topology.components.size();
  if (count < 2) return true;
  std::vector<char> empty(count, 1);
  const auto touched = [&](Index face) { empty[at(topology.face_component[at(face)])] = 0; };
  for (const DesignControl& c : controls) {
    if (const auto* target = std::get_if<SingularityTarget>(&c.control)) touched(target->face);
    if (const auto* fixed = std::get_if<VertexConstraint>(&c.control))
      empty[at(topology.vertex_component[at(fixed->vertex)])] = 0;
    if (const auto* stroke = std::get_if<Stroke>(&c.control)) {
      for (const SurfacePoint& p : stroke->points) touched(p.face);
      for (const SurfaceSegment& s : stroke->line.segments) touched(s.face);
    }
    if (std::holds_alternative<BoundaryAlignment>(c.control))
      for (const Loop& loop : topology.loops) empty[at(loop.component)] = 0;
    if (const auto* features = std::get_if<FeatureAlignment>(&c.control))
      for (const Index e : features->features.edges) touched(Mesh::face(connected_.mesh().halfedge(e)));
  }
  if (guidance_.u)
    for (Index v = 0; v < connected_.mesh().vertices(); ++v)
      if ((*guidance_.u)[v] != 0.0 && topology.vertex_component[at(v)] != none)
        empty[at(topology.vertex_component[at(v)])] = 0;
  if (std::count(empty.begin(), empty.end(), 1) == 0) return true;
  if (pieces_ != empty || pieces_field_.n != run.design.n || pieces_s_ != run.design.s) {
    SmoothestResult smooth =
        smoothest_on(connected_, empty, {.n = run.design.n, .s = run.design.s, .eigen = {.solver = options_.solver}});
    pieces_converged_ = std::all_of(smooth.components.begin(), smooth.components.end(),
                                    [](const EigenReport& e) { return e.converged || e.solver.empty(); });
    pieces_field_ = std::move(smooth.field);
    pieces_ = empty;
    pieces_s_ = run.design.s;
  }
  // As long as the designed field is, in the mean over its components.
  ComplexVectorX<double>& u = run.field.u;
  const double designed = root_mean_square(connected_.surface(), u),
               filled = root_mean_square(connected_.surface(), pieces_field_.u);
  if (filled > 0) u += (designed > 0 ? designed / filled : 1.0) * pieces_field_.u;
  run.remarks.push_back(remark_pieces(empty));
  return pieces_converged_;
}

namespace {

/// The controls of an eigen design; the boundary as a stroke along every loop, after the strokes.
EigenControls eigen_controls(const ConnectedSurface& surface, const std::vector<DesignControl>& controls) {
  EigenControls asked;
  for (const DesignControl& c : controls) {
    if (const auto* target = std::get_if<SingularityTarget>(&c.control)) asked.singularities.push_back(*target);
    if (const auto* fixed = std::get_if<VertexConstraint>(&c.control)) asked.fixed.push_back(*fixed);
    if (const auto* stroke = std::get_if<Stroke>(&c.control))
      asked.strokes.push_back({.line = stroke->line, .weight = stroke->weight, .radius = stroke->radius});
    if (const auto* features = std::get_if<FeatureAlignment>(&c.control)) asked.features.push_back(*features);
  }
  for (const DesignControl& c : controls) {
    const auto* const boundary = std::get_if<BoundaryAlignment>(&c.control);
    if (boundary == nullptr) continue;
    const std::vector<Loop>& loops = surface.topology().loops;
    if (loops.empty()) throw OptionError("/boundary", "none", "this mesh has no boundary to align with");
    for (const Loop& loop : loops) {
      std::vector<Index> vertices;
      for (const Index h : loop.halfedges) vertices.push_back(surface.mesh().tail(h));
      vertices.push_back(vertices.front());
      asked.strokes.push_back(
          {.line = stroke_along_vertices(surface, vertices), .weight = boundary->weight, .across = boundary->normal});
    }
  }
  return asked;
}

/// In the order of controls: singularities, fixed vertices, strokes, the boundary, whose loops are the last strokes,
/// and features.
std::vector<ControlReport> eigen_reports(const std::vector<DesignControl>& controls, const EigenControls& asked,
                                         const EigenDesignResult& result, double boundary_degrees) {
  std::vector<ControlReport> reports = result.singularities;
  reports.insert(reports.end(), result.fixed.begin(), result.fixed.end());
  std::size_t k = 0;
  for (const DesignControl& c : controls) {
    if (std::holds_alternative<Stroke>(c.control)) {
      const EigenStrokeReport& stroke = result.strokes[k++];
      reports.push_back({.met = stroke.met, .error_degrees = stroke.mean_degrees});
    } else if (std::holds_alternative<BoundaryAlignment>(c.control)) {
      double degrees = 0, length = 0;
      for (; k < asked.strokes.size(); ++k) {
        degrees += asked.strokes[k].line.length() * result.strokes[k].mean_degrees;
        length += asked.strokes[k].line.length();
      }
      degrees /= length;
      reports.push_back({.met = degrees <= boundary_degrees, .error_degrees = degrees});
    }
  }
  reports.insert(reports.end(), result.features.begin(), result.features.end());
  return reports;
}

}  // namespace

bool DesignStages::solve_eigen(const std::vector<DesignControl>& controls, std::vector<ControlReport>& reports,
                               DesignRun& run) {
  EigenControls asked = eigen_controls(connected_, controls);
  const DesignGuidance& g = run.design.guidance;
  bool converged = true;
  if (g.source != Source::nothing) {
    const Stopwatch watch;
    say("guidance");
    guide(run.design, g.source);
    run.guidance = guidance_.u;
    run.guidance_scale = guidance_.scale;
    converged = guidance_.converged;
    if (guidance_.u) asked.guidance = *guidance_.u;
    asked.guidance_weight = g.weight;
    asked.guidance_weights = guidance_weights(g);
    run.times.guidance = watch.seconds();
  }
  say("solve");
  EigenDesignResult result = eigen_design(connected_, asked,
                                          {.n = run.design.n,
                                           .s = run.design.s,
                                           .eigen = {.tolerance = options_.residual, .solver = options_.solver},
                                           .tolerances = options_.tolerances});
  run.times.prepare = result.assembly_seconds;
  run.times.solve = result.eigen_seconds;
  reports = eigen_reports(controls, asked, result, options_.tolerances.boundary_degrees);
  run.field = std::move(result.field);
  for (const EigenReport& e : result.components) {
    converged = converged && e.converged;
    run.residual = std::max(run.residual, e.residual);
    run.solver = e.solver;
  }
  run.eigen = std::move(result.components);
  return converged;
}

bool DesignStages::solve_guided(const std::vector<DesignControl>& controls, std::vector<ControlReport>& reports,
                                DesignRun& run) {
  const Stopwatch watch;
  const bool lone = controls.empty() && run.design.guidance.source == Source::nothing;
  say("guidance");
  guide(run.design, lone ? Source::smoothest : run.design.guidance.source);
  run.guidance = guidance_.u;
  run.guidance_scale = guidance_.scale;
  run.times.guidance = watch.seconds();
  if (lone) {
    run.field = {.n = run.design.n, .u = *guidance_.u, .frames = connected_.in_space() ? connected_.frames() : nullptr};
    return guidance_.converged;
  }
  bool converged = solve_variational(controls, reports, run);
  return fill_pieces(controls, run) && converged && guidance_.converged;
}

DesignRun DesignStages::solve(const DesignFile& design) {
  DesignRun run;
  Stopwatch watch;
  say("connection");
  run.design = place_design(design, surface_);
  if (design.features.wanted) run.features.emplace().graph = design_features(design, surface_);
  keep_edges(run.design.features.wanted ? run.features->graph.edges : std::vector<Index>{});
  connect(run.design);
  run.surface = given_;
  // From here on the cones are those of the connection.
  run.design.connection.cones = connected_.connection().cones;
  run.design.connection.balance = false;
  const std::vector<DesignControl> controls = design_controls(run.design, given_),
                                   there = carried(controls, run.design.n);
  run.times.connection = watch.lap();

  std::vector<ControlReport> reports;
  bool converged = true;
  const AlignedAlone alone = aligned_alone(run.design);
  if (alone != AlignedAlone::no) {
    say("solve");
    const FeatureGraph lines =
        alone == AlignedAlone::features ? run.features->graph : sharp_edges(surface_, {.creases = false});
    const double coarser =
        static_cast<double>(connected_.mesh().vertices()) / static_cast<double>(given_.mesh().vertices());
    converged = solve_along(alone, connected_, graph_there(lines), coarser, options_, there, reports, run);
  } else if (run.design.method == DesignMethod::variational) {
    converged = solve_guided(there, reports, run);
  } else {
    converged = solve_eigen(there, reports, run);
  }

  watch.lap();
  say("analysis");
  const ComplexVectorX<double> solved = run.field.u;
  if (solve_) bring_back(run);
  const bool lone = controls.empty() && run.design.guidance.source == Source::nothing;
  const bool guided = run.design.guidance.source != Source::nothing;
  if ((run.design.method == DesignMethod::variational || guided) && alone == AlignedAlone::no && !lone)
    remark_vanishing(options_.residual, run);
  analyse(design, solved, controls, there, reports, converged, run);
  run.times.analysis = watch.lap();
  return run;
}

void DesignStages::analyse(const DesignFile& asked, const ComplexVectorX<double>& solved,
                           const std::vector<DesignControl>& controls,
                           const std::vector<DesignControl>& solved_controls, const std::vector<ControlReport>& reports,
                           bool converged, DesignRun& run) const {
  run.indices = face_indices(run.surface, run.field);
  run.index_sums = index_sums(run.surface, run.field, run.indices);
  run.singularities = find_singularities(run.surface, run.field, run.indices);
  run.outcomes = judge_design(run, {connected_, solved, solved_controls}, controls, reports, options_.tolerances);
  if (run.triangulation) remark_triangulation(*run.triangulation, run.singularities.size(), run.remarks);
  if (needles_stay_) run.remarks.push_back(own_triangles());
  if (run.features) {
    if (asked.features.hold)
      run.features->free_corners =
          feature_directions(run.surface, run.features->graph, asked.n, asked.features.across).free_corners;
    judge_design_features(asked, run);
  }
  certify_design(connected_.connection(), converged, options_.residual, run);
  if (options_.normalise) run.field = normalised(std::move(run.field));
}

}  // namespace detail

namespace {

RunControl control_of(const DesignRunOptions& options) {
  RunControl control = options.control;
  if (options.threads > 0) control.threads = options.threads;
  return control;
}

}  // namespace

bool DesignRun::met() const {
  return std::all_of(outcomes.begin(), outcomes.end(), [](const DesignOutcome& o) { return o.met; });
}

struct DesignSession::State {
  detail::DesignStages stages;
  RunControl control;
};

DesignSession::DesignSession(const Surface& surface, DesignRunOptions options) {
  RunControl control = control_of(options);
  state_ = std::make_unique<State>(State{detail::DesignStages(surface, std::move(options), false), std::move(control)});
}
DesignSession::~DesignSession() = default;
DesignSession::DesignSession(DesignSession&&) noexcept = default;
DesignSession& DesignSession::operator=(DesignSession&&) noexcept = default;

DesignRun DesignSession::solve(const DesignFile& design) {
  return controlled(state_->control, [&] { return state_->stages.solve(design); });
}

DesignRun run_design(const Surface& surface, const DesignFile& design, const DesignRunOptions& options) {
  detail::DesignStages stages(surface, options, true);
  return controlled(control_of(options), [&] { return stages.solve(design); });
}

DesignFile plan_design(const DesignFile& design, const Surface& surface) {
  DesignFile placed = place_design(design, surface);
  if (placed.connection.kind == ConnectionKind::trivial && placed.connection.balance)
    placed.connection.cones = balance_cones(surface, placed.connection.cones, {.n = placed.n});
  placed.connection.balance = false;
  return placed;
}

}  // namespace alcap
