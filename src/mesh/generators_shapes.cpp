// SPDX-License-Identifier: MIT
//
// generators_shapes.cpp: surfaces of any genus, and stand-ins for CAD models and scans.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <unordered_map>
#include <vector>

#include "alcap/generators.h"
#include "src/base/array.h"
#include "src/base/cancel.h"
#include "src/base/index_pair.h"
#include "src/base/random.h"

namespace alcap {
namespace {

using Point = Eigen::RowVector3d;

MeshData pack(const std::vector<Point>& points, const std::vector<Eigen::RowVector<Index, 3>>& triangles) {
  MeshData s{Positions<double>(static_cast<Eigen::Index>(points.size()), 3),
             Faces(static_cast<Eigen::Index>(triangles.size()), 3)};
  for (std::size_t v = 0; v < points.size(); ++v) s.V.row(static_cast<Eigen::Index>(v)) = points[v];
  for (std::size_t t = 0; t < triangles.size(); ++t) s.F.row(static_cast<Eigen::Index>(t)) = triangles[t];
  return s;
}

/// Moves each vertex half-way to the mean of the outer ends of its halfedges, `rounds` times. Closed meshes only.
void smooth(MeshData& s, int rounds) {
  Eigen::VectorXd valence = Eigen::VectorXd::Zero(s.V.rows());
  for (Eigen::Index t = 0; t < s.F.rows(); ++t) {
    for (int c = 0; c < 3; ++c) valence[s.F(t, c)] += 1;
  }
  Positions<double> sum(s.V.rows(), 3);
  for (int round = 0; round < rounds; ++round) {
    detail::check_cancelled();
    sum.setZero();
    for (Eigen::Index t = 0; t < s.F.rows(); ++t) {
      for (int c = 0; c < 3; ++c) sum.row(s.F(t, c)) += s.V.row(s.F(t, (c + 1) % 3));
    }
    s.V = 0.5 * (s.V + Positions<double>(sum.array().colwise() / valence.array()));
  }
}

/// Drops vertices no face uses; the others keep their order.
MeshData compacted(const MeshData& s, const std::vector<Eigen::RowVector<Index, 3>>& triangles) {
  detail::Array<Index> number(s.V.rows(), none);
  for (const auto& f : triangles) {
    for (int c = 0; c < 3; ++c) number[f[c]] = 0;
  }
  std::vector<Point> points;
  for (std::int64_t v = 0; v < number.size(); ++v) {
    if (number[v] == none) continue;
    number[v] = static_cast<Index>(points.size());
    points.emplace_back(s.V.row(v));
  }
  MeshData out = pack(points, triangles);
  for (Eigen::Index t = 0; t < out.F.rows(); ++t) {
    for (int c = 0; c < 3; ++c) out.F(t, c) = number[out.F(t, c)];
  }
  return out;
}

using detail::IndexPair;

/// The smallest angle's sine of triangle (i, j, k) of a star-shaped surface, negative when it faces inward.
double quality(const Positions<double>& V, Index i, Index j, Index k) {
  const Point a = V.row(i), b = V.row(j), c = V.row(k);
  const Point n = (b - a).cross(c - a);
  double lengths[3] = {(b - a).norm(), (c - b).norm(), (a - c).norm()};
  std::sort(lengths, lengths + 3);
  return (n.dot(a + b + c) > 0 ? 1 : -1) * n.norm() / (lengths[1] * lengths[2]);
}

/// Flips a random part of the edges where both new triangles keep a smallest angle above about 11 degrees.
void flip_some_edges(MeshData& s, double part, detail::Random& random) {
  std::unordered_map<IndexPair, Index, detail::IndexPairHash> halfedge;
  halfedge.reserve(static_cast<std::size_t>(3 * s.F.rows()));
  const auto add_face = [&](Index t) {
    for (Index c = 0; c < 3; ++c) halfedge[{s.F(t, c), s.F(t, (c + 1) % 3)}] = 3 * t + c;
  };
  for (Index t = 0; t < s.F.rows(); ++t) add_face(t);
  for (Index h = 0; h < 3 * s.F.rows(); ++h) {
    detail::check_cancelled_at(h);
    const Index t = h / 3, i = s.F(t, h % 3), j = s.F(t, (h + 1) % 3), k = s.F(t, (h + 2) % 3);
    const bool wanted = random.uniform() < part;
    const auto opposite = halfedge.find(IndexPair{j, i});
    if (!wanted || opposite == halfedge.end()) continue;
    const Index u = opposite->second / 3, l = s.F(u, (opposite->second + 2) % 3);
    if (halfedge.contains(IndexPair{k, l}) || halfedge.contains(IndexPair{l, k})) continue;
    if (std::min(quality(s.V, k, i, l), quality(s.V, l, j, k)) < 0.2) continue;
    halfedge.erase(IndexPair{i, j});
    halfedge.erase(IndexPair{j, i});
    s.F.row(t) << k, i, l;
    s.F.row(u) << l, j, k;
    add_face(t);
    add_face(u);
  }
}

}  // namespace

MeshData genus_surface(int genus, int resolution) {
  if (genus < 0 || genus > 1000) throw OptionError("genus", genus, "must be in [0, 1000]");
  if (resolution < 1 || resolution > 100) {
    throw OptionError("resolution", resolution, "must be in [1, 100]");
  }
  const std::int64_t r = resolution, size[3] = {(2 * genus + 1) * r, 3 * r, r};
  const auto solid = [&](const std::int64_t(&x)[3]) {
    for (int d = 0; d < 3; ++d) {
      if (x[d] < 0 || x[d] >= size[d]) return false;
    }
    return !(x[1] / r == 1 && (x[0] / r) % 2 == 1);
  };
  std::vector<Point> points;
  std::vector<Eigen::RowVector<Index, 3>> triangles;
  std::unordered_map<std::int64_t, Index> numbers;
  const auto number = [&](const std::int64_t(&x)[3]) {
    const std::int64_t key = (x[2] * (size[1] + 1) + x[1]) * (size[0] + 1) + x[0];
    const auto [at, added] = numbers.try_emplace(key, static_cast<Index>(points.size()));
    if (added) points.push_back(Point(double(x[0]), double(x[1]), double(x[2])) / double(r));
    return at->second;
  };
  std::int64_t x[3];
  for (x[2] = 0; x[2] < size[2]; ++x[2]) {
    for (x[1] = 0; x[1] < size[1]; ++x[1]) {
      for (x[0] = 0; x[0] < size[0]; ++x[0]) {
        if (!solid(x)) continue;
        for (int side = 0; side < 6; ++side) {
          const int d = side / 2, e1 = (d + 1) % 3, e2 = (d + 2) % 3;
          std::int64_t neighbour[3] = {x[0], x[1], x[2]};
          neighbour[d] += side % 2 == 1 ? 1 : -1;
          if (solid(neighbour)) continue;
          std::int64_t corner[3] = {x[0], x[1], x[2]};
          corner[d] += side % 2;
          const Index a = number(corner);
          ++corner[e1];
          Index b = number(corner);
          ++corner[e2];
          const Index c = number(corner);
          --corner[e1];
          Index f = number(corner);
          if (side % 2 == 0) std::swap(b, f);  // e1 x e2 points along +d
          triangles.emplace_back(a, b, c);
          triangles.emplace_back(a, c, f);
        }
      }
    }
  }
  MeshData s = pack(points, triangles);
  smooth(s, 3 * resolution);
  return s;
}

MeshData cad_like(int segments, int steps) {
  if (segments < 3) throw OptionError("segments", segments, "must be at least 3");
  if (steps < 1) throw OptionError("steps", steps, "must be at least 1");
  if (std::int64_t{segments} * steps > std::numeric_limits<Index>::max() / 12) {
    throw OptionError("steps", steps, "makes more faces than can be numbered");
  }
  std::vector<Point> points;
  std::vector<Eigen::RowVector<Index, 3>> triangles;
  const auto add_ring = [&](double radius, double height) {
    for (int k = 0; k < segments; ++k) {
      const double u = 2 * pi<double> * k / segments;
      points.emplace_back(radius * std::cos(u), radius * std::sin(u), height);
    }
  };
  // Radii 1, 2, 1.25, 1.75, 1, 2, ...; the lengths alternate between long and short.
  const double radii[4] = {1, 2, 1.25, 1.75};
  double height = 0;
  for (int step = 0; step < steps; ++step) {
    add_ring(radii[step % 4], height);
    height += step % 2 == 0 ? 6 : 1;
    add_ring(radii[step % 4], height);
  }
  const Index rings = 2 * static_cast<Index>(steps);
  for (Index ring = 0; ring + 1 < rings; ++ring) {
    for (Index k = 0; k < segments; ++k) {
      const Index a = ring * segments + k, b = ring * segments + (k + 1) % segments;
      const Index c = b + segments, d = a + segments;
      triangles.emplace_back(a, b, c);
      triangles.emplace_back(a, c, d);
    }
  }
  const Index top = (rings - 1) * segments;
  for (Index k = 1; k + 1 < segments; ++k) {
    triangles.emplace_back(0, k + 1, k);
    triangles.emplace_back(top, top + k, top + k + 1);
  }
  return pack(points, triangles);
}

MeshData noisy_scan(int level, double noise, std::uint64_t seed) {
  if (level < 3) throw OptionError("level", level, "must be in [3, 12]");
  if (!(noise >= 0 && noise <= 0.5)) throw OptionError("noise", noise, "must be in [0, 0.5]");
  MeshData s = jittered_sphere(level, 0.2, seed);
  detail::Random random(seed ^ 0x5ca15ca15ca15ca1ULL);

  // Holes: the stars of the vertices of the unjittered sphere within a small cap around five of the twelve first
  // vertices. Such a cap is a hexagonal patch of a regular triangulation (five-sided at its middle), so the rest stays
  // manifold.
  const double scale = std::pow(0.5, level);
  detail::Array<char> gone(s.V.rows(), 0);
  const MeshData regular = icosphere(level);
  for (Eigen::Index hole = 0; hole < 5; ++hole) {
    const double radius = std::max(0.3 * scale, hole == 0 ? 0.12 : 0.02 * static_cast<double>(hole));
    for (Eigen::Index v = 0; v < s.V.rows(); ++v) {
      if ((regular.V.row(v) - regular.V.row(2 * hole)).norm() < radius) gone[v] = 1;
    }
  }
  std::vector<Eigen::RowVector<Index, 3>> kept;
  for (Eigen::Index t = 0; t < s.F.rows(); ++t) {
    const auto is_gone = [&](int c) { return gone[s.F(t, c)] != 0; };
    if (!is_gone(0) && !is_gone(1) && !is_gone(2)) kept.emplace_back(s.F.row(t));
  }
  s = compacted(s, kept);
  flip_some_edges(s, 0.15, random);

  const double mean_edge = 1.2 * scale;  // of an icosphere, to a few percent
  for (Eigen::Index v = 0; v < s.V.rows(); ++v) {
    const Point n = s.V.row(v);
    const double bumps = 0.1 * (5 * n).array().sin().sum() / 3 + 0.02 * (17 * n).array().cos().sum() / 3;
    double sum = 0;  // twelve uniform numbers: close to normal, and the same everywhere
    for (int k = 0; k < 12; ++k) sum += random.uniform() - 0.5;
    s.V.row(v) *= 1 + bumps + noise * mean_edge * std::clamp(sum, -3.0, 3.0);
  }
  return s;
}

}  // namespace alcap
