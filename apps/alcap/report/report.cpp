// SPDX-License-Identifier: MIT
//
// report.cpp: results as JSON.
#include "apps/alcap/report/report.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "alcap/memory.h"
#include "alcap/version.h"
#include "apps/alcap/report/flags.h"
#include "src/base/parallel.h"

namespace alcap::app {
namespace {

double infinity() { return std::numeric_limits<double>::infinity(); }

struct Spread {
  double least = infinity(), most = -infinity(), sum = 0;
};

/// Of value(i) for i in [0, n).
template <class Value>
Spread spread(std::int64_t n, Value&& value) {
  return parallel_reduce(
      n, Spread{},
      [&](std::int64_t begin, std::int64_t end) {
        Spread here;
        for (std::int64_t i = begin; i < end; ++i) {
          const double x = value(i);
          here = {std::min(here.least, x), std::max(here.most, x), here.sum + x};
        }
        return here;
      },
      [](const Spread& a, const Spread& b) {
        return Spread{std::min(a.least, b.least), std::max(a.most, b.most), a.sum + b.sum};
      });
}

std::int64_t integer(std::size_t count) { return static_cast<std::int64_t>(count); }

Json optional_number(const std::optional<double>& value) { return value ? number(*value) : Json(nullptr); }

Json eigen_json(const EigenReport& eigen) {
  return {{"lambda", number(eigen.lambda)},
          {"next", optional_number(eigen.next)},
          {"residual", number(eigen.residual)},
          {"energy_residual", number(eigen.energy_residual)},
          {"distance", number(eigen.distance)},
          {"angle_degrees", optional_number(eigen.angle)},
          {"angle_check", name(eigen.angle_check)},
          {"angle_at_vertices_degrees", optional_number(eigen.angle_at_vertices)},
          {"smallest", name(eigen.smallest)},
          {"lower_bound", optional_number(eigen.lower_bound)},
          {"smallest_note", in_flags(eigen.smallest_note)},
          {"iterations", eigen.iterations},
          {"converged", eigen.converged},
          {"solver", eigen.solver},
          {"seconds", number(eigen.seconds)},
          {"proof_seconds", number(eigen.proof_seconds)},
          {"message", in_flags(eigen.message)}};
}

Json modes_json(const EigenModes& modes) {
  Json list = Json::array();
  for (Eigen::Index k = 0; k < modes.lambda.size(); ++k) {
    list.push_back({{"lambda", number(modes.lambda[k])},
                    {"residual", number(modes.residual[k])},
                    {"cluster", modes.cluster[static_cast<std::size_t>(k)]}});
  }
  return {{"list", std::move(list)},           {"smallest", name(modes.smallest)},
          {"converged", modes.converged},      {"solver", modes.solver},
          {"iterations", modes.iterations},    {"seconds", number(modes.seconds)},
          {"message", in_flags(modes.message)}};
}

/// Of several components: eigenvalues of the largest one, the worst residual, all iterations.
Json eigen_summary(const FieldRun& run, const FieldRunOptions& options) {
  if (run.features) return nullptr;
  const auto& parts = run.topology().components;
  const auto largest = static_cast<std::size_t>(
      std::max_element(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.faces < b.faces; }) -
      parts.begin());
  Json json = eigen_json(run.eigen.at(largest));
  double residual = 0, energy_residual = 0, seconds = 0, proof_seconds = 0;
  std::int64_t iterations = 0;
  const auto worse = [](double a, double b) { return std::isnan(b) ? infinity() : std::max(a, b); };
  for (const EigenReport& e : run.eigen) {
    residual = worse(residual, e.residual);
    energy_residual = worse(energy_residual, e.energy_residual);
    proof_seconds += e.proof_seconds;
    iterations += e.iterations;
    seconds += e.seconds;
  }
  json["residual"] = number(residual);
  json["energy_residual"] = number(energy_residual);
  json["proof_seconds"] = number(proof_seconds);
  json["iterations"] = iterations;
  json["converged"] = run.certificate.eigen_converged;
  json["seconds"] = number(seconds);
  json["angle_degrees"] = optional_number(run.certificate.angle);
  json["angle_check"] = name(run.certificate.angle_check);
  json["tolerance"] = number(options.eigen.residual_tolerance());
  json["angle_tolerance_degrees"] = options.eigen.by_angle() ? number(options.eigen.angle_tolerance) : Json(nullptr);
  json["component"] = largest;
  return json;
}

Json singularity_json(const Singularity& s, const Eigen::RowVector3d& xyz, Index component) {
  return {{"face", s.face},
          {"barycentric", {number(s.barycentric[0]), number(s.barycentric[1]), number(s.barycentric[2])}},
          {"xyz", {number(xyz[0]), number(xyz[1]), number(xyz[2])}},
          {"index", s.index},
          {"index_nths", s.index},
          {"orientation", number(s.orientation)},
          {"located", s.located},
          {"component", component}};
}

Json component_eigen(const FieldRun& run, std::size_t c) {
  if (!run.features) return eigen_json(run.eigen.at(c));
  const auto& eigen = run.features->pieces.at(c).eigen;
  return eigen ? eigen_json(*eigen) : Json(nullptr);
}

Json deviation_json(const LineDeviation& line) {
  return {{"edges", line.edges},
          {"corner_edges", line.corner_edges},
          {"length", number(line.length)},
          {"mean_degrees", number(line.mean_degrees)},
          {"p95_degrees", number(line.p95_degrees)},
          {"worst_degrees", number(line.worst_degrees)},
          {"corner_worst_degrees", number(line.corner_worst_degrees)},
          {"singularities", line.singularities}};
}

Json piece_json(const AlignedPiece& piece) {
  Json steps = Json::array();
  for (const AlignedStep& step : piece.steps)
    steps.push_back({{"tau", number(step.tau)},
                     {"energy", number(step.energy)},
                     {"largest_degrees", number(step.largest_degrees)},
                     {"rms_degrees", number(step.rms_degrees)}});
  return {{"held", piece.held},       {"drawn_edges", piece.rows},          {"lambda", number(piece.lambda)},
          {"settled", piece.settled}, {"residual", number(piece.residual)}, {"solver", piece.solver},
          {"steps", std::move(steps)}};
}

}  // namespace

