// SPDX-License-Identifier: MIT
#include "alcap/eigen_design.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "alcap/connected_surface.h"
#include "alcap/energies.h"
#include "alcap/operators.h"
#include "alcap/singularities.h"
#include "src/base/cancel.h"
#include "src/base/clock.h"
#include "src/base/parallel.h"
#include "src/design/eigen/guidance.h"
#include "src/design/eigen/pencil.h"
#include "src/design/eigen/pins.h"
#include "src/design/eigen/rows.h"
#include "src/design/feature_rows.h"
#include "src/design/singularity_parts.h"
#include "src/design/tolerances.h"
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

// Of the field along held features, in units of its mean there.
constexpr double least_length = 1e-3;

void check_guidance(const Mesh& mesh, const EigenControls& controls) {
  if (!detail::fit_weight_or_zero(controls.guidance_weight))
    throw OptionError("guidance_weight", controls.guidance_weight, detail::weight_or_zero_rule);
  const ComplexVectorX<double>& g = controls.guidance;
  const VectorX<double>& weights = controls.guidance_weights;
  if (!(controls.guidance_weight > 0) && g.size() > 0)
    throw OptionError("guidance_weight", "0", "a guidance field needs a weight");
  if (g.size() > 0 && g.size() != mesh.vertices())
    throw OptionError("guidance", std::to_string(g.size()) + " values", "needs one per vertex");
  if (!g.allFinite()) throw OptionError("guidance", "not finite", "every value must be finite");
  if (weights.size() == 0) return;
  if (weights.size() != mesh.vertices())
    throw OptionError("guidance_weights", std::to_string(weights.size()) + " values", "needs one per vertex");
  for (Index v = 0; v < mesh.vertices(); ++v)
    if (!detail::fit_weight_or_zero(weights[v]))
      throw OptionError("guidance_weights", weights[v],
                        "of vertex " + std::to_string(v) + " " + detail::weight_or_zero_rule);
  if (!(weights.maxCoeff() > 0)) throw OptionError("guidance_weights", "all 0", "one at least must be positive");
}

void validate(const Mesh& mesh, const EigenControls& controls, const EigenDesignOptions& options) {
  const std::vector<EigenStroke>& strokes = controls.strokes;
  if (options.n < 1) throw OptionError("n", options.n, "the degree of a field is at least 1");
  detail::check_tolerances(options.tolerances);
  if (options.largest_rank < 0) throw OptionError("largest_rank", options.largest_rank, "must not be negative");
  if (!(options.offset >= 0) || !std::isfinite(options.offset))
    throw OptionError("offset", options.offset, "must be finite and not negative");
  for (std::size_t k = 0; k < strokes.size(); ++k) {
    const std::string name = "strokes[" + std::to_string(k) + "]";
    const double weight = strokes[k].weight;
    if (!detail::fit_weight(weight)) throw OptionError(name + ".weight", weight, detail::weight_rule);
    if (!(strokes[k].radius >= 0) || !std::isfinite(strokes[k].radius))
      throw OptionError(name + ".radius", strokes[k].radius, "must be finite and not negative");
    if (strokes[k].line.segments.empty()) throw OptionError(name + ".line", "empty", "a stroke needs some length");
    for (const SurfaceSegment& segment : strokes[k].line.segments) {
      if (segment.face < 0 || segment.face >= mesh.faces())
        throw OptionError(name + ".line", segment.face,
                          "there is no such face; the mesh has " + std::to_string(mesh.faces()));
      if (!(segment.length > 0) || !std::isfinite(segment.length))
        throw OptionError(name + ".line", segment.length, "segments have a positive length");
    }
  }
  for (const SingularityTarget& target : controls.singularities) detail::check_target(mesh, target);
  for (const VertexConstraint& fixed : controls.fixed) {
    if (fixed.vertex < 0 || fixed.vertex >= mesh.vertices() || !mesh.referenced(fixed.vertex))
      throw OptionError("fixed", fixed.vertex, "must be a vertex that a face uses");
    if (!(std::abs(fixed.value) > 0) || !std::isfinite(std::abs(fixed.value)))
      throw OptionError("fixed", fixed.vertex, "needs a direction: a value that is finite and not zero");
  }
  for (std::size_t k = 0; k < controls.features.size(); ++k) {
    const FeatureAlignment& features = controls.features[k];
    const std::string name = "features[" + std::to_string(k) + "]";
    detail::check_features(mesh, features.features, options.n);
    if (features.features.edges.empty()) throw OptionError(name, "none", "needs feature edges to align with");
    if (!detail::fit_weight(features.weight)) throw OptionError(name + ".weight", features.weight, detail::weight_rule);
  }
  check_guidance(mesh, controls);
}

