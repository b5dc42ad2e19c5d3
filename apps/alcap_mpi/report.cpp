// SPDX-License-Identifier: MIT
#include "apps/alcap_mpi/report.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "apps/alcap/report/flags.h"
#include "apps/alcap/report/report.h"
#include "src/base/index_text.h"

namespace alcap::app {
namespace {

Json spread_json(const double (&value)[3]) {
  return {{"min", number(value[0])}, {"mean", number(value[1])}, {"max", number(value[2])}};
}

Json component_json(const DistributedComponent& c) {
  const EigenReport& e = c.eigen;
  const auto optional = [](const std::optional<double>& x) { return x ? number(*x) : Json(nullptr); };
  return {{"vertices", c.vertices},
          {"edges", c.edges},
          {"faces", c.faces},
          {"first_face", c.first_face},
          {"euler", c.euler},
          {"boundary_loops", c.boundary_loops},
          {"area", number(c.area)},
          {"index_sum", c.indices.sum},
          {"expected", c.indices.expected},
          {"index_sum_nths", c.indices.sum},
          {"expected_nths", c.indices.expected},
          {"eigen",
           {{"lambda", number(e.lambda)},
            {"next", optional(e.next)},
            {"residual", number(e.residual)},
            {"energy_residual", number(e.energy_residual)},
            {"smallest", name(e.smallest)},
            {"lower_bound", optional(e.lower_bound)},
            {"smallest_note", in_flags(e.smallest_note)},
            {"iterations", e.iterations},
            {"converged", e.converged},
            {"solver", e.solver},
            {"seconds", number(e.seconds)},
            {"message", e.message}}}};
}

Json singularities(const DistributedField& field) {
  Json list = Json::array();
  std::int64_t positive = 0, sum = 0, expected = 0;
  for (const DistributedSingularity& s : field.singularities) {
    positive += s.index > 0 ? 1 : 0;
    list.push_back({{"face", s.face},
                    {"index", s.index},
                    {"index_nths", s.index},
                    {"barycentric", s.barycentric},
                    {"located", s.located},
                    {"orientation", number(s.orientation)},
                    {"component", s.component},
                    {"position", s.position}});
  }
  for (const DistributedComponent& c : field.components) {
    sum += c.indices.sum;
    expected += c.indices.expected;
  }
  const auto count = static_cast<std::int64_t>(field.singularities.size());
  return {{"count", count},         {"positive", positive},      {"negative", count - positive},
          {"denominator", field.n}, {"index_sum", sum},          {"expected", expected},
          {"index_sum_nths", sum},  {"expected_nths", expected}, {"list", std::move(list)}};
}

struct Verdict {
  bool connection, eigen, residual, indices;
  Smallest smallest;
};

Verdict judge(const DistributedField& field, double tolerance) {
  Verdict v{field.connection.converged, true, true, true, Smallest::proven};
  const auto rank_of = [](Smallest s) {
    return s == Smallest::refuted ? 0 : s == Smallest::not_checked ? 1 : s == Smallest::searched ? 2 : 3;
  };
  for (const DistributedComponent& c : field.components) {
    v.eigen = v.eigen && c.eigen.converged;
    v.residual = v.residual && c.eigen.residual <= tolerance && c.eigen.energy_residual <= tolerance;
    v.indices = v.indices && c.indices.sum == c.indices.expected;
    if (rank_of(c.eigen.smallest) < rank_of(v.smallest)) v.smallest = c.eigen.smallest;
  }
  return v;
}

Json phases_json(const DistributedField& field) {
  Json phases = Json::object();
  for (const PhaseCost& p : field.phases)
    phases[p.name] = {{"seconds", spread_json(p.seconds)},
                      {"bytes_sent", spread_json(p.bytes_sent)},
                      {"messages", spread_json(p.messages)},
                      {"memory_bytes", spread_json(p.memory)}};
  return phases;
}

Json mesh_of(const MeshSlice& mesh, const DistributedField& field) {
  std::int64_t edges = 0, loops = 0, euler = 0;
  double area = 0;
  for (const DistributedComponent& c : field.components) {
    edges += c.edges;
    loops += c.boundary_loops;
    euler += c.euler;
    area += c.area;
  }
  return {{"vertices", mesh.vertices},
          {"faces", mesh.faces},
          {"edges", edges},
          {"euler", euler},
          {"boundary_loops", loops},
          {"components", field.components.size()},
          {"area", number(area)}};
}

Json counts_json(const std::int64_t (&value)[3]) { return {{"min", value[0]}, {"mean", value[1]}, {"max", value[2]}}; }

/// Counts of meshes are grouped by thousands.
std::string count(const Json& value) { return grouped(value.get<std::int64_t>()); }

}  // namespace

void add_field(const std::string& path, const MeshSlice& mesh, const DistributedField& field, Json& report) {
  report["program"] = "alcap-mpi";
  report["input"] = {{"path", path}};
  report["mesh"] = mesh_of(mesh, field);
  Json cones = Json::array(), loops = Json::array();
  for (const Cone& c : field.cones) cones.push_back({{"vertex", c.vertex}, {"index", number(c.index)}});
  for (const double turns : field.loop_index) loops.push_back(number(turns));
  report["connection"] = {{"kind", std::string(name(ConnectionChoice{field.kind, field.center}))},
                          {"detail", number(field.global.detail)},
                          {"cones", std::move(cones)},
                          {"loop_index", std::move(loops)},
                          {"D_T", number(field.connection.D_T)},
                          {"D_E", number(field.connection.D_E)},
                          {"iterations", field.connection.iterations},
                          {"residual", number(field.connection.residual)},
                          {"converged", field.connection.converged},
                          {"message", field.connection.message}};
  report["n"] = field.n;
  Json components = Json::array();
  for (const DistributedComponent& c : field.components) components.push_back(component_json(c));
  report["components"] = std::move(components);
  report["singularities"] = singularities(field);
  const double mean = static_cast<double>(field.owned[1]);
  report["ranks"] = {{"count", distributed_ranks()},
                     {"partition", field.partition},
                     {"owned_vertices", counts_json(field.owned)},
                     {"held_vertices", counts_json(field.held)},
                     {"imbalance", number(mean > 0 ? static_cast<double>(field.owned[2]) / mean : 1)},
                     {"cut_edges", field.cut_edges}};
  report["phases"] = phases_json(field);
}

Json distributed_report(const std::string& path, const MeshSlice& mesh, const DistributedField& field,
                        const DistributedOptions& options) {
  const Verdict v = judge(field, options.tolerance);
  const bool ok = v.connection && v.eigen && v.residual && v.indices && v.smallest != Smallest::refuted;
  Json report = report_head("field", ok);
  add_field(path, mesh, field, report);
  report["certificate"] = {{"connection_converged", v.connection},
                           {"eigen_converged", v.eigen},
                           {"residual_small", v.residual},
                           {"index_sums_match", v.indices},
                           {"smallest", name(v.smallest)}};
  report["warnings"] = remarks_json(field.remarks, true);
  report["notes"] = remarks_json(field.remarks, false);
  return report;
}

std::string mesh_summary(const Json& report) {
  std::string text;
  const auto line = [&](const char* label, const std::string& value) { text += summary_line(label, value); };
  const Json &mesh = report["mesh"], &connection = report["connection"], &ranks = report["ranks"];
  line("mesh", fmt::format("{} vertices, {} faces, {} component(s), {} boundary loop(s), Euler characteristic {}",
                           count(mesh["vertices"]), count(mesh["faces"]), count(mesh["components"]),
                           count(mesh["boundary_loops"]), count(mesh["euler"])));
  line("ranks", fmt::format("{}: {} to {} vertices owned, at most {} held, {} edges cut ({})", count(ranks["count"]),
                            count(ranks["owned_vertices"]["min"]), count(ranks["owned_vertices"]["max"]),
                            count(ranks["held_vertices"]["max"]), count(ranks["cut_edges"]),
                            ranks["partition"].get<std::string>()));
  line("connection",
       fmt::format("{}: D_T {}, D_E {}, {} iterations", connection["kind"].get<std::string>(),
                   short_text(connection["D_T"]), short_text(connection["D_E"]), count(connection["iterations"])));
  return text;
}

std::string costs_summary(const Json& report) {
  std::string text;
  const auto line = [&](const char* label, const std::string& value) { text += summary_line(label, value); };
  const Json& singular = report["singularities"];
  const int n = report["n"].get<int>();
  line("singularities", fmt::format("{}: {} positive, {} negative; indices sum to {}, expected {}",
                                    count(singular["count"]), count(singular["positive"]), count(singular["negative"]),
                                    detail::turns_text(singular["index_sum"].get<std::int64_t>(), n),
                                    detail::turns_text(singular["expected"].get<std::int64_t>(), n)));
  std::string seconds, bytes;
  double memory = 0;
  for (const auto& [phase, cost] : report["phases"].items()) {
    const char* const comma = seconds.empty() ? "" : ", ";
    seconds += fmt::format("{}{} {:.2f}", comma, phase, cost["seconds"]["max"].get<double>());
    bytes += fmt::format("{}{} {:.2f}", comma, phase, cost["bytes_sent"]["max"].get<double>() / 1e6);
    memory = std::max(memory, cost["memory_bytes"]["max"].get<double>());
  }
  line("seconds", seconds);
  line("MB sent", bytes + " (the rank that sends most)");
  line("memory", fmt::format("{:.0f} MB on the rank that holds most", memory / 1e6));
  return text;
}

std::string distributed_summary(const Json& report) {
  std::string text = mesh_summary(report);
  const auto line = [&](const char* label, const std::string& value) { text += summary_line(label, value); };
  const Json& parts = report["components"];
  const Json& eigen = std::max_element(parts.begin(), parts.end(), [](const Json& a, const Json& b) {
                        return a["faces"] < b["faces"];
                      })->at("eigen");
  const int n = report["n"].get<int>();
  line("field",
       fmt::format("n = {}, eigenvalue {}, residual {}, {} iterations, {}", n, short_text(eigen["lambda"]),
                   short_text(eigen["residual"]), count(eigen["iterations"]), eigen["solver"].get<std::string>()));
  line("smallest", smallest_text(report["certificate"], eigen, parts.size() == 1));
  text += costs_summary(report);
  for (const Json& w : report["warnings"]) line("warning", w["message"].get<std::string>());
  for (const Json& w : report["notes"]) line("note", w["message"].get<std::string>());
  line("certificate", report["ok"].get<bool>() ? "holds" : "DOES NOT HOLD, see the warnings");
  return text;
}

}  // namespace alcap::app
