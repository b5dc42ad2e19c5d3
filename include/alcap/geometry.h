// SPDX-License-Identifier: MIT
//
// geometry.h: lengths, angles, areas and angle defects of a mesh, from positions or from edge lengths.
//
// Everything a connection or an energy needs is intrinsic: corner angles, their cotangents, areas, edge lengths.
//
//   alcap::Geometry<double> geometry(mesh, V);
//   double k = geometry.defect(mesh, v);       // 2 pi - sum of angles, pi - sum at a boundary vertex
#pragma once

#include "alcap/conventions.h"
#include "alcap/mesh.h"

namespace alcap {

template <class T>
class Geometry {
 public:
  Geometry() = default;

  /// From positions (#V x 3). Throws MeshError (not_finite, zero_length_edge, zero_area_face) naming the elements,
  /// OptionError when V has not mesh.vertices() rows.
  Geometry(const Mesh& mesh, const Eigen::Ref<const Positions<T>>& V);

  /// From edge lengths (#E, in the order of mesh edges): an intrinsic surface, such as a flat torus, that need not lie
  /// in space. Throws MeshError (zero_area_face) when the triangle inequality fails.
  [[nodiscard]] static Geometry from_lengths(const Mesh& mesh, const VectorX<T>& lengths);

  [[nodiscard]] T length(Index e) const { return length_[e]; }
  /// Interior angle of corner c, in (0, pi).
  [[nodiscard]] T angle(Index c) const { return angle_[c]; }
  /// Cotangent of the angle of corner c.
  [[nodiscard]] T cot(Index c) const { return cot_[c]; }
  [[nodiscard]] T area(Index t) const { return area_[t]; }
  /// Sum of the corner angles around vertex v.
  [[nodiscard]] T angle_sum(Index v) const { return angle_sum_[v]; }
  /// 2 pi - angle sum at an interior vertex; pi - angle sum (the geodesic curvature's integral) at a boundary vertex.
  [[nodiscard]] T defect(const Mesh& mesh, Index v) const {
    return (mesh.boundary_vertex(v) ? pi<T> : T(2) * pi<T>)-angle_sum_[v];
  }
  /// Direction of halfedge h in its face's frame (the frame is halfedge 3 t): 0, pi - angle(1), pi + angle(0).
  [[nodiscard]] T direction(Index h) const {
    const Index c = h % 3;
    return c == 0 ? T(0) : c == 1 ? pi<T> - angle_[h] : pi<T> + angle_[h - 2];
  }

  [[nodiscard]] const VectorX<T>& lengths() const { return length_; }
  [[nodiscard]] const VectorX<T>& angles() const { return angle_; }
  [[nodiscard]] const VectorX<T>& cots() const { return cot_; }
  [[nodiscard]] const VectorX<T>& areas() const { return area_; }
  /// Sum of all areas, over fixed chunks.
  [[nodiscard]] T total_area() const { return total_area_; }

 private:
  void sum_angles(const Mesh& mesh);

  VectorX<T> length_, angle_, cot_, area_, angle_sum_;
  T total_area_ = 0;
};

extern template class Geometry<float>;
extern template class Geometry<double>;

}  // namespace alcap