/// The strokes, and those along features after them. Lines across which a field runs are lines along which its turned
/// copy does.
std::vector<EigenStroke> along(const ConnectedSurface& surface, const EigenControls& controls) {
  std::vector<EigenStroke> strokes = controls.strokes;
  for (const FeatureAlignment& features : controls.features)
    for (const FeatureLine& line : features.features.lines)
      strokes.push_back({.line = detail::polyline_of(surface.mesh(), surface.geometry(), line),
                         .weight = features.weight,
                         .across = features.across});
  for (EigenStroke& stroke : strokes)
    if (stroke.across)
      for (SurfaceSegment& segment : stroke.line.segments) segment.tangent *= C(0, 1);
  return strokes;
}

ControlReport judge(std::size_t number, const VertexConstraint& fixed, const EigenDesignOptions& options,
                    const ComplexVectorX<double>& u) {
  ControlReport report{.id = static_cast<ControlId>(number)};
  report.error_degrees = std::abs(std::arg(u[fixed.vertex] * std::conj(fixed.value))) / options.n * 180 / pi<double>;
  report.met = report.error_degrees <= options.tolerances.fixed_degrees;
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
                    const std::vector<int>& indices, const EigenDesignOptions& options,
                    const ComplexVectorX<double>& u) {
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
  report.error_degrees =
      std::abs(std::arg(value)) / std::abs(detail::target_turns(options.n, target)) * 180 / pi<double>;
  report.met = all && report.error_degrees <= options.tolerances.singularity_degrees;
  return report;
}

