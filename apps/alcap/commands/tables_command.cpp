// SPDX-License-Identifier: MIT
//
// tables_command.cpp: `alcap tables`, the accuracy tables of the paper measured on this machine.
#include <fmt/core.h>

#include <memory>
#include <sstream>

#include "alcap/memory.h"
#include "alcap/mesh_io.h"
#include "apps/alcap/commands/commands.h"
#include "apps/alcap/options/cli.h"
#include "apps/alcap/report/report.h"
#include "apps/alcap/tables/tables.h"

namespace alcap::app {
namespace tables_parts {
namespace {

constexpr const char* footer =
    "Examples:\n"
    "  alcap tables                          all four spheres, as in the paper; takes minutes\n"
    "  alcap tables --levels 2,3 --fields 10 a quick look\n"
    "  alcap tables --json > tables.json\n"
    "  alcap tables --more --levels 2,3,4    other surfaces, noise, and other methods beside ours\n"
    "  alcap tables --mesh bunny.ply --levels 2\n"
    "\n"
    "Liu, Tong, de Goes, Desbrun 2016, Tables I and II: errors of divergence, curl and Dirichlet energy of smooth "
    "random\n"
    "fields on spheres, and (E_A - E_H) / pi, for every connection and both kinds of operators, on clean and on\n"
    "jittered spheres, beside the published numbers. Level l has 10 4^l + 2 vertices.";

Outcome run(TablesOptions options, const std::filesystem::path& mesh, Progress& progress) {
  if (!mesh.empty()) {
    MeshFile file = read_mesh(mesh);
    options.mesh = {std::move(file.V), std::move(file.F)};
    options.mesh_name = mesh.stem().string();
  }
  options.progress = [&](std::string_view what) { progress.phase(fmt::format("measuring on {}", what)); };
  const TablesResult result = compute_tables(options);
  Json report = report_head("tables", true);
  report.update(tables_json(result));
  report["times"] = {{"total", number(result.seconds)}};
  report["peak_memory_bytes"] = peak_memory_bytes();
  std::ostringstream text;
  print_tables(text, result);
  return {.report = std::move(report), .text = text.str()};
}

std::function<Outcome(const Common&, Progress&)> attach(cli::App& app) {
  auto options = std::make_shared<TablesOptions>();
  auto mesh = std::make_shared<std::filesystem::path>();
  app.footer(footer);
  app.add_option("--levels", options->levels, "Icosphere levels, coarse to fine")
      ->type_name("LIST")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--fields", options->fields, "Random fields to average over")->type_name("N")->capture_default_str();
  app.add_option("--jitter", options->jitter, "Of the jittered spheres, in mean edge lengths")
      ->type_name("X")
      ->capture_default_str();
  app.add_option("--seed", options->seed, "Of the random fields")->type_name("N")->capture_default_str();
  app.add_option("--mesh", *mesh, "Rows of the second table for this closed mesh as well")->type_name("MESH");
  app.add_flag("--more", options->more,
               "Also noise, random points, an ellipsoid and a generic body; and baselines: 1-forms on edges (Fisher et "
               "al. 2007), fields per face (Crane et al. 2010)");
  return [options, mesh](const Common&, Progress& progress) { return run(*options, *mesh, progress); };
}

}  // namespace
}  // namespace tables_parts

const Command tables_command{"tables", "The accuracy tables of the paper, measured here", true, &tables_parts::attach};

}  // namespace alcap::app
