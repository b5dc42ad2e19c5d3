// SPDX-License-Identifier: MIT
//
// surface.cpp: a mesh made ready once, and the functions of topology.h on surfaces.
#include "alcap/surface.h"

#include <string>

namespace alcap {

Surface::Surface(Made, Positions<double> V, Faces F) {
  Mesh mesh(std::move(F), V.rows());
  *this = from_mesh(std::move(V), std::move(mesh));
}

Surface Surface::from_mesh(Positions<double> V, Mesh mesh) {
  if (V.rows() != mesh.vertices())
    throw OptionError("V", std::to_string(V.rows()) + " rows",
                      "needs one per vertex, " + std::to_string(mesh.vertices()));
  auto parts = std::make_shared<Parts>();
  parts->V = std::move(V);
  parts->mesh = std::move(mesh);
  parts->topology = find_topology(parts->mesh);
  parts->geometry = Geometry(parts->mesh, parts->V);
  Surface surface;
  surface.parts_ = std::move(parts);
  return surface;
}

Surface Surface::from_lengths(Mesh mesh, const VectorX<double>& lengths, Positions<double> V) {
  if (V.rows() != 0 && V.rows() != mesh.vertices())
    throw OptionError("V", std::to_string(V.rows()) + " rows",
                      "needs one per vertex, " + std::to_string(mesh.vertices()) + ", or none");
  auto parts = std::make_shared<Parts>();
  parts->V = std::move(V);
  parts->mesh = std::move(mesh);
  parts->topology = find_topology(parts->mesh);
  parts->geometry = Geometry::from_lengths(parts->mesh, lengths);
  Surface surface;
  surface.parts_ = std::move(parts);
  return surface;
}

Surface Surface::from_geometry(Mesh mesh, Geometry geometry) {
  if (geometry.lengths().size() != mesh.edges())
    throw OptionError("geometry", std::to_string(geometry.lengths().size()) + " edges",
                      "is not of this mesh, which has " + std::to_string(mesh.edges()));
  auto parts = std::make_shared<Parts>();
  parts->mesh = std::move(mesh);
  parts->topology = find_topology(parts->mesh);
  parts->geometry = std::move(geometry);
  Surface surface;
  surface.parts_ = std::move(parts);
  return surface;
}

const Positions<double>& Surface::positions() const {
  if (!in_space()) throw OptionError("surface", "edge lengths alone", "needs positions in space");
  return V();
}

std::vector<Loop> homology_generators(const Surface& surface) {
  return homology_generators(surface.mesh(), surface.topology());
}

Piece extract_component(const Surface& surface, Index component) {
  return extract_component(surface.mesh(), surface.positions(), surface.topology(), component);
}

std::vector<Piece> split_components(const Surface& surface) {
  return split_components(surface.mesh(), surface.positions(), surface.topology());
}

}  // namespace alcap
