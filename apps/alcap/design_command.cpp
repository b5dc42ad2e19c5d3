// SPDX-License-Identifier: MIT
//
// design_command.cpp: `alcap design`, from a design file or flags to the field that has what was asked for.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "alcap/memory.h"
#include "alcap/output.h"
#include "commands.h"
#include "design_options.h"
#include "design_report.h"
#include "outputs.h"
#include "report.h"
#include "shared_options.h"

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
  std::filesystem::path output = {};
  std::vector<std::string> formats = {};  // all
  std::string solver = "auto";
  bool unit = false;
  bool explain = false;
};

using Clock = std::chrono::steady_clock;

double seconds(Clock::time_point from) { return std::chrono::duration<double>(Clock::now() - from).count(); }

/// The guidance field, scaled to root mean square length 1 over the surface, and what the report says about it.
struct Guidance {
  ComplexVectorX<double> u0 = {};  // empty: none, or zero
  Json report = {};
  bool converged = true;
};

double mean_square(const FieldRun& run, const ComplexVectorX<double>& u) {
  double sum = 0;
  for (Index t = 0; t < run.mesh.faces(); ++t)
    for (Index c = 0; c < 3; ++c) sum += run.geometry.area(t) / 3 * std::norm(u[run.mesh.F()(t, c)]);
  return sum / run.geometry.total_area();
}

ComplexVectorX<double> read_guidance(const DesignFile& design, const MeshFile& file, const FieldRun& run,
                                     const std::shared_ptr<const Frames<double>>& frames) {
  const std::string path = design.guidance.file.string();
  const FieldFile field = read_field(design.guidance.file);
  const auto refuse = [&](const std::string& why) {
    throw Failure(Exit::input, fmt::format("guidance {}: {}", path, why), {{"path", path}});
  };
  if (field.field.n != design.n)
    refuse(fmt::format("holds a field of n = {}, and the design has n = {}", field.field.n, design.n));
  if (field.V.rows() != file.V.rows() || field.F.rows() != run.mesh.faces() ||
      !((file.V - field.V).cwiseAbs().maxCoeff() <= 1e-6 * file.V.cwiseAbs().maxCoeff()))
    refuse("holds a field on another mesh; give one that was computed on this mesh");
  // Same frames: the numbers as they are. Otherwise the vectors in space are what counts, with their lengths.
  if (field.field.frames->X == frames->X && field.field.frames->N == frames->N) return field.field.u;
  Field<double> moved = from_vectors(design.n, field.field.vectors(0), frames);
  for (Eigen::Index v = 0; v < moved.u.size(); ++v)
    moved.u[v] = std::polar(std::abs(field.field.u[v]), std::arg(moved.u[v]));
  return moved.u;
}

Guidance find_guidance(const DesignFile& design, const MeshFile& file, const FieldRun& run,
                       const std::shared_ptr<const Frames<double>>& frames, const std::string& solver) {
  using Source = DesignGuidance::Source;
  const Source source = design.guidance.source;
  Guidance out;
  out.report = {{"field", source == Source::none        ? "none"
                          : source == Source::zero      ? "zero"
                          : source == Source::smoothest ? "smoothest"
                                                        : design.guidance.file.string()},
                {"weight", source == Source::none ? Json(0) : number(design.guidance.weight)},
                {"scale", nullptr}};
  if (source == Source::none || source == Source::zero) return out;
  if (source == Source::smoothest) {
    SmoothestResult smooth =
        smoothest_field(run.mesh, run.geometry, run.connection, frames, {.n = design.n, .eigen = {.solver = solver}});
    out.converged = std::all_of(smooth.components.begin(), smooth.components.end(),
                                [](const EigenReport& e) { return e.converged; });
    out.u0 = std::move(smooth.field.u);
  } else {
    out.u0 = read_guidance(design, file, run, frames);
  }
  const double square = mean_square(run, out.u0);
  if (!(square > 0) || !std::isfinite(square))
    throw Failure(Exit::input, fmt::format("guidance {}: the field is zero or not finite everywhere",
                                           design.guidance.file.string()));
  const double scale = 1 / std::sqrt(square);
  out.u0 *= scale;
  out.report["scale"] = number(scale);
  return out;
}

