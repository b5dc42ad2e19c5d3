// SPDX-License-Identifier: MIT
// Parallel transport of a vector around an eighth of the unit sphere: it comes back rotated by the area, a right angle.
#include <alcap/alcap.h>

#include <cmath>
#include <iostream>
#include <vector>

int main() {
  const alcap::MeshData sphere = alcap::icosphere(5);
  const alcap::ConnectedSurface surface = alcap::connect(alcap::Surface(sphere.V, sphere.F));

  // Around a triangle of three great circles. The last point is the first one: a closed path.
  alcap::Positions<double> points(31, 3);
  const Eigen::Matrix3d corners = Eigen::Matrix3d::Identity();
  for (Eigen::Index k = 0; k <= 30; ++k) {
    const Eigen::Index side = k / 10 % 3;
    const double s = static_cast<double>(k % 10) / 10;
    points.row(k) = ((1 - s) * corners.row(side) + s * corners.row((side + 1) % 3)).normalized();
  }
  const alcap::SurfacePolyline loop = alcap::stroke_from_space(surface, points);
  const alcap::Transported around = alcap::transport(surface, loop, 1.0);
  const double enclosed = 2 * alcap::pi<double> + around.turn_from_path;  // the curvature inside
  std::cout << "curvature enclosed: " << enclosed << ", the area is " << alcap::pi<double> / 2 << "\n"
            << "turned by " << std::lround(enclosed * 180 / alcap::pi<double>) << " degrees\n";

  // Along edges, by the shortest way from one vertex to another.
  const std::vector<alcap::Index> path = alcap::shortest_path(surface, 0, 1000);
  const alcap::Transported there = alcap::transport(surface, path, 1.0);
  std::cout << path.size() - 1 << " edges, length kept: " << (std::abs(std::abs(there.z) - 1) < 1e-12 ? "yes" : "no")
            << "\n";
}
