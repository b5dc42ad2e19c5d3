// SPDX-License-Identifier: MIT
//
// info_command.cpp: `alcap info`, what a mesh is, everything that is wrong with it, and whether a field can be
// computed.
#include <fmt/core.h>

#include <memory>
#include <optional>

#include "alcap/mesh_check.h"
#include "apps/alcap/commands/commands.h"
#include "apps/alcap/options/cli.h"
#include "apps/alcap/options/shared_options.h"
#include "apps/alcap/report/flags.h"
#include "apps/alcap/report/outputs.h"
#include "apps/alcap/report/printable.h"
#include "apps/alcap/report/report.h"
#include "apps/alcap/report/statistics.h"

namespace alcap::app {
namespace info_parts {
namespace {

constexpr const char* footer =
    "Examples:\n"
    "  alcap info bunny.ply\n"
    "  alcap info scan.stl --repair weld --repair orient    what it would be after these repairs\n"
    "  alcap info part.obj --json | jq .defects\n"
    "\n"
    "Exit code 0: a field can be computed. 4: it cannot; the defects say why. 3: the file cannot be read.";

std::vector<DefectReport> all_defects(const Positions<double>& V, const Faces& F) {
  std::vector<DefectReport> defects = find_defects(F, V.rows());
  for (DefectReport& d : find_defects(V, F)) defects.push_back(std::move(d));
  return defects;
}

/// Which repairs, alone or together, make the mesh usable; empty when none does.
std::vector<std::string> helpful_repairs(const Positions<double>& V, const Faces& F) {
  const std::vector<std::vector<Repair>> choices = {
      {Repair::orient}, {Repair::duplicates},           {Repair::degenerate}, {Repair::split},
      {Repair::weld},   {Repair::weld, Repair::orient}, {Repair::automatic},  {Repair::mollify}};
  for (const std::vector<Repair>& repairs : choices) {
    try {
      if (repairs.front() == Repair::mollify) {
        (void)repaired_surface(V, F, {.repairs = repairs});
      } else {
        const RepairedMesh mesh = repair_mesh(V, F, {.repairs = repairs});
        if (!all_defects(mesh.V, mesh.F).empty()) continue;
      }
      std::vector<std::string> names;
      for (const Repair r : repairs) names.emplace_back(name(r));
      return names;
    } catch (const MeshError&) {  // this repair is impossible; the next may work
    }
  }
  return {};
}

bool asked(const RepairOptions& options, Repair repair) {
  return std::find(options.repairs.begin(), options.repairs.end(), repair) != options.repairs.end();
}

/// Counts and ranges under the same keys as in the report of `alcap field`; what needs a manifold is null without one.
Json mesh_part(const Statistics& s, const std::optional<Mesh>& mesh, const std::optional<Topology>& topology) {
  Json json{{"vertices", s.vertices},
            {"faces", s.faces},
            {"edges", s.edges},
            {"components", topology ? static_cast<std::int64_t>(topology->components.size()) : s.components},
            {"boundary_loops", topology ? Json(topology->loops.size()) : Json(nullptr)},
            {"boundary_edges", s.boundary_edges},
            {"euler", mesh ? std::int64_t{topology->euler()} : s.referenced - s.edges + s.faces},
            {"genus", nullptr},
            {"unreferenced_vertices", s.vertices - s.referenced},
            {"duplicate_vertices", s.duplicate_vertices},
            {"area", number(s.area)},
            {"edge_length_min", number(s.edge_min)},
            {"edge_length_mean", number(s.edge_mean)},
            {"edge_length_max", number(s.edge_max)},
            {"angle_min_degrees", number(s.angle_min * 180 / pi<double>)},
            {"angle_max_degrees", number(s.angle_max * 180 / pi<double>)},
            {"box_min", {number(s.box_min[0]), number(s.box_min[1]), number(s.box_min[2])}},
            {"box_max", {number(s.box_max[0]), number(s.box_max[1]), number(s.box_max[2])}}};
  if (!topology) return json;
  std::int64_t genus = 0;
  for (const ComponentInfo& part : topology->components) genus += part.genus;
  json["genus"] = genus;
  return json;
}

Json components_part(const std::optional<Topology>& topology) {
  if (!topology) return nullptr;
  Json list = Json::array();
  for (const ComponentInfo& part : topology->components) {
    list.push_back({{"vertices", part.vertices},
                    {"edges", part.edges},
                    {"faces", part.faces},
                    {"boundary_loops", part.boundary_loops},
                    {"euler", part.euler},
                    {"genus", part.genus},
                    {"first_face", part.first_face}});
  }
  return list;
}

std::string summary(const Json& report) {
  const Json& mesh = report["mesh"];
  const auto count = [&](const char* key) {
    return mesh[key].is_null() ? std::string("?") : grouped(mesh[key].get<std::int64_t>());
  };
  const auto real = [&](const char* key) {
    return mesh[key].is_null() ? std::string("?") : fmt::format("{:.6g}", mesh[key].get<double>());
  };
  std::string text;
  const auto line = [&](const char* label, const std::string& value) {
    text += fmt::format("{:<10}{}\n", label, value);
  };
  line("file", fmt::format("{}, {} bytes", report["input"]["format"].get<std::string>(),
                           grouped(report["input"]["bytes"].get<std::int64_t>())));
  line("counts", fmt::format("{} vertices ({} unreferenced), {} edges, {} faces", count("vertices"),
                             count("unreferenced_vertices"), count("edges"), count("faces")));
  line("topology", fmt::format("{} component(s), {} boundary loop(s) of {} edges, genus {}, Euler characteristic {}",
                               count("components"), count("boundary_loops"), count("boundary_edges"), count("genus"),
                               count("euler")));
  line("edges",
       fmt::format("{} to {}, mean {}", real("edge_length_min"), real("edge_length_max"), real("edge_length_mean")));
  line("angles", fmt::format("{} to {} degrees", real("angle_min_degrees"), real("angle_max_degrees")));
  line("area", real("area"));
  constexpr std::size_t most = 10;
  if (const Json& parts = report["components"]; parts.size() > 1) {
    for (std::size_t c = 0; c < std::min(parts.size(), most); ++c) {
      const auto part = [&](const char* key) { return grouped(parts[c][key].get<std::int64_t>()); };
      line(c == 0 ? "pieces" : "", fmt::format("{}: {} vertices, {} faces, {} boundary loop(s), genus {}", c,
                                               part("vertices"), part("faces"), part("boundary_loops"), part("genus")));
    }
    if (parts.size() > most) line("", fmt::format("... and {} more", parts.size() - most));
  }
  for (const Json& r : report["input"]["remarks"]) line("file", r.get<std::string>());
  for (const Json& w : report["warnings"]) line("warning", w["message"].get<std::string>());
  for (const Json& w : report["notes"]) line("note", w["message"].get<std::string>());
  for (const Json& d : report["defects"]) line("defect", d["message"].get<std::string>());
  if (report["ok"].get<bool>()) {
    line("field", "can be computed");
  } else {
    const Json& command = report["command_that_works"];
    line("field", "cannot be computed" + (command.is_null() ? "" : "; it can by: " + command.get<std::string>()));
  }
  return text;
}

/// The command that computes a field after these repairs, besides those that were asked for.
std::string command_with(const MeshChoice& choice, const std::vector<std::string>& repairs) {
  std::string command = "alcap field " + shell_file(choice.path);
  if (!choice.format.empty()) command += " --input-format " + shell_word(choice.format);
  for (const Repair r : choice.repair.repairs) {
    const bool near = r == Repair::weld && choice.repair.weld_tolerance > 0;
    command += " --repair " + std::string(name(r)) + (near ? fmt::format(":{}", choice.repair.weld_tolerance) : "");
  }
  for (const std::string& r : repairs) command += " --repair " + r;
  return command;
}

/// The mesh after what was asked for and, where nothing else is wrong with it, with its bow-ties split, as every
/// command does.
RepairedMesh repaired_for_info(const MeshFile& file, const RepairOptions& asked, std::vector<Remark>& remarks) {
  RepairOptions options = asked;
  options.bow_ties = false;
  RepairedMesh out = repair_mesh(file.V, file.F, options);
  const std::vector<DefectReport> defects = find_defects(out.F, out.V.rows());
  if (defects.size() == 1 && defects.front().defect == Defect::non_manifold_vertex) {
    options.bow_ties = true;
    out = repair_mesh(file.V, file.F, options);
  }
  add_remarks(out.steps, remarks);
  return out;
}

Outcome run(const MeshChoice& choice, const Common& common, Progress& progress) {
  check_distinct({{"--report", common.report}}, {{"mesh", choice.path}});
  progress.phase(fmt::format("reading {}", choice.path.string()));
  const MeshFile file = read_choice(choice);
  progress.phase(fmt::format("checking {} faces", grouped(file.F.rows())));
  std::vector<Remark> remarks;
  const RepairedMesh repaired = repaired_for_info(file, choice.repair, remarks);
  const Positions<double>& V = repaired.V;
  const Faces& F = repaired.F;
  const std::vector<DefectReport> topological = find_defects(F, V.rows());
  std::vector<DefectReport> geometric = find_defects(V, F);
  std::optional<Surface> mollified;
  if (topological.empty() && asked(choice.repair, Repair::mollify)) {
    RepairedSurface made = repaired_surface(V, F, {.repairs = {Repair::mollify}});
    for (Remark& r : made.remarks) remarks.push_back(std::move(r));
    mollified = std::move(made.surface);
    geometric.clear();
  }
  std::optional<Mesh> mesh;
  std::optional<Topology> topology;
  if (topological.empty()) {
    if (geometric.empty()) {
      const Surface surface = mollified ? *mollified : Surface(V, F);
      mesh = surface.mesh();
      topology = surface.topology();
      for (Remark& r : mesh_remarks(surface)) remarks.push_back(std::move(r));
    } else {
      mesh.emplace(F, V.rows());
      topology.emplace(find_topology(*mesh));
    }
  }
  const bool fit = topological.empty() && geometric.empty();
  Json report = report_head("info", fit);
  report["input"] = input_json(choice.path, file);
  report["mesh"] = mesh_part(measure(V, F), mesh, topology);
  report["components"] = components_part(topology);
  report["defects"] = defects_json(topological);
  for (Json& d : defects_json(geometric)) report["defects"].push_back(std::move(d));
  const std::vector<std::string> helpful = fit ? std::vector<std::string>{} : helpful_repairs(V, F);
  report["repairs_that_help"] = helpful;
  report["command_that_works"] = helpful.empty() ? Json(nullptr) : Json(command_with(choice, helpful));
  report["warnings"] = remarks_json(remarks, true);
  report["notes"] = remarks_json(remarks, false);

  Outcome outcome{.exit = fit ? Exit::ok : Exit::mesh, .report = std::move(report)};
  outcome.text = summary(outcome.report);
  if (!fit) outcome.complaint = in_flags((topological.empty() ? geometric : topological).front().message);
  return outcome;
}

std::function<Outcome(const Common&, Progress&)> attach(cli::App& app) {
  auto choice = std::make_shared<MeshChoice>();
  app.footer(footer);
  add_mesh_options(app, *choice);
  return [choice](const Common& common, Progress& progress) { return run(*choice, common, progress); };
}

}  // namespace
}  // namespace info_parts

const Command info_command{"info", "What a mesh is, what is wrong with it, whether a field can be computed", true,
                           &info_parts::attach};

}  // namespace alcap::app
