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

Json to_json(const OperatorRow& row) {
  return {{"sphere", row.sphere},
          {"level", row.level},
          {"vertices", row.vertices},
          {"mean_edge", number(row.mean_edge)},
          {"connection", row.connection},
          {"kind", row.kind},
          {"l2_div", number(row.l2_div)},
          {"l2_curl", number(row.l2_curl)},
          {"linf_div", number(row.linf_div)},
          {"linf_curl", number(row.linf_curl)},
          {"face_div", number(row.face_div)},
          {"face_curl", number(row.face_curl)},
          {"energy", number(row.energy)},
          {"paper",
           {{"l2_div", number(row.paper_l2_div)},
            {"l2_curl", number(row.paper_l2_curl)},
            {"linf_div", number(row.paper_linf_div)},
            {"linf_curl", number(row.paper_linf_curl)},
            {"energy", number(row.paper_energy)}}},
          {"order",
           {{"l2_div", number(row.order_l2_div)},
            {"l2_curl", number(row.order_l2_curl)},
            {"linf_div", number(row.order_linf_div)},
            {"linf_curl", number(row.order_linf_curl)},
            {"energy", number(row.order_energy)}}}};
}

Json to_json(const StiffnessRow& row) {
  return {{"sphere", row.sphere},
          {"level", row.level},
          {"vertices", row.vertices},
          {"mean_edge", number(row.mean_edge)},
          {"connection", row.connection},
          {"energy", number(row.energy)},
          {"paper", {{"energy", number(row.paper_energy)}}},
          {"order", {{"energy", number(row.order_energy)}}}};
}

Json to_json(const EulerRow& row) {
  return {{"surface", row.surface},
          {"level", row.level},
          {"vertices", row.vertices},
          {"connection", row.connection},
          {"kind", row.kind},
          {"mean", number(row.mean)},
          {"deviation", number(row.deviation)},
          {"expected", number(row.expected)},
          {"paper", {{"mean", number(row.paper_mean)}, {"deviation", number(row.paper_deviation)}}}};
}

Json to_json(const BaselineRow& row) {
  return {{"sphere", row.sphere},       {"level", row.level},
          {"vertices", row.vertices},   {"fisher", number(row.fisher)},
          {"edge", number(row.edge)},   {"triangle", number(row.triangle)},
          {"basis", number(row.basis)}, {"crane_degrees", number(row.crane_degrees)}};
}

template <class Row>
Json rows_json(const std::vector<Row>& rows) {
  Json list = Json::array();
  for (const Row& row : rows) list.push_back(to_json(row));
  return list;
}

Outcome run(TablesOptions options, const std::filesystem::path& mesh, Progress& progress) {
  if (!mesh.empty()) {
    MeshFile file = read_mesh(mesh);
    options.mesh = {std::move(file.V), std::move(file.F)};
    options.mesh_name = mesh.stem().string();
  }
  options.progress = [&](std::string_view what) { progress.phase(fmt::format("measuring on {}", what)); };
  const TablesResult result = compute_tables(options);
  Json report = report_head("tables", true);
  report["options"] = {{"levels", options.levels},         {"fields", options.fields},
                       {"harmonics", options.harmonics},   {"unit_harmonics", options.unit_harmonics},
                       {"jitter", number(options.jitter)}, {"seed", options.seed}};
  report["operators"] = rows_json(result.operators);
  report["stiffness"] = rows_json(result.stiffness);
  report["euler"] = rows_json(result.euler);
  report["baselines"] = rows_json(result.baselines);
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
