// SPDX-License-Identifier: MIT
//
// design_report.cpp: what was asked of a design and what came of it.
#include "apps/alcap/report/design_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "apps/alcap/report/report.h"
#include "src/base/index_text.h"
#include "src/base/numbers.h"

namespace alcap::app {
namespace {

constexpr double degrees = 180 / pi<double>;
Json triple(const std::array<double, 3>& x) { return {number(x[0]), number(x[1]), number(x[2])}; }

Json point(const Eigen::RowVector3d& x) { return {number(x[0]), number(x[1]), number(x[2])}; }

/// How many turns of the pattern by 360 degrees / turns look the same.
int symmetry(int n, int index) { return std::max(1, std::abs(n - index)); }

Json head(const std::string& path, const std::string& name, const char* type) {
  return {{"path", path}, {"name", name}, {"type", type}};
}

const char* type_name(DesignOutcome::Type type) {
  switch (type) {
    case DesignOutcome::Type::singularity:
      return "singularity";
    case DesignOutcome::Type::fixed:
      return "fixed";
    case DesignOutcome::Type::stroke:
      return "stroke";
    case DesignOutcome::Type::boundary:
      return "boundary";
    case DesignOutcome::Type::cone:
      return "cone";
    case DesignOutcome::Type::features:
      return "features";
  }
  return "";
}

/// The angle that looks like `angle` and is nearest to `asked`, in degrees.
double nearest_angle(double angle, double asked, double period) {
  return asked + std::remainder(angle - asked, period);
}

void singularity(const DesignRun& run, const DesignOutcome& outcome, Json& json) {
  const DesignSingularity& s = run.design.singularities[outcome.number];
  const auto& target = std::get<SingularityTarget>(*outcome.control);
  const double asked = target.orientation * degrees;
  json["asked"] = {{"kind", name(s.kind)},
                   {"face", s.face},
                   {"index", target.sign * target.count},
                   {"index_nths", target.sign * target.count},
                   {"angle_degrees", number(asked)},
                   {"strength", number(s.strength)},
                   {"pin", target.pin ? triple(*target.pin) : Json(nullptr)}};
  json["achieved"] = {{"index", outcome.index},
                      {"index_nths", outcome.index},
                      {"angle_degrees", nullptr},
                      {"barycentric", nullptr},
                      {"xyz", nullptr}};
  if (outcome.found && target.count == 1) {
    const double period = 360.0 / symmetry(run.design.n, outcome.found->index);
    json["achieved"]["angle_degrees"] = number(nearest_angle(outcome.found->orientation * degrees, asked, period));
    json["achieved"]["barycentric"] = triple(outcome.found->barycentric);
    json["achieved"]["xyz"] = point(position(run.surface, *outcome.found));
  }
  if (target.pin) json["achieved"]["length_at_pin"] = number(outcome.length_at_pin);
}

void fixed(const DesignRun& run, const DesignOutcome& outcome, Json& json) {
  const DesignFixed& f = run.design.fixed[outcome.number];
  const auto& constraint = std::get<VertexConstraint>(*outcome.control);
  const Frames& frames = *run.field.frames;
  const int n = run.design.n;
  // Of the n branches, the one nearest to what was asked.
  const Complex<double> u = run.field.u[f.vertex];
  const double asked = std::arg(constraint.value) / n;
  const double achieved = nearest_angle(std::arg(u) / n, asked, 2 * pi<double> / n);
  json["asked"] = {{"vertex", f.vertex},
                   {"xyz", point(run.surface.V().row(f.vertex))},
                   {"direction", point(frames.vector(f.vertex, std::polar(1.0, asked)))},
                   {"length", f.free_length ? Json("free") : number(f.length)}};
  json["achieved"] = {{"direction", point(frames.vector(f.vertex, std::polar(1.0, achieved)))},
                      {"length", number(std::abs(u))}};
}

void cone(const DesignRun& run, const DesignOutcome& outcome, Json& json) {
  json["asked"] = {{"vertex", run.design.connection.cones[outcome.number].vertex},
                   {"index", number(outcome.cone_asked)}};
  json["achieved"] = {{"index", number(outcome.cone_index)}};
}

std::string control_text(const Json& c, int n) {
  const Json& asked = c["asked"];
  const std::string type = c["type"];
  if (type == "singularity")
    return fmt::format("{} (index {}) in face {}, angle {:.4g}, strength {:.4g}{}", asked["kind"].get<std::string>(),
                       detail::turns_text(asked["index_nths"].get<int>(), n), asked["face"].get<Index>(),
                       asked["angle_degrees"].get<double>(), asked["strength"].get<double>(),
                       asked["pin"].is_null() ? "" : ", pinned");
  if (type == "fixed") return fmt::format("vertex {} fixed", asked["vertex"].get<Index>());
  if (type == "stroke")
    return fmt::format("stroke of {} points, weight {:.4g}", asked["points"].get<std::size_t>(),
                       asked["weight"].get<double>());
  if (type == "boundary")
    return fmt::format("boundary {}, weight {:.4g}", asked["align"].get<std::string>(), asked["weight"].get<double>());
  if (type == "features")
    return fmt::format("{} {} feature edges, {}, weight {:.4g}", asked["across"].get<bool>() ? "across" : "along",
                       grouped(asked["edges"].get<std::int64_t>()), asked["hold"].get<bool>() ? "held" : "drawn",
                       asked["weight"].get<double>());
  return fmt::format("cone of index {:.6g} at vertex {}", asked["index"].get<double>(), asked["vertex"].get<Index>());
}

Json stroke_json(const DesignStroke& s) {
  return {{"points", s.points.size() + s.vertices.size()}, {"weight", number(s.weight)}, {"radius", number(s.radius)}};
}

Json boundary_json(const DesignBoundary& b) {
  return {{"align", b.normal ? "normal" : "tangent"}, {"weight", number(b.weight)}};
}

Json features_json(const DesignFeatures& f) {
  return {{"edges", f.edges.size()}, {"across", f.across}, {"hold", f.hold}, {"weight", number(f.weight)}};
}

}  // namespace

Json controls_json(const DesignRun& run) {
  using Type = DesignOutcome::Type;
  Json list = Json::array();
  for (const DesignOutcome& outcome : run.outcomes) {
    Json json = head(outcome.path, outcome.name, type_name(outcome.type));
    switch (outcome.type) {
      case Type::singularity:
        singularity(run, outcome, json);
        break;
      case Type::fixed:
        fixed(run, outcome, json);
        break;
      case Type::stroke:
        json["asked"] = stroke_json(run.design.strokes[outcome.number]);
        json["asked"]["faces"] = std::get<Stroke>(*outcome.control).line.segments.size();
        json["achieved"] = {{"mean_deviation_degrees", number(outcome.error_degrees)}};
        break;
      case Type::boundary:
        json["asked"] = boundary_json(run.design.boundary);
        json["achieved"] = {{"mean_deviation_degrees", number(outcome.error_degrees)}};
        break;
      case Type::features:
        json["asked"] = features_json(run.design.features);
        json["achieved"] = {{"mean_deviation_degrees", number(outcome.error_degrees)}};
        break;
      case Type::cone:
        cone(run, outcome, json);
        break;
    }
    json["error_degrees"] = number(outcome.error_degrees);
    json["tolerance_degrees"] = number(outcome.tolerance_degrees);
    if (outcome.tolerance_relative) json["tolerance_relative"] = number(*outcome.tolerance_relative);
    json["met"] = outcome.met;
    list.push_back(std::move(json));
  }
  return list;
}

Json guidance_json(const DesignRun& run) {
  using Source = DesignGuidance::Source;
  const DesignGuidance& g = run.design.guidance;
  return {{"field", g.source == Source::file ? g.file.string() : std::string(name(g.source))},
          {"weight", g.source == Source::nothing || g.t ? Json(0) : number(g.weight)},
          {"t", g.t ? number(*g.t) : Json(nullptr)},
          {"scale", run.guidance ? number(run.guidance_scale) : Json(nullptr)}};
}

Json solve_json(const DesignRun& run) {
  const bool eigen = run.design.method == DesignMethod::eigen;
  Json lambda = Json::array();
  for (const EigenReport& e : run.eigen) lambda.push_back(number(e.lambda));
  return {{"method", eigen ? "eigen" : "variational"},
          {"rows", run.rows},
          {"residual", number(run.residual)},
          {"lambda", eigen ? std::move(lambda) : Json(nullptr)},
          {"solver", run.solver}};
}

Json design_json(const DesignFile& design) { return Json::parse(design_text(design)); }

Json design_report(const Json& input, const DesignFile& asked, const DesignRun& run,
                   const std::vector<Remark>& remarks) {
  const DesignCertificate& certificate = run.certificate;
  Json report = report_head("design", certificate.holds() && run.met());
  report["input"] = input;
  report["design"] = design_json(asked);
  report["mesh"] = mesh_json(run.surface);
  const ConnectionOptions asked_connection = connection_options(run.design);
  ConnectionOptions connection = asked_connection;
  if (run.triangulation) connection.kind = run.connection().kind;
  report["connection"] = connection_json(run.surface, connection);
  if (run.triangulation) report["triangulation"] = triangulation_json(*run.triangulation, asked_connection);
  report["guidance"] = guidance_json(run);
  report["solve"] = solve_json(run);
  report["controls"] = controls_json(run);
  if (run.features) {
    const DesignFeatures& f = asked.features;
    report["alignment"] = alignment_json(
        *run.features,
        {.angle_degrees = f.angle, .boundary = f.boundary, .across = f.across, .weight = f.weight, .hold = f.hold});
  }
  report["singularities"] = singularities_json(run.surface, run.field.n, run.index_sums, run.singularities);
  report["certificate"] = {{"connection_converged", certificate.connection_converged},
                           {"eigen_converged", certificate.eigen_converged},
                           {"residual_small", certificate.residual_small},
                           {"index_sums_match", certificate.index_sums_match},
                           {"finite", certificate.finite}};
  report["certified"] = certificate.holds();
  report["met"] = run.met();
  report["warnings"] = remarks_json(remarks, true);
  report["notes"] = remarks_json(remarks, false);
  return report;
}

Json plan_json(const DesignFile& placed, const Mesh& mesh) {
  Json list = Json::array();
  std::size_t exact = 0;
  for (std::size_t k = 0; k < placed.singularities.size(); ++k) {
    const DesignSingularity& s = placed.singularities[k];
    exact += s.pin;
    Json json = head(fmt::format("/singularities/{}", k), s.name, "singularity");
    json["asked"] = {{"kind", name(s.kind)},
                     {"face", s.face},
                     {"index", index_of(s.kind) * s.count},
                     {"index_nths", index_of(s.kind) * s.count},
                     {"angle_degrees", number(s.angle)},
                     {"relative_to", s.relative_to ? triple(*s.relative_to) : Json(nullptr)},
                     {"strength", number(s.strength)},
                     {"pin", s.pin ? triple(*s.barycentric) : Json(nullptr)}};
    list.push_back(std::move(json));
  }
  for (std::size_t k = 0; k < placed.fixed.size(); ++k) {
    ++exact;
    Json json = head(fmt::format("/fixed/{}", k), placed.fixed[k].name, "fixed");
    json["asked"] = {{"vertex", placed.fixed[k].vertex}, {"length", number(placed.fixed[k].length)}};
    list.push_back(std::move(json));
  }
  for (std::size_t k = 0; k < placed.strokes.size(); ++k) {
    Json json = head(fmt::format("/strokes/{}", k), placed.strokes[k].name, "stroke");
    json["asked"] = stroke_json(placed.strokes[k]);
    list.push_back(std::move(json));
  }
  if (placed.boundary.wanted) {
    Json json = head("/boundary", "", "boundary");
    json["asked"] = boundary_json(placed.boundary);
    list.push_back(std::move(json));
  }
  if (placed.features.wanted) {
    Json json = head("/features", "", "features");
    json["asked"] = features_json(placed.features);
    list.push_back(std::move(json));
  }
  for (std::size_t k = 0; k < placed.connection.cones.size(); ++k) {
    const Cone& c = placed.connection.cones[k];
    Json json = head(fmt::format("/connection/cones/{}", k), "", "cone");
    json["asked"] = {{"vertex", c.vertex}, {"index", number(c.index)}};
    list.push_back(std::move(json));
  }
  return {{"n", placed.n},
          {"faces", mesh.faces()},
          {"unknowns", mesh.referenced_vertices()},
          {"connection", name(ConnectionChoice{placed.connection.kind, placed.connection.center})},
          {"method", placed.method == DesignMethod::eigen ? "eigen" : "variational"},
          {"energy", number(placed.s)},
          {"guidance", placed.guidance.source == DesignGuidance::Source::file ? placed.guidance.file.string()
                                                                              : name(placed.guidance.source)},
          {"guidance_weight", placed.guidance.source == DesignGuidance::Source::nothing || placed.guidance.t
                                  ? Json(0)
                                  : number(placed.guidance.weight)},
          {"guidance_t", placed.guidance.t ? number(*placed.guidance.t) : Json(nullptr)},
          {"exact_rows", exact},
          {"controls", std::move(list)}};
}

std::string plan_text(const Json& plan) {
  std::string text;
  const auto line = [&](const char* label, const std::string& value) { text += summary_line(label, value); };
  const std::string guidance = plan["guidance"];
  line("field", fmt::format("n = {}: one complex number at each of {} vertices, {} faces", plan["n"].get<int>(),
                            grouped(plan["unknowns"].get<std::int64_t>()), grouped(plan["faces"].get<std::int64_t>())));
  line("connection", plan["connection"].get<std::string>());
  const bool eigen = plan["method"] == "eigen", by_t = !plan["guidance_t"].is_null();
  line("guidance", guidance == "none" ? "none"
                   : by_t             ? fmt::format("{}, t = {:.4g}", guidance, plan["guidance_t"].get<double>())
                          : fmt::format("{}, weight {:.4g}", guidance, plan["guidance_weight"].get<double>()));
  line("system", eigen                ? "S u = lambda M u, with terms of strokes, singularities and guidance in both"
                 : guidance == "none" ? "2 S u = targets"
                 : by_t               ? "2 (S - lambda_t M) u = targets + w M u0"
                                      : "(2 S + w M) u = targets + w M u0");
  if (!eigen)
    line("rows", fmt::format("{} exact (pins, fixed vertices), softly one for each face that a stroke crosses",
                             plan["exact_rows"].get<std::size_t>()));
  line("controls", detail::counted(plan["controls"].size(), "control", "controls"));
  for (const Json& c : plan["controls"]) {
    const std::string given = c["name"];
    line("", fmt::format("{}: {}{}", c["path"].get<std::string>(), control_text(c, plan["n"].get<int>()),
                         given.empty() ? "" : " \"" + given + "\""));
  }
  return text;
}

std::string design_summary(const Json& report) {
  const Json &mesh = report["mesh"], &solve = report["solve"], &singular = report["singularities"];
  std::string text;
  const auto line = [&](const char* label, const std::string& value) { text += summary_line(label, value); };
  line("mesh", fmt::format("{} vertices, {} faces, {} component(s), {} boundary loop(s)",
                           grouped(mesh["vertices"].get<std::int64_t>()), grouped(mesh["faces"].get<std::int64_t>()),
                           mesh["components"].get<int>(), mesh["boundary_loops"].get<int>()));
  line("field",
       fmt::format("n = {}, {}, connection {}, guidance {}, {} rows, residual {}", report["design"]["n"].get<int>(),
                   solve["method"].get<std::string>(), report["connection"]["kind"].get<std::string>(),
                   report["guidance"]["field"].get<std::string>(), solve["rows"].get<int>(),
                   short_text(solve["residual"])));
  if (report.contains("triangulation")) text += triangulation_summary(report["triangulation"]);
  if (report.contains("alignment")) text += alignment_summary(report["alignment"]);
  const int n = singular["denominator"];
  for (const Json& c : report["controls"])
    line(c["met"].get<bool>() ? "met" : "NOT MET",
         fmt::format("{}: {}, off by {} degrees", c["path"].get<std::string>(), control_text(c, n),
                     short_text(c["error_degrees"])));
  line("singularities",
       fmt::format("{}: {} positive, {} negative; indices sum to {}, expected {}", singular["count"].get<int>(),
                   singular["positive"].get<int>(), singular["negative"].get<int>(),
                   detail::turns_text(singular["index_sum"], n), detail::turns_text(singular["expected"], n)));
  line("time", fmt::format("{:.2f} s", report["times"]["total"].get<double>()));
  return text + summary_end(report);
}

}  // namespace alcap::app
