// SPDX-License-Identifier: MIT
//
// intrinsic_refine.h: flips until all edges are Delaunay, and Ruppert's refinement in the surface. Internal to
// src/mesh.
//
// A bad triangle is cured by a vertex at the centre of its circle, or nearer to its shortest edge where that is enough
// (off-centres: Uengoer 2009), found by walking straight from the triangle. Where the way, or the vertex's influence,
// meets a fixed edge, that edge is halved instead. Corners between fixed edges and
// at pointed vertices are the surface's own and stay. All choices are made in the order of a queue, serially: so the
// result does not depend on threads.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "alcap/intrinsic.h"
#include "src/mesh/intrinsic_mesh.h"

namespace alcap::detail {

/// Whether an edge with these cotangents opposite is Delaunay, up to rounding.
[[nodiscard]] bool delaunay_cotangents(double a, double b);

class DelaunayFlips {
 public:
  /// At most `most` flips per edge.
  DelaunayFlips(IntrinsicMesh& mesh, double most) : mesh_(mesh), most_(most) {}

  /// Every edge.
  void all();
  /// The edges of these faces, and those around every flip. `changed` receives the faces that were flipped.
  void around(const std::vector<Index>& faces, std::vector<Index>& changed);
  [[nodiscard]] std::int64_t count() const { return count_; }
  [[nodiscard]] bool complete() const { return complete_; }

 private:
  void ask(Index e);
  /// Whether some edge was flipped.
  bool empty_queue(std::vector<Index>* changed);

  IntrinsicMesh& mesh_;
  double most_;
  std::int64_t count_ = 0;
  bool complete_ = true;
  std::vector<Index> queue_;
  std::vector<char> queued_;  // by edge
};

class Refinement {
 public:
  Refinement(IntrinsicMesh& mesh, DelaunayFlips& flips, const IntrinsicOptions& options);

  void run();
  [[nodiscard]] bool complete() const { return complete_; }

 private:
  struct Bad {
    Index face;
    double cot[2];  // what it looked like
  };
  /// Where a straight walk ends: in a face, with its corners and the target, or at a fixed edge.
  struct Place {
    Index face = none, hit = none, corner = 0;
    IntrinsicMesh::Points p{};
    std::array<double, 2> target{};
  };

  [[nodiscard]] bool own_corner(Index h) const;
  [[nodiscard]] double squared_radius(Index t) const;
  /// Whether it has a corner that is too small and not the surface's own.
  [[nodiscard]] bool skinny(Index t) const;
  [[nodiscard]] bool encroached(Index h) const;
  void look_at(Index t);
  [[nodiscard]] bool same(const Bad& bad) const;
  void cure(const Bad& worst);
  [[nodiscard]] Place walk_to_cure(Index t);
  [[nodiscard]] IntrinsicMesh::Points across(const IntrinsicMesh::Points& p, std::size_t k, Index g) const;
  [[nodiscard]] Index influenced(const Place& place) const;
  void halve(Index e);
  void put_vertex(const Place& place);
  void settle(const std::vector<Index>& faces);

  IntrinsicMesh& mesh_;
  DelaunayFlips& flips_;
  double cot_;      // of the smallest angle
  double largest_;  // squared radius
  Index most_;
  std::int64_t steps_ = 0;  // of all walks
  bool complete_ = true;
  bool any_fixed_ = false;
  std::map<int, std::vector<Bad>> bad_;  // by the octave of the squared radius
  std::vector<Index> halves_;            // fixed edges to be halved
};

}  // namespace alcap::detail