Json alignment_json(const FieldFeatures& features, const AlignmentAsked& asked) {
  Json lines = Json::array(), pieces = Json::array();
  for (std::size_t k = 0; k < features.graph.lines.size(); ++k) {
    const FeatureLine& line = features.graph.lines[k];
    Json json{{"from", line.vertices.front()}, {"to", line.vertices.back()}, {"closed", line.closed}};
    json.update(deviation_json(features.report.lines.at(k)));
    lines.push_back(std::move(json));
  }
  std::int64_t steps = 0;
  bool settled = true;
  for (const AlignedPiece& piece : features.pieces) {
    steps += integer(piece.steps.size());
    settled = settled && piece.settled;
    pieces.push_back(piece_json(piece));
  }
  const auto corners =
      std::count(features.graph.vertices.begin(), features.graph.vertices.end(), FeatureVertex::corner);
  return {{"angle_degrees", number(asked.angle_degrees)},
          {"boundary", asked.boundary},
          {"across", asked.across},
          {"weight", number(asked.weight)},
          {"hold", asked.hold},
          {"edges", features.graph.edges.size()},
          {"corners", corners},
          {"free_corners", features.free_corners.size()},
          {"all", deviation_json(features.report.all)},
          {"singularities_at_corners", features.report.singularities_at_corners},
          {"steps", steps},
          {"settled", settled},
          {"followed", features.followed},
          {"lines", std::move(lines)},
          {"pieces", std::move(pieces)}};
}

