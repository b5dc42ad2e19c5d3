// SPDX-License-Identifier: MIT
// Divergence and curl of your own vectors: the unit sphere turning about the z axis has divergence 0 and curl 2 z.
#include <alcap/alcap.h>

#include <algorithm>
#include <cmath>
#include <iostream>

int main() {
  const alcap::MeshData sphere = alcap::icosphere(5);
  const alcap::ConnectedSurface surface = alcap::connect(alcap::Surface(sphere.V, sphere.F));

  alcap::Positions<double> vectors(sphere.V.rows(), 3);  // one vector per vertex, in space
  for (Eigen::Index v = 0; v < vectors.rows(); ++v) vectors.row(v) << -sphere.V(v, 1), sphere.V(v, 0), 0;

  const alcap::Field field = alcap::from_vectors(1, vectors, surface.frames());  // projected to the tangent planes
  const alcap::FirstOrderOperators operators = alcap::first_order_operators(surface, {.n = 1});
  const alcap::ComplexVectorX<double> integrals = alcap::apply(surface.mesh(), operators.p, field.u);  // per face

  double largest_div = 0, largest_error = 0, total_curl = 0;
  for (alcap::Index t = 0; t < surface.mesh().faces(); ++t) {
    const double area = surface.geometry().area(t);
    const double div = integrals[t].real() / area, curl = integrals[t].imag() / area;  // means over the face
    double z = 0;
    for (Eigen::Index c = 0; c < 3; ++c) z += sphere.V(sphere.F(t, c), 2) / 3;
    largest_div = std::max(largest_div, std::abs(div));
    largest_error = std::max(largest_error, std::abs(curl - 2 * z));
    total_curl += integrals[t].imag();
  }
  std::cout << "largest divergence: " << largest_div << "\n"
            << "largest difference of curl from 2 z: " << largest_error << "\n"
            << "within 0.01: " << (std::max(largest_div, largest_error) < 0.01 ? "yes" : "no") << "\n"
            << "total curl is zero: " << (std::abs(total_curl) < 1e-10 ? "yes" : "no") << "\n";
}
