// SPDX-License-Identifier: MIT
//
// statistics.cpp: counts and ranges of any list of triangles.
#include "apps/alcap/report/statistics.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "alcap/mesh_check.h"

namespace alcap::app {
namespace {

class Components {
 public:
  explicit Components(std::int64_t count) : parent_(static_cast<std::size_t>(count)) {
    std::iota(parent_.begin(), parent_.end(), Index{0});
  }
  Index root(Index v) {
    while (at(v) != v) {
      at(v) = at(at(v));
      v = at(v);
    }
    return v;
  }
  void join(Index a, Index b) {
    a = root(a);
    b = root(b);
    at(std::max(a, b)) = std::min(a, b);
  }

 private:
  Index& at(Index v) { return parent_[static_cast<std::size_t>(v)]; }
  std::vector<Index> parent_;
};

bool usable(const Faces& F, Eigen::Index t, std::int64_t vertices) {
  const Index a = F(t, 0), b = F(t, 1), c = F(t, 2);
  return F.row(t).minCoeff() >= 0 && F.row(t).maxCoeff() < vertices && a != b && b != c && c != a;
}

void count(const Faces& F, Statistics& s) {
  Components components(s.vertices);
  std::vector<char> used(static_cast<std::size_t>(s.vertices), 0);
  std::vector<std::int64_t> edges;
  edges.reserve(static_cast<std::size_t>(3 * F.rows()));
  for (Eigen::Index t = 0; t < F.rows(); ++t) {
    if (!usable(F, t, s.vertices)) continue;
    for (int c = 0; c < 3; ++c) {
      const Index a = F(t, c), b = F(t, (c + 1) % 3);
      used[static_cast<std::size_t>(a)] = 1;
      components.join(a, b);
      edges.push_back(std::min(a, b) * s.vertices + std::max(a, b));
    }
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t k = 0; k < edges.size();) {
    std::size_t end = k + 1;
    while (end < edges.size() && edges[end] == edges[k]) ++end;
    ++s.edges;
    s.boundary_edges += end - k == 1;
    k = end;
  }
  for (Index v = 0; v < s.vertices; ++v) {
    if (used[static_cast<std::size_t>(v)] == 0) continue;
    ++s.referenced;
    s.components += components.root(v) == v;
  }
}

}  // namespace

Statistics measure(const Positions<double>& V, const Faces& F) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Statistics s{.vertices = V.rows(),
               .faces = F.rows(),
               .duplicate_vertices = duplicate_positions(V),
               .edge_min = infinity,
               .edge_max = -infinity,
               .angle_min = infinity,
               .angle_max = -infinity,
               .box_min = Eigen::RowVector3d::Constant(infinity),
               .box_max = Eigen::RowVector3d::Constant(-infinity)};
  count(F, s);
  std::int64_t measured = 0;
  for (Eigen::Index t = 0; t < F.rows(); ++t) {
    if (!usable(F, t, s.vertices)) continue;
    const Eigen::Matrix3d p = V(F.row(t), Eigen::all);
    if (!p.allFinite()) continue;
    s.box_min = s.box_min.cwiseMin(p.colwise().minCoeff());
    s.box_max = s.box_max.cwiseMax(p.colwise().maxCoeff());
    // Angles of faces whose areas are too large or too small for a number.
    const double extent = (p.rowwise() - p.row(0)).cwiseAbs().maxCoeff();
    const double scale = extent > 0 && std::isfinite(extent) ? std::ldexp(1.0, std::ilogb(extent)) : 1.0;
    for (int c = 0; c < 3; ++c) {
      const Eigen::RowVector3d a = (p.row((c + 1) % 3) - p.row(c)) / scale, b = (p.row((c + 2) % 3) - p.row(c)) / scale;
      const double length = scale * a.norm(), angle = std::atan2(a.cross(b).norm(), a.dot(b));
      s.edge_min = std::min(s.edge_min, length);
      s.edge_max = std::max(s.edge_max, length);
      s.edge_mean += length;
      ++measured;
      if (length > 0 && b.norm() > 0) {
        s.angle_min = std::min(s.angle_min, angle);
        s.angle_max = std::max(s.angle_max, angle);
      }
      if (c == 0) s.area += scale * scale * (a.cross(b).norm() / 2);
    }
  }
  s.edge_mean /= static_cast<double>(measured);
  return s;
}

}  // namespace alcap::app
