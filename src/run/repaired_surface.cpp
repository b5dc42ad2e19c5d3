// SPDX-License-Identifier: MIT
//
// repaired_surface.cpp: points and triangles, repaired as asked, as a surface.
#include <utility>

#include "alcap/field_run.h"

namespace alcap {
namespace {

void keep(RepairedMesh&& mesh, RepairedSurface& out) {
  for (RepairStep& step : mesh.steps)
    out.remarks.push_back({.code = std::move(step.code),
                           .warning = false,
                           .message = std::move(step.message),
                           .count = step.count,
                           .first = std::move(step.first)});
  out.copies_of = std::move(mesh.copies_of);
  out.face_of = std::move(mesh.face_of);
}

}  // namespace

RepairedSurface repaired_surface(Positions<double> V, Faces F, const RepairOptions& options) {
  RepairedSurface out;
  RepairOptions now = options;
  now.bow_ties = false;  // rare, and looking for them costs as much as making the mesh
  if (!now.repairs.empty()) {
    RepairedMesh mesh = repair_mesh(std::move(V), std::move(F), now);
    V = std::move(mesh.V);
    F = std::move(mesh.F);
    keep(std::move(mesh), out);
  }
  Faces spare = F;  // the mesh keeps the given ones, or loses them when it is refused
  Mesh mesh;
  try {
    mesh = Mesh(std::move(F), V.rows());
  } catch (const MeshError& e) {
    if (e.defect() != Defect::non_manifold_vertex || !options.bow_ties) throw;
    // Copies that an earlier step appended come first; a copy of a copy is one of its original.
    const std::vector<Index> before = std::move(out.copies_of), faces = std::move(out.face_of);
    const auto original = static_cast<Index>(V.rows()) - static_cast<Index>(before.size());
    RepairedMesh split = repair_mesh(std::move(V), std::move(spare), {});
    V = std::move(split.V);
    F = std::move(split.F);
    keep(std::move(split), out);
    for (Index& v : out.copies_of)
      if (v >= original) v = before[static_cast<std::size_t>(v - original)];
    out.copies_of.insert(out.copies_of.begin(), before.begin(), before.end());
    out.face_of = faces;
    mesh = Mesh(std::move(F), V.rows());
  }
  out.surface = Surface::from_mesh(std::move(V), std::move(mesh));
  return out;
}

}  // namespace alcap
