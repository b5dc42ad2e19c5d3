// SPDX-License-Identifier: MIT
//
// on_surface.cpp: the functions of singularities.h and alignment.h on surfaces.
#include "alcap/alignment.h"
#include "alcap/connected_surface.h"
#include "alcap/singularities.h"

namespace alcap {

std::vector<int> face_indices(const ConnectedSurface& surface, const Field& field) {
  return face_indices(surface.mesh(), surface.connection(), field);
}

int face_index(const ConnectedSurface& surface, const Field& field, Index t) {
  return face_index(surface.mesh(), surface.connection(), field, t);
}

std::vector<Singularity> find_singularities(const ConnectedSurface& surface, const Field& field) {
  return find_singularities(surface, field, face_indices(surface, field));
}

std::vector<Singularity> find_singularities(const ConnectedSurface& surface, const Field& field,
                                            const std::vector<int>& indices) {
  return find_singularities(surface.mesh(), surface.geometry(), surface.connection(), field, indices);
}

std::vector<IndexSum> index_sums(const ConnectedSurface& surface, const Field& field, const std::vector<int>& indices) {
  return index_sums(surface.mesh(), surface.geometry(), surface.connection(), field, indices, surface.topology());
}

std::vector<int> vertex_indices(const Surface& surface, const Field& face_field) {
  return vertex_indices(surface.mesh(), surface.geometry(), face_field);
}

double root_mean_square(const Surface& surface, const ComplexVectorX<double>& u) {
  return root_mean_square(surface.mesh(), surface.geometry(), u);
}

}  // namespace alcap
