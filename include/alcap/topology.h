// SPDX-License-Identifier: MIT
//
// topology.h: connected components, boundary loops, genus, and cycles that generate the homology of a mesh.
//
// Boundary loops keep the surface on their left. A generator is a closed strip of faces: it leaves face(h) through each
// of its halfedges h into face(twin(h)). Everything is numbered by first appearance in the faces, so the result depends
// on nothing but the faces.
//
//   for (const auto& c : surface.topology().components) { ... c.genus, c.boundary_loops ... }
//   const std::vector<alcap::Loop> generators = alcap::homology_generators(surface);
#pragma once

#include <vector>

#include "alcap/mesh.h"

namespace alcap {

class Surface;

/// A closed path given by the halfedges it follows (a boundary loop) or crosses (a generator), in order.
struct Loop {
  Index component = none;        ///< which component it bounds
  std::vector<Index> halfedges;  ///< in order, the surface on their left
};

/// One connected component of the faces and their vertices.
struct ComponentInfo {
  Index vertices = 0;  ///< that faces use
  Index edges = 0;     ///< how many
  Index faces = 0;     ///< how many
  /// vertices - edges + faces = 2 - 2 genus - boundary_loops.
  Index euler = 0;
  Index genus = 0;           ///< number of handles
  Index boundary_loops = 0;  ///< how many
  /// The smallest face.
  Index first_face = none;
};

/// Components, boundary loops and the Euler characteristic of a mesh.
struct Topology {
  /// In the order of their smallest faces.
  std::vector<ComponentInfo> components;
  /// #V: the component of each vertex, `none` for vertices no face uses.
  std::vector<Index> vertex_component;
  /// #F: the component of each face.
  std::vector<Index> face_component;
  /// In the order of their smallest boundary halfedges, with which they start: tip(h_k) = tail(h_{k+1}), cyclically.
  std::vector<Loop> loops;

  /// Sum over the components.
  [[nodiscard]] Index euler() const {
    Index sum = 0;
    for (const ComponentInfo& c : components) sum += c.euler;
    return sum;
  }
};

/// Components, boundary loops, Euler characteristics and genera. O(V + F).
[[nodiscard]] Topology find_topology(const Mesh& mesh);

/// 2 genus closed strips of faces per component, in the order of the components. Together with the boundary loops (all
/// but one of each component) they generate the first homology group; on closed components they are a basis. Short in
/// the greedy sense: shortest among the cycles through the first face before the parts passed twice are cut away.
/// Tree-cotree decomposition (Eppstein 2003) with a breadth-first cotree and a maximum tree (Erickson and Whittlesey
/// 2005), each boundary loop shrunk to a point. O(F log V) at worst, no work for genus 0.
[[nodiscard]] std::vector<Loop> homology_generators(const Surface& surface);
[[nodiscard]] std::vector<Loop> homology_generators(const Mesh& mesh, const Topology& topology);

/// A part of a mesh as a mesh of its own, and where its elements come from.
struct Piece {
  Positions<double> V;  ///< its points
  Faces F;              ///< its triangles, in its own numbers
  /// Number in the whole mesh of each vertex and face of the piece, ascending.
  std::vector<Index> vertices, faces;  ///< their numbers in the whole mesh
};

/// One component as a mesh of its own; elements keep their order. O(V + F). Throws OptionError when there is no such
/// component. The second form is for those who own the parts; V is #V x 3 with the vertices of `mesh`.
[[nodiscard]] Piece extract_component(const Surface& surface, Index component);
[[nodiscard]] Piece extract_component(const Mesh& mesh, const Positions<double>& V, const Topology& topology,
                                      Index component);

/// All components, each as extract_component() gives it, O(V + F) altogether.
[[nodiscard]] std::vector<Piece> split_components(const Surface& surface);
[[nodiscard]] std::vector<Piece> split_components(const Mesh& mesh, const Positions<double>& V,
                                                  const Topology& topology);

}  // namespace alcap
