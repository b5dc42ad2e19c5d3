// SPDX-License-Identifier: MIT
//
// mesh_repair.h: repairs of triangle meshes. None moves a vertex or gives one another number; every step says what it
// did.
//
//   alcap::RepairedMesh mesh = alcap::repair_mesh(V, F, {.repairs = {alcap::Repair::automatic}});
//   for (const alcap::RepairStep& step : mesh.steps) std::cout << step.message << "\n";
//   alcap::Surface surface(mesh.V, mesh.F);
#pragma once

#include <string>
#include <vector>

#include "alcap/conventions.h"
#include "alcap/names.h"

namespace alcap {

/// One repair. Those asked for are done in this order.
enum class Repair {
  weld,        ///< faces use the first vertex at each position: joins triangle soups
  degenerate,  ///< faces without area go: a short side becomes one vertex, a flat corner is flipped into its neighbour
  duplicates,  ///< of faces with the same three vertices only the first stays
  split,       ///< the surface is cut along edges of more than two faces
  orient,      ///< faces are turned so that neighbours agree
  /// Edges are taken a little longer than they are, all by the same, so that every face has an area (Sharp and Crane
  /// 2020). Of surfaces: repaired_surface() does it, repair_mesh() leaves it out.
  mollify,
  automatic,  ///< those of the first five that a surface needs, and no others
};
template <>
struct NamesOf<Repair> {
  static constexpr auto table = detail::name_table<Repair>({{Repair::weld, "weld"},
                                                            {Repair::degenerate, "degenerate"},
                                                            {Repair::duplicates, "duplicates"},
                                                            {Repair::split, "split"},
                                                            {Repair::orient, "orient"},
                                                            {Repair::mollify, "mollify"},
                                                            {Repair::automatic, "auto"}});
};

/// What is repaired.
struct RepairOptions {
  std::vector<Repair> repairs = {};  ///< in any order; none by default: a mesh is not changed unasked
  /// Of `weld`: vertices this close are one, in diagonals of the box around all points, in [0, 0.1]. 0: exactly the
  /// same position. Faces that lose a side by it are dropped.
  double weld_tolerance = 0;
  /// Gives each of the parts that meet at a vertex without sharing an edge there (bow-ties) a vertex of its own. The
  /// part with the smallest corner keeps the number, the copies are appended. Moves nothing, opens nothing.
  bool bow_ties = true;
};

/// One step that changed something.
struct RepairStep {
  std::string code;  ///< stable: "welded", "degenerate_repaired", "duplicates_removed", "edges_split", "reoriented",
                     ///< "bow_ties_split"
  std::int64_t count = 0;    ///< corners, faces, edges or vertices concerned
  std::vector<Index> first;  ///< the first faces or vertices of them, at most 8, in the numbers of the given mesh
  std::string message;       ///< one sentence
  Repair repair{};           ///< which; of bow-ties `split`
};

/// A mesh and what was done to it.
struct RepairedMesh {
  Positions<double> V;            ///< the given points, then the copies
  Faces F;                        ///< the faces that are left, in order
  std::vector<Index> copies_of;   ///< the given vertex that each appended one is a copy of
  std::vector<Index> face_of;     ///< the given number of each face; empty where all are kept
  std::vector<RepairStep> steps;  ///< in the order they were done
};

/// Repairs as asked; what cannot be repaired is left, and Surface refuses it by name. Throws OptionError for a bad
/// tolerance, MeshError where `orient` is impossible and for numbers out of range. O(F log valence) for every step.
[[nodiscard]] RepairedMesh repair_mesh(Positions<double> V, Faces F, const RepairOptions& options = {});

}  // namespace alcap
