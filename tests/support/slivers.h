// SPDX-License-Identifier: MIT
//
// slivers.h: good meshes made bad.
#pragma once

#include <array>
#include <vector>

#include "alcap/generators.h"
#include "alcap/mesh.h"

namespace alcap::test {

/// A face at every `step`-th edge gets a vertex at `height` of its height above the middle of that edge: a sliver.
inline MeshData with_slivers(const MeshData& s, Index step, double height) {
  const Mesh mesh(s.F, s.V.rows());
  std::vector<char> used(static_cast<std::size_t>(mesh.faces()), 0);
  std::vector<Eigen::RowVector3d> points;
  std::vector<std::array<Index, 3>> more;
  Faces F = s.F;
  for (Index e = 0; e < mesh.edges(); e += step) {
    // Inside one face, next to an edge: the face becomes three, one of them a sliver with its longest side on the edge.
    const Index h = mesh.halfedge(e), t = Mesh::face(h);
    if (used[static_cast<std::size_t>(t)] != 0) continue;
    used[static_cast<std::size_t>(t)] = 1;
    const Index i = mesh.tail(h), j = mesh.tip(h), k = mesh.tip(Mesh::next(h));
    const Index p = static_cast<Index>(s.V.rows()) + static_cast<Index>(points.size());
    points.emplace_back(((1 - height) / 2) * (s.V.row(i) + s.V.row(j)) + height * s.V.row(k));
    F.row(t) << i, j, p;
    more.push_back({j, k, p});
    more.push_back({k, i, p});
  }
  MeshData out{Positions<double>(s.V.rows() + static_cast<Index>(points.size()), 3),
               Faces(F.rows() + static_cast<Index>(more.size()), 3)};
  out.V.topRows(s.V.rows()) = s.V;
  for (std::size_t k = 0; k < points.size(); ++k) out.V.row(s.V.rows() + static_cast<Index>(k)) = points[k];
  out.F.topRows(F.rows()) = F;
  for (std::size_t k = 0; k < more.size(); ++k)
    out.F.row(F.rows() + static_cast<Index>(k)) << more[k][0], more[k][1], more[k][2];
  return out;
}

}  // namespace alcap::test
