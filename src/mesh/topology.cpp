// SPDX-License-Identifier: MIT
//
// topology.cpp: components by joining faces across edges, in parallel, boundary loops, and parts as meshes of their
// own.
#include "alcap/topology.h"

#include <atomic>
#include <string>
#include <utility>

#include "src/base/array.h"
#include "src/base/cancel.h"
#include "src/base/parallel.h"

namespace alcap {
namespace {

using detail::Array;
using detail::at;

// Faces joined across edges by a forest in which every face points to a smaller one or to itself: the root of a
// component is its smallest face, whichever thread joined what.
class FaceForest {
 public:
  explicit FaceForest(Index faces) : parent_(faces) {
    parallel_for(faces, [&](std::int64_t t) { parent_[t] = static_cast<Index>(t); });
  }

  Index root(Index t) {
    for (Index above = load(t); above != t;) {
      const Index next = load(above);
      slot(t).compare_exchange_weak(above, next, std::memory_order_relaxed);  // halves the path; it may fail
      t = next;
      above = load(t);
    }
    return t;
  }

  void join(Index s, Index t) {
    for (;;) {
      s = root(s);
      t = root(t);
      if (s == t) return;
      if (s < t) std::swap(s, t);
      Index expected = s;
      if (slot(s).compare_exchange_strong(expected, t, std::memory_order_relaxed)) return;
    }
  }

 private:
  std::atomic_ref<Index> slot(Index t) { return std::atomic_ref<Index>(parent_[t]); }
  Index load(Index t) { return slot(t).load(std::memory_order_relaxed); }
  Array<Index> parent_;
};

// Components in the order of their smallest faces.
void find_components(const Mesh& mesh, Topology& topology) {
  FaceForest forest(mesh.faces());
  parallel_for(mesh.edges(), [&](std::int64_t e) {
    const Index h = mesh.halfedge(static_cast<Index>(e)), g = mesh.twin(h);
    if (g != none) forest.join(Mesh::face(h), Mesh::face(g));
  });
  Array<Index> number(mesh.faces());
  parallel_for(mesh.faces(), [&](std::int64_t t) { number[t] = forest.root(static_cast<Index>(t)) == t ? 1 : 0; });
  topology.components.resize(at(parallel_exclusive_scan(number.data(), mesh.faces())));
  topology.face_component.resize(at(mesh.faces()));
  parallel_for(mesh.faces(), [&](std::int64_t t) {
    const Index root = forest.root(static_cast<Index>(t));
    const Index component = number[root];
    topology.face_component[at(t)] = component;
    if (root == t) topology.components[at(component)].first_face = root;
  });
  topology.vertex_component.resize(at(mesh.vertices()));
  parallel_for(mesh.vertices(), [&](std::int64_t v) {
    const Index h = mesh.first(static_cast<Index>(v));
    topology.vertex_component[at(v)] = h == none ? none : topology.face_component[at(Mesh::face(h))];
  });
}

void trace_loops(const Mesh& mesh, Topology& topology) {
  if (mesh.boundary_edges() == 0) return;
  Array<char> seen(mesh.halfedges(), 0);
  for (Index start = 0; start < mesh.halfedges(); ++start) {
    detail::check_cancelled_at(start);
    if (!mesh.boundary_halfedge(start) || seen[start] != 0) continue;
    Loop loop{topology.face_component[at(Mesh::face(start))], {}};
    // The first halfedge of a boundary vertex is its boundary halfedge.
    for (Index h = start; seen[h] == 0; h = mesh.first(mesh.tip(h))) {
      seen[h] = 1;
      loop.halfedges.push_back(h);
    }
    topology.loops.push_back(std::move(loop));
  }
}

}  // namespace

Topology find_topology(const Mesh& mesh) {
  Topology topology;
  find_components(mesh, topology);
  trace_loops(mesh, topology);
  std::vector<ComponentInfo>& components = topology.components;
  if (components.size() == 1) {
    components[0].vertices = mesh.referenced_vertices();
    components[0].edges = mesh.edges();
    components[0].faces = mesh.faces();
  } else {
    for (const Index c : topology.vertex_component) {
      if (c != none) ++components[at(c)].vertices;
    }
    for (const Index c : topology.face_component) ++components[at(c)].faces;
    for (Index e = 0; e < mesh.edges(); ++e) {
      ++components[at(topology.face_component[at(Mesh::face(mesh.halfedge(e)))])].edges;
    }
  }
  for (const Loop& loop : topology.loops) ++components[at(loop.component)].boundary_loops;
  for (ComponentInfo& c : components) {
    c.euler = c.vertices - c.edges + c.faces;
    c.genus = (2 - c.boundary_loops - c.euler) / 2;
  }
  return topology;
}

std::vector<Piece> split_components(const Mesh& mesh, const Positions<double>& V, const Topology& topology) {
  std::vector<Piece> pieces(topology.components.size());
  for (std::size_t c = 0; c < pieces.size(); ++c) {
    pieces[c].vertices.reserve(at(topology.components[c].vertices));
    pieces[c].faces.reserve(at(topology.components[c].faces));
  }
  Array<Index> number(mesh.vertices(), none);
  for (Index v = 0; v < mesh.vertices(); ++v) {
    const Index c = topology.vertex_component[at(v)];
    if (c == none) continue;
    number[v] = static_cast<Index>(pieces[at(c)].vertices.size());
    pieces[at(c)].vertices.push_back(v);
  }
  for (Index t = 0; t < mesh.faces(); ++t) pieces[at(topology.face_component[at(t)])].faces.push_back(t);
  for (Piece& piece : pieces) {
    detail::check_cancelled();
    piece.V.resize(static_cast<Eigen::Index>(piece.vertices.size()), 3);
    piece.F.resize(static_cast<Eigen::Index>(piece.faces.size()), 3);
    Eigen::Index row = 0;
    for (const Index v : piece.vertices) piece.V.row(row++) = V.row(v);
    row = 0;
    for (const Index t : piece.faces) {
      for (int c = 0; c < 3; ++c) piece.F(row, c) = number[mesh.F()(t, c)];
      ++row;
    }
  }
  return pieces;
}

Piece extract_component(const Mesh& mesh, const Positions<double>& V, const Topology& topology, Index component) {
  const auto count = static_cast<Index>(topology.components.size());
  if (component < 0 || component >= count) {
    throw OptionError("component", component, "the mesh has " + std::to_string(count) + " components, numbered from 0");
  }
  const ComponentInfo& info = topology.components[at(component)];
  Piece piece{Positions<double>(info.vertices, 3), Faces(info.faces, 3), {}, {}};
  piece.vertices.reserve(at(info.vertices));
  piece.faces.reserve(at(info.faces));
  Array<Index> number(mesh.vertices(), none);
  for (Index v = 0; v < mesh.vertices(); ++v) {
    if (topology.vertex_component[at(v)] != component) continue;
    number[v] = static_cast<Index>(piece.vertices.size());
    piece.V.row(number[v]) = V.row(v);
    piece.vertices.push_back(v);
  }
  for (Index t = 0; t < mesh.faces(); ++t) {
    if (topology.face_component[at(t)] != component) continue;
    const auto row = static_cast<Eigen::Index>(piece.faces.size());
    for (int c = 0; c < 3; ++c) piece.F(row, c) = number[mesh.F()(t, c)];
    piece.faces.push_back(t);
  }
  return piece;
}

}  // namespace alcap
