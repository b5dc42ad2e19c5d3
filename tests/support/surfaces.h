// SPDX-License-Identifier: MIT
//
// surfaces.h: surfaces with their globally optimal connection, and a flat one without positions.
#pragma once

#include <utility>

#include "alcap/connected_surface.h"
#include "alcap/generators.h"

namespace alcap::test {

inline ConnectedSurface connected(const MeshData& data) { return connect(Surface(data.V, data.F)); }

/// flat_torus() as a surface.
inline Surface flat_torus_surface(int nu, int nv) {
  const FlatTorus flat = flat_torus(nu, nv);
  Mesh mesh(flat.F, flat.vertices);
  VectorX<double> lengths(mesh.edges());
  for (Index h = 0; h < mesh.halfedges(); ++h) lengths[mesh.edge(h)] = flat.lengths(h / 3, h % 3);
  return Surface::from_lengths(std::move(mesh), lengths);
}

}  // namespace alcap::test