EigenStrokeReport judge(const std::vector<detail::StrokeSample>& samples, const EigenDesignOptions& options,
                        double area, const ComplexVectorX<double>& u) {
  EigenStrokeReport report;
  double length = 0;
  for (const detail::StrokeSample& sample : samples) {
    const C value = sample.at(u);
    const double degrees = std::abs(std::arg(value)) / options.n * 180 / pi<double>;
    report.mean_degrees += sample.ds * degrees;
    report.largest_degrees = std::max(report.largest_degrees, degrees);
    report.magnitude += sample.ds * std::abs(value);
    length += sample.ds;
  }
  report.mean_degrees /= length;
  report.magnitude *= std::sqrt(area) / length;  // int |u|^2 = 1
  report.met = report.mean_degrees <= options.tolerances.stroke_degrees;
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
        strokes_(along(surface, controls)),
        options_(options),
        areas_(detail::areas_of_components(surface.geometry(), topology_)),
        vertices_(detail::vertices_of_components(topology_)),
        local_(static_cast<std::size_t>(mesh_.vertices()), none),
        rows_(areas_.size()),
        sizes_(areas_),
        joint_(areas_.size()),
        ties_(areas_.size()),
        pull_(controls.guidance_weight * detail::guidance_unit(options.n, surface.geometry().total_area()) / 2) {
    holds_.assign(controls.strokes.size(), false);
    for (const FeatureAlignment& features : controls.features)
      holds_.insert(holds_.end(), features.features.lines.size(), features.hold);
    pin_terms_.resize(areas_.size());
    held_.resize(areas_.size());
    held_mean_.assign(areas_.size(), 0.0);
    joined_.assign(areas_.size(), false);
    for (const std::vector<Index>& piece : vertices_) pins_.emplace_back(static_cast<Index>(piece.size()));
    for (const std::vector<Index>& piece : vertices_)
      for (std::size_t k = 0; k < piece.size(); ++k) local_[static_cast<std::size_t>(piece[k])] = static_cast<Index>(k);
    add_strokes();
    add_means();
    add_held();
    if (!controls.singularities.empty()) add_targets();
    add_fixed();
    for (std::size_t c = 0; c < areas_.size(); ++c) {
      if (joint_[c].vertex.empty()) continue;
      if (!held_[c].empty()) join_held(c);
      rows_[c].along.push_back(std::move(joint_[c]));
    }
  }

  /// The smallest eigenpair of every component, side by side.
  void solve(const StiffnessMass& matrices, EigenDesignResult& result) const;
  /// Of u and -u the one that goes with the singularities, or else with the rest.
  void choose_signs(const SparseMatrix<C>& M, ComplexVectorX<double>& u) const;
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
  void add_held();
  /// Fields with the directions that features hold, and the pins; with `one_length` they are as long at all of these.
  [[nodiscard]] detail::ZeroSpace<double> held_space(std::size_t c, bool one_length) const;
  /// Gives held features the sign of everything else: at one vertex for all, which are as long then.
  void join_held(std::size_t c);
  /// Whether a field among them has another direction at some: one opposite as an n-th power, or none.
  [[nodiscard]] bool turns_over(std::size_t c, const ComplexVectorX<double>& u) const;
  /// The pencil of one component with what it asks for, and its smallest eigenpair.
  [[nodiscard]] EigenResult solve_one(std::size_t c, const SparseMatrix<C>& S, const SparseMatrix<C>& M) const;
  [[nodiscard]] EigenResult solve_pinned(std::size_t c, const SparseMatrix<C>& S, const SparseMatrix<C>& M,
                                         const detail::DesignRows& rows, double size) const;
  [[nodiscard]] detail::EigenGuidance guidance(std::size_t c) const;
  /// What a stroke has of length, or its band of shares.
  [[nodiscard]] double length(std::size_t stroke) const;

  const ConnectedSurface& surface_;
  const Mesh& mesh_;
  const Topology& topology_;
  const EigenControls& controls_;
  std::vector<EigenStroke> strokes_;  // turned where they are followed across
  std::vector<bool> holds_;           // of each: whether it goes along held features
  const EigenDesignOptions& options_;
  std::vector<double> areas_;
  std::vector<std::vector<Index>> vertices_;  // of each component
  std::vector<Index> local_;                  // number of each vertex in its component
  std::vector<detail::DesignRows> rows_;
  std::vector<double> sizes_;  // mass of a unit field, rows included
  // One square over everything that has a sign, so that all of it takes the same one.
  std::vector<detail::RealRow> joint_;
  // What guidance gives its sign to: each is drawn to r times what a variational design draws it to.
  std::vector<std::vector<detail::GuidanceTie>> ties_;
  double pull_;  // of guidance: what multiplies the mass
  std::vector<detail::ZeroSpace<C>> pins_;
  // What the pins of each component ask for, and directions that its features hold.
  std::vector<std::vector<std::vector<detail::ZeroSpace<C>::Term>>> pin_terms_;
  std::vector<std::vector<std::pair<Index, C>>> held_;
  std::vector<double> held_mean_;  // what the means along held features have in the joint row, for length 1
  std::vector<bool> joined_;       // whether they are in it
  std::vector<std::vector<detail::StrokeSample>> samples_;
  std::vector<TargetFlux> fluxes_;
};

double ControlledPencil::length(std::size_t stroke) const {
  if (!(strokes_[stroke].radius > 0)) return strokes_[stroke].line.length();
  double sum = 0;
  for (const detail::StrokeSample& sample : samples_[stroke]) sum += sample.ds;
  return sum;
}