std::vector<std::string> chosen_formats(const DesignOptionsGiven& options, const OutputPlan& plan) {
  std::vector<std::string> known = field_formats();
  if (options.formats.empty()) return known;
  if (plan.kind != OutputPlan::Kind::folder)
    throw Failure(Exit::usage, "--formats goes with -o FOLDER; the extension of a file already says its format",
                  {{"option", "--formats"}});
  for (const std::string& f : options.formats) {
    if (std::find(known.begin(), known.end(), f) == known.end())
      throw Failure(Exit::usage, fmt::format("--formats {}: unknown; known are {}", f, fmt::join(known, ", ")),
                    {{"option", "--formats"}, {"value", f}});
  }
  return options.formats;
}

Outcome explain(const DesignOptionsGiven& options, const MeshFile& file, const DesignFile& design,
                const DesignFile& placed, const FieldRun& run) {
  Outcome outcome{.report = report_head("design", true)};
  outcome.report["input"] = input_json(options.mesh.path, file);
  outcome.report["mesh"] = mesh_json(run.mesh, run.topology, run.geometry);
  outcome.report["design"] = design_json(design);
  outcome.report["plan"] = plan_json(placed, run.mesh);
  outcome.report["warnings"] = remarks_json(run.remarks, true);
  outcome.report["notes"] = remarks_json(run.remarks, false);
  outcome.text = plan_text(outcome.report["plan"]);
  return outcome;
}

