// SPDX-License-Identifier: MIT
// Stiffness S and mass M as Eigen matrices, for your own solver: here inverse iteration with Eigen's LDLT.
#include <alcap/alcap.h>

#include <Eigen/SparseCholesky>
#include <cmath>
#include <iostream>

int main() {
  const alcap::MeshData sphere = alcap::icosphere(3);
  const alcap::ConnectedSurface surface = alcap::connect(alcap::Surface(sphere.V, sphere.F));
  const auto [S, M] = alcap::energy_matrices(surface, 1);  // complex Hermitian, #V x #V, both triangles stored

  Eigen::SimplicialLDLT<alcap::SparseMatrix<alcap::Complex<double>>> solver(S);
  alcap::ComplexVectorX<double> u = alcap::ComplexVectorX<double>::Random(S.rows());
  for (int i = 0; i < 30; ++i) {
    u = solver.solve(M * u);
    u /= std::sqrt(u.dot(M * u).real());
  }
  const double energy = u.dot(S * u).real();  // the integral of |grad u|^2, where |u|^2 has integral 1
  std::cout << "smallest eigenvalue by hand: " << energy << "\n";

  // u is the n-th power of the field, in the frames of the vertices.
  const alcap::Field field{.n = 1, .u = u, .frames = surface.frames()};
  std::cout << alcap::find_singularities(surface, field).size() << " singularities\n"
            << "smallest eigenvalue by alcap: " << alcap::smoothest_field(surface, {.n = 1}).components[0].lambda
            << "\n";
}
