// SPDX-License-Identifier: MIT
//
// topology.cpp: components by flooding the faces in order, boundary loops, and parts as meshes of their own.
#include "alcap/topology.h"

#include <string>

namespace alcap {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

void flood_components(const Mesh& mesh, Topology& topology) {
  topology.face_component.assign(at(mesh.faces()), none);
  topology.vertex_component.assign(at(mesh.vertices()), none);
  std::vector<Index> queue;
  for (Index seed = 0; seed < mesh.faces(); ++seed) {
    if (topology.face_component[at(seed)] != none) continue;
    const Index component = static_cast<Index>(topology.components.size());
    topology.components.emplace_back();
    topology.components.back().first_face = seed;
    topology.face_component[at(seed)] = component;
    queue.assign(1, seed);
    for (std::size_t q = 0; q < queue.size(); ++q) {
      for (Index h = 3 * queue[q]; h < 3 * queue[q] + 3; ++h) {
        topology.vertex_component[at(mesh.tail(h))] = component;
        const Index twin = mesh.twin(h);
        if (twin == none || topology.face_component[at(Mesh::face(twin))] != none) continue;
        topology.face_component[at(Mesh::face(twin))] = component;
        queue.push_back(Mesh::face(twin));
      }
    }
  }
}

void trace_loops(const Mesh& mesh, Topology& topology) {
  if (mesh.boundary_edges() == 0) return;
  std::vector<char> seen(at(mesh.halfedges()), 0);
  for (Index start = 0; start < mesh.halfedges(); ++start) {
    if (!mesh.boundary_halfedge(start) || seen[at(start)] != 0) continue;
    Loop loop{topology.face_component[at(Mesh::face(start))], {}};
    // The first halfedge of a boundary vertex is its boundary halfedge.
    for (Index h = start; seen[at(h)] == 0; h = mesh.first(mesh.tip(h))) {
      seen[at(h)] = 1;
      loop.halfedges.push_back(h);
    }
    topology.loops.push_back(std::move(loop));
  }
}

}  // namespace

Topology find_topology(const Mesh& mesh) {
  Topology topology;
  flood_components(mesh, topology);
  trace_loops(mesh, topology);
  std::vector<ComponentInfo>& components = topology.components;
  for (const Index c : topology.vertex_component) {
    if (c != none) ++components[at(c)].vertices;
  }
  for (const Index c : topology.face_component) ++components[at(c)].faces;
  for (Index e = 0; e < mesh.edges(); ++e) {
    ++components[at(topology.face_component[at(Mesh::face(mesh.halfedge(e)))])].edges;
  }
  for (const Loop& loop : topology.loops) ++components[at(loop.component)].boundary_loops;
  for (ComponentInfo& c : components) {
    c.euler = c.vertices - c.edges + c.faces;
    c.genus = (2 - c.boundary_loops - c.euler) / 2;
  }
  return topology;
}

template <class T>
std::vector<Piece<T>> split_components(const Mesh& mesh, const Positions<T>& V, const Topology& topology) {
  std::vector<Piece<T>> pieces(topology.components.size());
  for (std::size_t c = 0; c < pieces.size(); ++c) {
    pieces[c].vertices.reserve(at(topology.components[c].vertices));
    pieces[c].faces.reserve(at(topology.components[c].faces));
  }
  std::vector<Index> number(at(mesh.vertices()), none);
  for (Index v = 0; v < mesh.vertices(); ++v) {
    const Index c = topology.vertex_component[at(v)];
    if (c == none) continue;
    number[at(v)] = static_cast<Index>(pieces[at(c)].vertices.size());
    pieces[at(c)].vertices.push_back(v);
  }
  for (Index t = 0; t < mesh.faces(); ++t) pieces[at(topology.face_component[at(t)])].faces.push_back(t);
  for (Piece<T>& piece : pieces) {
    piece.V.resize(static_cast<Eigen::Index>(piece.vertices.size()), 3);
    piece.F.resize(static_cast<Eigen::Index>(piece.faces.size()), 3);
    Eigen::Index row = 0;
    for (const Index v : piece.vertices) piece.V.row(row++) = V.row(v);
    row = 0;
    for (const Index t : piece.faces) {
      for (int c = 0; c < 3; ++c) piece.F(row, c) = number[at(mesh.F()(t, c))];
      ++row;
    }
  }
  return pieces;
}

template <class T>
Piece<T> extract_component(const Mesh& mesh, const Positions<T>& V, const Topology& topology, Index component) {
  const auto count = static_cast<Index>(topology.components.size());
  if (component < 0 || component >= count) {
    throw OptionError("component", std::to_string(component),
                      "the mesh has " + std::to_string(count) + " components, numbered from 0");
  }
  const ComponentInfo& info = topology.components[at(component)];
  Piece<T> piece{Positions<T>(info.vertices, 3), Faces(info.faces, 3), {}, {}};
  piece.vertices.reserve(at(info.vertices));
  piece.faces.reserve(at(info.faces));
  std::vector<Index> number(at(mesh.vertices()), none);
  for (Index v = 0; v < mesh.vertices(); ++v) {
    if (topology.vertex_component[at(v)] != component) continue;
    number[at(v)] = static_cast<Index>(piece.vertices.size());
    piece.V.row(number[at(v)]) = V.row(v);
    piece.vertices.push_back(v);
  }
  for (Index t = 0; t < mesh.faces(); ++t) {
    if (topology.face_component[at(t)] != component) continue;
    const auto row = static_cast<Eigen::Index>(piece.faces.size());
    for (int c = 0; c < 3; ++c) piece.F(row, c) = number[at(mesh.F()(t, c))];
    piece.faces.push_back(t);
  }
  return piece;
}

template Piece<float> extract_component(const Mesh&, const Positions<float>&, const Topology&, Index);
template Piece<double> extract_component(const Mesh&, const Positions<double>&, const Topology&, Index);
template std::vector<Piece<float>> split_components(const Mesh&, const Positions<float>&, const Topology&);
template std::vector<Piece<double>> split_components(const Mesh&, const Positions<double>&, const Topology&);

}  // namespace alcap
