// SPDX-License-Identifier: MIT
//
// on_surface.cpp: the functions of operators.h and energies.h on surfaces.
#include "alcap/connected_surface.h"
#include "alcap/energies.h"
#include "alcap/operators.h"

namespace alcap {

FirstOrderOperators first_order_operators(const ConnectedSurface& surface, const OperatorOptions& options) {
  return first_order_operators(surface.mesh(), surface.geometry(), surface.connection(), options);
}

OperatorEnergies operator_energies(const Surface& surface, const FirstOrderOperators& operators,
                                   const ComplexVectorX<double>& u) {
  return operator_energies(surface.mesh(), surface.geometry(), operators, u);
}

Complex<double> flux_and_circulation(const ConnectedSurface& surface, const ComplexVectorX<double>& u, Index h) {
  return flux_and_circulation(surface.mesh(), surface.geometry(), surface.connection(), u, h);
}

FaceField face_field(const ConnectedSurface& surface, int n, const ComplexVectorX<double>& u, Index t) {
  return face_field(surface.mesh(), surface.geometry(), surface.connection(), n, u, t);
}

EdgeField edge_field(const ConnectedSurface& surface, int n, const ComplexVectorX<double>& u, Index h) {
  return edge_field(surface.mesh(), surface.geometry(), surface.connection(), n, u, h);
}

double edge_to_face(const ConnectedSurface& surface, Index h, double s) {
  return edge_to_face(surface.mesh(), surface.connection(), h, s);
}

StiffnessMass energy_matrices(const ConnectedSurface& surface, int n, double s) {
  return energy_matrices(surface.mesh(), surface.geometry(), surface.connection(), n, s);
}

SparseMatrix<Complex<double>> curvature_and_boundary(const ConnectedSurface& surface, int n) {
  return curvature_and_boundary(surface.mesh(), HermitianPattern(surface.mesh()), surface.geometry(),
                                surface.connection(), n);
}

FieldEnergies field_energies(const ConnectedSurface& surface, int n, const ComplexVectorX<double>& u) {
  return field_energies(surface.mesh(), surface.geometry(), surface.connection(), n, u);
}

}  // namespace alcap