namespace {

Json quality_json(const TriangleQuality& quality) {
  return {{"angle_min_degrees", number(quality.angle_min * 180 / pi<double>)},
          {"angle_max_degrees", number(quality.angle_max * 180 / pi<double>)},
          {"cotangent_min", number(quality.cotangent_min)},
          {"not_delaunay", quality.not_delaunay},
          {"slivers", quality.slivers}};
}

Json components_json(const FieldRun& run) {
  const auto& parts = run.topology().components;
  std::vector<double> area(parts.size(), 0.0);
  std::vector<std::int64_t> singular(parts.size(), 0);
  if (parts.size() == 1) {
    area[0] = run.geometry().total_area();
  } else {
    for (Index t = 0; t < run.mesh().faces(); ++t)
      area[static_cast<std::size_t>(run.topology().face_component[static_cast<std::size_t>(t)])] +=
          run.geometry().area(t);
  }
  for (const Singularity& s : run.singularities) {
    ++singular[static_cast<std::size_t>(run.topology().face_component[static_cast<std::size_t>(s.face)])];
  }
  Json list = Json::array();
  for (std::size_t c = 0; c < parts.size(); ++c) {
    const ComponentInfo& part = parts[c];
    list.push_back({{"mesh",
                     {{"vertices", part.vertices},
                      {"edges", part.edges},
                      {"faces", part.faces},
                      {"boundary_loops", part.boundary_loops},
                      {"euler", part.euler},
                      {"genus", part.genus},
                      {"area", number(area[c])},
                      {"first_face", part.first_face}}},
                    {"eigen", component_eigen(run, c)},
                    {"singularities",
                     {{"count", singular[c]},
                      {"index_sum", run.index_sums.at(c).sum},
                      {"expected", run.index_sums.at(c).expected},
                      {"index_sum_nths", run.index_sums.at(c).sum},
                      {"expected_nths", run.index_sums.at(c).expected}}}});
  }
  return list;
}

Json numbers(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double x : values) list.push_back(number(x));
  return list;
}

Json options_json(const FieldRunOptions& options) {
  Json repairs = Json::array();
  for (const Repair r : options.repairs) repairs.push_back(name(r));
  Json cones = Json::array();
  for (const Cone& c : options.connection.cones) cones.push_back({{"vertex", c.vertex}, {"index", number(c.index)}});
  return {{"n", options.n},
          {"energy", number(options.s)},
          {"connection", name(ConnectionChoice{options.connection.kind, options.connection.polar.center})},
          {"detail", number(options.connection.global.detail)},
          {"length_factor", name(options.connection.global.length_factor)},
          {"tan_cap", number(options.connection.global.tan_cap)},
          {"cones", std::move(cones)},
          {"balance_cones", options.connection.balance_cones},
          {"tolerance", optional_number(options.eigen.tolerance)},
          {"angle_tolerance_degrees", number(options.eigen.angle_tolerance)},
          {"solver", options.eigen.solver},
          {"method", options.eigen.method},
          {"prove", name(options.eigen.prove_smallest)},
          {"triangulation", name(options.triangulation)},
          {"min_angle_degrees", number(options.min_angle * 180 / pi<double>)},
          {"modes", options.modes},
          {"repairs", std::move(repairs)},
          {"unit", options.normalise}};
}

}  // namespace

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json report_head(const std::string& command, bool ok) {
  return {{"program", "alcap"},
          {"version", version()},
          {"report_version", report_version},
          {"command", command},
          {"ok", ok}};
}

Json error_report(const std::string& command, Exit exit, const std::string& message, const Json& details) {
  Json error{{"kind", name(exit)}, {"exit_code", static_cast<int>(exit)}, {"message", message}};
  error.update(details);
  Json report = report_head(command, false);
  report["error"] = std::move(error);
  return report;
}

Json file_details(const FileError& error) {
  Json details{{"path", error.path()}};
  if (error.line() > 0) details["line"] = error.line();
  if (error.offset() >= 0) details["offset"] = error.offset();
  return details;
}

Json mesh_details(const MeshError& error) {
  return {{"defect", name(error.defect())},
          {"element", name(error.element())},
          {"count", error.count()},
          {"first", error.first()}};
}

const char* name(Exit exit) {
  switch (exit) {
    case Exit::ok:
      return "ok";
    case Exit::internal:
      return "internal";
    case Exit::usage:
      return "usage";
    case Exit::input:
      return "input";
    case Exit::mesh:
      return "mesh";
    case Exit::uncertified:
      return "uncertified";
    case Exit::output:
      return "output";
    case Exit::solver:
      return "solver";
    case Exit::unmet:
      return "unmet";
    case Exit::interrupted:
      return "interrupted";
  }
  return "internal";
}

