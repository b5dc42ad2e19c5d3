// SPDX-License-Identifier: MIT
//
// face_pairs.h: pairs of faces across edges, each face in at most one. The globally optimal connection solves for the
// edge between two paired faces as it solves for their corners, exactly, so that only outer edges are left to iterate
// on. Pairs form across long edges: these lie opposite large angles, where D_E is stiff, and a stiff edge couples its
// faces so strongly that edges one by one see little of what moves both.
#pragma once

#include "alcap/geometry.h"
#include "alcap/mesh.h"
#include "src/base/large_array.h"

namespace alcap::detail {

struct FacePairs {
  Index pairs = 0, singles = 0, outer = 0;
  LargeArray<Index> between{0};  ///< #pairs: the edge between the two faces; its canonical halfedge lies in the first
  LargeArray<Index> single{0};   ///< #singles: a face
  LargeArray<Index> edge{0};     ///< #outer: the edge that has this number among the outer ones, ascending
  LargeArray<Index> number{0};   ///< #E: its number among the outer ones, or `outer` plus the pair it lies in
};

/// Independent of threads. Some nine tenths of all faces are paired.
[[nodiscard]] FacePairs pair_faces(const Mesh& mesh, const Geometry& geometry);

/// The same without pairs.
[[nodiscard]] FacePairs single_faces(const Mesh& mesh);

}  // namespace alcap::detail
