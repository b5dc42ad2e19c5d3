// SPDX-License-Identifier: MIT
//
// rows.h: what controls ask, as loads and as rows on a few vertices. Internal to designer.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "alcap/controls.h"
#include "alcap/frames.h"
#include "alcap/operators.h"

namespace alcap::detail {

/// Weight per length of a stroke of weight 1, times sqrt(area) of the surface: the same on every mesh and in every
/// unit.
inline constexpr double stroke_scale = 40;

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

  [[nodiscard]] bool target() const { return !parts.empty(); }
  [[nodiscard]] bool soft() const { return !rows.empty() && rows.front().weight > 0; }
};

/// Turns controls into loads and rows. Keeps references. Every overload throws OptionError naming what is wrong.
struct ControlLoads {
  const Mesh& mesh;
  const Positions<double>& V;  // empty where the surface lies in no space
  const Geometry& geometry;
  const Connection& connection;
  const FirstOrderOperators& operators;
  int n = 1;

  [[nodiscard]] ControlLoad operator()(const SingularityTarget& target) const;
  [[nodiscard]] ControlLoad operator()(const VertexConstraint& constraint) const;
  [[nodiscard]] ControlLoad operator()(const Stroke& stroke) const;
  [[nodiscard]] ControlLoad operator()(const BoundaryAlignment& alignment) const;

  /// The field at a point in the face's frame.
  [[nodiscard]] ControlRow point_row(const SurfacePoint& p) const;

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

/// Throws OptionError for a face the mesh has not or coordinates outside it.
void check_surface_point(const Mesh& mesh, const SurfacePoint& p, const char* name);
/// Throws OptionError for a face, sign, count, strength or orientation that cannot be.
void check_target(const Mesh& mesh, const SingularityTarget& target);

}  // namespace alcap::detail
