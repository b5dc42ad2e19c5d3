// SPDX-License-Identifier: MIT
#include "alcap/eigen_design.h"

#include <cmath>
#include <string>

#include "alcap/connected_surface.h"
#include "alcap/energies.h"
#include "alcap/operators.h"
#include "alcap/singularities.h"
#include "src/base/cancel.h"
#include "src/base/clock.h"
#include "src/base/parallel.h"
#include "src/design/eigen/pencil.h"
#include "src/design/eigen/rows.h"
#include "src/design/singularity_parts.h"
#include "src/design/variational/rows.h"
#include "src/design/weight_range.h"
#include "src/field/component_blocks.h"

namespace alcap {
namespace {

using C = Complex<double>;

// w of a stroke of weight 1, in units of sqrt(area): measured to align to a few degrees on spheres, tori and disks.
constexpr double stroke_scale = 10;
// Reward of the mean along a stroke, beside that of the square: without it the field may turn back halfway, which for
// even n means across.
constexpr double mean_reward = 10;
// Reward of the flux of a target of strength 1, in units of area of the component over area of its face: enough for the
// eigenvalue to fall well below the smoothest field's, so that the field is what the targets make of it.
constexpr double target_reward = 1000;
// Penalty of the flux across, in units of 1 / area of the face.
constexpr double target_penalty = 1e4;

// Of a fixed direction: penalty of the part across, and reward of the part along in units of the component's area. The
// reward is what the rest of a surface weighs, so that the field neither vanishes there nor gathers there.
constexpr double fixed_penalty = 1e4;
constexpr double fixed_reward = 1;

void validate(const Mesh& mesh, const EigenControls& controls, const EigenDesignOptions& options) {
  const std::vector<EigenStroke>& strokes = controls.strokes;
  if (options.n < 1) throw OptionError("n", options.n, "the degree of a field is at least 1");
  if (options.largest_rank < 0) throw OptionError("largest_rank", options.largest_rank, "must not be negative");
  if (!(options.offset >= 0) || !std::isfinite(options.offset))
    throw OptionError("offset", options.offset, "must be finite and not negative");
  for (std::size_t k = 0; k < strokes.size(); ++k) {
    const std::string name = "strokes[" + std::to_string(k) + "]";
    const double weight = strokes[k].weight;
    if (!detail::fit_weight(weight)) throw OptionError(name + ".weight", weight, detail::weight_rule);
    if (strokes[k].line.segments.empty()) throw OptionError(name + ".line", "empty", "a stroke needs some length");
    for (const SurfaceSegment& segment : strokes[k].line.segments) {
      if (segment.face < 0 || segment.face >= mesh.faces())
        throw OptionError(name + ".line", segment.face,
                          "there is no such face; the mesh has " + std::to_string(mesh.faces()));
      if (!(segment.length > 0) || !std::isfinite(segment.length))
        throw OptionError(name + ".line", segment.length, "segments have a positive length");
    }
  }
  for (const SingularityTarget& target : controls.singularities) {
    detail::check_target(mesh, target);
    if (target.pin)
      throw OptionError("pin", "in face " + std::to_string(target.face),
                        "zeros are pinned by variational designs only");
  }
  for (const VertexConstraint& fixed : controls.fixed) {
    if (fixed.vertex < 0 || fixed.vertex >= mesh.vertices() || !mesh.referenced(fixed.vertex))
      throw OptionError("fixed", fixed.vertex, "must be a vertex that a face uses");
    if (!(std::abs(fixed.value) > 0) || !std::isfinite(std::abs(fixed.value)))
      throw OptionError("fixed", fixed.vertex, "needs a direction: a value that is finite and not zero");
  }
}

/// Lines across which a field runs, as lines along which its turned copy does.
std::vector<EigenStroke> along(std::vector<EigenStroke> strokes) {
  for (EigenStroke& stroke : strokes)
    if (stroke.across)
      for (SurfaceSegment& segment : stroke.line.segments) segment.tangent *= C(0, 1);
  return strokes;
}

ControlReport judge(std::size_t number, const VertexConstraint& fixed, int n, const ComplexVectorX<double>& u) {
  ControlReport report{.id = static_cast<ControlId>(number)};
  report.error_degrees = std::abs(std::arg(u[fixed.vertex] * std::conj(fixed.value))) / n * 180 / pi<double>;
  report.met = report.error_degrees <= target_met_degrees;
  return report;
}

/// Rows of a stroke with its weight multiplied in, vertices numbered as in their component.
void append(detail::DesignRows& all, const detail::DesignRows& rows, double weight, const std::vector<Index>& local) {
  const auto scaled = [&](const std::vector<detail::RealRow>& from, std::vector<detail::RealRow>& to) {
    for (detail::RealRow row : from) {
      for (std::size_t k = 0; k < row.vertex.size(); ++k) {
        row.vertex[k] = local[static_cast<std::size_t>(row.vertex[k])];
        row.coefficient[k] *= std::sqrt(weight);
      }
      to.push_back(row);
    }
  };
  scaled(rows.across, all.across);
  scaled(rows.along, all.along);
}

/// e^{-i turns orientation} P u (or Q u) of a target, or of one zero of several: real and positive when it is met.
struct TargetFlux {
  std::size_t number;  // of the target
  Index face;
  std::array<Index, 3> vertex{};
  std::array<C, 3> coefficient{};

