// SPDX-License-Identifier: MIT
//
// mesh_check.h: every defect of a triangle mesh at once, with the elements named and what to do about them, and the
// two repairs that change no geometry. Mesh and Geometry refuse a bad mesh with the first of these; `alcap info`
// prints them all.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "alcap/conventions.h"

namespace alcap {

/// One kind of defect: how many elements have it and which come first.
struct DefectReport {
  Defect defect{};         ///< what is wrong
  Element element{};       ///< what `first` lists
  std::int64_t count = 0;  ///< how many elements are concerned
  /// The first offenders (at most 8): vertex or face numbers, or pairs of vertices for edges.
  std::vector<Index> first;
  /// One sentence with the count, the names and the remedy.
  std::string message;
};

/// All topological defects of F (#F x 3) over `vertex_count` vertices, the ones to repair first in front: empty, index
/// out of range, repeated vertex, duplicate face, non-manifold edge, not orientable, inconsistent orientation,
/// non-manifold vertex. Nothing found means Mesh(F, vertex_count) works. A face that one of the first four names is
/// left out of the later checks. Safe on any numbers; O(F log valence) time, 40 bytes a halfedge.
[[nodiscard]] std::vector<DefectReport> find_defects(const Eigen::Ref<const Faces>& F, std::int64_t vertex_count);

/// All geometric defects of faces with in-range indices: points that are not finite (whether a face uses them or not),
/// edges between vertices at the same position, faces of area zero that have no such edge (see degenerate()), faces
/// larger or smaller than can be computed with (see measurable()).
[[nodiscard]] std::vector<DefectReport> find_defects(const Positions<double>& V, const Eigen::Ref<const Faces>& F);

/// Throws a report as MeshError.
[[noreturn]] void throw_defect(const DefectReport& report);

/// Whether the altitude of a triangle over its longest edge is below the rounding of its coordinates, or a coordinate
/// is not finite. The answer does not depend on the unit of length: everything is measured against the largest extent.
[[nodiscard]] bool degenerate(const Eigen::Matrix<double, 1, 3>& a, const Eigen::Matrix<double, 1, 3>& b,
                              const Eigen::Matrix<double, 1, 3>& c);

/// Lengths up to this, and down to its inverse, can be computed with: products of four of them are numbers still.
inline constexpr double largest_length = 1e60;

/// Whether a triangle's longest side is within 1 / largest_length and largest_length, to within a factor of two.
[[nodiscard]] bool measurable(const Eigen::Matrix<double, 1, 3>& a, const Eigen::Matrix<double, 1, 3>& b,
                              const Eigen::Matrix<double, 1, 3>& c);

/// Faces re-oriented so that neighbours agree: in each component the orientation of its smallest face wins.
/// `flipped` receives the numbers of the turned faces; a face is turned by exchanging its last two vertices. Throws
/// MeshError when that cannot be done (not_orientable, naming a face of each one-sided component), or a face is broken
/// or double, or an edge has more than two faces.
[[nodiscard]] Faces repair_orientation(const Eigen::Ref<const Faces>& F, std::int64_t vertex_count,
                                       std::vector<Index>* flipped = nullptr);

/// Faces that use, for every vertex, the first vertex at exactly the same position: welds triangle soups. Vertices keep
/// their numbers; the duplicates stay, unreferenced.
[[nodiscard]] Faces repair_weld(const Positions<double>& V, const Eigen::Ref<const Faces>& F);

/// How many vertices share their exact position with an earlier one.
[[nodiscard]] std::int64_t duplicate_positions(const Positions<double>& V);

}  // namespace alcap
