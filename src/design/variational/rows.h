// SPDX-License-Identifier: MIT
//
// rows.h: what controls ask, as loads and as rows on a few vertices. Internal to designer.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "alcap/controls.h"
#include "alcap/field.h"
#include "alcap/frames.h"
#include "alcap/operators.h"
#include "src/design/singularity_parts.h"

namespace alcap::detail {

/// Weight per length of a stroke of weight 1, times sqrt(area) of the surface: the same on every mesh and in every
/// unit.
inline constexpr double stroke_scale = 40;
/// A target's flux, in units of 2 pi sqrt(area of its face): the field it makes is several unit lengths long at the rim
/// of the face, so that strength 1 outweighs a unit guidance field there.
inline constexpr double target_flux = 4;

/// sum_k coefficient_k u[vertex_k] = target: softly (weight |.|^2 in twice the energy), or exactly (weight 0).
struct ControlRow {
  std::array<Index, 3> vertex{};
  std::array<Complex<double>, 3> coefficient{};
  Complex<double> target = 0;
  double weight = 0;
  bool direction_only = false;  ///< exact rows: only Im(conj(target) sum) = 0

  template <class Vector>
  [[nodiscard]] Complex<double> at(const Vector& u) const {
    Complex<double> sum = 0;
    for (std::size_t k = 0; k < 3; ++k) sum += coefficient[k] * u[vertex[k]];
    return sum;
  }

  /// add(i, j, value) for every entry of w r' r that is not zero.
  template <class Add>
  void add_product(double w, Add&& add) const {
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        const Complex<double> value = w * std::conj(coefficient[i]) * coefficient[j];
        if (value != Complex<double>(0)) add(vertex[i], vertex[j], value);
      }
  }
  /// add(i, value) for the entries of r' z.
  template <class Add>
  void add_adjoint(Complex<double> z, Add&& add) const {
    for (std::size_t c = 0; c < 3; ++c) add(vertex[c], std::conj(coefficient[c]) * z);
  }
};

/// One zero of a target: P u or Q u of its face, turned so that it takes the argument of the target's density.
struct TargetPart {
  Index face = none;
  std::array<Complex<double>, 3> coefficient{};

  bool operator==(const TargetPart&) const = default;
};

/// A control made ready: a target's load, rows otherwise (and for its pin). Rows are all soft or all exact.
struct ControlLoad {
  std::vector<TargetPart> parts = {};  ///< of a target
  Complex<double> density = 0;         ///< its load is density conj(coefficient) at the corners of each part's face
  std::vector<ControlRow> rows = {};
  std::vector<VertexConstraint> held = {};  ///< directions of features: too many for rows, and none may turn over

  [[nodiscard]] bool target() const { return !parts.empty(); }
  [[nodiscard]] bool soft() const { return !rows.empty() && rows.front().weight > 0; }

  /// add(i, value) for the entries of a target's load, of this density instead of its own.
  template <class Add>
  void add_target(const Mesh& mesh, Complex<double> of_density, Add&& add) const {
    for (const TargetPart& part : parts)
      for (Index c = 0; c < 3; ++c)
        add(mesh.F()(part.face, c), std::conj(part.coefficient[static_cast<std::size_t>(c)]) * of_density);
  }
};

/// The field at a point in the face's frame.
[[nodiscard]] ControlRow point_row(const Mesh& mesh, const Geometry& geometry, const Connection& connection, int n,
                                   const SurfacePoint& p);
/// The field at the pin of the zero in this face, which is held at 0.
[[nodiscard]] ControlRow pin_row(const Mesh& mesh, const Geometry& geometry, const Connection& connection, int n,
                                 const SingularityTarget& target, Index face);
/// Of all zeros of a target; none without a pin.
[[nodiscard]] std::vector<ControlRow> pin_rows(const Mesh& mesh, const Geometry& geometry, const Connection& connection,
                                               int n, const SingularityTarget& target);

/// Turns controls into loads and rows. Keeps references. Every overload throws OptionError naming what is wrong.
struct ControlLoads {
  const Mesh& mesh;
  const Positions<double>& V;  // empty where the surface lies in no space
  const Geometry& geometry;
  const Connection& connection;
  const FirstOrderOperators& operators;
  int n = 1;
  double total_area = 0;  ///< of the whole surface, of which the mesh may be a part

