// SPDX-License-Identifier: MIT
//
// intrinsic_solve.h: an intrinsic triangulation that runs solve on, its connection, and how values at vertices go there
// and back. Internal to run.
#pragma once

#include <optional>
#include <vector>

#include "alcap/field_run.h"
#include "src/mesh/intrinsic_trace.h"

namespace alcap::detail {

/// Whether a run is solved on one. Throws OptionError where it is asked for by name and cannot be.
[[nodiscard]] bool wants_intrinsic(const Surface& surface, Triangulation kind, const ConnectionOptions& connection);

/// Refined to the angle, or, where the budget of vertices does not suffice for that and triangles would be worse,
/// flipped only (`complete` is false then). Nothing where one that was not asked for by name would not help. `keep`:
/// edges.
[[nodiscard]] std::optional<IntrinsicTriangulation> triangulate(const Surface& surface, Triangulation kind,
                                                                double min_angle, std::vector<Index> keep);

/// A triangulation with the connection asked for. Values on the given surface are in the frames of its locally optimal
/// connection, at whose vertices directions are those of the surface itself.
class IntrinsicSolve {
 public:
  /// `n` of the connection counts. Cones stay at their vertices, indices of loops at their loops.
  IntrinsicSolve(const Surface& given, IntrinsicTriangulation triangulation, ConnectionOptions connection);

  [[nodiscard]] const IntrinsicTriangulation& triangulation() const { return triangulation_; }
  /// What is solved on.
  [[nodiscard]] const ConnectedSurface& surface() const { return there_; }
  [[nodiscard]] Index given_vertices() const { return triangulation_.given_vertices; }

  [[nodiscard]] ComplexVectorX<double> to_given(const ComplexVectorX<double>& u, int n) const;
  /// Of one given vertex.
  [[nodiscard]] Complex<double> from_given(Index v, Complex<double> u, int n) const;
  /// Added vertices get the harmonic extension of the others: what turns and changes least between them.
  [[nodiscard]] ComplexVectorX<double> from_given(const ComplexVectorX<double>& u, int n) const;
  /// The same of numbers, which stay between their least and their largest.
  [[nodiscard]] VectorX<double> from_given(const VectorX<double>& x) const;
  /// Of a field there.
  [[nodiscard]] SolvedTriangulation summary(const Field& field) const;

 private:
  void find_turns();
  void extend(ComplexVectorX<double>& u, int n) const;

  IntrinsicTriangulation triangulation_;
  ConnectedSurface there_;
  VectorX<double> turn_;  // u in given frames is u exp(i n turn)
};

/// The connection's options there: the same cones, loops and curvature.
[[nodiscard]] ConnectionOptions connection_there(const Surface& given, const IntrinsicTriangulation& now,
                                                 ConnectionOptions options);

/// The same features on the triangulation that kept the edges `kept`, ascending, in as many edges as it made of them.
[[nodiscard]] FeatureGraph graph_on(const IntrinsicTriangulation& now, const std::vector<Index>& kept,
                                    const FeatureGraph& given);

/// What is worth saying about it: `singularities` were found on the mesh.
void remark_triangulation(const SolvedTriangulation& t, std::size_t singularities, std::vector<Remark>& remarks);

/// That one was wanted, but the mesh's own triangles had to do.
[[nodiscard]] Remark own_triangles();

}  // namespace alcap::detail