Outcome run(DesignOptionsGiven options, Progress& progress) {
  const auto start = Clock::now();
  std::vector<std::string> extensions;
  for (const std::string& f : field_formats()) extensions.push_back("." + f);
  const OutputPlan plan = options.explain ? OutputPlan{} : plan_output(options.output, extensions);
  const std::vector<std::string> formats = chosen_formats(options, plan);
  DesignFile design = make_design(options.flags);
  if (!design.guidance.file.empty()) design.guidance.file = std::filesystem::absolute(design.guidance.file);

  progress.phase(fmt::format("reading {}", options.mesh.path.string()));
  const MeshFile file = read_choice(options.mesh);
  FieldRun run;
  RunSeconds times{.read = seconds(start)};
  auto lap = Clock::now();
  run.mesh = Mesh(apply_repairs(file.V, file.F, options.mesh.repairs, run.remarks), file.V.rows());
  run.topology = find_topology(run.mesh);
  run.geometry = Geometry<double>(run.mesh, file.V);
  for (Remark& r : mesh_remarks(file.V, run.mesh, run.topology, run.geometry)) run.remarks.push_back(std::move(r));
  const DesignFile placed = place_design(design, run.mesh, file.V);
  run.times.mesh = seconds(lap);
  if (options.explain) return explain(options, file, design, placed, run);

  progress.phase("finding the connection");
  lap = Clock::now();
  const FieldRunOptions how = run_options(placed);
  run.connection = make_connection(run.mesh, run.geometry, how);
  const auto frames = std::make_shared<const Frames<double>>(vertex_frames(run.mesh, file.V, run.connection));
  const std::vector<DesignControl> controls = design_controls(placed, run.mesh, file.V, *frames);
  run.times.connection = seconds(lap);

  progress.phase("finding the guidance field");
  lap = Clock::now();
  Guidance guidance = find_guidance(placed, file, run, frames, options.solver);
  const double guidance_seconds = seconds(lap);

  progress.phase("preparing");
  lap = Clock::now();
  const bool guided = placed.guidance.source != DesignGuidance::Source::none;
  Designer designer(
      run.mesh, file.V, run.geometry, run.connection,
      {.n = placed.n, .guidance_weight = guided ? placed.guidance.weight : 0.0, .solver = options.solver});
  for (const DesignControl& c : controls) (void)designer.add(c.control);
  if (guidance.u0.size() > 0) designer.set_guidance(guidance.u0);
  const double prepare_seconds = seconds(lap);

  progress.phase("solving");
  const DesignResult result = designer.solve();
  lap = Clock::now();
  run.field = result.field;
  run.indices = face_indices(run.mesh, run.connection, run.field);
  run.index_sums = index_sums(run.mesh, run.geometry, run.connection, run.field, run.indices, run.topology);
  run.singularities = find_singularities(run.mesh, run.geometry, run.connection, run.field);
  Json asked = controls_json({placed, controls, result, run});
  run.times.analysis = seconds(lap);

  const bool met = std::all_of(asked.begin(), asked.end(), [](const Json& c) { return c["met"].get<bool>(); });
  const bool sums =
      std::all_of(run.index_sums.begin(), run.index_sums.end(), [](const IndexSum& i) { return i.sum == i.expected; });
  const bool small = result.residual <= largest_residual, finite = run.field.u.allFinite();
  const bool connected = run.connection.report.converged;
  for (Remark& r : unmet_remarks(asked)) run.remarks.push_back(std::move(r));
  const auto warn = [&](bool fine, const char* code, const char* message) {
    if (!fine) run.remarks.push_back({.code = code, .message = message});
  };
  warn(connected, "connection_not_converged", "the connection did not reach its tolerance");
  warn(guidance.converged, "eigen_not_converged", "the eigensolver of the guidance field did not reach its tolerance");
  warn(small, "residual_large", "the linear solve did not reach its tolerance; try another --solver");
  warn(sums, "index_sum_mismatch", "the indices do not sum to what topology demands; please report this mesh");
  warn(finite, "not_finite", "the field has values that are not finite numbers");
  const bool ok = met && sums && small && finite && connected && guidance.converged;

  Json report = report_head("design", ok);
  report["input"] = input_json(options.mesh.path, file);
  report["design"] = design_json(design);
  report["mesh"] = mesh_json(run.mesh, run.topology, run.geometry);
  report["connection"] = connection_json(run.mesh, run.geometry, run.connection, how);
  report["guidance"] = guidance.report;
  report["solve"] = {{"rows", result.rows}, {"residual", number(result.residual)}, {"solver", options.solver}};
  report["controls"] = std::move(asked);
  report["singularities"] = singularities_json(run);
  report["certificate"] = {{"connection_converged", connected},
                           {"guidance_converged", guidance.converged},
                           {"residual_small", small},
                           {"index_sums_match", sums},
                           {"finite", finite},
                           {"controls_met", met}};
  report["warnings"] = remarks_json(run.remarks, true);
  report["notes"] = remarks_json(run.remarks, false);
  if (options.unit) run.field = normalised(std::move(run.field));

  progress.phase("writing");
  lap = Clock::now();
  const FieldOutput output{.mesh = run.mesh,
                           .V = file.V,
                           .geometry = run.geometry,
                           .connection = run.connection,
                           .field = run.field,
                           .singularities = run.singularities};
  const auto finish = [&](const std::vector<std::string>& files) {
    report["times"] = {{"read", times.read},
                       {"mesh", run.times.mesh},
                       {"connection", run.times.connection},
                       {"guidance", guidance_seconds},
                       {"prepare", prepare_seconds},
                       {"solve", result.seconds},
                       {"analysis", run.times.analysis},
                       {"write", seconds(lap)},
                       {"total", seconds(start)}};
    report["peak_memory_bytes"] = peak_memory_bytes();
    report["files"] = files;
  };
  std::vector<std::string> files;
  if (plan.kind == OutputPlan::Kind::file) {
    write_guarded([&] {
      for (const auto& path : write_field(output, plan.target)) files.push_back(path.string());
    });
    finish(files);
  } else if (plan.kind == OutputPlan::Kind::folder) {
    write_folder(plan.target, [&](const std::filesystem::path& folder) {
      std::vector<std::filesystem::path> paths;
      for (const std::string& f : formats) paths.push_back(folder / ("field." + f));
      for (const auto& path : write_field(output, paths)) files.push_back((plan.target / path.filename()).string());
      write_design(folder / "design.json", design);
      for (const char* last : {"design.json", "report.json"}) files.push_back((plan.target / last).string());
      finish(files);
      write_text(folder / "report.json", report.dump(2) + "\n");
    });
  } else {
    finish({});
  }

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
  app.add_option("-o,--output", options->output,
                 "Folder to create (or fill), or one file whose extension picks the format. Without it nothing is "
                 "written")
      ->type_name("OUT");
  app.add_option("--formats", options->formats, "Of the files in the folder, only these: ply,vtp,rawfield,rosy,...")
      ->type_name("LIST")
      ->delimiter(',')
      ->allow_extra_args(false);
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