void ControlledPencil::add_strokes() {
  const Geometry& geometry = surface_.geometry();
  const Connection& connection = surface_.connection();
  for (std::size_t k = 0; k < strokes_.size(); ++k) {
    const EigenStroke& stroke = strokes_[k];
    const std::size_t c = component(stroke);
    for (const SurfaceSegment& segment : stroke.line.segments)
      if (component(segment.face) != c)
        throw OptionError("strokes[" + std::to_string(k) + "].line", segment.face, "a stroke stays on one component");
    const double weight = stroke.weight * stroke_scale * std::sqrt(areas_[c]), offset = options_.offset / areas_[c];
    if (stroke.radius > 0) {
      const auto band = detail::stroke_band(mesh_, geometry, connection, stroke.line, stroke.radius);
      append(rows_[c], detail::band_rows(surface_, options_.n, band, offset, stroke.across), weight, local_);
      samples_.push_back(detail::samples_of_band(band, options_.n));
    } else {
      append(rows_[c], detail::stroke_rows(mesh_, geometry, connection, options_.n, stroke.line, offset), weight,
             local_);
      samples_.push_back(detail::samples_along(mesh_, geometry, connection, options_.n, stroke.line));
    }
    sizes_[c] += weight * length(k);
  }
}

void ControlledPencil::add_means() {
  for (std::size_t k = 0; k < strokes_.size(); ++k) {
    const EigenStroke& stroke = strokes_[k];
    const std::size_t c = component(stroke);
    const double weight = mean_reward * stroke.weight * stroke_scale * std::sqrt(areas_[c]);
    const double scale = std::sqrt(weight / length(k));
    const double drawn = std::sqrt(stroke.weight * detail::stroke_scale / 2 * length(k) / std::sqrt(areas_[c]));
    detail::GuidanceTie& tie = ties_[c].emplace_back(detail::GuidanceTie{.row = {}, .value = drawn});
    // A row over thousands of vertices would fill the matrix. Held directions need no sign: they turn over nowhere.
    const bool signed_mean = !holds_[k];
    for (const detail::StrokeSample& sample : samples_[k])
      for (std::size_t v = 0; v < 3; ++v) {
        const Index at = local_[static_cast<std::size_t>(sample.vertex[v])];
        if (signed_mean) joint_[c].add(at, scale * sample.ds * std::conj(sample.coefficient[v]));
        tie.row.add(at, drawn / length(k) * sample.ds * std::conj(sample.coefficient[v]));
      }
    if (signed_mean)
      sizes_[c] += weight * length(k);
    else
      held_mean_[c] += scale * length(k);
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
      detail::GuidanceTie& tie = ties_[c].emplace_back();
      flux.add_real_part(tie.row, 1 / std::sqrt(area), 1, local_);
      tie.value = target.strength * detail::target_flux * 2 * pi<double> * std::norm(zero.factor);
    }
    for (const detail::ControlRow& row :
         detail::pin_rows(mesh_, surface_.geometry(), surface_.connection(), options_.n, target)) {
      std::vector<detail::ZeroSpace<C>::Term>& terms = pin_terms_[c].emplace_back();
      for (std::size_t corner = 0; corner < 3; ++corner)
        terms.emplace_back(local_[static_cast<std::size_t>(row.vertex[corner])], row.coefficient[corner]);
      pins_[c].demand(terms);
    }
  }
}

void ControlledPencil::add_held() {
  std::vector<char> fixed(local_.size(), 0);  // they win over features
  for (const VertexConstraint& f : controls_.fixed) fixed[static_cast<std::size_t>(f.vertex)] = 1;
  for (const FeatureAlignment& features : controls_.features) {
    if (!features.hold) continue;
    const FeatureDirections directions =
        detail::directions_at_features(mesh_, surface_.connection(), features.features, options_.n, features.across);
    for (const VertexConstraint& held : directions.held) {
      const auto at = static_cast<std::size_t>(held.vertex);
      if (fixed[at] == 0)
        held_[static_cast<std::size_t>(topology_.vertex_component[at])].emplace_back(local_[at], held.value);
    }
  }
}

