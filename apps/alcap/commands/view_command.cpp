// SPDX-License-Identifier: MIT
//
// view_command.cpp: `alcap view`, from a field that alcap wrote to a page that shows it in any browser.
#include <fmt/core.h>

#include <algorithm>
#include <memory>

#include "alcap/memory.h"
#include "alcap/output.h"
#include "apps/alcap/commands/commands.h"
#include "apps/alcap/options/cli.h"
#include "apps/alcap/options/shared_options.h"
#include "apps/alcap/page/html_page.h"
#include "apps/alcap/page/view_scene.h"
#include "apps/alcap/picture/png_picture.h"
#include "apps/alcap/report/flags.h"
#include "apps/alcap/report/outputs.h"
#include "apps/alcap/report/report.h"
#include "src/base/clock.h"
#include "src/base/input_file.h"

namespace alcap::app {
namespace view_parts {
namespace {

constexpr const char* footer =
    "Examples:\n"
    "  alcap field bunny.ply -n 4 -o out\n"
    "  alcap view out -o bunny.html          with the figures of out/report.json\n"
    "  alcap view out/field.ply -o bunny.html\n"
    "  alcap view out --png bunny.png        a picture instead of a page, or both\n"
    "\n"
    "The page is one file and needs no network: open it from the disk, or send it to somebody. `alcap field ... "
    "--html\n"
    "FILE` makes the same page in one go.";

struct ViewOptions {
  std::filesystem::path field = {};
  ConnectionOptions connection = {};
  cli::App* app = nullptr;            // to see which options were given
  std::filesystem::path output = {};  // none: no page
  PictureOptions picture = {};
  std::string title = {};
};

constexpr int deepest_report = 16;

/// The report beside a field, null when there is none that can be read: it only adds figures.
Json read_report(const std::filesystem::path& path) {
  try {
    const detail::InputFile file(path, {.what = "report", .largest = std::int64_t{1} << 30, .writer_seconds = 0.1});
    // What nests deeper is no report of ours; such a tree cannot be copied or taken down without a deep stack.
    const auto shallow = [](int depth, Json::parse_event_t, const Json&) { return depth <= deepest_report; };
    Json report = Json::parse(file.bytes(), shallow, false);
    return report.is_object() ? report : Json();
  } catch (const FileError&) {
    return nullptr;
  }
}

/// Whether the report is about this field, as far as names and counts can tell: a folder may have fields of other runs.
bool about(const Json& report, const std::filesystem::path& file, const FieldOutput& output) {
  const auto says = [&](const char* pointer, std::int64_t count) {
    const Json::json_pointer at(pointer);
    return report.contains(at) && report.at(at) == count;
  };
  const Mesh& mesh = output.surface.mesh();
  if (!says("/mesh/vertices", mesh.vertices()) || !says("/mesh/faces", mesh.faces()) ||
      !says("/singularities/denominator", output.field.n) ||
      !says("/singularities/count", static_cast<std::int64_t>(output.singularities.size())) ||
      !report.contains("files"))
    return false;
  const Json& files = report["files"];
  return std::any_of(files.begin(), files.end(), [&](const Json& name) {
    return name.is_string() && std::filesystem::path(name.get<std::string>()).filename() == file.filename();
  });
}

std::string title_of(const ViewOptions& options, const std::filesystem::path& file, const Json& report) {
  if (!options.title.empty()) return options.title;
  const Json::json_pointer path("/input/path");
  if (report.contains(path) && report.at(path).is_string())
    return std::filesystem::path(report.at(path).get<std::string>()).stem().string();
  return file.stem().string();
}

/// Before anything that takes long.
void check_outputs(const ViewOptions& options) {
  if (options.output.empty() && options.picture.file.empty() && options.picture.curves.empty())
    throw Failure(Exit::usage, "nothing is to be made; give -o FILE.html, --png FILE or --curves FILE");
  if (!options.output.empty()) {
    check_page();
    check_writable(options.output);
  }
  check_picture(options.picture);
}

/// The connection to show the field with: as asked, or else as the field was made.
ConnectionOptions choose_connection(const ViewOptions& options, const FieldFile& data, std::vector<Remark>& remarks) {
  if (!connection_lost(*options.app, data)) return connection_for(*options.app, options.connection, data);
  // The field keeps its directions at the vertices.
  remarks.push_back({.code = "cones_unknown",
                     .message = "the file does not hold all of the " + std::string(name(data.connection)) +
                                " connection that the field was made with; shown with the global connection instead "
                                "(repeat its --cone or --target options here)"});
  return {.global = options.connection.global, .n = data.field.n};
}

/// The files with one line each; the page says how to look at it.
std::string summary(const ViewOptions& options, const Json& report) {
  std::string text;
  for (const Json& r : report["warnings"])
    text += fmt::format("{:<14}{}\n", "warning", r["message"].get<std::string>());
  for (const Json& f : report["files"]) {
    const bool page = f == options.output.string();
    text +=
        fmt::format("{:<14}{}{}\n", "wrote", f.get<std::string>(),
                    page ? fmt::format(" ({:.1f} MB); open it in a browser", report["bytes"].get<double>() / 1e6) : "");
  }
  return text;
}

Outcome run(const ViewOptions& options, const Common& common, Progress& progress) {
  const detail::Stopwatch watch;
  check_outputs(options);
  std::error_code error;
  const bool folder = std::filesystem::is_directory(options.field, error);
  const std::filesystem::path file = folder ? options.field / "field.ply" : options.field;
  check_distinct({{"--report", common.report},
                  {"-o", options.output},
                  {"--png", options.picture.file},
                  {"--curves", options.picture.curves}},
                 {{"field", file}, {"report of the field", file.parent_path() / "report.json"}});

  progress.phase("reading");
  FieldFile data = read_field(file);
  Json figures = read_report(file.parent_path() / "report.json");
  std::vector<Remark> remarks;
  const ConnectionOptions how = choose_connection(options, data, remarks);
  const Surface surface(std::move(data.V), std::move(data.F));
  progress.phase("finding the connection");
  const ConnectedSurface connected = connect(surface, how);
  const Field field = on_frames(data.field, connected.frames());
  const std::vector<Singularity> singularities = find_singularities(connected, field);
  const FieldOutput output{.surface = connected, .field = field, .singularities = singularities};
  if (!figures.is_null() && !about(figures, file, output)) {
    figures = nullptr;
    remarks.push_back({.code = "other_report",
                       .message = "the report.json beside this field is about another one; its figures are left out"});
  }

  progress.phase("drawing curves");
  const std::optional<CurveSet> curves = picture_curves(output, options.picture);
  std::vector<std::string> files = write_pictures(output, curves, options.picture);
  std::size_t bytes = 0;
  bool complete = true;
  if (!options.output.empty()) {
    const PageCurves on_page = page_curves(output);
    complete = on_page.complete();
    const ViewPack scene = make_scene(output, on_page, title_of(options, file, figures), figures);
    progress.phase("writing");
    const std::string page = html_page(scene);
    write_text(options.output, page);
    bytes = page.size();
    files.push_back(options.output.string());
  }

  if (!complete || (curves && !curves->complete)) remarks.push_back(curves_cut_short());
  Outcome outcome{.report = report_head("view", true)};
  outcome.report["field"] = file.string();
  outcome.report["n"] = field.n;
  outcome.report["mesh"] = {{"vertices", surface.mesh().vertices()}, {"faces", surface.mesh().faces()}};
  outcome.report["singularities"] = {{"count", singularities.size()}};
  if (curves) outcome.report["curves"] = curves_json(*curves);
  outcome.report["bytes"] = bytes;
  outcome.report["warnings"] = remarks_json(remarks, true);
  outcome.report["files"] = files;
  outcome.report["times"] = {{"total", watch.seconds()}};
  outcome.report["peak_memory_bytes"] = peak_memory_bytes();
  outcome.text = summary(options, outcome.report);
  return outcome;
}

std::function<Outcome(const Common&, Progress&)> attach(cli::App& app) {
  auto options = std::make_shared<ViewOptions>();
  app.footer(footer);
  app.add_option("field", options->field, "A .ply written by alcap field or alcap design, or the folder they wrote")
      ->required()
      ->type_name("FIELD");
  app.add_option("-o,--output", options->output, "The page to write")->type_name("FILE.html");
  app.add_option("--title", options->title, "Its title; otherwise the name of the mesh")->type_name("TEXT");
  add_connection_options(app, options->connection);
  add_picture_options(app, options->picture);
  options->app = &app;
  return [options](const Common& common, Progress& progress) { return run(*options, common, progress); };
}

}  // namespace
}  // namespace view_parts

const Command view_command{"view", "A page that shows a field in any browser, in one file", true, &view_parts::attach};

}  // namespace alcap::app
