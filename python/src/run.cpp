// SPDX-License-Identifier: MIT
//
// run.cpp: whole runs of fields and of designs, with the reports and the page of the command line.
#include <mutex>

#include "alcap/batch.h"
#include "alcap/design_run.h"
#include "alcap/mesh_io.h"
#include "apps/alcap/page/html_page.h"
#include "apps/alcap/page/view_scene.h"
#include "apps/alcap/report/design_report.h"
#include "apps/alcap/report/report.h"
#include "python/src/arrays.h"
#include "python/src/bindings.h"
#include "python/src/features.h"
#include "python/src/long_call.h"
#include "python/src/options.h"
#include "python/src/singularity_array.h"

namespace alcap::python {
namespace {

/// A run and the options that its report repeats.
struct Run {
  FieldRun run;
  FieldRunOptions options;
};
struct Designed {
  DesignRun run;
  DesignFile asked;
};

FieldAlignment alignment_of(const py::dict& d) {
  FieldAlignment out{.features = sharp_options(d),
                     .edges = {},
                     .across = as<bool>(d["across"], "across"),
                     .weight = as<double>(d["weight"], "weight"),
                     .max_steps = as<int>(d["max_steps"], "max_steps")};
  if (!d["edges"].is_none()) out.edges = pairs_of(d["edges"], "edges");
  return out;
}

FieldRunOptions options_of(const py::dict& d, const py::dict& connection, const py::dict& eigen) {
  FieldRunOptions out{.n = as<int>(d["n"], "n"),
                      .s = as<double>(d["s"], "s"),
                      .connection = connection_of(connection),
                      .eigen = eigen_of(eigen),
                      .normalise = as<bool>(d["normalise"], "normalise")};
  for (const py::handle h : d["repairs"])
    out.repairs.push_back(named<Repair>(as<std::string>(h, "repairs"), "repairs"));
  out.weld_tolerance = as<double>(d["weld_tolerance"], "weld_tolerance");
  out.modes = as<int>(d["modes"], "modes");
  out.triangulation = named<Triangulation>(as<std::string>(d["triangulation"], "triangulation"), "triangulation");
  out.min_angle = as<double>(d["min_angle"], "min_angle");
  if (!d["align"].is_none()) out.align = alignment_of(as<py::dict>(d["align"], "align"));
  return out;
}

py::list remarks(const std::vector<Remark>& list) {
  py::list out;
  for (const Remark& r : list) {
    out.append(py::dict("code"_a = r.code, "warning"_a = r.warning, "message"_a = r.message, "count"_a = r.count,
                        "first"_a = r.first));
  }
  return out;
}

app::Json times(const FieldTimes& t) {
  const double total = t.mesh + t.connection + t.assembly + t.eigen + t.analysis;
  app::Json json = app::times_json(t, {.total = total});
  json.erase("read");
  json.erase("write");
  return json;
}

std::string report(const Run& r) {
  app::Json json = app::field_report({}, {}, r.run, r.options);
  json["input"] = nullptr;  // arrays
  json["times"] = times(r.run.times);
  return app::text_of(json);
}

std::string report(const Designed& d) {
  std::vector<Remark> all = mesh_remarks(d.run.surface);
  all.insert(all.end(), d.run.remarks.begin(), d.run.remarks.end());
  app::Json json = app::design_report(nullptr, d.asked, d.run, all);
  const DesignTimes& t = d.run.times;
  json["times"] = {{"connection", t.connection},
                   {"guidance", t.guidance},
                   {"prepare", t.prepare},
                   {"solve", t.solve},
                   {"analysis", t.analysis}};
  return app::text_of(json);
}

template <class Any>
py::bytes page(const Any& any, const std::string& title) {
  const auto& run = any.run;
  return py::bytes(watched(py::none(), 0, [&] {
    app::check_page();
    const FieldOutput output{.surface = run.surface, .field = run.field, .singularities = run.singularities};
    return app::html_page(app::make_scene(output, title, app::Json::parse(report(any))));
  }));
}

/// What both kinds of run have.
template <class Any>
void bind_common(py::class_<Any>& c) {
  c.def_property_readonly("connection", [](const Any& a) { return a.run.surface; });
  c.def_property_readonly("field", [](const Any& a) { return std::make_shared<Field>(a.run.field); });
  c.def_property_readonly("indices", [](const Any& a) { return moved(std::vector<int>(a.run.indices)); });
  c.def_property_readonly("index_sums", [](const Any& a) {
    py::list out;
    for (const IndexSum& i : a.run.index_sums) out.append(py::make_tuple(i.sum, i.expected));
    return out;
  });
  c.def_property_readonly("singularities", [](const Any& a) { return singularity_array(a.run.singularities); });
  c.def_property_readonly("holds", [](const Any& a) { return a.run.certificate.holds(); });
  c.def_property_readonly("remarks", [](const Any& a) {
    std::vector<Remark> all;
    if constexpr (std::is_same_v<Any, Designed>) all = mesh_remarks(a.run.surface);
    all.insert(all.end(), a.run.remarks.begin(), a.run.remarks.end());
    return remarks(all);
  });
  c.def_property_readonly("eigen", [](const Any& a) {
    py::list out;
    for (const EigenReport& e : a.run.eigen) out.append(eigen_dict(e));
    return out;
  });
  c.def("report_json", [](const Any& a) { return report(a); });
  c.def("page", &page<Any>);
}

/// Meshes of a batch: surfaces, or points and triangles.
struct BatchMesh {
  Surface surface;
  Positions<double> V;
  Faces F;
};

py::list batch(const py::list& meshes, const FieldRunOptions& options, int jobs, const py::object& progress) {
  std::vector<BatchMesh> input;
  for (const py::handle h : meshes) {
    if (py::isinstance<Surface>(h)) {
      input.push_back({h.cast<Surface>(), {}, {}});
    } else {
      const auto pair = h.cast<py::sequence>();
      input.push_back({{}, positions_of(pair[0]), faces_of(pair[1])});
    }
  }
  std::vector<std::unique_ptr<Run>> runs(input.size());
  std::vector<std::exception_ptr> errors(input.size());
  long_call(progress, 0, [&] {
    run_batch(
        static_cast<std::int64_t>(input.size()), {.field = options, .jobs = jobs},
        [&](Context& context, std::int64_t i) {
          BatchMesh& mesh = input[static_cast<std::size_t>(i)];
          const FieldRun& run =
              mesh.V.rows() > 0 ? context.run(std::move(mesh.V), std::move(mesh.F)) : context.run(mesh.surface);
          runs[static_cast<std::size_t>(i)] = std::make_unique<Run>(Run{run, options});
        },
        [&](std::int64_t i, const std::exception&) { errors[static_cast<std::size_t>(i)] = std::current_exception(); });
  });
  py::list out;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    if (runs[k]) {
      out.append(std::move(runs[k]));
      continue;
    }
    // As Python would catch it.
    out.append(py::cpp_function([error = errors[k]] { std::rethrow_exception(error); }));
  }
  return out;
}

/// Several threads of Python may call it, one after the other.
class Session {
 public:
  Session(const Surface& surface, const DesignRunOptions& options, py::object progress, int threads)
      : progress_(std::move(progress)), threads_(threads), session_(surface, options) {}
  std::unique_ptr<Designed> solve(const std::string& design, const std::string& folder) {
    DesignFile file = parse_design(design, "design", folder);
    auto out = std::make_unique<Designed>();
    long_call(progress_, threads_, [&] {
      const std::lock_guard lock(mutex_);
      *out = Designed{session_.solve(file), file};
    });
    return out;
  }

