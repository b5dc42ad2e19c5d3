// SPDX-License-Identifier: MIT
#include <fmt/core.h>

#include <algorithm>

#include "apps/alcap/report/design_report.h"
#include "apps/alcap/report/report.h"
#include "apps/alcap_mpi/report.h"

namespace alcap::app {
namespace {

using Type = DesignOutcome::Type;

Json triple(const std::array<double, 3>& x) { return {number(x[0]), number(x[1]), number(x[2])}; }

void singularity(const DistributedDesign& d, const DesignOutcome& outcome, Json& json) {
  const DesignSingularity& s = d.design.singularities[outcome.number];
  const auto& target = std::get<SingularityTarget>(*outcome.control);
  json["type"] = "singularity";
  json["asked"] = {{"kind", name(s.kind)},
                   {"face", s.face},
                   {"index", target.sign * target.count},
                   {"index_nths", target.sign * target.count},
                   {"angle_degrees", number(target.orientation * 180 / pi<double>)},
                   {"strength", number(s.strength)},
                   {"pin", target.pin ? triple(*target.pin) : Json(nullptr)}};
  json["achieved"] = {{"index", outcome.index},
                      {"index_nths", outcome.index},
                      {"barycentric", outcome.found ? triple(outcome.found->barycentric) : Json(nullptr)}};
  if (target.pin) json["achieved"]["length_at_pin"] = number(outcome.length_at_pin);
}

Json control_json(const DistributedDesign& d, const DesignOutcome& outcome) {
  Json json = {{"path", outcome.path}, {"name", outcome.name}};
  const Json deviation = {{"mean_deviation_degrees", number(outcome.error_degrees)}};
  if (outcome.type == Type::singularity) {
    singularity(d, outcome, json);
  } else if (outcome.type == Type::fixed) {
    const DesignFixed& f = d.design.fixed[outcome.number];
    json["type"] = "fixed";
    json["asked"] = {{"vertex", f.vertex}, {"length", f.free_length ? Json("free") : number(f.length)}};
  } else if (outcome.type == Type::stroke) {
    const DesignStroke& s = d.design.strokes[outcome.number];
    json["type"] = "stroke";
    json["asked"] = {{"points", s.points.size() + s.vertices.size()}, {"weight", number(s.weight)}};
    json["achieved"] = deviation;
  } else if (outcome.type == Type::cone) {
    json["type"] = "cone";
    json["asked"] = {{"vertex", d.cones[outcome.number].vertex}, {"index", number(outcome.cone_asked)}};
    json["achieved"] = {{"index", number(outcome.cone_index)}};
  } else {
    const DesignBoundary& b = d.design.boundary;
    json["type"] = "boundary";
    json["asked"] = {{"align", b.normal ? "normal" : "tangent"}, {"weight", number(b.weight)}};
    json["achieved"] = deviation;
  }
  json["error_degrees"] = number(outcome.error_degrees);
  json["tolerance_degrees"] = number(outcome.tolerance_degrees);
  if (outcome.tolerance_relative) json["tolerance_relative"] = number(*outcome.tolerance_relative);
  json["met"] = outcome.met;
  return json;
}

}  // namespace

Json distributed_report(const std::string& path, const MeshSlice& mesh, const DesignFile& asked,
                        const DistributedDesign& design) {
  const DesignCertificate& c = design.certificate;
  const DesignGuidance& g = design.design.guidance;
  Json report = report_head("design", c.holds() && design.met());
  report["design"] = design_json(asked);
  add_field(path, mesh, design, report);
  report["guidance"] = {{"field", name(g.source)},
                        {"weight", g.source == DesignGuidance::Source::nothing || g.t ? Json(0) : number(g.weight)},
                        {"t", g.t ? number(*g.t) : Json(nullptr)}};
  report["solve"] = {{"method", "variational"},
                     {"rows", design.rows},
                     {"solves", design.solves},
                     {"iterations", design.iterations},
                     {"residual", number(design.residual)},
                     {"solver", design.solver}};
  report["controls"] = Json::array();
  for (const DesignOutcome& outcome : design.outcomes) report["controls"].push_back(control_json(design, outcome));
  report["certificate"] = {{"connection_converged", c.connection_converged},
                           {"eigen_converged", c.eigen_converged},
                           {"residual_small", c.residual_small},
                           {"index_sums_match", c.index_sums_match},
                           {"finite", c.finite}};
  report["certified"] = c.holds();
  report["met"] = design.met();
  report["warnings"] = remarks_json(design.remarks, true);
  report["notes"] = remarks_json(design.remarks, false);
  return report;
}

std::string distributed_design_summary(const Json& report) {
  std::string text = mesh_summary(report);
  const auto line = [&](const char* label, const std::string& value) { text += summary_line(label, value); };
  const Json& solve = report["solve"];
  line("field",
       fmt::format("n = {}, guidance {}, {} exact rows, {} solves, {} iterations, residual {}", report["n"].get<int>(),
                   report["guidance"]["field"].get<std::string>(), solve["rows"].get<int>(), solve["solves"].get<int>(),
                   solve["iterations"].get<int>(), short_text(solve["residual"])));
  for (const Json& c : report["controls"])
    line(c["met"].get<bool>() ? "met" : "NOT MET",
         fmt::format("{}: {}, off by {} degrees", c["path"].get<std::string>(), c["name"].get<std::string>(),
                     short_text(c["error_degrees"])));
  text += costs_summary(report);
  for (const Json& w : report["warnings"]) line("warning", w["message"].get<std::string>());
  for (const Json& w : report["notes"]) line("note", w["message"].get<std::string>());
  line("certificate", report["certified"].get<bool>() ? "holds" : "DOES NOT HOLD, see the warnings");
  line("design", report["met"].get<bool>() ? "met" : "NOT MET everywhere");
  return text;
}

}  // namespace alcap::app
