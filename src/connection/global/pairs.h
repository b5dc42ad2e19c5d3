// SPDX-License-Identifier: MIT
//
// pairs.h: pairs of faces across edges, each face in at most one. The globally optimal connection solves for the
// edge between two paired faces as it solves for their corners, exactly, so that only outer edges are left to iterate
// on. Pairs form across long edges: these lie opposite large angles, where D_E is stiff, and a stiff edge couples its
// faces so strongly that edges one by one see little of what moves both.
#pragma once

#include "alcap/geometry.h"
#include "alcap/mesh.h"
#include "src/base/array.h"

namespace alcap::detail {

struct FacePairs {
  Index pairs = 0, singles = 0, outer = 0;
  Array<Index> between;  ///< #pairs: the edge between the two faces; its canonical halfedge lies in the first
  Array<Index> single;   ///< #singles: a face
  Array<Index> edge;     ///< #outer: the edge that has this number among the outer ones, ascending
  Array<Index> number;   ///< #E: its number among the outer ones, or `outer` plus the pair it lies in
};

/// Independent of threads. Some nine tenths of all faces are paired.
[[nodiscard]] FacePairs pair_faces(const Mesh& mesh, const Geometry& geometry);

/// The same without pairs.
[[nodiscard]] FacePairs single_faces(const Mesh& mesh);

}  // namespace alcap::detail
