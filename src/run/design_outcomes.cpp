// SPDX-License-Identifier: MIT
//
// design_outcomes.cpp: what became of every control and cone of a design, the certificate, and what deserves a remark.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <variant>

#include "alcap/operators.h"
#include "src/base/index_text.h"
#include "src/base/numbers.h"
#include "src/base/parallel.h"
#include "src/run/design_stages.h"
#include "src/run/remarks.h"

namespace alcap::detail {
namespace {

using Type = DesignOutcome::Type;

Type type_of(const Control& control) {
  if (std::holds_alternative<SingularityTarget>(control)) return Type::singularity;
  if (std::holds_alternative<VertexConstraint>(control)) return Type::fixed;
  if (std::holds_alternative<FeatureAlignment>(control)) return Type::features;
  return std::holds_alternative<Stroke>(control) ? Type::stroke : Type::boundary;
}

void judge_singularity(const DesignRun& run, const SolvedDesign& solved, const SingularityTarget& target,
                       const SingularityTarget& solved_target, DesignOutcome& out) {
  for (const Singularity& found : run.singularities)
    if (found.face == target.face) out.found = found;
  if (!target.pin) return;
  const ConnectedSurface& surface = solved.surface;
  const Field field{run.design.n, solved.u, nullptr};
  out.length_at_pin = length_at_pin(surface.mesh(), surface.geometry(), surface.connection(), field, solved_target);
  out.met = out.met && out.length_at_pin <= *out.tolerance_relative;
}

void judge_cones(const DesignRun& run, const ConnectedSurface& solved, double tolerance_degrees,
                 std::vector<DesignOutcome>& outcomes) {
  const std::vector<Cone>& cones = run.design.connection.cones;
  for (std::size_t k = 0; k < cones.size(); ++k) {
    const double turns = vertex_turns(solved.mesh(), solved.geometry(), solved.connection(), cones[k].vertex);
    outcomes.push_back(judge_cone(cones, k, turns, tolerance_degrees));
  }
}

std::string degrees_text(double x) {
  if (!std::isfinite(x)) return "a number that is not finite";
  char text[64];
  std::snprintf(text, sizeof text, "%.3g degrees", x);
  return text;
}

/// Another target whose face shares a vertex with this one's; none if there is no such.
Index target_next_to(const DesignRun& run, const SingularityTarget& target) {
  const auto& F = run.mesh().F();
  for (const DesignOutcome& other : run.outcomes) {
    if (other.type != Type::singularity) continue;
    const Index face = std::get<SingularityTarget>(*other.control).face;
    if (face == target.face) continue;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        if (F(face, i) == F(target.face, j)) return face;
  }
  return none;
}

}  // namespace

Remark remark_pieces(const std::vector<char>& empty) {
  Remark remark{.code = "pieces_without_control", .warning = false, .count = std::count(empty.begin(), empty.end(), 1)};
  remark.message = counted(remark.count, "component has", "components have") +
                   " no control and no guidance; each has its smoothest field";
  for (std::size_t c = 0; c < empty.size() && remark.first.size() < 8; ++c)
    if (empty[c] != 0) remark.first.push_back(static_cast<Index>(c));
  return remark;
}

double vertex_turns(const Mesh& mesh, const Geometry& geometry, const Connection& connection, Index v) {
  double turns = 1;
  const auto& alpha = connection.alpha;
  mesh.for_each_outgoing(v, [&](Index h) {
    const double turned = alpha.size() ? alpha[h] - alpha[Mesh::prev(h)] : 0.0;
    turns -= (geometry.angle(h) + turned) / (2 * pi<double>);
  });
  return turns;
}

DesignOutcome judge_cone(const std::vector<Cone>& cones, std::size_t k, double turns, double tolerance_degrees) {
  // Several entries for one vertex add up.
  double asked = 0;
  for (const Cone& c : cones) asked += c.vertex == cones[k].vertex ? c.index : 0.0;
  const double degrees = std::abs(turns - asked) * 360;
  return {.type = Type::cone,
          .number = k,
          .path = "/connection/cones/" + std::to_string(k),
          .name = "cone at vertex " + std::to_string(cones[k].vertex),
          .met = degrees <= tolerance_degrees,
          .error_degrees = degrees,
          .tolerance_degrees = tolerance_degrees,
          .cone_asked = asked,
          .cone_index = turns};
}

double length_at_pin(const Mesh& mesh, const Geometry& geometry, const Connection& connection, const Field& field,
                     const SingularityTarget& target) {
  const FieldValue there = face_field(mesh, geometry, connection, field.n, field.u, target.face).at(*target.pin);
  double size = 0;
  for (Index c = 0; c < 3; ++c) size = std::max(size, std::abs(field.u[mesh.F()(target.face, c)]));
  return size > 0 ? std::abs(there.u) / size : 0;
}

Remark unmet(const DesignOutcome& outcome, int n, Index next_target) {
  std::string what = "off by " + degrees_text(outcome.error_degrees);
  Remark remark{.code = "control_not_met", .count = 1};
  switch (outcome.type) {
    case Type::singularity: {
      const auto& target = std::get<SingularityTarget>(*outcome.control);
      remark.first = {target.face};
      if (const int asked = target.sign * target.count; outcome.index != asked)
        what = std::string(target.count > 1 ? "the faces around " : "") + "face " + std::to_string(target.face) +
               (target.count > 1 ? " have" : " has") + " index " + turns_text(outcome.index, n) + " instead of " +
               turns_text(asked, n);
      if (next_target != none)
        what += "; it is too close to the target in face " + std::to_string(next_target) +
                ", with which it shares a vertex: put faces between them, or refine the mesh there";
      else
        what += "; more strength, less guidance or fewer controls nearby help";
      break;
    }
    case Type::stroke:
    case Type::boundary:
    case Type::features:
      what += " on average; more weight helps";
      break;
    case Type::fixed:
      remark.first = {std::get<VertexConstraint>(*outcome.control).vertex};
      break;
    case Type::cone:
      break;
  }
  remark.message = outcome.name + " (" + outcome.path + ") is not met: " + what;
  return remark;
}

void set_tolerance(const ControlTolerances& tolerances, DesignMethod method, DesignOutcome& outcome) {
  const auto* const target = outcome.control ? std::get_if<SingularityTarget>(&*outcome.control) : nullptr;
  const auto* const fixed = outcome.control ? std::get_if<VertexConstraint>(&*outcome.control) : nullptr;
  switch (outcome.type) {
    case Type::singularity:
      outcome.tolerance_degrees = tolerances.singularity_degrees;
      if (target != nullptr && target->pin) outcome.tolerance_relative = tolerances.pin_length;
      break;
    case Type::fixed:
      outcome.tolerance_degrees = tolerances.fixed_degrees;
      if (fixed != nullptr && !fixed->direction_only && method == DesignMethod::variational)
        outcome.tolerance_relative = tolerances.fixed_value;
      break;
    case Type::stroke:
    case Type::features:
      outcome.tolerance_degrees = tolerances.stroke_degrees;
      break;
    case Type::boundary:
      outcome.tolerance_degrees = tolerances.boundary_degrees;
      break;
    case Type::cone:
      outcome.tolerance_degrees = tolerances.cone_degrees;
      break;
  }
}

std::vector<DesignOutcome> judge_design(const DesignRun& run, const SolvedDesign& solved,
                                        const std::vector<DesignControl>& controls,
                                        const std::vector<ControlReport>& reports,
                                        const ControlTolerances& tolerances) {
  std::vector<DesignOutcome> outcomes;
  std::size_t numbers[6] = {};
  for (std::size_t k = 0; k < controls.size(); ++k) {
    const DesignControl& c = controls[k];
    const ControlReport& report = reports.at(k);
    const Type type = type_of(c.control);
    DesignOutcome& out = outcomes.emplace_back(DesignOutcome{.type = type,
                                                             .number = numbers[static_cast<std::size_t>(type)]++,
                                                             .path = c.path,
                                                             .name = c.name,
                                                             .control = c.control,
                                                             .met = report.met,
                                                             .error_degrees = report.error_degrees,
                                                             .index = report.index});
    set_tolerance(tolerances, run.design.method, out);
    if (type == Type::singularity)
      judge_singularity(run, solved, std::get<SingularityTarget>(c.control),
                        std::get<SingularityTarget>(solved.controls[k].control), out);
  }
  judge_cones(run, solved.surface, tolerances.cone_degrees, outcomes);
  return outcomes;
}

void remark_vanishing(double largest_residual, DesignRun& run) {
  const Topology& topology = run.topology();
  const ComplexVectorX<double>& u = run.field.u;
  std::vector<double> largest(topology.components.size(), 0.0);
  const auto component = [&](Index v) { return topology.vertex_component[static_cast<std::size_t>(v)]; };
  for (Index v = 0; v < u.size(); ++v)
    if (const Index c = component(v); c != none) {
      double& most = largest[static_cast<std::size_t>(c)];
      most = std::max(most, std::abs(u[v]));
    }
  const double least = vanishing_length(run.residual, largest_residual);
  Remark remark{.code = "field_vanishes"};
  for (Index v = 0; v < u.size(); ++v) {
    const Index c = component(v);
    if (c == none || !(std::abs(u[v]) < least * largest[static_cast<std::size_t>(c)])) continue;
    ++remark.count;
    if (remark.first.size() < 8) remark.first.push_back(v);
  }
  remark_vanishing(std::move(remark), run.outcomes.size(), run.remarks);
}

double vanishing_length(double residual, double largest_residual) {
  // What is this small is what the solve has left over.
  return std::min(largest_residual, 10 * std::max(residual, 1e-16));
}

void remark_vanishing(Remark remark, std::size_t outcomes, std::vector<Remark>& remarks) {
  // A pinned zero is no such place, nor is one that a control asks for.
  if (remark.count <= static_cast<std::int64_t>(outcomes) + 3) return;
  remark.message = "the field fades to rounding at " + counted(remark.count, "vertex", "vertices") +
                   ", far from what it was asked for: directions and singularities there mean nothing; give less zero "
                   "guidance, or guidance smoothest";
  remarks.push_back(std::move(remark));
}

void certify_design(const Connection& solved, bool eigen_converged, double largest_residual, DesignRun& run) {
  DesignCertificate& c = run.certificate;
  c.connection_converged = solved.report.converged;
  c.eigen_converged = eigen_converged;
  c.residual_small = run.residual <= largest_residual;  // false for NaN
  c.index_sums_match =
      std::all_of(run.index_sums.begin(), run.index_sums.end(), [](const IndexSum& i) { return i.sum == i.expected; });
  c.finite = run.field.u.allFinite();
  for (const DesignOutcome& outcome : run.outcomes) {
    if (outcome.met) continue;
    const bool target = outcome.type == Type::singularity;
    Remark remark = unmet(outcome, run.design.n,
                          target ? target_next_to(run, std::get<SingularityTarget>(*outcome.control)) : none);
    if (outcome.type == Type::cone) remark.first = {run.design.connection.cones[outcome.number].vertex};
    run.remarks.push_back(std::move(remark));
  }
  if (solved.flat && !solved.admits_parallel(run.design.n)) run.remarks.push_back(not_parallel(run.design.n));
  const bool linear = run.design.method == DesignMethod::variational;
  const std::string solver = "; try another DesignRunOptions::solver";
  certificate_remarks(c,
                      {.connection = "; a larger GlobalOptions::detail makes it easier, slivers make it harder",
                       .eigen = solver,
                       .linear = linear ? std::optional(solver) : std::nullopt},
                      run.remarks);
}

void certificate_remarks(const DesignCertificate& c, const Remedies& remedies, std::vector<Remark>& remarks) {
  const auto warn = [&](bool fine, const char* code, const std::string& message) {
    if (!fine) remarks.push_back({.code = code, .message = message});
  };
  warn(c.connection_converged, "connection_not_converged",
       "the connection did not reach its tolerance" + remedies.connection);
  warn(c.eigen_converged, "eigen_not_converged", "an eigensolver did not reach its tolerance" + remedies.eigen);
  warn(c.residual_small || !remedies.linear, "residual_large",
       "the linear solve did not reach its tolerance" + remedies.linear.value_or(""));
  warn(c.index_sums_match || !c.finite, "index_sum_mismatch",
       "the indices do not sum to what topology demands; please report this mesh");
  warn(c.finite, "not_finite", "the field has values that are not finite numbers");
}

}  // namespace alcap::detail
