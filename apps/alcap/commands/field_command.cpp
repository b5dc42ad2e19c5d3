// SPDX-License-Identifier: MIT
//
// field_command.cpp: `alcap field`, from a mesh to the smoothest n-field, its files and its certificate.
#include <fmt/core.h>
#include <algorithm>

#include <cstdio>

#include <map>
#include <memory>
#include <span>

#include "alcap/memory.h"
#include "apps/alcap/commands/batch_field.h"
#include "apps/alcap/commands/commands.h"
#include "apps/alcap/commands/show_options.h"
#include "apps/alcap/commands/sizing_options.h"
#include "apps/alcap/options/cli.h"
#include "apps/alcap/options/shared_options.h"
#include "apps/alcap/report/field_files.h"
#include "apps/alcap/report/flags.h"
#include "apps/alcap/report/report.h"
#include "src/base/clock.h"
#include "src/base/index_text.h"

namespace alcap::app {
namespace field_parts {
namespace {

constexpr const char* footer =
    "Examples:\n"
    "  alcap field bunny.ply -n 4 -o out            cross field; out/ gets field.ply, field.vtp, report.json\n"
    "  alcap field bunny.ply -n 2 -o lines.vtp      line field for ParaView\n"
    "  alcap field bunny.ply -o out --formats ply,rosy\n"
    "  alcap field scan.stl --repair weld -o out    a triangle soup, welded first\n"
    "  alcap field cow.off --detail 0.1 -o out      fewer singularities: small bumps are ignored\n"
    "  alcap field ball.off --cone 0:1 --cone 41:1   singularities where you say\n"
    "  alcap field part.stl --align-features -o out  crosses along creases and boundary; out/ gets field.sharp\n"
    "  alcap field part.stl --for quadwild -o out    what QuadWild makes quads of\n"
    "  alcap field part.stl --sizing part.sol       how long edges should be, for mmg\n"
    "  alcap field bunny.ply --png bunny.png        a picture: curves and singularities\n"
    "  alcap field bunny.ply --html bunny.html      a page to look at it with\n"
    "  alcap field bunny.ply --json                 no files, just the certificate\n"
    "  alcap field --batch list.txt -j 2 -o out     every mesh named in list.txt\n"
    "\n"
    "The files hold n-vectors: long where the field is sure, short near singularities. --unit makes them\n"
    "directions of length 1. Exit code 5 means that the files were written but the report's certificate does\n"
    "not hold; its warnings say why.";

struct FieldOptions {
  MeshChoice mesh = {};
  FieldRunOptions run = {};
  FilesChoice files = {};
  ShowOptions show = {};
  SizingChoice sizing = {};
  BatchChoice batch = {};
  FeatureFlags features = {};
};

/// Time and memory of the dense method, said before they are spent.
void warn_of_dense(std::int64_t rows, Progress& progress) {
  constexpr std::int64_t usual = 2000;
  if (rows <= usual) return;
  progress.clear();
  const double size = static_cast<double>(rows);
  // Two matrices of complex numbers and as much to work in.
  (void)std::fputs(
      fmt::format("alcap field: --method dense is for small meshes: with {} vertices it takes some {:.2g} GB "
                  "and time that grows with the third power; Ctrl-C ends it\n",
                  grouped(rows), 4 * 16 * size * size / 1e9)
          .c_str(),
      stderr);
}

std::string phase_text(std::string_view phase, std::int64_t faces) {
  const std::map<std::string_view, std::string> words{{"mesh", "building the mesh"},
                                                      {"connection", "finding the connection"},
                                                      {"solve", "solving for the smoothest field"},
                                                      {"analysis", "locating singularities"}};
  const auto found = words.find(phase);
  return fmt::format("{} ({} faces)", found == words.end() ? std::string(phase) : found->second, grouped(faces));
}

/// Clusters in braces.
std::string modes_text(const Json& modes) {
  std::string text;
  const Json& list = modes["list"];
  for (std::size_t k = 0; k < list.size(); ++k) {
    const bool with_last = k > 0 && list[k - 1]["cluster"] == list[k]["cluster"];
    const bool with_next = k + 1 < list.size() && list[k + 1]["cluster"] == list[k]["cluster"];
    text += fmt::format("{}{}{}{}", k == 0 ? "" : ", ", with_next && !with_last ? "{" : "",
                        short_text(list[k]["lambda"]), with_last && !with_next ? "}" : "");
  }
  return text + fmt::format("; complete: {}", modes["smallest"].get<std::string>());
}

std::string summary(const FieldOptions& options, const Json& report) {
  const Json &mesh = report["mesh"], &connection = report["connection"], &eigen = report["eigen"];
  const Json &singular = report["singularities"], &times = report["times"];
  const auto count = [](const Json& value) { return grouped(value.get<std::int64_t>()); };
  const int n = options.run.n;
  std::string text;
  const auto line = [&](const char* label, const std::string& value) { text += summary_line(label, value); };
  line("mesh", fmt::format("{} vertices, {} faces, {} component(s), {} boundary loop(s), Euler characteristic {}",
                           count(mesh["vertices"]), count(mesh["faces"]), count(mesh["components"]),
                           count(mesh["boundary_loops"]), count(mesh["euler"])));
  line("connection",
       fmt::format("{}: D_T {}, D_E {}, {} iterations", connection["kind"].get<std::string>(),
                   short_text(connection["D_T"]), short_text(connection["D_E"]), count(connection["iterations"])));
  if (report.contains("triangulation")) text += triangulation_summary(report["triangulation"]);
  if (report.contains("alignment")) {
    const Json& alignment = report["alignment"];
    line("field",
         fmt::format("n = {}, {} features: {} steps, {}", n, alignment["across"].get<bool>() ? "across" : "along",
                     count(alignment["steps"]), alignment["settled"].get<bool>() ? "settled" : "not settled"));
    text += alignment_summary(alignment);
  }
  if (!eigen.is_null()) {
    const std::string next = eigen["next"].is_null() ? "" : fmt::format(" (next {})", short_text(eigen["next"]));
    line("field", fmt::format("n = {}, eigenvalue {}{}, residual {}, {}", n, short_text(eigen["lambda"]), next,
                              short_text(eigen["residual"]), eigen["solver"].get<std::string>()));
    if (!eigen["angle_degrees"].is_null())
      line("directions", fmt::format("off by {} degrees at most, as root mean square ({})",
                                     short_text(eigen["angle_degrees"]), eigen["angle_check"].get<std::string>()));
    line("smallest", smallest_text(report["certificate"], eigen, report["components"].size() == 1));
    if (report.contains("modes")) line("modes", modes_text(report["modes"]));
  }
  line("singularities", fmt::format("{}: {} positive, {} negative; indices sum to {}, expected {}",
                                    count(singular["count"]), count(singular["positive"]), count(singular["negative"]),
                                    detail::turns_text(singular["index_sum"].get<std::int64_t>(), n),
                                    detail::turns_text(singular["expected"].get<std::int64_t>(), n)));
  std::string phases;
  for (const auto& [phase, seconds] : times.items()) {
    if (phase != "total")
      phases += fmt::format("{}{} {:.2f}", phases.empty() ? "" : ", ", phase, seconds.get<double>());
  }
  line("time", fmt::format("{:.2f} s ({})", times["total"].get<double>(), phases));
  line("memory", fmt::format("{:.0f} MB at most", report["peak_memory_bytes"].get<double>() / 1e6));
  return text + summary_end(report);
}

/// The field of the mesh that was read, or of the intrinsic surface that edge lengths make of it.
FieldRun run_on(FieldOptions& options, MeshFile& file) {
  options.run.repairs = options.mesh.repair.repairs;
  options.run.weld_tolerance = options.mesh.repair.weld_tolerance;
  if (options.mesh.lengths.empty()) return run_field(std::move(file.V), std::move(file.F), options.run);
  std::vector<Remark> remarks;
  const Surface surface = make_surface(options.mesh, file, remarks);
  FieldRunOptions without_repairs = options.run;
  without_repairs.repairs.clear();
  FieldRun run = run_field(surface, without_repairs);
  run.remarks.insert(run.remarks.begin(), remarks.begin(), remarks.end());
  return run;
}

/// mode-1.EXT ... for every format asked for, numbered as in the report; the names of the files.
std::vector<std::string> write_modes(const FieldOptions& options, const FieldRun& run,
                                     const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (Eigen::Index k = 0; k < run.modes.U.cols(); ++k) {
    Field field{.n = run.field.n, .u = run.modes.U.col(k), .frames = run.field.frames};
    const std::vector<Singularity> singularities =
        find_singularities(run.surface, field, face_indices(run.surface, field));
    if (options.run.normalise) field = normalised(std::move(field));
    std::vector<std::filesystem::path> paths;
    for (const std::string& format : chosen_formats(options.files))
      paths.push_back(folder / fmt::format("mode-{}.{}", k + 1, format));
    for (const auto& path : write_field({run.surface, field, singularities}, paths))
      names.push_back(path.filename().string());
  }
  return names;
}

/// Quads follow creases: without a word about alignment, crosses for QuadWild are aligned.
void imply_alignment(FieldOptions& options) {
  if (options.files.reader != Reader::quadwild) return;
  if (options.run.n != 4)
    throw Failure(Exit::usage, "--for quadwild takes crosses: leave out -n, or say -n 4", {{"option", "--for"}});
  if (!options.run.align) options.run.align.emplace();
}

/// Exit code and complaint.
void judge(const FieldRun& result, Outcome& outcome) {
  if (!result.certificate.holds()) {
    outcome.exit = Exit::uncertified;
    outcome.complaint = complaint("the certificate does not hold:", result.remarks);
  } else if (result.features && !result.features->followed) {
    outcome.exit = Exit::unmet;
    outcome.complaint = complaint("the field does not follow every feature:", result.remarks);
  }
}

Outcome run(FieldOptions options, const Common& common, Progress& progress) {
  const detail::Stopwatch total;
  const OutputPlan plan = plan_files(options.files);
  imply_alignment(options);
  check_names(plan, options.files,
              {{"--report", common.report},
               {"--html", options.show.html},
               {"--png", options.show.picture.file},
               {"--curves", options.show.picture.curves},
               {"--sizing", options.sizing.file}},
              {{"mesh", options.mesh.path}});
  check_show(options.show);
  check_sizing(options.sizing);

  RunSeconds times;
  progress.phase(fmt::format("reading {}", options.mesh.path.string()));
  MeshFile file = read_choice(options.mesh);
  const std::int64_t faces = file.F.rows();
  times.read = total.seconds();

  if (options.run.eigen.method == "dense" && !common.quiet) warn_of_dense(file.V.rows(), progress);
  options.run.progress = [&](std::string_view phase) { progress.phase(phase_text(phase, faces)); };
  if (!options.features.file.empty())
    options.run.align->edges = read_feature_edges(file.F, file.V.rows(), options.features.file);
  const FieldRun result = run_on(options, file);

  const FieldOutput output = output_of(result, options.run.normalise);
  Json report = field_report(options.mesh.path, file, result, options.run);
  progress.phase("drawing curves");
  const ShownCurves shown = trace_show(output, options.show, report);
  const FeatureGraph* const features = result.features ? &result.features->graph : nullptr;
  const VectorX<double> sizing = find_sizing(result.surface, features, options.sizing, report);
  Json& warnings = report["warnings"];
  for (const auto& path : {plan.target, common.report})
    for (Json& left : remarks_json(leftover_remarks(path), true))
      if (std::find(warnings.begin(), warnings.end(), left) == warnings.end()) warnings.push_back(std::move(left));

  progress.phase("writing");
  const detail::Stopwatch writing;
  const auto others = [&](const std::filesystem::path& folder) {
    return options.files.reader ? std::vector<std::string>{} : write_modes(options, result, folder);
  };
  write_files(plan, options.files, output, features, others, [&](const std::vector<std::string>& files) -> const Json& {
    times.write = writing.seconds();
    times.total = total.seconds();
    report["times"] = times_json(result.times, times);
    report["peak_memory_bytes"] = peak_memory_bytes();
    report["files"] = files;
    return report;
  });
  write_show(output, options.mesh.path.stem().string(), options.show, shown, report);
  write_sizing(sizing, options.sizing, report);

  Outcome outcome{.report = std::move(report)};
  outcome.text = summary(options, outcome.report);
  if (options.files.reader)
    outcome.text += summary_line("next", command_for(*options.files.reader, plan.target / "field"));
  judge(result, outcome);
  return outcome;
}

/// Options of one mesh cannot be combined with a batch.
void refuse_with_batch(const FieldOptions& options) {
  const auto refuse = [](bool given, const char* option) {
    if (given)
      throw Failure(Exit::usage, fmt::format("{} is for one mesh, and --batch has many", option), {{"option", option}});
  };
  refuse(!options.mesh.lengths.empty(), "--lengths");
  refuse(options.files.reader.has_value(), "--for");
  refuse(!options.sizing.file.empty(), "--sizing");
  refuse(!options.features.file.empty(), "--features");
  refuse(options.run.modes > 1, "--modes");
  refuse(!options.show.html.empty(), "--html");
  refuse(!options.show.picture.file.empty(), "--png");
  refuse(!options.show.picture.curves.empty(), "--curves");
}

Outcome run_batch_of(FieldOptions options, const Common& common) {
  if (!options.mesh.path.empty()) {
    throw Failure(Exit::usage, "MESH and --batch exclude each other; put the mesh into the list",
                  {{"option", "--batch"}});
  }
  refuse_with_batch(options);
  options.batch.folder = options.files.output;
  options.batch.formats =
      options.files.formats.empty() ? std::vector<std::string>{"ply"} : chosen_formats(options.files);
  options.run.repairs = options.mesh.repair.repairs;
  options.run.weld_tolerance = options.mesh.repair.weld_tolerance;
  return run_field_batch(options.batch, options.mesh, options.run, common);
}

void add_alignment_options(cli::App& app, FieldOptions& options) {
  const auto align = [&options]() -> FieldAlignment& {
    return options.run.align ? *options.run.align : options.run.align.emplace();
  };
  app.add_option_function<std::string>(
         "--align-features", [align](const std::string& text) { align().features.angle = feature_angle(text); },
         "A field of even n along the edges that fold by ANGLE degrees (default 40) and along the boundary, with "
         "singularities where the directions turn least; after MESH, or with =ANGLE")
      ->type_name("ANGLE")
      ->expected(0, 1)
      ->group("Alignment");
  app.add_flag_function(
         "--align-boundary",
         [align, &app](std::int64_t) {
           if (app.get_option("--align-features")->count() == 0) align().features.creases = false;
         },
         "The same along the boundary alone")
      ->group("Alignment");
  add_feature_options(app, options.features,
                      "Draw the field along, with this weight, instead of holding it; 1 is that of a stroke");
}

/// What the flags say of features goes into the run's alignment.
void take_features(FieldOptions& options) {
  const FeatureFlags& flags = options.features;
  if (!flags.any()) return;
  FieldAlignment& align = options.run.align ? *options.run.align : options.run.align.emplace();
  constexpr double degree = pi<double> / 180;
  align.across = flags.across;
  if (flags.weight) align.weight = *flags.weight;
  if (flags.corner_angle) align.features.corner_angle = *flags.corner_angle * degree;
  if (flags.low_angle) align.features.low_angle = *flags.low_angle * degree;
  if (flags.gap) align.features.gap = *flags.gap;
  if (flags.spur) align.features.spur = *flags.spur;
}

std::function<Outcome(const Common&, Progress&)> attach(cli::App& app) {
  auto options = std::make_shared<FieldOptions>();
  app.footer(footer);
  add_mesh_options(app, options->mesh);
  add_lengths_option(app, options->mesh);
  app.get_option("mesh")->required(false);  // or --batch
  add_batch_options(app, options->batch);
  app.add_option("-n,-r,--degree,--rosy", options->run.n,
                 "Symmetry: 1 vectors, 2 lines, 4 crosses, 6 hexagonal; any n >= 1")
      ->type_name("N")
      ->capture_default_str()
      ->check(cli::Range(1, 1000));
  add_files_options(app, options->files);
  app.add_flag("--unit,--normalise,--direction", options->run.normalise,
               "Write unit directions instead of n-vectors of varying length");
  app.add_option("-s,--energy,--s", options->run.s,
                 "Which smoothness, in [-1, 1]: 0 Dirichlet, 1 favours holomorphic, -1 antiholomorphic fields")
      ->type_name("S")
      ->capture_default_str()
      ->check(cli::Range(-1.0, 1.0));
  add_connection_options(app, options->run.connection);
  add_eigen_options(app, options->run.eigen);
  add_alignment_options(app, *options);
  add_triangulation_options(app, options->run.triangulation, options->run.min_angle);
  add_show_options(app, options->show);
  add_sizing_options(app, options->sizing);
  app.add_option(
         "--modes", options->run.modes,
         "Also find the K smoothest fields: listed in the report, and mode-1 ... mode-K in a folder given by -o")
      ->type_name("K")
      ->capture_default_str()
      ->check(cli::Range(1, 1000))
      ->group("Solver");
  return [options](const Common& common, Progress& progress) {
    take_features(*options);
    if (!options->batch.list.empty()) return run_batch_of(*options, common);
    if (!options->batch.lines.empty() || options->batch.jobs != 0)
      throw Failure(Exit::usage, "--lines and --jobs need --batch", {{"option", "--batch"}});
    if (options->mesh.path.empty()) throw Failure(Exit::usage, "mesh is required (see alcap field --help)");
    return run(*options, common, progress);
  };
}

}  // namespace
}  // namespace field_parts

const Command field_command{"field", "The smoothest n-field of a mesh, with singularities and certificate", true,
                            &field_parts::attach};

}  // namespace alcap::app