detail::ZeroSpace<double> ControlledPencil::held_space(std::size_t c, bool one_length) const {
  detail::ZeroSpace<double> space(static_cast<Index>(2 * vertices_[c].size()));
  for (const auto& [v, d] : held_[c]) space.demand({{2 * v, -d.imag()}, {2 * v + 1, d.real()}});  // Im(conj(d) u) = 0
  const auto& [first, d0] = held_[c].front();
  for (const auto& [v, d] : held_[c])
    if (one_length && v != first)
      space.demand({{2 * v, d.real()}, {2 * v + 1, d.imag()}, {2 * first, -d0.real()}, {2 * first + 1, -d0.imag()}});
  for (const auto& terms : pin_terms_[c]) {
    std::vector<detail::ZeroSpace<double>::Term> real, imaginary;
    for (const auto& [v, z] : terms) {
      real.insert(real.end(), {{2 * v, z.real()}, {2 * v + 1, -z.imag()}});
      imaginary.insert(imaginary.end(), {{2 * v, z.imag()}, {2 * v + 1, z.real()}});
    }
    space.demand(real);
    space.demand(imaginary);
  }
  return space;
}

void ControlledPencil::join_held(std::size_t c) {
  const auto& [first, d0] = held_[c].front();
  joint_[c].add(first, held_mean_[c] * d0);
  sizes_[c] += held_mean_[c] * held_mean_[c];
  joined_[c] = true;
}

bool ControlledPencil::turns_over(std::size_t c, const ComplexVectorX<double>& u) const {
  double sum = 0, least = std::numeric_limits<double>::infinity(), most = -least;
  for (const auto& [v, d] : held_[c]) {
    const double length = (u[v] * std::conj(d)).real();
    sum += length;
    least = std::min(least, length);
    most = std::max(most, length);
  }
  const double mean = sum / static_cast<double>(held_[c].size());
  return !(mean > 0 ? least > least_length * mean : most < least_length * mean);
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
    ties_[c].push_back({.row = {.vertex = {v}, .coefficient = {std::sqrt(fixed_penalty) * direction}},
                        .value = std::sqrt(fixed_penalty)});
  }
}

detail::EigenGuidance ControlledPencil::guidance(std::size_t c) const {
  detail::EigenGuidance out{.pull = pull_, .field = {}, .weights = {}};
  const auto size = static_cast<Eigen::Index>(vertices_[c].size());
  if (controls_.guidance.size() > 0) out.field.resize(size);
  if (controls_.guidance_weights.size() > 0) out.weights.resize(size);
  for (Eigen::Index k = 0; k < size; ++k) {
    const Index v = vertices_[c][static_cast<std::size_t>(k)];
    if (out.field.size() > 0) out.field[k] = controls_.guidance[v];
    if (out.weights.size() > 0) out.weights[k] = controls_.guidance_weights[v];
  }
  return out;
}

EigenResult ControlledPencil::solve_one(std::size_t c, const SparseMatrix<C>& S, const SparseMatrix<C>& M) const {
  // Drawn towards zero everywhere alike a field without rows stays what it is.
  const bool shifted =
      controls_.guidance.size() == 0 && controls_.guidance_weights.size() == 0 && rows_[c].along.empty();
  if (!(pull_ > 0) || shifted) return solve_pinned(c, S, M, rows_[c], sizes_[c]);
  const detail::GuidedPencil pencil = detail::guided(S, M, rows_[c], ties_[c], sizes_[c], areas_[c], guidance(c));
  return solve_pinned(c, pencil.S, M, pencil.rows, pencil.size);
}

