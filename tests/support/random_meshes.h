// SPDX-License-Identifier: MIT
//
// random_meshes.h: families of random meshes for the programs that look for hard ones: noise, patches, bumps, chains of
// necks, scans, shafts, tori, pieces, of 600 to 14,000 vertices.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "alcap/conventions.h"
#include "alcap/generators.h"
#include "src/base/random.h"
#include "tests/support/mesh_helpers.h"

namespace alcap::test {

using Row = Eigen::RowVector3d;

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) {}
  double between(double a, double b) { return random_.uniform(a, b); }
  int whole(int a, int b) { return a + static_cast<int>(random_.uniform(0, 1) * (b - a + 1)); }
  /// Normally distributed (Box and Muller 1958).
  double normal() {
    return std::sqrt(-2 * std::log(1 - random_.uniform(0, 1))) * std::cos(2 * pi<double> * random_.uniform(0, 1));
  }
  std::uint64_t seed() { return static_cast<std::uint64_t>(whole(1, 1'000'000)); }

 private:
  detail::Random random_;
};

/// Points spread evenly over the sphere.
inline std::vector<Row> spread(int count) {
  std::vector<Row> points;
  for (int k = 0; k < count; ++k) {
    const double z = 1 - (2 * k + 1.0) / count, turn = pi<double> * (1 + std::sqrt(5.0)) * (k + 0.5);
    const double r = std::sqrt(1 - z * z);
    points.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
  }
  return points;
}

inline double edge_of(const MeshData& sphere) {
  return std::sqrt(4 * pi<double> / static_cast<double>(sphere.V.rows()));
}

inline int level(Dice& dice) { return dice.whole(4, 5); }

/// Every vertex moved along its normal.
inline MeshData noise(Dice& dice) {
  MeshData m = icosphere(level(dice));
  const double amount = dice.between(0.05, 0.6) * edge_of(m);
  for (Eigen::Index i = 0; i < m.V.rows(); ++i) m.V.row(i) *= 1 + amount * dice.normal();
  return m;
}

/// Noise with smooth patches of about the same size in it, each of which holds a localised vector.
inline MeshData patches(Dice& dice) {
  MeshData m = icosphere(level(dice));
  const double amount = dice.between(0.2, 0.6) * edge_of(m), radius = dice.between(0.08, 0.2);
  const double difference = dice.between(0, 0.1);
  const std::vector<Row> centres = spread(dice.whole(20, 100));
  std::vector<double> radii;
  for (std::size_t k = 0; k < centres.size(); ++k) radii.push_back(radius * (1 + difference * dice.between(-1, 1)));
  for (Eigen::Index i = 0; i < m.V.rows(); ++i) {
    const Row x = m.V.row(i);
    double nearest = 10;
    for (std::size_t k = 0; k < centres.size(); ++k)
      nearest = std::min(nearest, std::acos(std::clamp(x.dot(centres[k]), -1.0, 1.0)) / radii[k]);
    m.V.row(i) = x * (1 + amount * std::clamp(4 * (nearest - 1), 0.0, 1.0) * dice.normal());
  }
  return m;
}

/// Bumps on a sphere, all the same and evenly spread, or of any height anywhere.
inline MeshData bumps(Dice& dice) {
  MeshData m = icosphere(level(dice));
  const bool same = dice.whole(0, 1) == 1;
  const double height = dice.between(0.1, 0.6), width = dice.between(0.04, 0.12);
  std::vector<Row> centres = spread(dice.whole(20, 120));
  std::vector<double> heights(centres.size(), height);
  for (std::size_t k = 0; !same && k < centres.size(); ++k) {
    centres[k] = Row(dice.normal(), dice.normal(), dice.normal()).normalized();
    heights[k] *= dice.between(0.3, 1);
  }
  for (Eigen::Index i = 0; i < m.V.rows(); ++i) {
    const Row x = m.V.row(i);
    double scale = 1;
    for (std::size_t k = 0; k < centres.size(); ++k)
      scale += heights[k] * std::exp(-(x - centres[k]).squaredNorm() / (width * width));
    m.V.row(i) = scale * x;
  }
  return m;
}