  [[nodiscard]] ControlLoad operator()(const SingularityTarget& target) const;
  [[nodiscard]] ControlLoad operator()(const VertexConstraint& constraint) const;
  [[nodiscard]] ControlLoad operator()(const Stroke& stroke) const;
  [[nodiscard]] ControlLoad operator()(const BoundaryAlignment& alignment) const;
  [[nodiscard]] ControlLoad operator()(const FeatureAlignment& alignment) const;

  /// The load of a target, without parts; area: of its face.
  [[nodiscard]] Complex<double> target_density(const SingularityTarget& target, double area) const;
  /// Adds one zero of a target to its load; area: of the target's face.
  void add_part(const SingularityPart& zero, const SingularityTarget& target, double area, ControlLoad& load) const;
  /// The field at a point in the face's frame.
  [[nodiscard]] ControlRow point_row(const SurfacePoint& p) const {
    return detail::point_row(mesh, geometry, connection, n, p);
  }
  /// The row of one segment of a stroke's line.
  [[nodiscard]] ControlRow segment_row(const SurfaceSegment& segment, double weight) const;
  /// The rows of an alignment, one per boundary vertex whose two sides do not ask for opposites.
  [[nodiscard]] std::vector<ControlRow> boundary_rows(const BoundaryAlignment& alignment) const;

 private:
  [[nodiscard]] double stroke_weight(double weight) const;
  [[nodiscard]] ControlLoad along_points(const Stroke& stroke) const;
  [[nodiscard]] ControlLoad along_line(const Stroke& stroke) const;
  [[nodiscard]] ControlLoad footprint(const Stroke& stroke) const;
};

/// How a target of an index (n-ths) is met: orientation times this many turns is the argument of c in u = c z^index,
/// and so of P u or Q u.
[[nodiscard]] constexpr int target_turns(int n, int index) { return index == n ? n : n - index; }
[[nodiscard]] inline int target_turns(int n, const SingularityTarget& target) {
  return target_turns(n, target.sign * target.count);
}

/// Of the guidance weight and of 2 lambda_t: twice the lambda_min of a round sphere of this area.
[[nodiscard]] inline double guidance_unit(int n, double area) { return 8 * pi<double> * n / area; }

/// What became of a target: of the parts of its load, with the field around their faces.
[[nodiscard]] ControlReport judge_target(const Mesh& mesh, const Connection& connection, const Field& field,
                                         const SingularityTarget& target, const ControlLoad& load,
                                         const ControlTolerances& tolerances);
/// The parts of it, which may be those of several ranks.
struct TargetTally {
  int index = 0;              ///< sum of the faces' indices
  bool all = true;            ///< every face has the target's sign as its index
  Complex<double> value = 0;  ///< sum of P u or Q u of the parts, each of length 1

  void add(const Mesh& mesh, const Connection& connection, const Field& field, const SingularityTarget& target,
           const ControlLoad& load);
  [[nodiscard]] ControlReport judge(int n, const SingularityTarget& target, const ControlTolerances& tolerances) const;
};
/// What became of a fixed vertex: of the value there, with the length of the longest of all.
[[nodiscard]] ControlReport judge_fixed(const VertexConstraint& constraint, int n, Complex<double> value,
                                        double longest, const ControlTolerances& tolerances);
/// What became of soft rows, summed over them.
struct Deviation {
  double radians = 0, weights = 0;  ///< sums of weight times angle, and of weights

  void add(const ControlRow& row, Complex<double> value, int n) {
    radians += row.weight * std::abs(wrap(std::arg(value) - std::arg(row.target))) / n;
    weights += row.weight;
  }
  [[nodiscard]] ControlReport judge(double tolerance_degrees) const;
};

/// Throws OptionError for a face the mesh has not or coordinates outside it.
void check_surface_point(const Mesh& mesh, const SurfacePoint& p, const char* name);
/// Throws OptionError for a face, sign, count, strength or orientation that cannot be.
void check_target(const Mesh& mesh, const SingularityTarget& target);

}  // namespace alcap::detail
