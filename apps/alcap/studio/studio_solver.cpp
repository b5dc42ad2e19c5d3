// SPDX-License-Identifier: MIT
//
// studio_solver.cpp: three stages, each with the text of the part of the design that it depends on: connection, field
// to stay close to, designer. A stage is made anew when its text changes, and so are those after it. Within the
// designer, controls are compared one by one.
#include "apps/alcap/studio/studio_solver.h"

#include <chrono>
#include <cmath>
#include <variant>

#include "alcap/alignment.h"
#include "alcap/designer.h"
#include "alcap/field_run.h"
#include "alcap/smoothest.h"

namespace alcap::app {
namespace {

/// The text of a design with nothing but these parts.
std::string connection_key(const DesignFile& design) {
  DesignFile part;
  // Cones are multiples of 1/n; other connections serve every n.
  if (design.connection.kind == ConnectionKind::trivial) part.n = design.n;
  part.connection = design.connection;
  return design_text(part);
}

std::string guidance_key(const DesignFile& design) {
  DesignFile part;
  part.n = design.n;
  part.s = design.s;
  part.connection = design.connection;
  part.guidance.source = design.guidance.source;
  return design_text(part);
}

std::string designer_key(const DesignFile& design) {
  DesignFile part = design;
  part.singularities.clear();
  part.fixed.clear();
  part.strokes.clear();
  part.boundary = {};
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
  return keys;
}

}  // namespace

const std::string& StudioResult::details() const {
  std::call_once(once_, [&] {
    ViewPack pack;
    pack.meta["result"] = id;
    add_curves(pack, output(), curve_spacing(output()));
    add_scalars(pack, output());
    details_ = pack.bytes();
  });
  return details_;
}

struct StudioSolver::State {
  struct Held {
    std::string key;
    ControlId id{};
  };
  explicit State(Surface of) : surface(std::move(of)) {}

  Surface surface;
  std::uint64_t results = 0;

  std::string connection_text;
  ConnectedSurface connected;
  std::string guidance_text;
  ComplexVectorX<double> guidance;  // empty: none, or zero
  std::string designer_text;
  std::unique_ptr<Designer> designer;
  std::vector<Held> held;

  void connect(const DesignFile& design) {
    const std::string text = connection_key(design);
    if (text == connection_text) return;
    forget();
    connection_text.clear();
    connected = alcap::connect(surface, connection_options(design));
    connection_text = text;
  }

  /// As `alcap design` does: fields have root mean square length 1, so that a strength of 1 holds against them.
  [[nodiscard]] ComplexVectorX<double> find_guidance(const DesignFile& design, bool lone) const {
    using Source = DesignGuidance::Source;
    const Source source = lone ? Source::smoothest : design.guidance.source;
    ComplexVectorX<double> u;
    if (source == Source::smoothest) {
      u = smoothest_field(connected, {.n = design.n, .s = design.s}).field.u;
    } else if (source == Source::curvature || source == Source::least_curvature) {
      u = curvature_field(connected, {.n = design.n, .smallest = source == Source::least_curvature}).u;
    } else {
      return u;
    }
    const double size = root_mean_square(surface, u);
    if (!(size > 0) || !std::isfinite(size))
      throw OptionError("/guidance/field", name(source), "this surface has no such directions");
    return u / size;
  }

  void guide(const DesignFile& design, bool lone) {
    const std::string text = guidance_key(design) + (lone ? "lone" : "");
    if (text == guidance_text) return;
    forget();
    guidance = find_guidance(design, lone);
    guidance_text = text;
  }

  void forget() {
    designer.reset();
    designer_text.clear();
    guidance_text.clear();
    held.clear();
  }

  void prepare(const DesignFile& design) {
    const std::string text = designer_key(design);
    if (text == designer_text && designer) return;
    const DesignGuidance& g = design.guidance;
    const bool guided = g.source != DesignGuidance::Source::none;
    held.clear();
    designer_text.clear();
    designer = std::make_unique<Designer>(
        connected,
        DesignerOptions{.n = design.n, .guidance_weight = guided && !g.t ? g.weight : 0.0, .t = g.t, .s = design.s});
    if (guidance.size() > 0) designer->set_guidance(guidance);
    if (!g.weights.empty()) {
      designer->set_guidance_weights(
          Eigen::Map<const VectorX<double>>(g.weights.data(), static_cast<Eigen::Index>(g.weights.size())));
    }
    designer_text = text;
  }

  void place(const std::vector<DesignControl>& controls, std::vector<std::string> keys) {
    keys.resize(controls.size());
    while (held.size() > controls.size()) {
      designer->remove(held.back().id);
      held.pop_back();
    }
    for (std::size_t k = 0; k < controls.size(); ++k) {
      if (k < held.size()) {
        if (held[k].key == keys[k] && !keys[k].empty()) continue;
        designer->set(held[k].id, controls[k].control);
        held[k].key = keys[k];
      } else {
        held.push_back({keys[k], designer->add(controls[k].control)});
      }
    }
  }
};

StudioSolver::StudioSolver(Surface surface) : state_(std::make_unique<State>(std::move(surface))) {}
StudioSolver::~StudioSolver() = default;

std::shared_ptr<const StudioResult> StudioSolver::solve(const DesignFile& design) {
  State& s = *state_;
  const auto start = std::chrono::steady_clock::now();
  if (design.method != DesignMethod::variational)
    throw OptionError("/method", "eigen", "the studio solves variational designs; alcap design solves both");
  const DesignFile placed = place_design(design, s.surface);
  s.connect(placed);
  const std::vector<DesignControl> controls = design_controls(placed, s.connected);
  const bool lone = controls.empty() && placed.guidance.source == DesignGuidance::Source::none;
  s.guide(placed, lone);
  auto result = std::make_shared<StudioResult>();
  result->surface = s.connected;
  if (lone) {
    result->field = {.n = placed.n, .u = s.guidance, .frames = s.connected.frames()};
  } else {
    try {
      s.prepare(placed);
      s.place(controls, control_keys(placed));
      DesignResult solved = s.designer->solve();
      result->field = std::move(solved.field);
      for (const ControlReport& r : solved.controls) {
        for (std::size_t k = 0; k < controls.size(); ++k) {
          if (s.held[k].id != r.id) continue;
          result->controls.push_back({{"path", controls[k].path}, {"met", r.met}, {"error_degrees", r.error_degrees}});
        }
      }
    } catch (...) {
      s.forget();  // a control may be half replaced
      throw;
    }
  }
  result->singularities = find_singularities(s.connected, result->field);
  result->id = ++s.results;
  result->seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace alcap::app
