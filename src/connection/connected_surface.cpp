// SPDX-License-Identifier: MIT
#include "alcap/connected_surface.h"

#include <string>

#include "src/base/parallel.h"

namespace alcap {

ConnectedSurface::ConnectedSurface(Surface surface, Connection connection) {
  const Mesh& mesh = surface.mesh();
  const auto require = [](const char* array, std::int64_t size, std::int64_t needed) {
    if (size != needed)
      throw OptionError(std::string("connection.") + array, std::to_string(size) + " entries",
                        "is not of this mesh, which has " + std::to_string(needed));
  };
  require("rho", connection.rho.size(), mesh.edges());
  require("rho_t", connection.rho_t.size(), mesh.halfedges());
  require("K", connection.K.size(), mesh.faces());
  parts_ = std::make_shared<Parts>();
  parts_->surface = std::move(surface);
  parts_->connection = std::move(connection);
}

std::shared_ptr<const Frames> ConnectedSurface::frames() const {
  if (!in_space()) throw OptionError("surface", "edge lengths alone", "frames need positions in space");
  std::call_once(parts_->frames_once, [&] {
    run_isolated(
        [&] { parts_->frames = std::make_shared<const Frames>(vertex_frames(mesh(), V(), geometry(), connection())); });
  });
  return parts_->frames;
}

}  // namespace alcap
