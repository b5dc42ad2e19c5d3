// SPDX-License-Identifier: MIT
#include "alcap/surface.h"

namespace alcap {

Surface::Surface(Made, Positions<double> V, Faces F) {
  auto parts = std::make_shared<Parts>();
  parts->V = std::move(V);
  parts->mesh = Mesh(std::move(F), parts->V.rows());
  parts->topology = find_topology(parts->mesh);
  parts->geometry = Geometry(parts->mesh, parts->V);
  parts_ = std::move(parts);
}

Surface Surface::from_lengths(Mesh mesh, const VectorX<double>& lengths) {
  auto parts = std::make_shared<Parts>();
  parts->mesh = std::move(mesh);
  parts->topology = find_topology(parts->mesh);
  parts->geometry = Geometry::from_lengths(parts->mesh, lengths);
  Surface surface;
  surface.parts_ = std::move(parts);
  return surface;
}

}  // namespace alcap
