// SPDX-License-Identifier: MIT
//
// design_report.cpp: what was asked of a design and what came of it.
#include "apps/alcap/report/design_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "alcap/operators.h"
#include "apps/alcap/report/report.h"

namespace alcap::app {
namespace {

constexpr double degrees = 180 / pi<double>;
// A pinned zero is met when the field there is no longer than this, relative to the corners of its face.
constexpr double pinned = 1e-6;
// Cones are exact up to rounding; in turns.
constexpr double cone_tolerance = 1e-6;

Json triple(const std::array<double, 3>& x) { return {number(x[0]), number(x[1]), number(x[2])}; }

Json point(const Eigen::RowVector3d& x) { return {number(x[0]), number(x[1]), number(x[2])}; }

/// How many turns of the pattern by 360 degrees / turns look the same.
int symmetry(int n, int index) { return std::max(1, std::abs(n - index)); }

Json head(const std::string& path, const std::string& name, const char* type) {
  return {{"path", path}, {"name", name}, {"type", type}};
}

/// The angle that looks like `angle` and is nearest to `asked`, in degrees.
double nearest_angle(double angle, double asked, double period) {
  return asked + std::remainder(angle - asked, period);
}

void singularity(const DesignRun& d, std::size_t k, const ControlReport& report, Json& json) {
  const DesignSingularity& s = d.design.singularities[k];
  const auto& target = std::get<SingularityTarget>(d.controls[k].control);
  const double asked = target.orientation * degrees;
  json["asked"] = {{"kind", name(s.kind)},           {"face", s.face},
                   {"index", target.sign},           {"angle_degrees", number(asked)},
                   {"strength", number(s.strength)}, {"pin", target.pin ? triple(*target.pin) : Json(nullptr)}};
  json["achieved"] = {{"index", report.index}, {"angle_degrees", nullptr}, {"barycentric", nullptr}};
  bool met = report.met;
  for (const Singularity& found : d.run.singularities) {
    if (found.face != s.face) continue;
    const double period = 360.0 / symmetry(d.design.n, found.index);
    json["achieved"]["angle_degrees"] = number(nearest_angle(found.orientation * degrees, asked, period));
    json["achieved"]["barycentric"] = triple(found.barycentric);
  }
  if (target.pin) {
    const ComplexVectorX<double>& u = d.run.field.u;
    const auto there = face_field(d.run.surface, d.design.n, u, s.face).at(*target.pin);
    double size = 0;
    for (Index c = 0; c < 3; ++c) size = std::max(size, std::abs(u[d.run.mesh().F()(s.face, c)]));
    const double left = size > 0 ? std::abs(there.u) / size : 0;
    json["achieved"]["length_at_pin"] = number(left);
    met = met && left <= pinned;
  }
  json["error_degrees"] = number(report.error_degrees);
  json["met"] = met;
}

void fixed(const DesignRun& d, std::size_t k, const VertexConstraint& constraint, const ControlReport& report,
           Json& json) {
  const DesignFixed& f = d.design.fixed[k];
  const auto frames = *d.run.field.frames;
  const int n = d.design.n;
  // Of the n branches, the one nearest to what was asked.
  const Complex<double> u = d.run.field.u[f.vertex];
  const double asked = std::arg(constraint.value) / n;
  const double achieved = nearest_angle(std::arg(u) / n, asked, 2 * pi<double> / n);
  json["asked"] = {{"vertex", f.vertex},
                   {"direction", point(frames.vector(f.vertex, std::polar(1.0, asked)))},
                   {"length", f.free_length ? Json("free") : number(f.length)}};
  json["achieved"] = {{"direction", point(frames.vector(f.vertex, std::polar(1.0, achieved)))},
                      {"length", number(std::abs(u))}};
  json["error_degrees"] = number(report.error_degrees);
  json["met"] = report.met;
}

/// Curvature that the connection gives every vertex, in turns: 1 - (sum of the corner angles it sees) / 2 pi.
VectorX<double> vertex_turns(const FieldRun& run) {
  VectorX<double> turns = VectorX<double>::Ones(run.mesh().vertices());
  const auto& alpha = run.connection().alpha;
  for (Index t = 0; t < run.mesh().faces(); ++t) {
    for (Index h = 3 * t; h < 3 * t + 3; ++h) {
      const double turned = alpha.size() ? alpha[h] - alpha[Mesh::prev(h)] : 0.0;
      turns[run.mesh().tail(h)] -= (run.geometry().angles()[h] + turned) / (2 * pi<double>);
    }
  }
  return turns;
}

std::string degrees_text(const Json& x) {
  return x.is_null() ? "a number that is not finite" : fmt::format("{:.3g} degrees", x.get<double>());
}

std::string plural(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

std::string control_text(const Json& c) {
  const Json& asked = c["asked"];
  const std::string type = c["type"];
  if (type == "singularity")
    return fmt::format("{} (index {}) in face {}, angle {:.4g}, strength {:.4g}{}", asked["kind"].get<std::string>(),
                       asked["index"].get<int>(), asked["face"].get<Index>(), asked["angle_degrees"].get<double>(),
                       asked["strength"].get<double>(), asked["pin"].is_null() ? "" : ", pinned");
  if (type == "fixed") return fmt::format("vertex {} fixed", asked["vertex"].get<Index>());
  if (type == "stroke")
    return fmt::format("stroke of {} points, weight {:.4g}", asked["points"].get<std::size_t>(),
                       asked["weight"].get<double>());
  if (type == "boundary")
    return fmt::format("boundary {}, weight {:.4g}", asked["align"].get<std::string>(), asked["weight"].get<double>());
  return fmt::format("cone of index {:.6g} at vertex {}", asked["index"].get<double>(), asked["vertex"].get<Index>());
}

Json stroke_json(const DesignStroke& s) {
  return {{"points", s.points.size() + s.vertices.size()}, {"weight", number(s.weight)}, {"radius", number(s.radius)}};
}

Json boundary_json(const DesignBoundary& b) {
  return {{"align", b.normal ? "normal" : "tangent"}, {"weight", number(b.weight)}};
}

}  // namespace

Json controls_json(const DesignRun& d) {
  Json list = Json::array();
  const std::size_t singularities = d.design.singularities.size(), fixes = d.design.fixed.size();
  for (std::size_t k = 0; k < d.controls.size(); ++k) {
    const DesignControl& c = d.controls[k];
    const ControlReport& report = d.result.controls.at(k);
    Json json;
    if (k < singularities) {
      json = head(c.path, c.name, "singularity");
      singularity(d, k, report, json);
    } else if (const auto* constraint = std::get_if<VertexConstraint>(&c.control)) {
      json = head(c.path, c.name, "fixed");
      fixed(d, k - singularities, *constraint, report, json);
    } else {
      const bool boundary = std::holds_alternative<BoundaryAlignment>(c.control);
      json = head(c.path, c.name, boundary ? "boundary" : "stroke");
      json["asked"] =
          boundary ? boundary_json(d.design.boundary) : stroke_json(d.design.strokes[k - singularities - fixes]);
      if (!boundary) json["asked"]["faces"] = std::get<Stroke>(c.control).line.segments.size();
      json["achieved"] = {{"mean_deviation_degrees", number(report.error_degrees)}};
      json["error_degrees"] = number(report.error_degrees);
      json["met"] = report.met;
    }
    list.push_back(std::move(json));
  }
  const auto& cones = d.design.connection.cones;
  if (cones.empty()) return list;
  const VectorX<double> turns = vertex_turns(d.run);
  for (std::size_t k = 0; k < cones.size(); ++k) {
    // Several entries for one vertex add up.
    double asked = 0;
    for (const Cone& c : cones) asked += c.vertex == cones[k].vertex ? c.index : 0.0;
    const double error = std::abs(turns[cones[k].vertex] - asked);
    Json json = head(fmt::format("/connection/cones/{}", k), fmt::format("cone at vertex {}", cones[k].vertex), "cone");
    json["asked"] = {{"vertex", cones[k].vertex}, {"index", number(asked)}};
    json["achieved"] = {{"index", number(turns[cones[k].vertex])}};
    json["error_degrees"] = number(error * 360);
    json["met"] = error <= cone_tolerance;
    list.push_back(std::move(json));
  }
  return list;
}

std::vector<Remark> unmet_remarks(const Json& controls) {
  std::vector<Remark> remarks;
  for (const Json& c : controls) {
    if (c["met"].get<bool>()) continue;
    const Json &asked = c["asked"], &achieved = c["achieved"];
    const std::string type = c["type"];
    std::string what = "off by " + degrees_text(c["error_degrees"]);
    Remark remark{.code = "control_not_met", .count = 1};
    if (type == "singularity") {
      remark.first = {asked["face"].get<Index>()};
      if (asked["index"] != achieved["index"])
        what = fmt::format("face {} has index {} instead of {}", asked["face"].get<Index>(),
                           achieved["index"].get<int>(), asked["index"].get<int>());
      what += "; more strength, less guidance or fewer controls nearby help";
    } else if (type == "stroke" || type == "boundary") {
      what += " on average; more weight helps";
    } else {
      remark.first = {asked["vertex"].get<Index>()};
    }
    remark.message =
        fmt::format("{} ({}) is not met: {}", c["name"].get<std::string>(), c["path"].get<std::string>(), what);
    remarks.push_back(std::move(remark));
  }
  return remarks;
}

Json design_json(const DesignFile& design) { return Json::parse(design_text(design)); }

Json plan_json(const DesignFile& placed, const Mesh& mesh) {
  Json list = Json::array();
  std::size_t exact = 0;
  for (std::size_t k = 0; k < placed.singularities.size(); ++k) {
    const DesignSingularity& s = placed.singularities[k];
    exact += s.pin;
    Json json = head(fmt::format("/singularities/{}", k), s.name, "singularity");
    json["asked"] = {{"kind", name(s.kind)},
                     {"face", s.face},
                     {"index", index_of(s.kind)},
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
  for (std::size_t k = 0; k < placed.connection.cones.size(); ++k) {
    const Cone& c = placed.connection.cones[k];
    Json json = head(fmt::format("/connection/cones/{}", k), "", "cone");
    json["asked"] = {{"vertex", c.vertex}, {"index", number(c.index)}};
    list.push_back(std::move(json));
  }
  return {{"n", placed.n},
          {"faces", mesh.faces()},
          {"unknowns", mesh.referenced_vertices()},
          {"connection", name(placed.connection.kind, placed.connection.center)},
          {"method", placed.method == DesignMethod::eigen ? "eigen" : "variational"},
          {"energy", number(placed.s)},
          {"guidance", placed.guidance.source == DesignGuidance::Source::file ? placed.guidance.file.string()
                                                                              : name(placed.guidance.source)},
          {"guidance_weight", placed.guidance.source == DesignGuidance::Source::none || placed.guidance.t
                                  ? Json(0)
                                  : number(placed.guidance.weight)},
          {"guidance_t", placed.guidance.t ? number(*placed.guidance.t) : Json(nullptr)},
          {"exact_rows", exact},
          {"controls", std::move(list)}};
}

std::string plan_text(const Json& plan) {
  std::string text;
  const auto line = [&](const char* label, const std::string& value) {
    text += fmt::format("{:<14}{}\n", label, value);
  };
  const std::string guidance = plan["guidance"];
  line("field", fmt::format("n = {}: one complex number at each of {} vertices, {} faces", plan["n"].get<int>(),
                            grouped(plan["unknowns"].get<std::int64_t>()), grouped(plan["faces"].get<std::int64_t>())));
  line("connection", plan["connection"].get<std::string>());
  const bool eigen = plan["method"] == "eigen", by_t = !plan["guidance_t"].is_null();
  line("guidance", guidance == "none" ? "none"
                   : by_t             ? fmt::format("{}, t = {:.4g}", guidance, plan["guidance_t"].get<double>())
                          : fmt::format("{}, weight {:.4g}", guidance, plan["guidance_weight"].get<double>()));
  line("system", eigen                ? "S u = lambda M u, with terms of strokes and singularities in both"
                 : guidance == "none" ? "2 S u = targets"
                 : by_t               ? "2 (S - lambda_t M) u = targets + w M u0"
                                      : "(2 S + w M) u = targets + w M u0");
  if (!eigen)
    line("rows", fmt::format("{} exact (pins, fixed vertices), softly one for each face that a stroke crosses",
                             plan["exact_rows"].get<std::size_t>()));
  line("controls", plural(plan["controls"].size(), "control", "controls"));
  for (const Json& c : plan["controls"]) {
    const std::string given = c["name"];
    line("", fmt::format("{}: {}{}", c["path"].get<std::string>(), control_text(c),
                         given.empty() ? "" : " \"" + given + "\""));
  }
  return text;
}

std::string design_summary(const Json& report) {
  const Json &mesh = report["mesh"], &solve = report["solve"], &singular = report["singularities"];
  std::string text;
  const auto line = [&](const char* label, const std::string& value) {
    text += fmt::format("{:<14}{}\n", label, value);
  };
  const auto real = [](const Json& value) {
    return value.is_null() ? "not finite" : fmt::format("{:.4g}", value.get<double>());
  };
  line("mesh", fmt::format("{} vertices, {} faces, {} component(s), {} boundary loop(s)",
                           grouped(mesh["vertices"].get<std::int64_t>()), grouped(mesh["faces"].get<std::int64_t>()),
                           mesh["components"].get<int>(), mesh["boundary_loops"].get<int>()));
  line("field",
       fmt::format("n = {}, {}, connection {}, guidance {}, {} rows, residual {}", report["design"]["n"].get<int>(),
                   solve["method"].get<std::string>(), report["connection"]["kind"].get<std::string>(),
                   report["guidance"]["field"].get<std::string>(), solve["rows"].get<int>(), real(solve["residual"])));
  for (const Json& c : report["controls"])
    line(c["met"].get<bool>() ? "met" : "NOT MET",
         fmt::format("{}: {}, off by {} degrees", c["path"].get<std::string>(), control_text(c),
                     real(c["error_degrees"])));
  line("singularities",
       fmt::format("{}: {} positive, {} negative; indices sum to {}/{}, expected {}/{}", singular["count"].get<int>(),
                   singular["positive"].get<int>(), singular["negative"].get<int>(), singular["index_sum"].get<int>(),
                   singular["denominator"].get<int>(), singular["expected"].get<int>(),
                   singular["denominator"].get<int>()));
  line("time", fmt::format("{:.2f} s", report["times"]["total"].get<double>()));
  return text + summary_end(report);
}

}  // namespace alcap::app