 private:
  py::object progress_;
  int threads_;
  std::mutex mutex_;
  DesignSession session_;
};

DesignRunOptions design_options(const py::dict& d) {
  return {.solver = d["solver"].cast<std::string>(),
          .residual = d["residual"].cast<double>(),
          .tolerances = tolerances_of(d["tolerances"]),
          .normalise = d["normalise"].cast<bool>(),
          .triangulation = named<Triangulation>(d["triangulation"].cast<std::string>(), "triangulation"),
          .min_angle = d["min_angle"].cast<double>()};
}

py::object triangulation_of(const std::optional<SolvedTriangulation>& found) {
  if (!found) return py::none();
  const SolvedTriangulation& t = *found;
  py::list cones;
  for (const Cone& c : t.cones) cones.append(py::make_tuple(c.vertex, c.index));
  return py::dict("before"_a = quality_dict(t.before), "after"_a = quality_dict(t.after), "flips"_a = t.flips,
                  "added"_a = t.added, "faces"_a = t.faces, "barred"_a = t.barred, "complete"_a = t.complete,
                  "seconds"_a = t.seconds, "connection"_a = connection_dict(t.connection), "cones"_a = cones,
                  "generator_holonomy"_a = t.generator_holonomy, "loop_index"_a = t.loop_index,
                  "parallel"_a = t.parallel, "singularities"_a = t.singularities);
}

py::object features_dict(const std::optional<FieldFeatures>& features) {
  if (!features) return py::none();
  return py::dict("graph"_a = graph_dict(features->graph), "pieces"_a = pieces_list(features->pieces),
                  "free_corners"_a = moved(std::vector<Index>(features->free_corners)),
                  "report"_a = deviations_dict(features->report), "followed"_a = features->followed);
}

}  // namespace

