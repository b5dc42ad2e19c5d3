// SPDX-License-Identifier: MIT
//
// intrinsic_mesh.h: a triangulation of a surface that may change: its edges are straight in the surface, not in space.
// Flips keep the surface as it is, splits add vertices to it. Internal to src/mesh.
//
// Halfedges are numbered as in mesh.h, 3 t + c; edges keep their numbers when they are flipped. Every triangle is kept
// by its lengths, its area and its cotangents: lengths alone lose the heights of slivers. Every halfedge knows its
// direction at its tail (signposts: Sharp, Soliman and Crane 2019): the angle counter-clockwise from the first halfedge
// of the surface there, of the angle_sum() around the vertex. It remains a simplicial complex: a flip that would give
// two vertices a second edge, or a vertex an edge to itself, is not done.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "alcap/surface.h"

namespace alcap::detail {

class IntrinsicMesh {
 public:
  /// `keep` lists edges of the surface that are not flipped; boundary edges never are.
  IntrinsicMesh(const Surface& surface, const std::vector<Index>& keep);

  [[nodiscard]] Index vertices() const { return static_cast<Index>(out_.size()); }
  [[nodiscard]] Index faces() const { return static_cast<Index>(twice_area_.size()); }
  [[nodiscard]] Index edges() const { return static_cast<Index>(half_.size()); }
  [[nodiscard]] Index halfedge(Index e) const { return half_[at(e)]; }
  [[nodiscard]] Index twin(Index h) const { return twin_[at(h)]; }
  [[nodiscard]] Index edge(Index h) const { return edge_[at(h)]; }
  [[nodiscard]] Index tail(Index h) const { return tail_[at(h)]; }
  [[nodiscard]] Index tip(Index h) const { return tail(Mesh::next(h)); }
  [[nodiscard]] double cot(Index h) const { return cot_[at(h)]; }
  [[nodiscard]] double length(Index e) const { return length_[at(e)]; }
  [[nodiscard]] double twice_area(Index t) const { return twice_area_[at(t)]; }
  [[nodiscard]] double angle_sum(Index v) const { return angle_sum_[at(v)]; }
  /// The surface's edge that e is, or is a part of, if it was to be kept; `none`.
  [[nodiscard]] Index kept(Index e) const { return kept_[at(e)]; }
  [[nodiscard]] bool fixed(Index e) const { return kept(e) != none || twin(halfedge(e)) == none; }
  /// Whether a fixed edge ends at v.
  [[nodiscard]] bool on_fixed(Index v) const { return on_fixed_[at(v)] != 0; }
  /// Direction of h at its tail, radians in [0, angle_sum).
  [[nodiscard]] double direction(Index h) const { return direction_[at(h)]; }

  /// Whether e is Delaunay up to rounding.
  [[nodiscard]] bool delaunay(Index e) const;
  /// Flips e if that is possible.
  bool flip(Index e);
  /// A vertex at the fraction s of the way along halfedge(e). Returns it.
  Index split_edge(Index e, double s);
  /// A vertex at the point (x, y) of face t in the frame of its first halfedge. Returns it.
  Index split_face(Index t, double x, double y);
  /// The three corners of a face in the frame of halfedge h, which runs along the x axis from 0.
  using Points = std::array<std::array<double, 2>, 3>;
  [[nodiscard]] Points layout(Index h) const;
  /// Calls body(h) for every halfedge that leaves v, and body(g) with the one that arrives last at a boundary.
  template <class Body>
  void for_each_around(Index v, Body&& body) const {
    const Index start = leftmost(v);
    for (Index h = start; h != none;) {
      body(h);
      const Index last = Mesh::prev(h);
      h = twin(last);
      if (h == none) body(last);
      if (h == start) return;
    }
  }

  /// Faces (#F x 3), as Mesh wants them.
  [[nodiscard]] Faces F() const;

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  struct Side {
    Index tail, twin, edge;
    double direction;
  };
  [[nodiscard]] Side side(Index h) const { return {tail(h), twin(h), edge(h), direction(h)}; }
  [[nodiscard]] Index leftmost(Index v) const;
  [[nodiscard]] bool joined(Index v, Index w) const;
  void put(Index h, const Side& side);
  void pair(Index g, Index h);
  void measure(Index t, const Points& p);
  [[nodiscard]] double corner(Index h) const { return std::atan2(1.0, cot(h)); }
  [[nodiscard]] double turned(Index v, double angle) const;
  Index add_vertex(double angle_sum, bool on_boundary, bool on_fixed);
  Index add_edge(double length, Index kept);
  Index add_face();

  std::vector<Index> tail_, twin_, edge_, half_, out_, valence_, kept_;
  std::vector<char> boundary_, on_fixed_;
  std::vector<double> cot_, direction_, length_, twice_area_, angle_sum_;
};

}  // namespace alcap::detail
