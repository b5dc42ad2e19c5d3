// SPDX-License-Identifier: MIT
//
// rings.h: the corners around vertices of the users' numbering, wherever the faces were read. Internal to
// src/distributed.
#pragma once

#include <array>
#include <vector>

#include "src/distributed/exchange.h"

namespace alcap::detail::distributed {

/// One corner: its face in the users' numbering and its place there, the vertex after it in the face, and the one
/// before. Halfedges have no numbers across ranks: of a billion faces they would not fit an Index.
using Corner = std::array<Index, 4>;

/// Corners by vertex: those of vertex k are [start[k], start[k + 1]).
struct Rings {
  std::vector<Index> start;
  std::vector<Corner> corners;
};

/// The corners around each vertex of this rank's slice.
[[nodiscard]] Rings rings_of_slice(const MeshSlice& mesh);

/// The corners around any vertices, from the ranks in whose slices they lie.
[[nodiscard]] Rings fetch_rings(const Rings& of_slice, const Slices& slices, const std::vector<Index>& vertices);

/// Whether PT-Scotch can divide a graph with so many ends of edges.
[[nodiscard]] bool scotch_can_number(std::int64_t ends_of_edges);

/// Who shall own each vertex of this rank's slice; `method` becomes what was done.
[[nodiscard]] petsc::Owned<IS, ISDestroy> partition(const MeshSlice& mesh, const Rings& of_slice,
                                                    PartitionMethod wanted, std::string& method);

}  // namespace alcap::detail::distributed
