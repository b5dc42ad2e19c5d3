// SPDX-License-Identifier: MIT
//
// design_command.cpp: `alcap design`, from a design file or flags to the field that has what was asked for.
#include <fmt/format.h>
#include <algorithm>

#include <memory>

#include "alcap/design_run.h"
#include "alcap/memory.h"
#include "apps/alcap/commands/commands.h"
#include "apps/alcap/commands/show_options.h"
#include "apps/alcap/options/cli.h"
#include "apps/alcap/options/design_options.h"
#include "apps/alcap/options/shared_options.h"
#include "apps/alcap/options/tolerance_options.h"
#include "apps/alcap/report/design_report.h"
#include "apps/alcap/report/field_files.h"
#include "apps/alcap/report/flags.h"
#include "apps/alcap/report/report.h"
#include "src/base/clock.h"

namespace alcap::app {
namespace design_parts {
namespace {

constexpr const char* footer =
    "Examples:\n"
    "  alcap make icosphere:4 -o ball.ply\n"
    "  alcap design ball.ply --source 12 --saddle 900:30 -o v.vtp     vector field, saddle turned by 30 degrees\n"
    "  alcap design ball.ply --design saddle.json -n 4 -o out         the same design as a cross field\n"
    "  alcap design ball.ply --cone 0:1 --cone 41:1 --guidance smoothest -o out\n"
    "  alcap design ball.ply --fix 12:0,0,1 --guidance out/field.ply:0.5 -o edited\n"
    "  alcap design ball.ply --design saddle.json --png saddle.png    a picture\n"
    "  alcap design ball.ply --design saddle.json --explain           what would be solved\n"
    "\n"
    "Faces and vertices count from 0, angles are in degrees. docs/design.md describes the design file. Exit code 8\n"
    "means that the field was written and certified, but some control is not met; 5, that the certificate does\n"
    "not hold.";

struct DesignOptionsGiven {
  MeshChoice mesh = {};
  DesignFlags flags = {};
  FilesChoice files = {};
  ShowOptions show = {};
  std::string solver = "auto";
  DesignRunOptions run = {};  // its triangulation and tolerances
  bool unit = false;
  bool explain = false;
};

/// What was read: the design as asked for, and the mesh, after repairs.
struct Inputs {
  DesignFile design;
  DesignFile solved;  // the same, with the edges of a file of features
  MeshFile file;      // its points and faces are in the surface
  Surface surface;
  std::vector<Remark> remarks;
  double read_seconds = 0, mesh_seconds = 0;
};

Inputs read_inputs(const DesignOptionsGiven& options, Progress& progress) {
  detail::Stopwatch watch;
  Inputs in;
  in.design = make_design(options.flags);
  if (!in.design.guidance.file.empty()) in.design.guidance.file = std::filesystem::absolute(in.design.guidance.file);
  if (!in.design.features.file.empty()) in.design.features.file = std::filesystem::absolute(in.design.features.file);
  progress.phase(fmt::format("reading {}", options.mesh.path.string()));
  in.file = read_choice(options.mesh);
  in.read_seconds = watch.lap();
  in.solved = in.design;
  if (!in.design.features.file.empty()) {
    // By the faces of the mesh as it was read: repairs may number them anew.
    in.solved.features.edges = read_feature_edges(in.file.F, in.file.V.rows(), in.design.features.file);
    in.solved.features.file.clear();
  }
  in.surface = make_surface(options.mesh, in.file, in.remarks);
  for (Remark& r : mesh_remarks(in.surface)) in.remarks.push_back(std::move(r));
  in.mesh_seconds = watch.lap();
  return in;
}

Outcome explain(const DesignOptionsGiven& options, const Inputs& in) {
  Outcome outcome{.report = report_head("design", true)};
  outcome.report["input"] = input_json(options.mesh.path, in.file);
  outcome.report["mesh"] = mesh_json(in.surface);
  outcome.report["design"] = design_json(in.design);
  outcome.report["plan"] = plan_json(plan_design(in.solved, in.surface), in.surface.mesh());
  outcome.report["warnings"] = remarks_json(in.remarks, true);
  outcome.report["notes"] = remarks_json(in.remarks, false);
  outcome.text = plan_text(outcome.report["plan"]);
  return outcome;
}

std::string phase_text(std::string_view phase) {
  if (phase == "connection") return "finding the connection";
  if (phase == "guidance") return "finding the guidance field";
  if (phase == "prepare") return "preparing";
  if (phase == "solve") return "solving";
  return "locating singularities";
}

DesignRun solve(const DesignOptionsGiven& options, const Inputs& in, Progress& progress) {
  try {
    DesignRunOptions how = options.run;
    how.solver = options.solver;
    how.normalise = options.unit;
    how.progress = [&](std::string_view phase) { progress.phase(phase_text(phase)); };
    return run_design(in.surface, in.solved, how);
  } catch (const OptionError& e) {
    // It is the mesh that has no such field.
    if (e.field() == "/guidance/field") throw Failure(Exit::input, e.what());
    throw;
  }
}

Json times_json(const Inputs& in, const DesignTimes& times, double write, double total) {
  return {{"read", in.read_seconds},    {"mesh", in.mesh_seconds},  {"connection", times.connection},
          {"guidance", times.guidance}, {"prepare", times.prepare}, {"solve", times.solve},
          {"analysis", times.analysis}, {"write", write},           {"total", total}};
}

Outcome run(const DesignOptionsGiven& options, const Common& common, Progress& progress) {
  const detail::Stopwatch total;
  const OutputPlan plan = plan_files(options.files);
  check_names(plan, options.files,
              {{"--report", common.report},
               {"--html", options.show.html},
               {"--png", options.show.picture.file},
               {"--curves", options.show.picture.curves}},
              {{"mesh", options.mesh.path}, {"design", options.flags.file}});
  check_show(options.show);
  const Inputs in = read_inputs(options, progress);
  if (options.explain) return explain(options, in);
  const DesignRun result = solve(options, in, progress);
  std::vector<Remark> remarks = in.remarks;
  remarks.insert(remarks.end(), result.remarks.begin(), result.remarks.end());
  for (const auto& path : {plan.target, common.report})
    for (Remark& left : leftover_remarks(path))
      if (std::none_of(remarks.begin(), remarks.end(), [&](const Remark& r) { return r.message == left.message; }))
        remarks.push_back(std::move(left));
  Json report = design_report(input_json(options.mesh.path, in.file), in.design, result, remarks);

  const FieldOutput output = output_of(result, options.unit);
  progress.phase("drawing curves");
  const ShownCurves shown = trace_show(output, options.show, report);

  progress.phase("writing");
  const detail::Stopwatch writing;
  const auto write_asked = [&](const std::filesystem::path& folder) {
    write_design(folder / "design.json", in.design);
    return std::vector<std::string>{"design.json"};
  };
  const FeatureGraph* const features = result.features ? &result.features->graph : nullptr;
  write_files(plan, options.files, output, features, write_asked,
              [&](const std::vector<std::string>& files) -> const Json& {
                report["times"] = times_json(in, result.times, writing.seconds(), total.seconds());
                report["peak_memory_bytes"] = peak_memory_bytes();
                report["files"] = files;
                return report;
              });

  write_show(output, options.mesh.path.stem().string(), options.show, shown, report);

  Outcome outcome{.report = std::move(report)};
  outcome.text = design_summary(outcome.report);
  if (!result.certificate.holds()) {
    outcome.exit = Exit::uncertified;
    outcome.complaint = complaint("the certificate does not hold:", remarks);
  } else if (!result.met()) {
    outcome.exit = Exit::unmet;
    outcome.complaint = complaint("the design is not met everywhere:", remarks);
  }
  return outcome;
}

std::function<Outcome(const Common&, Progress&)> attach(cli::App& app) {
  auto options = std::make_shared<DesignOptionsGiven>();
  app.footer(footer);
  add_mesh_options(app, options->mesh);
  add_lengths_option(app, options->mesh);
  add_design_options(app, options->flags);
  add_tolerance_options(app, options->run.tolerances);
  add_files_options(app, options->files);
  add_show_options(app, options->show);
  app.add_flag("--unit,--normalise,--direction", options->unit,
               "Write unit directions instead of n-vectors of varying length");
  app.add_flag("--explain", options->explain, "Print what would be solved, and solve nothing");
  std::vector<std::string> names{"auto"};
  for (const std::string& n : linear_solvers()) names.push_back(n);
  app.add_option("--solver", options->solver, "Linear solver; auto picks by size")
      ->type_name("NAME")
      ->capture_default_str()
      ->check(cli::IsMember(names))
      ->group("Solver");
  add_triangulation_options(app, options->run.triangulation, options->run.min_angle);
  return [options](const Common& common, Progress& progress) { return run(*options, common, progress); };
}

}  // namespace
}  // namespace design_parts

const Command design_command{"design", "A field with the singularities, directions and cones you ask for", true,
                             &design_parts::attach};

}  // namespace alcap::app
