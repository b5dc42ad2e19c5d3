// SPDX-License-Identifier: MIT
//
// mesh_case.h: a surface with what tests need of it: mesh and geometry, a connection, frames. A test adds its own
// questions by deriving from one of them.
#pragma once

#include <memory>
#include <utility>

#include "alcap/connected_surface.h"
#include "alcap/frames.h"
#include "alcap/generators.h"
#include "alcap/geometry.h"
#include "alcap/mesh.h"

namespace alcap::test {

struct MeshCase {
  MeshData surface;
  Mesh mesh;
  Geometry geometry;
  explicit MeshCase(MeshData s) : surface(std::move(s)), mesh(surface.F, surface.V.rows()), geometry(mesh, surface.V) {}
};

/// With the globally optimal connection.
struct ConnectedCase : MeshCase {
  using MeshCase::MeshCase;
  Connection connection = globally_optimal(mesh, geometry);
  /// With the connection as it is now.
  [[nodiscard]] ConnectedSurface connected() const { return {Surface(surface.V, surface.F), connection}; }
};

struct FramedCase : ConnectedCase {
  using ConnectedCase::ConnectedCase;
  std::shared_ptr<const Frames> frames = std::make_shared<const Frames>(vertex_frames(mesh, surface.V, connection));
};

}  // namespace alcap::test