  TargetFlux(const Mesh& mesh, const FirstOrderOperators& operators, int n, std::size_t target_number,
             const SingularityTarget& target, const detail::SingularityPart& zero)
      : number(target_number), face(zero.face) {
    const C turn = std::polar(1.0, -detail::target_turns(n, target) * target.orientation) * std::conj(zero.factor);
    for (std::size_t c = 0; c < 3; ++c) {
      const Index at = 3 * zero.face + static_cast<Index>(c);
      vertex[c] = mesh.F().data()[at];
      coefficient[c] = turn * (target.sign > 0 ? operators.p : operators.q)[at];
    }
  }
  [[nodiscard]] C at(const ComplexVectorX<double>& u) const {
    return coefficient[0] * u[vertex[0]] + coefficient[1] * u[vertex[1]] + coefficient[2] * u[vertex[2]];
  }
  void add_real_part(detail::RealRow& row, double scale, C turn, const std::vector<Index>& local) const {
    for (std::size_t c = 0; c < 3; ++c)
      row.add(local[static_cast<std::size_t>(vertex[c])], scale * std::conj(turn * coefficient[c]));
  }
};

/// What became of the target with these zeros.
ControlReport judge(std::size_t number, const SingularityTarget& target, const std::vector<TargetFlux>& fluxes,
                    const std::vector<int>& indices, int n, const ComplexVectorX<double>& u) {
  ControlReport report{.id = static_cast<ControlId>(number)};
  C value = 0;
  bool all = true;
  for (const TargetFlux& flux : fluxes) {
    if (flux.number != number) continue;
    const int index = indices[static_cast<std::size_t>(flux.face)];
    report.index += index;
    all = all && index == target.sign;
    if (const C here = flux.at(u); here != C(0)) value += here / std::abs(here);
  }
  report.error_degrees = std::abs(std::arg(value)) / std::abs(detail::target_turns(n, target)) * 180 / pi<double>;
  report.met = all && report.error_degrees <= target_met_degrees;
  return report;
}

EigenStrokeReport judge(const std::vector<detail::StrokeSample>& samples, int n, double area,
                        const ComplexVectorX<double>& u) {
  EigenStrokeReport report;
  double length = 0;
  for (const detail::StrokeSample& sample : samples) {
    const C value = sample.at(u);
    const double degrees = std::abs(std::arg(value)) / n * 180 / pi<double>;
    report.mean_degrees += sample.ds * degrees;
    report.largest_degrees = std::max(report.largest_degrees, degrees);
    report.magnitude += sample.ds * std::abs(value);
    length += sample.ds;
  }
  report.mean_degrees /= length;
  report.magnitude *= std::sqrt(area) / length;  // int |u|^2 = 1
  report.met = report.mean_degrees <= stroke_met_degrees;
  return report;
}

/// The controls as rows of each component's pencil, and what is needed to judge them afterwards.
class ControlledPencil {
 public:
  ControlledPencil(const ConnectedSurface& surface, const EigenControls& controls, const EigenDesignOptions& options)
      : surface_(surface),
        mesh_(surface.mesh()),
        topology_(surface.topology()),
        controls_(controls),
        strokes_(along(controls.strokes)),
        options_(options),
        areas_(detail::areas_of_components(surface.geometry(), topology_)),
        vertices_(detail::vertices_of_components(topology_)),
        local_(static_cast<std::size_t>(mesh_.vertices()), none),
        rows_(areas_.size()),
        sizes_(areas_),
        joint_(areas_.size()) {
    for (const std::vector<Index>& piece : vertices_)
      for (std::size_t k = 0; k < piece.size(); ++k) local_[static_cast<std::size_t>(piece[k])] = static_cast<Index>(k);
    add_strokes();
    add_means();
    if (!controls.singularities.empty()) add_targets();
    add_fixed();
    for (std::size_t c = 0; c < areas_.size(); ++c)
      if (!joint_[c].vertex.empty()) rows_[c].along.push_back(std::move(joint_[c]));
  }

