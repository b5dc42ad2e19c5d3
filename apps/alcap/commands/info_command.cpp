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
  const std::vector<std::pair<std::vector<Repair>, std::vector<std::string>>> choices = {
      {{Repair::orient}, {"orient"}}, {{Repair::weld}, {"weld"}}, {{Repair::weld, Repair::orient}, {"weld", "orient"}}};
  for (const auto& [repairs, names] : choices) {
    try {
      std::vector<Remark> ignored;
      if (all_defects(V, apply_repairs(V, F, repairs, ignored)).empty()) return names;
    } catch (const MeshError&) {  // this repair is impossible; the next may work
    }
  }
  return {};
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
  for (const Json& w : report["warnings"]) line("warning", w["message"].get<std::string>());
  for (const Json& w : report["notes"]) line("note", w["message"].get<std::string>());
  for (const Json& d : report["defects"]) line("defect", d["message"].get<std::string>());
  if (report["ok"].get<bool>()) {
    line("field", "can be computed");
  } else {
    std::string flags;
    for (const Json& r : report["repairs_that_help"]) flags += " --repair " + r.get<std::string>();
    line("field", "cannot be computed" + (flags.empty() ? std::string() : "; it can with" + flags));
  }
  return text;
}

Outcome run(const MeshChoice& choice, Progress& progress) {
  progress.phase(fmt::format("reading {}", choice.path.string()));
  const MeshFile file = read_choice(choice);
  progress.phase(fmt::format("checking {} faces", grouped(file.F.rows())));
  std::vector<Remark> remarks;
  const Faces F = apply_repairs(file.V, file.F, choice.repairs, remarks);
  const std::vector<DefectReport> topological = find_defects(F, file.V.rows());
  const std::vector<DefectReport> geometric = find_defects(file.V, F);
  std::optional<Mesh> mesh;
  std::optional<Topology> topology;
  if (topological.empty()) {
    if (geometric.empty()) {
      const Surface surface(file.V, F);
      mesh = surface.mesh();
      topology = surface.topology();
      for (Remark& r : mesh_remarks(surface)) remarks.push_back(std::move(r));
    } else {
      mesh.emplace(F, file.V.rows());
      topology.emplace(find_topology(*mesh));
    }
  }
  const bool fit = topological.empty() && geometric.empty();
  Json report = report_head("info", fit);
  report["input"] = input_json(choice.path, file);
  report["mesh"] = mesh_part(measure(file.V, F), mesh, topology);
  report["components"] = components_part(topology);
  report["defects"] = defects_json(topological);
  for (Json& d : defects_json(geometric)) report["defects"].push_back(std::move(d));
  report["repairs_that_help"] = fit ? std::vector<std::string>{} : helpful_repairs(file.V, F);
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
  return [choice](const Common&, Progress& progress) { return run(*choice, progress); };
}

}  // namespace
}  // namespace info_parts

const Command info_command{"info", "What a mesh is, what is wrong with it, whether a field can be computed", true,
                           &info_parts::attach};

}  // namespace alcap::app
