// SPDX-License-Identifier: MIT
//
// design.cpp: designs: prepared once and edited live, and smoothest ones. Controls are dataclasses of
// python/alcap/_controls.py, told apart by their attribute `kind`.
#include <mutex>

#include "alcap/connected_surface.h"
#include "alcap/designer.h"
#include "alcap/eigen_design.h"
#include "python/src/arrays.h"
#include "python/src/bindings.h"
#include "python/src/features.h"
#include "python/src/long_call.h"
#include "python/src/options.h"
#include "python/src/points.h"

namespace alcap::python {
namespace {

SingularityTarget target_of(const py::object& c) {
  SingularityTarget t{.face = as<Index>(c.attr("face"), "face"),
                      .sign = as<int>(c.attr("sign"), "sign"),
                      .orientation = as<double>(c.attr("orientation"), "orientation"),
                      .strength = as<double>(c.attr("strength"), "strength")};
  t.count = as<int>(c.attr("count"), "count");
  if (!c.attr("pin").is_none()) t.pin = as<std::array<double, 3>>(c.attr("pin"), "pin");
  return t;
}

Stroke stroke_of(const py::object& c) {
  return {.weight = as<double>(c.attr("weight"), "weight"),
          .line = as<const SurfacePolyline&>(c.attr("line"), "line"),
          .radius = as<double>(c.attr("radius"), "radius")};
}

VertexConstraint vertex_of(const py::object& c) {
  return {.vertex = as<Index>(c.attr("vertex"), "vertex"),
          .value = as<Complex<double>>(c.attr("value"), "value"),
          .direction_only = as<bool>(c.attr("direction_only"), "direction_only")};
}

FeatureAlignment features_of(const py::object& c) {
  return {.features = graph_of(c.attr("features")),
          .across = as<bool>(c.attr("across"), "across"),
          .weight = as<double>(c.attr("weight"), "weight"),
          .hold = as<bool>(c.attr("hold"), "hold")};
}

Control control_of(const py::object& c) {
  const auto kind = py::getattr(c, "kind", py::str("")).cast<std::string>();
  if (kind == "singularity") return target_of(c);
  if (kind == "stroke") return stroke_of(c);
  if (kind == "vertex") return vertex_of(c);
  if (kind == "boundary")
    return BoundaryAlignment{.normal = as<bool>(c.attr("normal"), "normal"),
                             .weight = as<double>(c.attr("weight"), "weight")};
  if (kind == "features") return features_of(c);
  throw OptionError("control", py::str(c).cast<std::string>(),
                    "must be a SingularityTarget, VertexConstraint, Stroke, BoundaryAlignment or FeatureAlignment");
}

py::list reports(const std::vector<ControlReport>& list) {
  py::list out;
  for (const ControlReport& r : list) {
    out.append(py::dict("id"_a = static_cast<int>(r.id), "met"_a = r.met, "index"_a = r.index,
                        "error_degrees"_a = r.error_degrees));
  }
  return out;
}

/// A Designer that several threads of Python may call, one after the other.
class Live {
 public:
  Live(const ConnectedSurface& surface, const py::dict& d, const py::object& progress, int threads)
      : progress_(progress), threads_(threads) {
    const DesignerOptions options = options_of(d);
    call([&] { designer_.emplace(surface, options); });
  }
  int add(const py::object& control) {
    Control c = control_of(control);
    int id = 0;
    call([&] { id = static_cast<int>(designer_->add(std::move(c))); });
    return id;
  }
  void set(int id, const py::object& control) {
    Control c = control_of(control);
    call([&] { designer_->set(ControlId{id}, std::move(c)); });
  }
  /// (id, members) of the singularities: what moving, merging and splitting made of them.
  py::list controls() {
    std::map<ControlId, Control> all;
    call([&] { all = designer_->controls(); });
    py::list out;
    for (const auto& [id, control] : all) {
      const auto* t = std::get_if<SingularityTarget>(&control);
      if (t == nullptr) continue;
      py::dict d("face"_a = t->face, "sign"_a = t->sign, "count"_a = t->count, "orientation"_a = t->orientation,
                 "strength"_a = t->strength, "pin"_a = t->pin);
      out.append(py::make_tuple(static_cast<int>(id), d));
    }
    return out;
  }
  void remove(int id) {
    call([&] { designer_->remove(ControlId{id}); });
  }
  void move(int id, Index face) {
    call([&] { designer_->move(ControlId{id}, face); });
  }
  std::optional<int> merge(int id, int other) {
    std::optional<ControlId> left;
    call([&] { left = designer_->merge(ControlId{id}, ControlId{other}); });
    return left ? std::optional(static_cast<int>(*left)) : std::nullopt;
  }
  int split(int id, Index face, int count) {
    ControlId made{};
    call([&] { made = designer_->split(ControlId{id}, face, count); });
    return static_cast<int>(made);
  }
  void set_guidance(const py::object& u0) {
    const auto values = complex_of(u0, "u0");
    call([&] { designer_->set_guidance(values); });
  }
  void set_guidance_weight(double weight) {
    call([&] { designer_->set_guidance_weight(weight); });
  }
  void set_guidance_weights(const py::object& weights) {
    const auto values = reals_of(weights, "weights");
    call([&] { designer_->set_guidance_weights(values); });
  }
  py::tuple solve() {
    std::optional<DesignResult> r;
    call([&] { r = designer_->solve(); });
    py::dict report("rows"_a = r->rows, "solves"_a = r->solves, "residual"_a = r->residual, "solver"_a = r->solver,
                    "seconds"_a = r->seconds);
    return py::make_tuple(std::make_shared<Field>(std::move(r->field)), reports(r->controls), report);
  }