  /// The smallest eigenpair of every component, side by side.
  void solve(const StiffnessMass& matrices, EigenDesignResult& result) const;
  /// Of u and -u the one that goes with the singularities, or else with the strokes.
  void choose_signs(ComplexVectorX<double>& u) const;
  void judge_controls(EigenDesignResult& result) const;

 private:
  [[nodiscard]] std::size_t component(Index face) const {
    return static_cast<std::size_t>(topology_.face_component[static_cast<std::size_t>(face)]);
  }
  [[nodiscard]] std::size_t component(const EigenStroke& stroke) const {
    return component(stroke.line.segments.front().face);
  }
  void add_strokes();
  void add_means();
  void add_targets();
  void add_fixed();

  const ConnectedSurface& surface_;
  const Mesh& mesh_;
  const Topology& topology_;
  const EigenControls& controls_;
  std::vector<EigenStroke> strokes_;  // turned where they are followed across
  const EigenDesignOptions& options_;
  std::vector<double> areas_;
  std::vector<std::vector<Index>> vertices_;  // of each component
  std::vector<Index> local_;                  // number of each vertex in its component
  std::vector<detail::DesignRows> rows_;
  std::vector<double> sizes_;  // mass of a unit field, rows included
  // One square over everything that has a sign, so that all of it takes the same one.
  std::vector<detail::RealRow> joint_;
  std::vector<std::vector<detail::StrokeSample>> samples_;
  std::vector<TargetFlux> fluxes_;
};

void ControlledPencil::add_strokes() {
  const Geometry& geometry = surface_.geometry();
  const Connection& connection = surface_.connection();
  for (std::size_t k = 0; k < strokes_.size(); ++k) {
    const EigenStroke& stroke = strokes_[k];
    const std::size_t c = component(stroke);
    for (const SurfaceSegment& segment : stroke.line.segments)
      if (component(segment.face) != c)
        throw OptionError("strokes[" + std::to_string(k) + "].line", segment.face, "a stroke stays on one component");
    const double weight = stroke.weight * stroke_scale * std::sqrt(areas_[c]);
    append(rows_[c],
           detail::stroke_rows(mesh_, geometry, connection, options_.n, stroke.line, options_.offset / areas_[c]),
           weight, local_);
    samples_.push_back(detail::samples_along(mesh_, geometry, connection, options_.n, stroke.line));
    sizes_[c] += weight * stroke.line.length();
  }
}

void ControlledPencil::add_means() {
  for (std::size_t k = 0; k < strokes_.size(); ++k) {
    const EigenStroke& stroke = strokes_[k];
    const std::size_t c = component(stroke);
    const double weight = mean_reward * stroke.weight * stroke_scale * std::sqrt(areas_[c]);
    const double scale = std::sqrt(weight / stroke.line.length());
    for (const detail::StrokeSample& sample : samples_[k])
      for (std::size_t v = 0; v < 3; ++v)
        joint_[c].add(local_[static_cast<std::size_t>(sample.vertex[v])],
                      scale * sample.ds * std::conj(sample.coefficient[v]));
    sizes_[c] += weight * stroke.line.length();
  }
}

void ControlledPencil::add_targets() {
  // Area integrals: those S is made of, so that a lone target is met exactly.
  const FirstOrderOperators operators =
      first_order_operators(surface_, {.n = options_.n, .kind = OperatorKind::triangle});
  for (std::size_t k = 0; k < controls_.singularities.size(); ++k) {
    const SingularityTarget& target = controls_.singularities[k];
    const std::size_t c = component(target.face);
    for (const detail::SingularityPart& zero :
         detail::singularity_parts(mesh_, surface_.geometry(), options_.n, target)) {
      const TargetFlux& flux = fluxes_.emplace_back(mesh_, operators, options_.n, k, target, zero);
      const double area = surface_.geometry().area(zero.face);
      flux.add_real_part(joint_[c], target.strength * std::sqrt(target_reward * areas_[c] / area), 1, local_);
      flux.add_real_part(rows_[c].across.emplace_back(), std::sqrt(target_penalty / area), C(0, -1), local_);
      sizes_[c] += target.strength * target.strength * target_reward * areas_[c];
    }
  }
}

void ControlledPencil::add_fixed() {
  for (const VertexConstraint& fixed : controls_.fixed) {
    const auto c = static_cast<std::size_t>(topology_.vertex_component[static_cast<std::size_t>(fixed.vertex)]);
    const C direction = fixed.value / std::abs(fixed.value);
    const Index v = local_[static_cast<std::size_t>(fixed.vertex)];
    // Im(conj(d) u) = Re(conj(i d) u)
    rows_[c].across.emplace_back().add(v, std::sqrt(fixed_penalty) * C(0, 1) * direction);
    joint_[c].add(v, std::sqrt(fixed_reward * areas_[c]) * direction);
    sizes_[c] += fixed_reward * areas_[c];
  }
}

void ControlledPencil::solve(const StiffnessMass& matrices, EigenDesignResult& result) const {
  result.components.resize(areas_.size());
  const bool whole = areas_.size() == 1 && mesh_.referenced_vertices() == mesh_.vertices();
  EigenOptions eigen_options = options_.eigen;
  eigen_options.degree = options_.n;
  const auto solve_one = [&](std::size_t c, const SparseMatrix<C>& S, const SparseMatrix<C>& M) {
    return rows_[c].along.empty() && options_.path == EigenPath::automatic
               ? smallest_eigenpair(S, M, areas_[c], eigen_options)
               : detail::smallest_with_rows(S, M, rows_[c], sizes_[c], options_);
  };
  parallel_for(
      static_cast<std::int64_t>(areas_.size()),
      [&](std::int64_t i) {
        const auto c = static_cast<std::size_t>(i);
        EigenResult eigen = whole ? solve_one(c, matrices.S, matrices.M)
                                  : solve_one(c, diagonal_block(matrices.S, vertices_[c], local_),
                                              diagonal_block(matrices.M, vertices_[c], local_));
        for (std::size_t k = 0; k < vertices_[c].size(); ++k)
          result.field.u[vertices_[c][k]] = eigen.u[static_cast<Eigen::Index>(k)];
        result.components[c] = std::move(eigen.report);
      },
      1);
}

void ControlledPencil::choose_signs(ComplexVectorX<double>& u) const {
  std::vector<double> along(areas_.size(), 0.0), flux(areas_.size(), 0.0);
  for (const TargetFlux& zero : fluxes_)
    flux[component(zero.face)] += controls_.singularities[zero.number].strength * zero.at(u).real();
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    const EigenStroke& stroke = strokes_[k];
    for (const detail::StrokeSample& sample : samples_[k])
      along[component(stroke)] += stroke.weight * sample.ds * sample.at(u).real();
  }
  for (const VertexConstraint& fixed : controls_.fixed)
    along[static_cast<std::size_t>(topology_.vertex_component[static_cast<std::size_t>(fixed.vertex)])] +=
        (std::conj(fixed.value) * u[fixed.vertex]).real() / std::abs(fixed.value);
  for (std::size_t c = 0; c < areas_.size(); ++c)
    if (flux[c] != 0 ? flux[c] < 0 : along[c] < 0)
      for (const Index v : vertices_[c]) u[v] = -u[v];
}

void ControlledPencil::judge_controls(EigenDesignResult& result) const {
  const ComplexVectorX<double>& u = result.field.u;
  for (std::size_t k = 0; k < samples_.size(); ++k)
    result.strokes.push_back(judge(samples_[k], options_.n, areas_[component(strokes_[k])], u));
  for (std::size_t k = 0; k < controls_.fixed.size(); ++k)
    result.fixed.push_back(judge(k, controls_.fixed[k], options_.n, u));
  if (fluxes_.empty()) return;
  const std::vector<int> indices = face_indices(surface_, result.field);
  for (std::size_t k = 0; k < controls_.singularities.size(); ++k)
    result.singularities.push_back(judge(k, controls_.singularities[k], fluxes_, indices, options_.n, u));
}

EigenDesignResult solved(const ConnectedSurface& surface, const EigenControls& controls,
                         const EigenDesignOptions& options) {
  detail::report_phase("assembly");
  detail::Stopwatch watch;
  EigenDesignResult result;
  result.field.n = options.n;
  if (surface.in_space()) result.field.frames = surface.frames();
  result.field.u = ComplexVectorX<double>::Zero(surface.mesh().vertices());
  const StiffnessMass matrices = energy_matrices(surface, options.n, options.s);
  const ControlledPencil problem(surface, controls, options);
  result.assembly_seconds = watch.lap();

  detail::report_phase("solve");
  problem.solve(matrices, result);
  detail::report_phase("analysis");
  problem.choose_signs(result.field.u);
  problem.judge_controls(result);
  result.eigen_seconds = watch.seconds();
  return result;
}

}  // namespace

EigenDesignResult eigen_design(const ConnectedSurface& surface, const EigenControls& controls,
                               const EigenDesignOptions& options) {
  validate(surface.mesh(), controls, options);
  return controlled(options.control, [&] {
    const detail::ControlScope eigen(options.eigen.cancel);
    return solved(surface, controls, options);
  });
}

}  // namespace alcap