Json input_json(const std::filesystem::path& path, const MeshFile& file) {
  Json ignored = Json::object();
  for (const auto& [kind, count] : file.ignored) ignored[kind] = count;
  return {{"path", path.string()},         {"format", file.format},
          {"bytes", file.bytes},           {"polygons_triangulated", !file.polygon_of.empty()},
          {"ignored", std::move(ignored)}, {"remarks", file.remarks}};
}

Json singularities_json(const Surface& surface, int n, const std::vector<IndexSum>& sums,
                        const std::vector<Singularity>& singularities) {
  std::int64_t sum = 0, expected = 0, positive = 0;
  for (const IndexSum& i : sums) {
    sum += i.sum;
    expected += i.expected;
  }
  Json list = Json::array();
  for (const Singularity& s : singularities) {
    positive += s.index > 0;
    list.push_back(
        singularity_json(s, position(surface, s), surface.topology().face_component[static_cast<std::size_t>(s.face)]));
  }
  return {{"count", singularities.size()},
          {"positive", positive},
          {"negative", integer(singularities.size()) - positive},
          {"denominator", n},
          {"index_sum", sum},
          {"expected", expected},
          {"index_sum_nths", sum},
          {"expected_nths", expected},
          {"list", std::move(list)}};
}

Json mesh_json(const Surface& surface) {
  const Mesh& mesh = surface.mesh();
  const Topology& topology = surface.topology();
  const Geometry& geometry = surface.geometry();
  std::int64_t genus = 0;
  for (const ComponentInfo& part : topology.components) genus += part.genus;
  const Spread length = spread(mesh.edges(), [&](std::int64_t e) { return geometry.lengths()[e]; });
  const Spread angle = spread(mesh.halfedges(), [&](std::int64_t c) { return geometry.angles()[c]; });
  return {{"vertices", mesh.vertices()},
          {"faces", mesh.faces()},
          {"edges", mesh.edges()},
          {"components", topology.components.size()},
          {"boundary_loops", topology.loops.size()},
          {"boundary_edges", mesh.boundary_edges()},
          {"euler", topology.euler()},
          {"genus", genus},
          {"unreferenced_vertices", mesh.vertices() - mesh.referenced_vertices()},
          {"area", number(geometry.total_area())},
          {"edge_length_min", number(length.least)},
          {"edge_length_mean", number(length.sum / static_cast<double>(mesh.edges()))},
          {"edge_length_max", number(length.most)},
          {"angle_min_degrees", number(angle.least * 180 / pi<double>)},
          {"angle_max_degrees", number(angle.most * 180 / pi<double>)}};
}

Json triangulation_json(const SolvedTriangulation& t, const ConnectionOptions& options) {
  Json cones = Json::array();
  for (const Cone& c : t.cones) cones.push_back({{"vertex", c.vertex}, {"index", number(c.index)}});
  return {{"before", quality_json(t.before)},
          {"after", quality_json(t.after)},
          {"flips", t.flips},
          {"added_vertices", t.added},
          {"faces", t.faces},
          {"barred", t.barred},
          {"complete", t.complete},
          {"singularities", t.singularities},
          {"seconds", number(t.seconds)},
          {"connection",
           {{"kind", name(ConnectionChoice{options.kind, options.polar.center})},
            {"cones", cones},
            {"generator_holonomy", numbers(t.generator_holonomy)},
            {"loop_index", numbers(t.loop_index)},
            {"D_T", number(t.connection.D_T)},
            {"D_E", number(t.connection.D_E)},
            {"iterations", t.connection.iterations},
            {"residual", number(t.connection.residual)},
            {"converged", t.connection.converged},
            {"message", in_flags(t.connection.message)}}}};
}

