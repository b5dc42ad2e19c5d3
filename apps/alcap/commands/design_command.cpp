// SPDX-License-Identifier: MIT
//
// design_command.cpp: `alcap design`, from a design file or flags to the field that has what was asked for.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "alcap/cones.h"
#include "alcap/memory.h"
#include "apps/alcap/commands/commands.h"
#include "apps/alcap/commands/design_solve.h"
#include "apps/alcap/options/design_options.h"
#include "apps/alcap/options/shared_options.h"
#include "apps/alcap/report/design_report.h"
#include "apps/alcap/report/field_files.h"
#include "apps/alcap/report/report.h"

namespace alcap::app {
namespace {

constexpr const char* footer =
    "Examples:\n"
    "  alcap make icosphere:4 -o ball.ply\n"
    "  alcap design ball.ply --source 12 --saddle 900:30 -o v.vtp     vector field, saddle turned by 30 degrees\n"
    "  alcap design ball.ply --design saddle.json -n 4 -o out         the same design as a cross field\n"
    "  alcap design ball.ply --cone 0:1 --cone 41:1 --guidance smoothest -o out\n"
    "  alcap design ball.ply --fix 12:0,0,1 --guidance out/field.ply:0.5 -o edited\n"
    "  alcap design ball.ply --design saddle.json --explain           what would be solved\n"
    "\n"
    "Faces and vertices count from 0, angles are in degrees. docs/design.md describes the design file. Exit code 5\n"
    "means that the files were written, but some control was not met or the certificate does not hold.";

// Relative residual of the linear solve that the certificate accepts: that of eigenvectors in `alcap field`.
constexpr double largest_residual = 1e-8;

struct DesignOptionsGiven {
  MeshChoice mesh = {};
  DesignFlags flags = {};
  FilesChoice files = {};
  std::string solver = "auto";
  bool unit = false;
  bool explain = false;
};

using Clock = std::chrono::steady_clock;

double seconds(Clock::time_point from) { return std::chrono::duration<double>(Clock::now() - from).count(); }

Outcome explain(const DesignOptionsGiven& options, const MeshFile& file, const DesignFile& design,
                const DesignFile& placed, const Surface& surface, const std::vector<Remark>& remarks) {
  Outcome outcome{.report = report_head("design", true)};
  outcome.report["input"] = input_json(options.mesh.path, file);
  outcome.report["mesh"] = mesh_json(surface);
  outcome.report["design"] = design_json(design);
  outcome.report["plan"] = plan_json(placed, surface.mesh());
  outcome.report["warnings"] = remarks_json(remarks, true);
  outcome.report["notes"] = remarks_json(remarks, false);
  outcome.text = plan_text(outcome.report["plan"]);
  return outcome;
}

Outcome run(const DesignOptionsGiven& options, Progress& progress) {
  const auto start = Clock::now();
  const OutputPlan plan = plan_files(options.files);
  DesignFile design = make_design(options.flags);
  if (!design.guidance.file.empty()) design.guidance.file = std::filesystem::absolute(design.guidance.file);

  progress.phase(fmt::format("reading {}", options.mesh.path.string()));
  MeshFile file = read_choice(options.mesh);
  FieldRun run;
  RunSeconds times{.read = seconds(start)};
  auto lap = Clock::now();
  Faces F = apply_repairs(file.V, file.F, options.mesh.repairs, run.remarks);
  const Surface surface(std::move(file.V), std::move(F));
  for (Remark& r : mesh_remarks(surface)) run.remarks.push_back(std::move(r));
  DesignFile placed = place_design(design, surface);
  if (placed.connection.balance)
    placed.connection.cones = balance_cones(surface, placed.connection.cones, {.n = placed.n});
  placed.connection.balance = false;
  run.times.mesh = seconds(lap);
  if (options.explain) return explain(options, file, design, placed, surface, run.remarks);

  progress.phase("finding the connection");
  lap = Clock::now();
  const ConnectionOptions how = connection_options(placed);
  run.surface = connect(surface, how);
  const std::vector<DesignControl> controls = design_controls(placed, run.surface);
  run.times.connection = seconds(lap);

  SolvedDesign solved = solve_design({placed, controls, run, options.solver}, progress);
  const DesignResult& result = solved.result;
  lap = Clock::now();
  run.field = result.field;
  run.indices = face_indices(run.surface, run.field);
  run.index_sums = index_sums(run.surface, run.field, run.indices);
  run.singularities = find_singularities(run.surface, run.field, run.indices);
  Json asked = controls_json({placed, controls, result, run});
  run.times.analysis = seconds(lap);

  const bool met = std::all_of(asked.begin(), asked.end(), [](const Json& c) { return c["met"].get<bool>(); });
  const bool sums =
      std::all_of(run.index_sums.begin(), run.index_sums.end(), [](const IndexSum& i) { return i.sum == i.expected; });
  const bool small = result.residual <= largest_residual, finite = run.field.u.allFinite();
  const bool connected = run.connection().report.converged;
  for (Remark& r : unmet_remarks(asked)) run.remarks.push_back(std::move(r));
  const auto warn = [&](bool fine, const char* code, const char* message) {
    if (!fine) run.remarks.push_back({.code = code, .message = message});
  };
  warn(connected, "connection_not_converged", "the connection did not reach its tolerance");
  warn(solved.converged, "eigen_not_converged", "an eigensolver did not reach its tolerance");
  warn(small, "residual_large", "the linear solve did not reach its tolerance; try another --solver");
  warn(sums, "index_sum_mismatch", "the indices do not sum to what topology demands; please report this mesh");
  warn(finite, "not_finite", "the field has values that are not finite numbers");
  const bool ok = met && sums && small && finite && connected && solved.converged;

  Json report = report_head("design", ok);
  report["input"] = input_json(options.mesh.path, file);
  report["design"] = design_json(design);
  report["mesh"] = mesh_json(run.surface);
  report["connection"] = connection_json(run.surface, how);
  report["guidance"] = std::move(solved.guidance);
  report["solve"] = std::move(solved.solve);
  report["controls"] = std::move(asked);
  report["singularities"] = singularities_json(run);
  report["certificate"] = {{"connection_converged", connected},
                           {"eigen_converged", solved.converged},
                           {"residual_small", small},
                           {"index_sums_match", sums},
                           {"finite", finite},
                           {"controls_met", met}};
  report["warnings"] = remarks_json(run.remarks, true);
  report["notes"] = remarks_json(run.remarks, false);
  if (options.unit) run.field = normalised(std::move(run.field));

  progress.phase("writing");
  lap = Clock::now();
  const auto write_asked = [&](const std::filesystem::path& folder) {
    write_design(folder / "design.json", design);
    return std::vector<std::string>{"design.json"};
  };
  write_files(plan, options.files, output_of(run), write_asked,
              [&](const std::vector<std::string>& files) -> const Json& {
                report["times"] = {{"read", times.read},
                                   {"mesh", run.times.mesh},
                                   {"connection", run.times.connection},
                                   {"guidance", solved.guidance_seconds},
                                   {"prepare", solved.prepare_seconds},
                                   {"solve", solved.solve_seconds},
                                   {"analysis", run.times.analysis},
                                   {"write", seconds(lap)},
                                   {"total", seconds(start)}};
                report["peak_memory_bytes"] = peak_memory_bytes();
                report["files"] = files;
                return report;
              });

  Outcome outcome{.report = std::move(report)};
  outcome.text = design_summary(outcome.report);
  if (!ok) {
    outcome.exit = Exit::uncertified;
    outcome.complaint = "not everything asked for holds:";
    for (const Remark& r : run.remarks) {
      if (r.warning) outcome.complaint += " " + r.message + ".";
    }
  }
  return outcome;
}

std::function<Outcome(const Common&, Progress&)> attach(CLI::App& app) {
  auto options = std::make_shared<DesignOptionsGiven>();
  app.footer(footer);
  add_mesh_options(app, options->mesh);
  add_design_options(app, options->flags);
  add_files_options(app, options->files);
  app.add_flag("--unit,--normalise,--direction", options->unit,
               "Write unit directions instead of n-vectors of varying length");
  app.add_flag("--explain", options->explain, "Print what would be solved, and solve nothing");
  std::vector<std::string> names{"auto"};
  for (const std::string& n : linear_solvers()) names.push_back(n);
  app.add_option("--solver", options->solver, "Linear solver; auto picks by size")
      ->type_name("NAME")
      ->capture_default_str()
      ->check(CLI::IsMember(names))
      ->group("Solver");
  return [options](const Common&, Progress& progress) { return run(*options, progress); };
}

}  // namespace

const Command design_command{"design", "A field with the singularities, directions and cones you ask for", true,
                             &attach};

}  // namespace alcap::app