void bind_run(py::module_& m) {
  py::class_<Run> field_run(m, "FieldRun");
  bind_common(field_run);
  field_run.def_property_readonly("features", [](const Run& r) { return features_dict(r.run.features); });
  field_run.def_property_readonly("triangulation", [](const Run& r) { return triangulation_of(r.run.triangulation); });
  field_run.def_property_readonly("modes", [](const Run& r) { return modes_tuple(EigenModes(r.run.modes)); });
  field_run.def_property_readonly("copies_of", [](const Run& r) { return moved(std::vector<Index>(r.run.copies_of)); });
  field_run.def_property_readonly("face_of", [](const Run& r) { return moved(std::vector<Index>(r.run.face_of)); });
  py::class_<Designed> design_run(m, "DesignRun");
  bind_common(design_run);
  design_run.def_property_readonly("triangulation",
                                   [](const Designed& d) { return triangulation_of(d.run.triangulation); });
  design_run.def_property_readonly("features", [](const Designed& d) { return features_dict(d.run.features); });
  design_run.def_property_readonly("design_json", [](const Designed& d) { return design_text(d.run.design); });
  m.def("run_field", [](const Surface& s, const py::dict& d, const py::dict& connection, const py::dict& eigen,
                        const py::object& progress, int threads) {
    const FieldRunOptions options = options_of(d, connection, eigen);
    return watched(progress, threads, [&] { return std::make_unique<Run>(Run{run_field(s, options), options}); });
  });
  m.def("repaired_surface", [](const py::object& V, const py::object& F, const std::vector<std::string>& repairs,
                               double tolerance, bool bow_ties) {
    RepairOptions options{.repairs = {}, .weld_tolerance = tolerance, .bow_ties = bow_ties};
    for (const std::string& text : repairs) options.repairs.push_back(named<Repair>(text, "repairs"));
    auto points = positions_of(V);
    auto faces = faces_of(F);
    RepairedSurface out =
        watched(py::none(), 0, [&] { return repaired_surface(std::move(points), std::move(faces), options); });
    return py::make_tuple(out.surface, moved(std::move(out.copies_of)), moved(std::move(out.face_of)),
                          remarks(out.remarks));
  });
  m.def("run_field_arrays", [](const py::object& V, const py::object& F, const py::dict& d, const py::dict& connection,
                               const py::dict& eigen, const py::object& progress, int threads) {
    const FieldRunOptions options = options_of(d, connection, eigen);
    auto points = positions_of(V);
    auto faces = faces_of(F);
    return watched(progress, threads, [&] {
      return std::make_unique<Run>(Run{run_field(std::move(points), std::move(faces), options), options});
    });
  });
  m.def("run_batch",
        [](const py::list& meshes, const py::dict& d, const py::dict& connection, const py::dict& eigen, int jobs,
           const py::object& progress) { return batch(meshes, options_of(d, connection, eigen), jobs, progress); });
  m.def("run_design", [](const Surface& s, const std::string& design, const std::string& folder, const py::dict& how,
                         const py::object& progress, int threads) {
    const DesignFile file = parse_design(design, "design", folder);
    const DesignRunOptions options = design_options(how);
    return watched(progress, threads, [&] {
      return std::make_unique<Designed>(Designed{run_design(s, file, options), file});
    });
  });
  py::class_<Session>(m, "DesignSession")
      .def(py::init([](const Surface& s, const py::dict& how, py::object progress, int threads) {
        return std::make_unique<Session>(s, design_options(how), std::move(progress), threads);
      }))
      .def("solve", &Session::solve);
  m.def("read_design", [](const std::string& path) { return design_text(read_design(path)); });
  m.def("write_design",
        [](const std::string& path, const std::string& design) { write_design(path, parse_design(design)); });
}

}  // namespace alcap::python