Json connection_json(const ConnectedSurface& surface, const ConnectionOptions& options) {
  const Connection& connection = surface.connection();
  const std::int64_t faces = surface.mesh().faces();
  const Spread density = spread(faces, [&](std::int64_t t) { return connection.K[t] / surface.geometry().areas()[t]; });
  const Spread curvature = spread(faces, [&](std::int64_t t) { return connection.K[t]; });
  const ConnectionReport& report = connection.report;
  return {{"kind", name(ConnectionChoice{options.kind, options.polar.center})},
          {"detail", number(options.global.detail)},
          {"length_factor", name(options.global.length_factor)},
          {"tan_cap", number(options.global.tan_cap)},
          {"generator_holonomy", numbers(connection.generator_holonomy)},
          {"loop_index", numbers(connection.loop_index)},
          {"D_T", number(report.D_T)},
          {"D_E", number(report.D_E)},
          {"K_min_over_area", number(density.least)},
          {"K_max_over_area", number(density.most)},
          {"K_sum", number(curvature.sum)},
          {"iterations", report.iterations},
          {"residual", number(report.residual)},
          {"converged", report.converged},
          {"message", in_flags(report.message)}};
}

Json remarks_json(const std::vector<Remark>& remarks, bool warnings) {
  Json list = Json::array();
  for (const Remark& r : remarks) {
    if (r.warning != warnings) continue;
    list.push_back({{"code", r.code}, {"message", in_flags(r.message)}, {"count", r.count}, {"first", r.first}});
  }
  return list;
}

Json curves_json(const CurveSet& curves) {
  Json ends = Json::object();
  for (const auto* reasons : {&curves.start_reason, &curves.end_reason})
    for (const CurveEnd end : *reasons) ends[std::string(name(end))] = ends.value(std::string(name(end)), 0) + 1;
  return {{"count", curves.size()}, {"points", curves.points.rows()}, {"complete", curves.complete}, {"ends", ends}};
}

Remark curves_cut_short() {
  return {.code = "curves_cut_short",
          .message =
              "curves are missing or end early, because they would have too many points: faces are so thin that "
              "curves wind around them, the spacing is too small, or n is too large"};
}

Json defects_json(const std::vector<DefectReport>& defects) {
  Json list = Json::array();
  for (const DefectReport& d : defects) {
    list.push_back({{"defect", name(d.defect)},
                    {"element", name(d.element)},
                    {"count", d.count},
                    {"first", d.first},
                    {"message", in_flags(d.message)}});
  }
  return list;
}

Json times_json(const FieldTimes& times, const RunSeconds& seconds) {
  return {{"read", number(seconds.read)},           {"mesh", number(times.mesh)},
          {"connection", number(times.connection)}, {"assembly", number(times.assembly)},
          {"eigen", number(times.eigen)},           {"analysis", number(times.analysis)},
          {"write", number(seconds.write)},         {"total", number(seconds.total)}};
}

Json field_report(const std::filesystem::path& path, const MeshFile& file, const FieldRun& run,
                  const FieldRunOptions& options) {
  const Certificate& certificate = run.certificate;
  Json report = report_head("field", certificate.holds() && !(run.features && !run.features->followed));
  report["input"] = input_json(path, file);
  report["options"] = options_json(options);
  report["mesh"] = mesh_json(run.surface);
  ConnectionOptions connection = options.connection;
  if (run.triangulation) connection.kind = run.connection().kind;
  report["connection"] = connection_json(run.surface, connection);
  if (run.triangulation) report["triangulation"] = triangulation_json(*run.triangulation, options.connection);
  report["eigen"] = eigen_summary(run, options);
  if (options.modes > 1) report["modes"] = modes_json(run.modes);
  report["singularities"] = singularities_json(run.surface, run.field.n, run.index_sums, run.singularities);
  report["components"] = components_json(run);
  report["certificate"] = {{"connection_converged", certificate.connection_converged},
                           {"eigen_converged", certificate.eigen_converged},
                           {"residual_small", certificate.residual_small},
                           {"index_sums_match", certificate.index_sums_match},
                           {"finite", certificate.finite},
                           {"smallest", name(certificate.smallest)},
                           {"angle_degrees", optional_number(certificate.angle)},
                           {"angle_check", name(certificate.angle_check)}};
  if (run.features) {
    report["certified"] = certificate.holds();
    report["certificate"]["directions_settled"] = certificate.directions_settled;
    const FieldAlignment& align = *options.align;
    report["alignment"] = alignment_json(*run.features, {.angle_degrees = align.features.angle * 180 / pi<double>,
                                                         .boundary = align.features.boundary,
                                                         .across = align.across,
                                                         .weight = align.weight,
                                                         .hold = align.weight == 0});
  }
  report["repaired"] = {{"copies_of", run.copies_of}, {"face_of", run.face_of}};
  report["warnings"] = remarks_json(run.remarks, true);
  report["notes"] = remarks_json(run.remarks, false);
  report["peak_memory_bytes"] = peak_memory_bytes();
  return report;
}

