// SPDX-License-Identifier: MIT
//
// vertex_indices.cpp: indices of a field that is constant on each face, around its vertices. Around an interior vertex
// the field turns, against Levi-Civita transport from face to face, by a multiple of 2 pi minus n times the angle
// defect.
#include <cmath>

#include "alcap/singularities.h"
#include "src/base/numbers.h"
#include "src/base/parallel.h"

namespace alcap {

std::vector<int> vertex_indices(const Mesh& mesh, const Geometry& geometry, const Field& face_field) {
  if (face_field.u.size() != mesh.faces()) {
    throw OptionError("face_field.u", std::to_string(face_field.u.size()) + " rows", "must have one per face");
  }
  VectorX<double> argument(mesh.faces());
  parallel_for(mesh.faces(), [&](std::int64_t t) { argument[t] = std::arg(face_field.u[t]); });
  std::vector<int> indices(static_cast<std::size_t>(mesh.vertices()), 0);
  parallel_for(mesh.vertices(), [&](std::int64_t i) {
    const auto v = static_cast<Index>(i);
    if (!mesh.referenced(v) || mesh.boundary_vertex(v)) return;
    double turn = face_field.n * geometry.defect(mesh, v);
    mesh.for_each_outgoing(v, [&](Index h) {
      // Counter-clockwise around v: from the face of h across prev(h), which ends at v, to the face of its twin.
      const Index out = Mesh::prev(h), in = mesh.twin(out);
      const double transport = geometry.direction(in) + pi<double> - geometry.direction(out);
      turn += wrap(argument[Mesh::face(in)] - argument[Mesh::face(out)] - face_field.n * transport);
    });
    indices[static_cast<std::size_t>(i)] = detail::rounded<int>(turn / (2 * pi<double>)).value_or(0);
  });
  return indices;
}

}  // namespace alcap
