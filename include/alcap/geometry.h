// SPDX-License-Identifier: MIT
//
// geometry.h: lengths, angles, areas and angle defects of a mesh, from positions or from edge lengths.
//
// Everything a connection or an energy needs is intrinsic: corner angles, their cotangents, areas, edge lengths.
//
//   alcap::Geometry geometry(mesh, V);
//   double k = geometry.defect(mesh, v);       // 2 pi - sum of angles, pi - sum at a boundary vertex
#pragma once

#include "alcap/conventions.h"
#include "alcap/mesh.h"

namespace alcap {

/// Lengths, angles and areas of a mesh. Immutable, safe to share between threads.
class Geometry {
 public:
  Geometry() = default;

  /// From positions (#V x 3). Throws MeshError (not_finite, zero_length_edge, zero_area_face, scale_out_of_range)
  /// naming the elements, OptionError when V does not have mesh.vertices() rows.
  Geometry(const Mesh& mesh, const Eigen::Ref<const Positions<double>>& V);

  /// From edge lengths (#E, in the order of mesh edges): an intrinsic surface, such as a flat torus, that need not lie
  /// in space. Throws MeshError (zero_area_face) when the triangle inequality fails,
  /// (scale_out_of_range) when a length is not within 1 / largest_length and largest_length.
  [[nodiscard]] static Geometry from_lengths(const Mesh& mesh, const VectorX<double>& lengths);

  /// From measures that are known to more digits than lengths can tell them, as those of slivers: lengths (#E),
  /// cotangents of the corners (3 #F), areas (#F). That they fit each other is up to the caller. Throws OptionError for
  /// other sizes, MeshError (zero_area_face, scale_out_of_range) as from_lengths().
  [[nodiscard]] static Geometry from_measures(const Mesh& mesh, VectorX<double> lengths, VectorX<double> cots,
                                              VectorX<double> areas);

  /// Length of edge e.
  [[nodiscard]] double length(Index e) const { return length_[e]; }
  /// Interior angle of corner c, in (0, pi).
  [[nodiscard]] double angle(Index c) const { return angle_[c]; }
  /// Cotangent of the angle of corner c.
  [[nodiscard]] double cot(Index c) const { return cot_[c]; }
  /// Area of face t.
  [[nodiscard]] double area(Index t) const { return area_[t]; }
  /// Sum of the corner angles around vertex v.
  [[nodiscard]] double angle_sum(Index v) const { return angle_sum_[v]; }
  /// 2 pi - angle sum at an interior vertex; pi - angle sum (the geodesic curvature's integral) at a boundary vertex.
  [[nodiscard]] double defect(const Mesh& mesh, Index v) const {
    return (mesh.boundary_vertex(v) ? pi<double> : double(2) * pi<double>)-angle_sum_[v];
  }
  /// Direction of halfedge h in its face's frame (the frame is halfedge 3 t): 0, pi - angle(1), pi + angle(0).
  [[nodiscard]] double direction(Index h) const {
    const Index c = h % 3;
    return c == 0 ? double(0) : c == 1 ? pi<double> - angle_[h] : pi<double> + angle_[h - 2];
  }

  /// #E.
  [[nodiscard]] const VectorX<double>& lengths() const { return length_; }
  /// 3 #F, by corner.
  [[nodiscard]] const VectorX<double>& angles() const { return angle_; }
  /// 3 #F, by corner.
  [[nodiscard]] const VectorX<double>& cots() const { return cot_; }
  /// #F.
  [[nodiscard]] const VectorX<double>& areas() const { return area_; }
  /// Sum of all areas, over fixed chunks.
  [[nodiscard]] double total_area() const { return total_area_; }

 private:
  void sum_angles(const Mesh& mesh);

  VectorX<double> length_, angle_, cot_, area_, angle_sum_;
  double total_area_ = 0;
};

}  // namespace alcap
