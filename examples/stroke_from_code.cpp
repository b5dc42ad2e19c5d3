// SPDX-License-Identifier: MIT
// A vector field that follows a stroke: a circle in space, projected to the surface.
#include <alcap/alcap.h>

#include <cmath>
#include <iostream>

int main() {
  const alcap::MeshData sphere = alcap::icosphere(4);
  const alcap::ConnectedSurface surface = alcap::connect(alcap::Surface(sphere.V, sphere.F));

  alcap::Positions<double> circle(41, 3);  // closed: the last point is the first one again
  for (Eigen::Index k = 0; k <= 40; ++k) {
    const double angle = 2 * alcap::pi<double> * static_cast<double>(k % 40) / 40;
    circle.row(k) << std::cos(angle), std::sin(angle), 0.1;
  }

  alcap::Designer designer(surface, {.n = 1});
  const alcap::ControlId id = designer.add(alcap::Stroke{.line = alcap::stroke_from_space(surface, circle)});
  alcap::DesignResult design = designer.solve();
  std::cout << "weight 1: " << design.controls[0].error_degrees << " degrees off on average\n";

  // With more weight the field follows the stroke more closely. Nothing is assembled or factorised again.
  designer.set(id, alcap::Stroke{.weight = 10, .line = alcap::stroke_from_space(surface, circle)});
  design = designer.solve();
  std::cout << "weight 10: " << design.controls[0].error_degrees << " degrees\n"
            << "follows the stroke: " << (design.controls[0].met ? "yes" : "no") << "\n";

  const auto zeros = alcap::find_singularities(surface, design.field);
  std::cout << zeros.size() << " singularities, one at each pole\n";
}
