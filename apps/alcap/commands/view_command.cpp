// SPDX-License-Identifier: MIT
//
// view_command.cpp: `alcap view`, from a field that alcap wrote to a page that shows it in any browser.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <fstream>
#include <memory>

#include "alcap/memory.h"
#include "alcap/output.h"
#include "apps/alcap/commands/commands.h"
#include "apps/alcap/options/shared_options.h"
#include "apps/alcap/page/html_page.h"
#include "apps/alcap/page/view_scene.h"
#include "apps/alcap/picture/png_picture.h"
#include "apps/alcap/report/outputs.h"
#include "apps/alcap/report/report.h"

namespace alcap::app {
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
  FieldRunOptions run = {};
  CLI::Option* connection = nullptr;  // --connection, to see whether it was given
  std::filesystem::path output = {};  // none: no page
  PictureOptions picture = {};
  std::string title = {};
};

/// The report beside a field, null when there is none that can be read: it only adds figures.
Json read_report(const std::filesystem::path& path) {
  std::ifstream in(path);
  if (!in) return nullptr;
  Json report = Json::parse(in, nullptr, false);
  return report.is_discarded() ? Json() : report;
}

std::string title_of(const ViewOptions& options, const std::filesystem::path& file, const Json& report) {
  if (!options.title.empty()) return options.title;
  const Json::json_pointer path("/input/path");
  if (report.contains(path) && report.at(path).is_string())
    return std::filesystem::path(report.at(path).get<std::string>()).stem().string();
  return file.stem().string();
}

Outcome run(ViewOptions options, Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  const bool page_wanted = !options.output.empty();
  if (!page_wanted && options.picture.file.empty() && options.picture.curves.empty())
    throw Failure(Exit::usage, "nothing is to be made; give -o FILE.html, --png FILE or --curves FILE");
  if (page_wanted) {
    check_page();
    check_writable(options.output);
  }
  check_picture(options.picture);
  std::error_code error;
  const bool folder = std::filesystem::is_directory(options.field, error);
  const std::filesystem::path file = folder ? options.field / "field.ply" : options.field;

  progress.phase("reading");
  FieldFile data = read_field(file);
  const Json figures = read_report(file.parent_path() / "report.json");
  options.run.n = data.field.n;
  if (options.connection->count() == 0 && options.run.cones.empty()) options.run.connection = data.connection;
  std::vector<Remark> remarks;
  if (options.run.connection == ConnectionKind::trivial && options.run.cones.empty()) {
    // Its cones are not in the file. The field keeps its directions at the vertices.
    options.run.connection = ConnectionKind::global;
    remarks.push_back({.code = "cones_unknown",
                       .message = "the field was made with a trivial connection whose cones the file does not hold; "
                                  "shown with the global connection instead (repeat its --cone options here)"});
  }
  const Mesh mesh(data.F, data.V.rows());
  const Geometry geometry(mesh, data.V);
  progress.phase("finding the connection");
  const Connection connection = make_connection(mesh, geometry, options.run, make_cones(mesh, geometry, options.run));
  const auto frames = std::make_shared<const Frames>(vertex_frames(mesh, data.V, geometry, connection));
  if (data.field.frames->X != frames->X || data.field.frames->N != frames->N)
    data.field = from_vectors(data.field.n, data.field.vectors(0), frames);
  const std::vector<Singularity> singularities = find_singularities(mesh, geometry, connection, data.field);

  progress.phase("drawing curves");
  std::vector<std::string> files = write_pictures({.mesh = mesh,
                                                   .V = data.V,
                                                   .geometry = geometry,
                                                   .connection = connection,
                                                   .field = data.field,
                                                   .singularities = singularities},
                                                  options.picture);
  std::size_t bytes = 0;
  if (page_wanted) {
    const ViewPack scene = make_scene({mesh, data.V, geometry, connection, data.field, singularities},
                                      title_of(options, file, figures), figures);
    progress.phase("writing");
    const std::string page = html_page(scene);
    write_text(options.output, page);
    bytes = page.size();
    files.push_back(options.output.string());
  }

  Outcome outcome{.report = report_head("view", true)};
  outcome.report["field"] = file.string();
  outcome.report["n"] = data.field.n;
  outcome.report["mesh"] = {{"vertices", mesh.vertices()}, {"faces", mesh.faces()}};
  outcome.report["singularities"] = {{"count", singularities.size()}};
  outcome.report["bytes"] = bytes;
  outcome.report["warnings"] = remarks_json(remarks, true);
  outcome.report["files"] = files;
  outcome.report["times"] = {
      {"total", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()}};
  outcome.report["peak_memory_bytes"] = peak_memory_bytes();
  for (const Remark& r : remarks) outcome.text += fmt::format("{:<14}{}\n", "warning", r.message);
  for (const std::string& f : files)
    outcome.text +=
        fmt::format("{:<14}{}{}\n", "wrote", f,
                    page_wanted && f == options.output.string()
                        ? fmt::format(" ({:.1f} MB); open it in a browser", static_cast<double>(bytes) / 1e6)
                        : "");
  return outcome;
}

std::function<Outcome(const Common&, Progress&)> attach(CLI::App& app) {
  auto options = std::make_shared<ViewOptions>();
  app.footer(footer);
  app.add_option("field", options->field, "A .ply written by alcap field or alcap design, or the folder they wrote")
      ->required()
      ->type_name("FIELD");
  app.add_option("-o,--output", options->output, "The page to write")->type_name("FILE.html");
  app.add_option("--title", options->title, "Its title; otherwise the name of the mesh")->type_name("TEXT");
  add_connection_options(app, options->run);
  add_picture_options(app, options->picture);
  options->connection = app.get_option("--connection");
  return [options](const Common&, Progress& progress) { return run(*options, progress); };
}

}  // namespace

const Command view_command{"view", "A page that shows a field in any browser, in one file", true, &attach};

}  // namespace alcap::app
