// SPDX-License-Identifier: MIT
//
// homology.cpp: generators by tree-cotree decomposition. With every boundary loop shrunk to a point the surface is
// closed: a spanning tree of its faces, a spanning tree of its vertices across the edges the first leaves alone, and
// 2 genus edges are left over. Each of these closes one cycle in the tree of faces.
#include <algorithm>
#include <numeric>

#include "alcap/topology.h"
#include "src/base/array.h"
#include "src/base/cancel.h"

namespace alcap {
namespace {

using detail::Array;
using detail::at;

/// Breadth-first tree over the faces of every component that has handles.
struct FaceTree {
  Array<Index> entry;  // the halfedge through which the tree leaves the parent towards this face, `none` at roots
  Array<Index> depth;  // `none` for faces of components without handles
};

FaceTree grow_face_tree(const Mesh& mesh, const Topology& topology) {
  FaceTree tree{Array<Index>(mesh.faces(), none), Array<Index>(mesh.faces(), none)};
  std::vector<Index> queue;
  for (const ComponentInfo& component : topology.components) {
    if (component.genus == 0) continue;
    queue.assign(1, component.first_face);
    tree.depth[component.first_face] = 0;
    for (std::size_t q = 0; q < queue.size(); ++q) {
      detail::check_cancelled_at(static_cast<std::int64_t>(q));
      const Index t = queue[q];
      for (Index h = 3 * t; h < 3 * t + 3; ++h) {
        const Index twin = mesh.twin(h);
        if (twin == none || tree.depth[Mesh::face(twin)] != none) continue;
        tree.depth[Mesh::face(twin)] = tree.depth[t] + 1;
        tree.entry[Mesh::face(twin)] = h;
        queue.push_back(Mesh::face(twin));
      }
    }
  }
  return tree;
}

class DisjointSets {
 public:
  explicit DisjointSets(Index count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), Index{0}); }

  Index root(Index i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[at(i)]];
    return i;
  }
  /// Whether the two were apart.
  bool join(Index i, Index j) {
    i = root(i);
    j = root(j);
    parent_[std::max(i, j)] = std::min(i, j);
    return i != j;
  }

 private:
  Array<Index> parent_;
};

/// The cycle that crosses h out of face(h) and returns through the tree.
std::vector<Index> close_cycle(const Mesh& mesh, const FaceTree& tree, Index h) {
  std::vector<Index> down, up;  // from the meeting face to face(h); from face(twin(h)) to the meeting face
  Index s = Mesh::face(h), t = Mesh::face(mesh.twin(h));
  while (s != t) {
    if (tree.depth[s] >= tree.depth[t]) {
      const Index entry = tree.entry[s];
      down.push_back(entry);
      s = Mesh::face(entry);
    } else {
      const Index entry = tree.entry[t];
      up.push_back(mesh.twin(entry));
      t = Mesh::face(entry);
    }
  }
  std::vector<Index> cycle(down.rbegin(), down.rend());
  cycle.push_back(h);
  cycle.insert(cycle.end(), up.begin(), up.end());
  return cycle;
}

}  // namespace

std::vector<Loop> homology_generators(const Mesh& mesh, const Topology& topology) {
  std::vector<Loop> generators;
  const auto has_handles = [](const ComponentInfo& c) { return c.genus > 0; };
  if (std::none_of(topology.components.begin(), topology.components.end(), has_handles)) return generators;
  const FaceTree tree = grow_face_tree(mesh, topology);

  // Interior edges that the tree of faces does not cross, those that close the longest cycles first.
  std::vector<Index> candidates;
  const auto length = [&](Index h) { return tree.depth[Mesh::face(h)] + tree.depth[Mesh::face(mesh.twin(h))]; };
  for (Index e = 0; e < mesh.edges(); ++e) {
    detail::check_cancelled_at(e);
    const Index h = mesh.halfedge(e), twin = mesh.twin(h);
    if (twin == none || tree.depth[Mesh::face(h)] == none) continue;
    if (tree.entry[Mesh::face(twin)] != h && tree.entry[Mesh::face(h)] != twin) candidates.push_back(h);
  }
  std::stable_sort(candidates.begin(), candidates.end(), [&](Index a, Index b) { return length(a) > length(b); });

  DisjointSets sets(mesh.vertices());
  for (const Loop& loop : topology.loops) {
    for (const Index h : loop.halfedges) sets.join(mesh.tail(h), mesh.tip(h));
  }
  for (const Index h : candidates) {
    detail::check_cancelled();
    if (sets.join(mesh.tail(h), mesh.tip(h))) continue;
    generators.push_back({topology.face_component[at(Mesh::face(h))], close_cycle(mesh, tree, h)});
  }
  std::stable_sort(generators.begin(), generators.end(),
                   [](const Loop& a, const Loop& b) { return a.component < b.component; });
  return generators;
}

}  // namespace alcap
