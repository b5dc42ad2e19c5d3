// SPDX-License-Identifier: MIT
//
// patch.h: what a rank holds of the mesh: the vertices that it owns, their neighbours (the ring), every face around
// both, and the vertices beyond (the rim). Around owned vertices and the ring the mesh is complete, so that angles,
// directions of edges and the rotations between them come out as on one machine, bit for bit: faces keep their order,
// and with it the first halfedge of every vertex. Internal to src/distributed.
#pragma once

#include <string>
#include <vector>

#include "alcap/geometry.h"
#include "alcap/mesh.h"
#include "src/distributed/exchange.h"

namespace alcap::detail::distributed {

struct Patch {
  /// User's number of each local vertex: owned ones ascending, then the ring, then the rim. A vertex of the rim where
  /// several fans of faces meet appears once for each.
  std::vector<Index> vertex;
  Index owned = 0;  ///< how many
  Index inner = 0;  ///< owned and ring: vertices whose faces are all here
  /// Row of each inner vertex in matrices: those of rank 0, then those of rank 1, ...
  std::vector<Index> row;
  Index first_row = 0;
  std::vector<Index> face;      ///< user's number of each local face, ascending
  std::vector<char> core;       ///< per local face: it has an owned vertex
  std::vector<char> mine;       ///< per local face: its smallest vertex is owned; every face is some rank's
  Mesh mesh;                    ///< empty, with no vertices, where no face uses an owned vertex
  Positions<double> V;          ///< local vertices
  Geometry geometry;            ///< of `mesh`
  std::vector<Node> ring_node;  ///< who owns each vertex of the ring, and its number there
  Exchange ring;                ///< roots: owned vertices; leaves: the ring
  Exchange home;                ///< roots: vertices of the slice in the users' numbering; leaves: owned vertices

  [[nodiscard]] bool empty() const { return face.empty(); }
  /// Extends values at owned vertices to the inner ones.
  template <class T>
  void extend(T* values) const {
    ring.fetch(values, values + owned);
  }
};

/// Gives every fan of faces at a vertex from `from` on a vertex of its own, where several meet; the vertex that each
/// new one, numbered from `count` on, is a copy of.
[[nodiscard]] std::vector<Index> split_fans(Faces& F, Index from, Index count);

/// Values at owned vertices at all local ones, those of the rim too.
[[nodiscard]] VectorX<double> at_local_vertices(const Patch& patch, const VectorX<double>& owned);

struct Partitioned {
  Patch patch;
  std::string method;
  std::int64_t cut_edges = 0;
};

/// Distributes the vertices and builds every rank's patch. Throws MeshError, on all ranks, with users' numbers.
[[nodiscard]] Partitioned make_patch(const MeshSlice& mesh, PartitionMethod method);

/// Lengths and angles of the patch, once its mesh is there. Throws MeshError on all ranks.
void measure(Patch& patch);

}  // namespace alcap::detail::distributed
