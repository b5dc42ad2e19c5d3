// SPDX-License-Identifier: MIT
//
// mesh.h: the connectivity of an oriented 2-manifold triangle mesh as immutable half-edge arrays.
//
// Halfedge h = 3 t + c runs from F(t,c) to F(t,(c+1)%3); corner h is the corner at its tail. Vertices and faces
// keep the user's numbers. Edges are numbered by the smaller of their halfedges (the canonical one), in order.
//
//   Eigen::MatrixXi F = ...;                   // #F x 3, counter-clockwise
//   alcap::Mesh mesh(F, V.rows());             // throws MeshError and names the elements if it cannot
//   for (Index h = mesh.first(v); h != none; h = mesh.next_around(h, v)) { ... }   // the corners around v
//   Index h = mesh.halfedge(i, j);             // from vertex i to vertex j, or none
#pragma once

#include <cstdint>

#include "alcap/conventions.h"

namespace alcap {

/// Half-edges of an oriented manifold. Immutable, safe to share between threads.
class Mesh {
 public:
  Mesh() = default;

  /// Builds from faces (#F x 3, indices in [0, vertex_count)). Vertices that no face uses are allowed.
  /// Throws MeshError (empty, index_out_of_range, repeated_vertex_in_face, duplicate_face, non_manifold_edge,
  /// inconsistent_orientation, not_orientable, non_manifold_vertex) naming the elements. O(F), parallel. The faces are
  /// kept: std::move them where memory counts.
  Mesh(Faces F, std::int64_t vertex_count);

  /// How many, unreferenced ones included.
  [[nodiscard]] Index vertices() const { return vertex_count_; }
  /// How many.
  [[nodiscard]] Index faces() const { return static_cast<Index>(F_.rows()); }
  /// How many.
  [[nodiscard]] Index edges() const { return static_cast<Index>(edge_halfedge_.size()); }
  /// 3 x faces.
  [[nodiscard]] Index halfedges() const { return 3 * faces(); }
  /// How many.
  [[nodiscard]] Index boundary_edges() const { return boundary_edges_; }
  /// How many vertices faces use.
  [[nodiscard]] Index referenced_vertices() const { return referenced_; }
  /// #F x 3, as given.
  [[nodiscard]] const Faces& F() const { return F_; }

  /// The face of halfedge h.
  [[nodiscard]] static Index face(Index h) { return h / 3; }
  /// The next halfedge of the face.
  [[nodiscard]] static Index next(Index h) { return h % 3 == 2 ? h - 2 : h + 1; }
  /// The one before in the face.
  [[nodiscard]] static Index prev(Index h) { return h % 3 == 0 ? h + 2 : h - 1; }
  /// The vertex that halfedge h starts at.
  [[nodiscard]] Index tail(Index h) const { return F_.data()[h]; }
  /// The vertex that halfedge h ends at.
  [[nodiscard]] Index tip(Index h) const { return F_.data()[next(h)]; }

  /// The halfedge on the other side, or `none` on the boundary.
  [[nodiscard]] Index twin(Index h) const { return twin_[h]; }
  /// The edge of halfedge h.
  [[nodiscard]] Index edge(Index h) const { return edge_[h]; }
  /// The canonical halfedge of edge e.
  [[nodiscard]] Index halfedge(Index e) const { return edge_halfedge_[e]; }
  /// The halfedge from vertex i to vertex j; `none` when no edge joins them, when i = j, and when the edge lies on the
  /// boundary and its only halfedge runs from j to i. Throws OptionError for a number that is not a vertex. O(valence).
  [[nodiscard]] Index halfedge(Index i, Index j) const;
  /// The edge that joins vertices i and j, in either direction; `none` when there is none. Throws OptionError for a
  /// number that is not a vertex. O(valence).
  [[nodiscard]] Index edge(Index i, Index j) const;
  /// Whether h is the canonical halfedge of its edge.
  [[nodiscard]] bool canonical(Index h) const { return halfedge(edge(h)) == h; }

  /// The first halfedge that leaves v: the smallest at an interior vertex, the boundary halfedge at a boundary vertex
  /// (so that walking counter-clockwise meets every corner); `none` when no face uses v.
  [[nodiscard]] Index first(Index v) const { return first_[v]; }
  /// The next halfedge counter-clockwise around the tail of h, `none` after the last: at a boundary, or back at
  /// first(v).
  [[nodiscard]] Index next_around(Index h, Index v) const {
    const Index n = twin(prev(h));
    return n == first(v) ? none : n;
  }

  /// Whether halfedge h has no twin.
  [[nodiscard]] bool boundary_halfedge(Index h) const { return twin(h) == none; }
  /// Whether vertex v lies on the boundary.
  [[nodiscard]] bool boundary_vertex(Index v) const { return first(v) != none && twin(first(v)) == none; }
  /// Whether a face uses vertex v.
  [[nodiscard]] bool referenced(Index v) const { return first(v) != none; }
  /// Throws OptionError for the argument `name` when v is the number of no vertex.
  void check_vertex(const char* name, Index v) const;

  /// Calls body(h) for the halfedges that leave v, counter-clockwise.
  template <class Body>
  void for_each_outgoing(Index v, Body&& body) const {
    for (Index h = first(v); h != none; h = next_around(h, v)) body(h);
  }

 private:
  Faces F_;
  VectorX<Index> twin_, edge_, edge_halfedge_, first_;  // not zeroed when they are made, as std::vector is
  Index vertex_count_ = 0;
  Index boundary_edges_ = 0;
  Index referenced_ = 0;
};

}  // namespace alcap