std::string smallest_text(const Json& certificate, const Json& eigen, bool one_piece) {
  const auto word = certificate["smallest"].get<std::string>();
  if (word == "proven")
    return one_piece ? fmt::format("proven: no eigenvalue lies below {:.7g}", eigen["lower_bound"].get<double>())
                     : "proven on every component";
  const auto note = eigen["smallest_note"].get<std::string>();
  return word + (note.empty() || !one_piece ? "" : fmt::format(" ({})", note));
}

std::string summary_line(std::string_view label, const std::string& value) {
  return fmt::format("{:<14}{}\n", label, value);
}

std::string triangulation_summary(const Json& t) {
  return summary_line(
      "triangles",
      fmt::format("solved on intrinsic ones: {} flips, {} vertices added, smallest angle {} "
                  "degrees instead of {}; connection {}, {} iterations",
                  grouped(t["flips"].get<std::int64_t>()), grouped(t["added_vertices"].get<std::int64_t>()),
                  short_text(t["after"]["angle_min_degrees"]), short_text(t["before"]["angle_min_degrees"]),
                  t["connection"]["kind"].get<std::string>(),
                  grouped(t["connection"]["iterations"].get<std::int64_t>())));
}

std::string alignment_summary(const Json& alignment) {
  const Json& all = alignment["all"];
  const auto count = [](const Json& value) { return grouped(value.get<std::int64_t>()); };
  const std::int64_t edges = all["edges"].get<std::int64_t>() + all["corner_edges"].get<std::int64_t>();
  const std::string text =
      summary_line("features", fmt::format("{} edges in {} lines, {} corners ({} free)", grouped(edges),
                                           grouped(integer(alignment["lines"].size())), count(alignment["corners"]),
                                           count(alignment["free_corners"])));
  return text + summary_line("deviation",
                             fmt::format("mean {}, 95 % below {}, worst {} degrees off corners; {} at "
                                         "corners; {} singularities on features, {} at corners",
                                         short_text(all["mean_degrees"]), short_text(all["p95_degrees"]),
                                         short_text(all["worst_degrees"]), short_text(all["corner_worst_degrees"]),
                                         count(all["singularities"]), count(alignment["singularities_at_corners"])));
}

std::string short_text(const Json& value) {
  return value.is_null() ? "not finite" : fmt::format("{:.4g}", value.get<double>());
}

std::string summary_end(const Json& report) {
  std::string text, files;
  if (report.contains("input"))
    for (const Json& r : report["input"]["remarks"]) text += summary_line("file", r.get<std::string>());
  for (const Json& w : report["warnings"]) text += summary_line("warning", w["message"].get<std::string>());
  for (const Json& w : report["notes"]) text += summary_line("note", w["message"].get<std::string>());
  for (const Json& f : report["files"]) files += (files.empty() ? "" : ", ") + f.get<std::string>();
  if (!files.empty()) text += summary_line("wrote", files);
  const bool certified = report.value("certified", report["ok"].get<bool>());
  text += summary_line("certificate", certified ? "holds" : "DOES NOT HOLD, see the warnings");
  if (report.contains("met")) text += summary_line("design", report["met"].get<bool>() ? "met" : "NOT MET everywhere");
  return text;
}

std::string complaint(const std::string& head, const std::vector<Remark>& remarks) {
  std::string text = head;
  for (const Remark& r : remarks)
    if (r.warning) text += " " + in_flags(r.message) + ".";
  return text;
}

std::string grouped(std::int64_t value) {
  const std::string digits = std::to_string(value);
  std::string text;
  for (std::size_t k = 0; k < digits.size(); ++k) {
    if (k > 0 && (digits.size() - k) % 3 == 0 && digits[k - 1] != '-') text += ',';
    text += digits[k];
  }
  return text;
}

}  // namespace alcap::app