 private:
  static DesignerOptions options_of(const py::dict& d) {
    DesignerOptions options{.n = as<int>(d["n"], "n"),
                            .guidance_weight = as<double>(d["guidance_weight"], "guidance_weight"),
                            .s = as<double>(d["s"], "s"),
                            .kind = named<OperatorKind>(as<std::string>(d["kind"], "kind"), "kind"),
                            .tolerances = tolerances_of(d["tolerances"]),
                            .solver = as<std::string>(d["solver"], "solver")};
    if (!d["t"].is_none()) options.t = as<double>(d["t"], "t");
    return options;
  }
  void call(const std::function<void()>& body) {
    long_call(progress_, threads_, [&] {
      const std::lock_guard lock(mutex_);
      body();
    });
  }
  py::object progress_;
  int threads_;
  std::mutex mutex_;
  std::optional<Designer> designer_;
};

/// Of lists of Stroke or EigenStroke, of SingularityTarget, of VertexConstraint, and guidance.
EigenControls eigen_controls(const py::dict& d) {
  EigenControls out;
  for (const py::handle h : d["strokes"]) {
    out.strokes.push_back({.line = as<const SurfacePolyline&>(h.attr("line"), "line"),
                           .weight = as<double>(h.attr("weight"), "weight"),
                           .across = as<bool>(py::getattr(h, "across", py::bool_(false)), "across"),
                           .radius = as<double>(h.attr("radius"), "radius")});
  }
  for (const py::handle h : d["singularities"])
    out.singularities.push_back(target_of(py::reinterpret_borrow<py::object>(h)));
  for (const py::handle h : d["features"]) out.features.push_back(features_of(py::reinterpret_borrow<py::object>(h)));
  for (const py::handle h : d["fixed"]) out.fixed.push_back(vertex_of(py::reinterpret_borrow<py::object>(h)));
  if (const py::object g = d["guidance"]; !g.is_none()) out.guidance = complex_of(g, "guidance");
  out.guidance_weight = as<double>(d["guidance_weight"], "guidance_weight");
  if (const py::object w = d["guidance_weights"]; !w.is_none()) out.guidance_weights = reals_of(w, "guidance_weights");
  return out;
}

py::tuple smoothest_design(const ConnectedSurface& surface, const py::dict& asked, const py::dict& d,
                           const py::dict& eigen, const py::object& progress, int threads) {
  const EigenControls controls = eigen_controls(asked);
  const EigenDesignOptions options{.n = as<int>(d["n"], "n"),
                                   .s = as<double>(d["s"], "s"),
                                   .offset = as<double>(d["offset"], "offset"),
                                   .eigen = eigen_of(eigen),
                                   .path = named<EigenPath>(as<std::string>(d["path"], "path"), "path"),
                                   .tolerances = tolerances_of(d["tolerances"])};
  EigenDesignResult r = watched(progress, threads, [&] { return eigen_design(surface, controls, options); });
  py::list components, lines;
  for (const EigenReport& e : r.components) components.append(eigen_dict(e));
  for (const EigenStrokeReport& s : r.strokes) {
    lines.append(py::dict("mean_degrees"_a = s.mean_degrees, "largest_degrees"_a = s.largest_degrees,
                          "magnitude"_a = s.magnitude, "met"_a = s.met));
  }
  return py::make_tuple(std::make_shared<Field>(std::move(r.field)), components, lines, reports(r.singularities),
                        reports(r.fixed), reports(r.features), r.assembly_seconds, r.eigen_seconds);
}

}  // namespace

void bind_design(py::module_& m) {
  py::class_<Live>(m, "Designer")
      .def(py::init<const ConnectedSurface&, const py::dict&, const py::object&, int>())
      .def("add", &Live::add)
      .def("set", &Live::set)
      .def("remove", &Live::remove)
      .def("move", &Live::move)
      .def("merge", &Live::merge)
      .def("split", &Live::split)
      .def("controls", &Live::controls)
      .def("set_guidance", &Live::set_guidance)
      .def("set_guidance_weight", &Live::set_guidance_weight)
      .def("set_guidance_weights", &Live::set_guidance_weights)
      .def("solve", &Live::solve);
  m.def("eigen_design", &smoothest_design);
}

}  // namespace alcap::python
