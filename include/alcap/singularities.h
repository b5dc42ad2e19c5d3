// SPDX-License-Identifier: MIT
//
// singularities.h: where an n-field vanishes: the index of every face, the zero inside it and its orientation.
//
// The index of a face is (1/2pi) [sum over its halfedges of wrap(arg u_j - arg u_i + n rho_ij) + n K], an integer count
// of n-ths (LTGD 2016, Sec. 4; math of Crane et al. 2010). On a closed surface the counts sum to n chi (Poincare-Hopf).
//
//   const std::vector<int> indices = alcap::face_indices(connected, field);
//   for (const alcap::Singularity& s : alcap::find_singularities(connected, field, indices)) ... s.face, s.index ...
//
// The forms that take mesh, geometry and connection do the same for those who own the parts.
#pragma once

#include <array>
#include <concepts>
#include <vector>

#include "alcap/field.h"
#include "alcap/surface_path.h"
#include "alcap/topology.h"

namespace alcap {

class ConnectedSurface;

/// A face of non-zero index.
struct Singularity {
  Index face = none;                    ///< the face it lies in
  std::array<double, 3> barycentric{};  ///< where the field vanishes inside the face; the barycenter when not found
  int index = 0;                        ///< in n-ths: a cross field's +1/4 has index 1, n = 4
  /// Turn of the pattern around its own centre, radians, in the face's frame: see SingularityTarget::orientation.
  double orientation = 0;
  bool located = false;  ///< whether the zero was found inside the face to rounding

  /// The zero as a point of the surface.
  [[nodiscard]] SurfacePoint point() const { return {face, barycentric}; }
};

/// Where a singularity lies in space. Throws OptionError when the surface has no such face or lies in no space. Takes
/// nothing else: position(surface, {face, {b0, b1, b2}}) stays that of a SurfacePoint.
[[nodiscard]] Eigen::RowVector3d position(const Surface& surface, const std::same_as<Singularity> auto& singularity) {
  return position(surface, singularity.point());
}

/// Poincare-Hopf on one component: what the indices sum to and what they should.
struct IndexSum {
  std::int64_t sum = 0;       ///< sum of face counts (n-ths)
  std::int64_t expected = 0;  ///< n chi + turns of the field along the boundary loops relative to their tangents
};

/// Counts of n-ths per face, #F. Where u is exactly zero at a corner its argument counts as 0: sums still hold.
[[nodiscard]] std::vector<int> face_indices(const ConnectedSurface& surface, const Field& field);
[[nodiscard]] std::vector<int> face_indices(const Mesh& mesh, const Connection& connection, const Field& field);

/// The count of one face.
[[nodiscard]] int face_index(const ConnectedSurface& surface, const Field& field, Index t);
[[nodiscard]] int face_index(const Mesh& mesh, const Connection& connection, const Field& field, Index t);

/// All faces of non-zero index, with position and orientation, in order of faces. `indices` are those of
/// face_indices(), where they are at hand.
[[nodiscard]] std::vector<Singularity> find_singularities(const ConnectedSurface& surface, const Field& field);
[[nodiscard]] std::vector<Singularity> find_singularities(const ConnectedSurface& surface, const Field& field,
                                                          const std::vector<int>& indices);
[[nodiscard]] std::vector<Singularity> find_singularities(const Mesh& mesh, const Geometry& geometry,
                                                          const Connection& connection, const Field& field);
[[nodiscard]] std::vector<Singularity> find_singularities(const Mesh& mesh, const Geometry& geometry,
                                                          const Connection& connection, const Field& field,
                                                          const std::vector<int>& indices);

/// Poincare-Hopf, one entry per component. On components with boundary the expected value uses the field's own turns
/// along the loops, computed from boundary data alone.
[[nodiscard]] std::vector<IndexSum> index_sums(const ConnectedSurface& surface, const Field& field,
                                               const std::vector<int>& indices);
[[nodiscard]] std::vector<IndexSum> index_sums(const Mesh& mesh, const Geometry& geometry, const Connection& connection,
                                               const Field& field, const std::vector<int>& indices,
                                               const Topology& topology);

/// The index of every vertex of a field given per face (at_faces), by Levi-Civita transport across the edges around it:
/// #V counts of n-ths, what principal matching finds. Zero at boundary vertices and at those that no face uses. On a
/// closed surface they sum to n chi.
[[nodiscard]] std::vector<int> vertex_indices(const Surface& surface, const Field& face_field);
[[nodiscard]] std::vector<int> vertex_indices(const Mesh& mesh, const Geometry& geometry, const Field& face_field);

}  // namespace alcap