/// Spheres of these radii in a row, joined by thin necks: a surface of revolution, `around` vertices a ring.
inline MeshData chain_of(const std::vector<double>& radii, int around, int rings, double neck) {
  std::vector<std::array<double, 2>> profile;  // height and radius
  double base = 0;
  for (std::size_t q = 0; q < radii.size(); ++q) {
    const double R = radii[q];
    const double from = q > 0 ? std::asin(neck / R) : 0;
    const double to = pi<double> - (q + 1 < radii.size() ? std::asin(neck / R) : 0);
    for (int k = q > 0 ? 1 : 0; k < rings; ++k) {
      const double t = from + (to - from) * k / (rings - 1);
      profile.push_back({base + R * (std::cos(from) - std::cos(t)), R * std::sin(t)});
    }
    base = profile.back()[0];
  }
  const int n = static_cast<int>(profile.size()) - 2, last = n * around + 1;
  MeshData m{Positions<double>(last + 1, 3), Faces(2 * around * n, 3)};
  m.V.row(0) = Row(0, 0, profile.front()[0]);
  m.V.row(last) = Row(0, 0, profile.back()[0]);
  const auto at = [&](int i, int j) { return 1 + i * around + j % around; };
  int face = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < around; ++j) {
      const double t = (2 * j + i % 2) * pi<double> / around, r = profile[static_cast<std::size_t>(i) + 1][1];
      m.V.row(at(i, j)) = Row(r * std::cos(t), r * std::sin(t), profile[static_cast<std::size_t>(i) + 1][0]);
      if (i == 0) m.F.row(face++) << 0, at(0, j + 1), at(0, j);
      if (i + 1 == n) {
        m.F.row(face++) << last, at(i, j), at(i, j + 1);
        continue;
      }
      const int s = i % 2, a = at(i, j), b = at(i, j + 1), c = at(i + 1, j), d = at(i + 1, j + 1);
      m.F.row(face++) << a, b, s == 0 ? c : d;
      m.F.row(face++) << (s == 0 ? b : a), d, c;
    }
  return m;
}

/// Chains of about equal spheres.
inline MeshData chain(Dice& dice) {
  const int count = dice.whole(10, 70), around = dice.whole(10, 15), rings = dice.whole(10, 15);
  const double neck = dice.between(0.05, 0.3), difference = dice.between(0, 0.05);
  std::vector<double> radii;
  for (int q = 0; q < count; ++q) radii.push_back(1 + difference * dice.normal());
  return chain_of(radii, around, rings, neck);
}

inline MeshData scan(Dice& dice) { return noisy_scan(level(dice), dice.between(0.05, 0.5), dice.seed()); }

inline MeshData shaft(Dice& dice) { return cad_like(24 + 8 * dice.whole(0, 11), dice.whole(8, 19)); }

inline MeshData noisy_torus(Dice& dice) {
  MeshData m = torus_random_diagonals(dice.whole(60, 120), dice.whole(30, 60), 1, dice.between(0.1, 0.7), dice.seed());
  const double amount = dice.between(0, 0.25) * std::sqrt(4 * pi<double> * pi<double> * 0.4 / double(m.V.rows()));
  for (Eigen::Index i = 0; i < m.V.rows(); ++i) m.V.row(i) += amount * Row(dice.normal(), dice.normal(), dice.normal());
  return m;
}

inline MeshData jittered(Dice& dice) { return jittered_sphere(level(dice), dice.between(0.02, 0.3), dice.seed()); }

/// The whole matrix of several pieces at once, as callers of smallest_eigenpair() may have it.
inline MeshData pieces(Dice& dice) {
  MeshData all = jittered_sphere(3, dice.between(0.02, 0.2), dice.seed());
  for (int k = dice.whole(1, 8); k > 0; --k) {
    MeshData next = jittered_sphere(3, dice.between(0.02, 0.2), dice.seed());
    next.V *= dice.between(0.95, 1.05);
    all = together(all, next);
  }
  return all;
}

inline const std::map<std::string, std::function<MeshData(Dice&)>> families{
    {"noise", noise}, {"patches", patches},   {"bumps", bumps},     {"chain", chain},  {"scan", scan},
    {"shaft", shaft}, {"torus", noisy_torus}, {"jitter", jittered}, {"pieces", pieces}};

}  // namespace alcap::test
