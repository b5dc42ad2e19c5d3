// SPDX-License-Identifier: MIT
//
// repaired_surface.cpp: points and triangles, repaired as asked, as a surface.
#include <algorithm>
#include <utility>

#include "alcap/field_run.h"
#include "alcap/mesh_check.h"
#include "src/base/numbers.h"
#include "src/base/parallel.h"

namespace alcap {
namespace {

using detail::counted;
using detail::number_text;

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

// In a mollified surface any two sides are longer than the third by at least this part of the mean edge (Sharp and
// Crane 2020, Sec. 4.5, who take the same).
constexpr double mollify_margin = 1e-5;

/// The surface whose edges are as long as they are in space, plus the least length that gives every face this margin.
Surface mollified(Positions<double> V, Mesh mesh, RepairedSurface& out) {
  for (const DefectReport& defect : find_defects(V, mesh.F()))
    if (defect.defect != Defect::zero_area_face && defect.defect != Defect::zero_length_edge) throw_defect(defect);
  VectorX<double> lengths(mesh.edges());
  parallel_for(mesh.edges(), [&](std::int64_t e) {
    const Index h = mesh.halfedge(static_cast<Index>(e));
    lengths[e] = (V.row(mesh.tip(h)) - V.row(mesh.tail(h))).stableNorm();
  });
  const double margin = mollify_margin *
                        parallel_sum<double>(mesh.edges(), [&](std::int64_t e) { return lengths[e]; }) /
                        static_cast<double>(mesh.edges());
  const auto lacks = [&](Index h) {
    const double side = lengths[mesh.edge(h)];
    return margin + side - lengths[mesh.edge(Mesh::next(h))] - lengths[mesh.edge(Mesh::prev(h))];
  };
  const double longer = parallel_reduce(
      mesh.halfedges(), 0.0,
      [&](std::int64_t begin, std::int64_t end) {
        double most = 0;
        for (std::int64_t h = begin; h < end; ++h) most = std::max(most, lacks(static_cast<Index>(h)));
        return most;
      },
      [](double a, double b) { return std::max(a, b); });
  if (!(longer > 0)) return Surface::from_mesh(std::move(V), std::move(mesh));
  Remark remark{.code = "mollified", .warning = false};
  for (Index t = 0; t < mesh.faces(); ++t) {
    if (!(std::max({lacks(3 * t), lacks(3 * t + 1), lacks(3 * t + 2)}) > 0)) continue;
    if (remark.count++ < 8) remark.first.push_back(t);
  }
  remark.message = "every edge was taken longer by " + number_text(longer) + ", so that " +
                   counted(remark.count, "face has", "faces have") + " an area; the mean edge is " +
                   number_text(margin / mollify_margin) + " long";
  out.remarks.push_back(std::move(remark));
  lengths.array() += longer;
  return Surface::from_lengths(std::move(mesh), lengths, std::move(V));
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
  const bool mollify = std::find(now.repairs.begin(), now.repairs.end(), Repair::mollify) != now.repairs.end();
  out.surface =
      mollify ? mollified(std::move(V), std::move(mesh), out) : Surface::from_mesh(std::move(V), std::move(mesh));
  return out;
}

}  // namespace alcap
