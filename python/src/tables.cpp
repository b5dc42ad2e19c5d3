// SPDX-License-Identifier: MIT
//
// tables.cpp: the accuracy tables of the paper, and plans of runs.
#include <sstream>

#include "alcap/plan.h"
#include "apps/alcap/commands/command.h"
#include "apps/alcap/tables/tables.h"
#include "python/src/arrays.h"
#include "python/src/bindings.h"
#include "python/src/long_call.h"

namespace alcap::python {
namespace {

std::string tables(const py::dict& d, const py::object& V, const py::object& F, const py::object& progress) {
  app::TablesOptions options{.levels = as<std::vector<int>>(d["levels"], "levels"),
                             .fields = as<int>(d["fields"], "fields"),
                             .jitter = as<double>(d["jitter"], "jitter"),
                             .seed = as<std::uint64_t>(d["seed"], "seed"),
                             .more = as<bool>(d["more"], "more")};
  if (py::len(V) > 0) {
    options.mesh = {positions_of(V), faces_of(F)};
    options.mesh_name = "mesh";
  }
  return watched(progress, 0, [&] {
    const app::TablesResult result = app::compute_tables(options);
    app::Json json = app::tables_json(result);
    std::ostringstream text;
    app::print_tables(text, result);
    json["text"] = text.str();
    return app::text_of(json);
  });
}

py::dict plan(const py::dict& d) {
  const PlanOptions options{.faces = as<std::int64_t>(d["faces"], "faces"),
                            .vertices = as<std::int64_t>(d["vertices"], "vertices"),
                            .n = as<int>(d["n"], "n"),
                            .threads = as<int>(d["threads"], "threads"),
                            .formats = as<std::vector<std::string>>(d["formats"], "formats"),
                            .speed = as<double>(d["speed"], "speed"),
                            .memory = as<std::int64_t>(d["memory"], "memory")};
  const RunPlan r = plan_field(options);
  py::list phases;
  for (const PhasePlan& phase : r.phases) {
    phases.append(
        py::dict("name"_a = phase.name, "seconds"_a = phase.seconds, "bytes"_a = phase.bytes, "disk"_a = phase.disk));
  }
  return py::dict("fits"_a = r.fits(), "halfedges"_a = r.halfedges, "edges"_a = r.edges,
                  "matrix_entries"_a = r.matrix_entries, "factor_fits"_a = r.factor_fits, "refusals"_a = r.refusals,
                  "phases"_a = phases, "seconds"_a = r.seconds, "bytes"_a = r.bytes, "most_bytes"_a = r.most_bytes,
                  "factor_bytes"_a = r.factor_bytes, "disk"_a = r.disk, "memory"_a = r.memory, "largest"_a = r.largest);
}

}  // namespace

void bind_tables(py::module_& m) {
  m.def("tables", &tables);
  m.def("plan_field", &plan);
  m.def("relative_speed", [] { return watched(py::none(), 0, [] { return relative_speed(); }); });
}

}  // namespace alcap::python
