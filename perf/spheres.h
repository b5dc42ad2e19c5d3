// SPDX-License-Identifier: MIT
//
// spheres.h: spheres of any of the sizes 20 f^2, so that benchmarks can have 50,000 triangles; subdivided icosahedra
// only come in sizes 20 4^level.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "alcap/generators.h"
#include "src/base/random.h"

namespace alcap::perf {

/// The icosahedron with every edge cut into f pieces and every face into f^2, projected to the unit sphere.
inline MeshData geodesic_sphere(Index f) {
  const MeshData base = icosphere(0);
  const Index faces = static_cast<Index>(base.F.rows());
  MeshData s{Positions<double>(10 * f * f + 2, 3), Faces(20 * f * f, 3)};
  s.V.topRows(12) = base.V;
  Index vertices = 12, row = 0;
  std::map<std::pair<Index, Index>, Index> first_on_edge;
  for (Index t = 0; t < faces; ++t) {
    const Index a = base.F(t, 0), b = base.F(t, 1), c = base.F(t, 2);
    // Point k of the edge from p to q; edges are numbered from their smaller end.
    const auto on_edge = [&](Index p, Index q, Index k) {
      const auto [edge, is_new] = first_on_edge.try_emplace(std::minmax(p, q), vertices);
      if (is_new)
        for (Index m = 1; m < f; ++m)
          s.V.row(vertices++) = (f - m) * base.V.row(edge->first.first) + m * base.V.row(edge->first.second);
      return edge->second + (p < q ? k : f - k) - 1;
    };
    std::vector<Index> grid(static_cast<std::size_t>((f + 1) * (f + 1)));
    const auto at = [&](Index i, Index j) -> Index& { return grid[static_cast<std::size_t>(i * (f + 1) + j)]; };
    for (Index i = 0; i <= f; ++i)  // i steps towards b, j towards c
      for (Index j = 0; i + j <= f; ++j) {
        if (i == f || j == f || i + j == 0) {
          at(i, j) = i == f ? b : j == f ? c : a;
        } else if (j == 0) {
          at(i, j) = on_edge(a, b, i);
        } else if (i == 0) {
          at(i, j) = on_edge(a, c, j);
        } else if (i + j == f) {
          at(i, j) = on_edge(b, c, j);
        } else {
          at(i, j) = vertices;
          s.V.row(vertices++) = (f - i - j) * base.V.row(a) + i * base.V.row(b) + j * base.V.row(c);
        }
      }
    for (Index i = 0; i < f; ++i)
      for (Index j = 0; i + j < f; ++j) {
        s.F.row(row++) << at(i, j), at(i + 1, j), at(i, j + 1);
        if (i + j + 1 < f) s.F.row(row++) << at(i + 1, j), at(i + 1, j + 1), at(i, j + 1);
      }
  }
  s.V.rowwise().normalize();
  return s;
}

/// Vertices of a unit sphere moved within it by up to `amount` mean edge lengths.
inline void jitter(MeshData& sphere, double amount, std::uint64_t seed) {
  const double edge = std::sqrt(4 * pi<double> / double(sphere.F.rows()) * 4 / std::sqrt(3.0));
  detail::Random random(seed);
  for (Eigen::Index v = 0; v < sphere.V.rows(); ++v) {
    const Eigen::RowVector3d n = sphere.V.row(v), e1 = n.unitOrthogonal(), e2 = n.cross(e1);
    double x = 1, y = 1;
    while (x * x + y * y > 1) x = random.uniform(-1, 1), y = random.uniform(-1, 1);
    sphere.V.row(v) = (n + amount * edge * (x * e1 + y * e2)).normalized();
  }
}

}  // namespace alcap::perf