EigenResult ControlledPencil::solve_pinned(std::size_t c, const SparseMatrix<C>& S, const SparseMatrix<C>& M,
                                           const detail::DesignRows& rows, double size) const {
  if (!held_[c].empty()) {
    const auto among = [&](bool one_length) {
      return detail::smallest_with_rows_in(held_space(c, one_length).basis(), S, M, rows, size, options_);
    };
    if (joined_[c]) return among(true);
    EigenResult result = among(false);
    return turns_over(c, result.u) ? among(true) : result;
  }
  if (!pins_[c].empty()) {
    const SparseMatrix<C> T = pins_[c].basis();
    SparseMatrix<C> TS, TM;  // assigned: Eigen's constructors leak where memory runs out in the middle of them
    TS = T.adjoint() * S * T;
    TM = T.adjoint() * M * T;
    EigenResult result = detail::smallest_with_rows(TS, TM, detail::pinned_rows(rows, T), size, options_);
    result.u = ComplexVectorX<double>(T * result.u);
    return result;
  }
  if (!rows.along.empty() || rows.follow.size() > 0 || options_.path != EigenPath::automatic)
    return detail::smallest_with_rows(S, M, rows, size, options_);
  EigenOptions eigen_options = options_.eigen;
  eigen_options.degree = options_.n;
  return smallest_eigenpair(S, M, size, eigen_options);
}

void ControlledPencil::solve(const StiffnessMass& matrices, EigenDesignResult& result) const {
  result.components.resize(areas_.size());
  const bool whole = areas_.size() == 1 && mesh_.referenced_vertices() == mesh_.vertices();
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

void ControlledPencil::choose_signs(const SparseMatrix<C>& M, ComplexVectorX<double>& u) const {
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
  if (controls_.guidance.size() > 0) {
    // In units of length times |u|, as strokes.
    const double unit = controls_.guidance.cwiseAbs().maxCoeff();
    ComplexVectorX<double> g = unit > 0 ? controls_.guidance / unit : controls_.guidance, Mg(g.size());
    if (controls_.guidance_weights.size() > 0) g = g.cwiseProduct(controls_.guidance_weights.cast<C>());
    hermitian_product(M, g.data(), Mg.data());
    for (std::size_t c = 0; c < areas_.size(); ++c)
      for (const Index v : vertices_[c])
        along[c] += controls_.guidance_weight * (std::conj(Mg[v]) * u[v]).real() / std::sqrt(areas_[c]);
  }
  for (std::size_t c = 0; c < areas_.size(); ++c) {
    double held = 0;
    for (const auto& [v, d] : held_[c]) held += (u[vertices_[c][static_cast<std::size_t>(v)]] * std::conj(d)).real();
    if (held != 0 ? held < 0 : flux[c] != 0 ? flux[c] < 0 : along[c] < 0)
      for (const Index v : vertices_[c]) u[v] = -u[v];
  }
}

void ControlledPencil::judge_controls(EigenDesignResult& result) const {
  const ComplexVectorX<double>& u = result.field.u;
  for (std::size_t k = 0; k < controls_.strokes.size(); ++k)
    result.strokes.push_back(judge(samples_[k], options_, areas_[component(strokes_[k])], u));
  for (std::size_t k = 0; k < controls_.features.size(); ++k) {
    ControlReport& report = result.features.emplace_back(
        detail::judge_features(surface_, result.field, controls_.features[k], options_.tolerances));
    report.id = static_cast<ControlId>(k);
  }
  for (std::size_t k = 0; k < controls_.fixed.size(); ++k)
    result.fixed.push_back(judge(k, controls_.fixed[k], options_, u));
  if (fluxes_.empty()) return;
  const std::vector<int> indices = face_indices(surface_, result.field);
  for (std::size_t k = 0; k < controls_.singularities.size(); ++k)
    result.singularities.push_back(judge(k, controls_.singularities[k], fluxes_, indices, options_, u));
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
  problem.choose_signs(matrices.M, result.field.u);
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
