// SPDX-License-Identifier: MIT
// A cross field that is aligned with the sharp edges of a box.
#include <alcap/alcap.h>

#include <algorithm>
#include <iostream>

namespace {

/// A box of 2 x 2 x 2 with size x size squares per side, as a triangle soup.
alcap::MeshData box_soup(int size) {
  const Eigen::Index corners = 6 * Eigen::Index{size} * size * 4;
  alcap::MeshData soup{alcap::Positions<double>(corners, 3), alcap::Faces(corners / 2, 3)};
  Eigen::Index v = 0, f = 0;
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2, sign = side % 2 == 0 ? 1 : -1;
    for (int i = 0; i < size; ++i) {
      for (int j = 0; j < size; ++j) {
        const auto first = static_cast<alcap::Index>(v);
        for (const auto& [a, b] : {std::pair{i, j}, {i + 1, j}, {i + 1, j + 1}, {i, j + 1}}) {
          soup.V(v, axis) = sign;
          soup.V(v, (axis + 1) % 3) = sign * (2.0 * a - size) / size;  // mirrored with the side: faces outward
          soup.V(v, (axis + 2) % 3) = (2.0 * b - size) / size;
          ++v;
        }
        soup.F.row(f++) << first, first + 1, first + 2;
        soup.F.row(f++) << first, first + 2, first + 3;
      }
    }
  }
  return soup;
}

}  // namespace

int main() {
  alcap::MeshData box = box_soup(12);
  box.F = alcap::repair_weld(box.V, box.F);  // faces share the vertices at equal positions
  const alcap::Surface surface(box.V, box.F);

  const alcap::FeatureGraph creases = alcap::sharp_edges(surface);  // edges that fold by at least 40 degrees
  const auto corners = std::count(creases.vertices.begin(), creases.vertices.end(), alcap::FeatureVertex::corner);
  std::cout << creases.lines.size() << " sharp lines, " << corners << " corners\n";

  const alcap::ConnectedSurface connected = alcap::connect(surface);
  alcap::Designer designer(connected, {.n = 4});
  for (const alcap::FeatureLine& line : creases.lines)
    designer.add(alcap::Stroke{.weight = 100, .line = alcap::stroke_along_vertices(surface, line.vertices)});
  const alcap::DesignResult design = designer.solve();

  double worst = 0;
  for (const alcap::ControlReport& control : design.controls) worst = std::max(worst, control.error_degrees);
  std::cout << "mean deviation along the worst line: " << worst << " degrees\n"
            << "aligned: " << (worst < 5 ? "yes" : "no") << "\n";
}
