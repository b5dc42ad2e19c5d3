// SPDX-License-Identifier: MIT
//
// generators.cpp: spheres, tori and flat pieces. See generators_shapes.cpp for the larger constructions.
#include "alcap/generators.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <unordered_map>

#include "src/base/cancel.h"
#include "src/base/index_pair.h"
#include "src/base/random.h"

namespace alcap {
namespace {

using Point = Eigen::RowVector3d;

template <class Number>
void require(bool good, const char* field, Number value, const char* rule) {
  if (!good) throw OptionError(field, value, rule);
}
void at_least(std::int64_t value, std::int64_t least, const char* field) {
  if (value < least) throw OptionError(field, value, "must be at least " + std::to_string(least));
}
void positive(double value, const char* field) {
  require(value > 0 && std::isfinite(value), field, value, "must be positive and finite");
}

/// 1-to-4 split; midpoints are numbered in the order in which the halfedges meet them.
MeshData subdivided(const MeshData& s) {
  const Index old = static_cast<Index>(s.V.rows());
  const Eigen::Index faces = s.F.rows();
  MeshData out{Positions<double>(old + faces * 3 / 2, 3), Faces(4 * faces, 3)};
  out.V.topRows(old) = s.V;
  std::unordered_map<detail::IndexPair, Index, detail::IndexPairHash> midpoint;
  midpoint.reserve(static_cast<std::size_t>(faces * 3 / 2));
  Index next = old;
  for (Eigen::Index t = 0; t < faces; ++t) {
    detail::check_cancelled_at(t);
    Index m[3];
    for (int c = 0; c < 3; ++c) {
      const Index i = s.F(t, c), j = s.F(t, (c + 1) % 3);
      const auto [at, added] = midpoint.try_emplace(detail::IndexPair{std::min(i, j), std::max(i, j)}, next);
      if (added) out.V.row(next++) = (s.V.row(i) + s.V.row(j)).normalized();
      m[c] = at->second;
    }
    out.F.row(4 * t) << s.F(t, 0), m[0], m[2];
    out.F.row(4 * t + 1) << s.F(t, 1), m[1], m[0];
    out.F.row(4 * t + 2) << s.F(t, 2), m[2], m[1];
    out.F.row(4 * t + 3) << m[0], m[1], m[2];
  }
  return out;
}

MeshData icosahedron() {
  const double g = (1 + std::sqrt(5.0)) / 2;
  MeshData s{Positions<double>(12, 3), Faces(20, 3)};
  s.V << -1, g, 0, 1, g, 0, -1, -g, 0, 1, -g, 0, 0, -1, g, 0, 1, g, 0, -1, -g, 0, 1, -g, g, 0, -1, g, 0, 1, -g, 0, -1,
      -g, 0, 1;
  s.V.rowwise().normalize();
  s.F << 0, 11, 5, 0, 5, 1, 0, 1, 7, 0, 7, 10, 0, 10, 11, 1, 5, 9, 5, 11, 4, 11, 10, 2, 10, 7, 6, 7, 1, 8, 3, 9, 4, 3,
      4, 2, 3, 2, 6, 3, 6, 8, 3, 8, 9, 4, 9, 5, 2, 4, 11, 6, 2, 10, 8, 6, 7, 9, 8, 1;
  return s;
}

/// Refuses a by b quads when their halfedges could not be numbered, or rows and columns not be counted.
void check_quads(std::int64_t a, std::int64_t b, const char* field) {
  constexpr std::int64_t most = std::numeric_limits<Index>::max() / 6, most_across = std::numeric_limits<int>::max();
  require(a <= most_across && b <= most_across && a * b <= most, field, b, "makes more faces than can be numbered");
}

Positions<double> torus_points(int nu, int nv, double R, double r) {
  Positions<double> V(static_cast<Eigen::Index>(nu) * nv, 3);
  for (int i = 0; i < nu; ++i) {
    for (int j = 0; j < nv; ++j) {
      const double u = 2 * pi<double> * i / nu, v = 2 * pi<double> * j / nv;
      const double ring = R + r * std::cos(v);
      V.row(static_cast<Eigen::Index>(i) * nv + j) << ring * std::cos(u), ring * std::sin(u), r * std::sin(v);
    }
  }
  return V;
}

/// Quads split along a-c, or along b-d where other_diagonal() says so.
template <class Choice>
Faces torus_faces(int nu, int nv, Choice&& other_diagonal) {
  Faces F(2 * static_cast<Eigen::Index>(nu) * nv, 3);
  Eigen::Index t = 0;
  const auto number = [&](int i, int j) { return Index{i % nu} * nv + j % nv; };
  for (int i = 0; i < nu; ++i) {
    for (int j = 0; j < nv; ++j) {
      const Index a = number(i, j), b = number(i + 1, j), c = number(i + 1, j + 1), d = number(i, j + 1);
      if (other_diagonal()) {
        F.row(t++) << a, b, d;
        F.row(t++) << b, c, d;
      } else {
        F.row(t++) << a, b, c;
        F.row(t++) << a, c, d;
      }
    }
  }
  return F;
}

void check_torus(int nu, int nv, double R, double r) {
  at_least(nu, 3, "nu");
  at_least(nv, 3, "nv");
  check_quads(nu, nv, "nv");
  positive(r, "r");
  require(R > r && std::isfinite(R), "R", R, "must be finite and larger than r");
}

}  // namespace

MeshData single_triangle() {
  MeshData s{Positions<double>(3, 3), Faces(1, 3)};
  s.V << 0, 0, 0, 1, 0, 0, 0, 1, 0;
  s.F << 0, 1, 2;
  return s;
}

MeshData tetrahedron() {
  MeshData s{Positions<double>(4, 3), Faces(4, 3)};
  s.V << 1, 1, 1, -1, -1, 1, -1, 1, -1, 1, -1, -1;
  s.V /= std::sqrt(3.0);
  s.F << 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3;
  return s;
}

MeshData cube() {
  MeshData s{Positions<double>(8, 3), Faces(12, 3)};
  for (int v = 0; v < 8; ++v) s.V.row(v) << (v & 1 ? 1 : -1), (v & 2 ? 1 : -1), (v & 4 ? 1 : -1);
  s.F << 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5;
  return s;
}

MeshData icosphere(int level) {
  require(level >= 0 && level <= 12, "level", level, "must be in [0, 12]");
  MeshData s = icosahedron();
  for (int l = 0; l < level; ++l) s = subdivided(s);
  return s;
}

MeshData jittered_sphere(int level, double amount, std::uint64_t seed) {
  require(amount >= 0 && amount <= 1, "amount", amount, "must be in [0, 1]");
  MeshData s = icosphere(level);
  double mean = 0;
  for (Eigen::Index t = 0; t < s.F.rows(); ++t) {
    for (int c = 0; c < 3; ++c) mean += (s.V.row(s.F(t, c)) - s.V.row(s.F(t, (c + 1) % 3))).norm();
  }
  mean /= static_cast<double>(3 * s.F.rows());
  detail::Random random(seed);
  for (Eigen::Index v = 0; v < s.V.rows(); ++v) {
    detail::check_cancelled_at(v);
    const Point n = s.V.row(v);
    double x = 0, y = 0;
    do {
      x = random.uniform(-1, 1);
      y = random.uniform(-1, 1);
    } while (x * x + y * y > 1);
    const Point e1 = n.unitOrthogonal(), e2 = n.cross(e1);
    s.V.row(v) = (n + amount * mean * (x * e1 + y * e2)).normalized();
  }
  return s;
}

MeshData bumpy_sphere(int level, double amplitude, double frequency) {
  require(std::abs(amplitude) < 1, "amplitude", amplitude, "must be in (-1, 1)");
  require(std::isfinite(frequency), "frequency", frequency, "must be finite");
  MeshData s = icosphere(level);
  for (Eigen::Index v = 0; v < s.V.rows(); ++v) {
    s.V.row(v) *= 1 + amplitude * (frequency * s.V.row(v)).array().sin().sum() / 3;
  }
  return s;
}

MeshData torus(int nu, int nv, double R, double r) {
  check_torus(nu, nv, R, r);
  return {torus_points(nu, nv, R, r), torus_faces(nu, nv, [] { return false; })};
}

MeshData torus_random_diagonals(int nu, int nv, double R, double r, std::uint64_t seed) {
  check_torus(nu, nv, R, r);
  detail::Random random(seed);
  return {torus_points(nu, nv, R, r), torus_faces(nu, nv, [&] { return random.bits() >> 63 != 0; })};
}

FlatTorus flat_torus(int nu, int nv) {
  at_least(nu, 3, "nu");
  at_least(nv, 3, "nv");
  check_quads(nu, nv, "nv");
  FlatTorus s{std::int64_t{nu} * nv, torus_faces(nu, nv, [] { return false; }), {}};
  const double u = 1.0 / nu, v = 1.0 / nv, diagonal = std::hypot(u, v);
  s.lengths.resize(s.F.rows(), 3);
  for (Eigen::Index t = 0; t < s.F.rows(); t += 2) {
    s.lengths.row(t) << u, v, diagonal;      // a b c
    s.lengths.row(t + 1) << diagonal, u, v;  // a c d
  }
  return s;
}

MeshData grid(int nx, int ny, double width, double height) {
  at_least(nx, 1, "nx");
  at_least(ny, 1, "ny");
  check_quads(nx + std::int64_t{1}, ny + std::int64_t{1}, "ny");
  positive(width, "width");
  positive(height, "height");
  MeshData s{Positions<double>((nx + Eigen::Index{1}) * (ny + 1), 3), Faces(2 * Eigen::Index{nx} * ny, 3)};
  const auto number = [&](int i, int j) { return j * (Index{nx} + 1) + i; };
  for (int j = 0; j <= ny; ++j) {
    for (int i = 0; i <= nx; ++i) s.V.row(number(i, j)) << width * i / nx, height * j / ny, 0;
  }
  Eigen::Index t = 0;
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      const Index a = number(i, j), b = number(i + 1, j), c = number(i + 1, j + 1), d = number(i, j + 1);
      s.F.row(t++) << a, b, c;
      s.F.row(t++) << a, c, d;
    }
  }
  return s;
}

MeshData disk(int rings) {
  at_least(rings, 1, "rings");
  require(rings <= 8000, "rings", rings, "must be at most 8000");
  const Eigen::Index r = rings;
  MeshData s{Positions<double>(1 + 3 * r * (r + 1), 3), Faces(6 * r * r, 3)};
  s.V.row(0).setZero();
  const auto number = [](Index ring, Index k) {  // vertex k of the 6 ring vertices of a ring
    return ring == 0 ? 0 : 1 + 3 * (ring - 1) * ring + k % (6 * ring);
  };
  Eigen::Index t = 0;
  for (int ring = 1; ring <= rings; ++ring) {
    for (int k = 0; k < 6 * ring; ++k) {
      const double angle = pi<double> * k / (3 * ring), radius = static_cast<double>(ring) / rings;
      s.V.row(number(ring, k)) << radius * std::cos(angle), radius * std::sin(angle), 0;
    }
    for (int sector = 0; sector < 6; ++sector) {
      for (int k = 0; k < ring; ++k) {
        const int outer = sector * ring + k, inner = sector * (ring - 1) + k;
        s.F.row(t++) << number(ring - 1, inner), number(ring, outer), number(ring, outer + 1);
        if (k + 1 < ring) s.F.row(t++) << number(ring - 1, inner), number(ring, outer + 1), number(ring - 1, inner + 1);
      }
    }
  }
  return s;
}

MeshData fan(int count) {
  at_least(count, 3, "count");
  check_quads(1, count, "count");
  MeshData s{Positions<double>(Eigen::Index{count} + 1, 3), Faces(count, 3)};
  s.V.row(0).setZero();
  for (int k = 0; k < count; ++k) {
    const double angle = 2 * pi<double> * k / count;
    s.V.row(k + 1) << std::cos(angle), std::sin(angle), 0;
    s.F.row(k) << 0, k + 1, (k + 1) % count + 1;
  }
  return s;
}

MeshData cylinder(int nu, int nv, double radius, double height) {
  at_least(nu, 3, "nu");
  at_least(nv, 1, "nv");
  check_quads(nu, nv + std::int64_t{1}, "nv");
  positive(radius, "radius");
  positive(height, "height");
  MeshData s{Positions<double>(Eigen::Index{nu} * (nv + 1), 3), Faces(2 * Eigen::Index{nu} * nv, 3)};
  const auto number = [&](int i, int j) { return Index{j} * nu + i % nu; };
  Eigen::Index t = 0;
  for (int j = 0; j <= nv; ++j) {
    for (int i = 0; i < nu; ++i) {
      const double u = 2 * pi<double> * i / nu;
      s.V.row(number(i, j)) << radius * std::cos(u), radius * std::sin(u), height * j / nv;
      if (j == nv) continue;
      const Index a = number(i, j), b = number(i + 1, j), c = number(i + 1, j + 1), d = number(i, j + 1);
      s.F.row(t++) << a, b, c;
      s.F.row(t++) << a, c, d;
    }
  }
  return s;
}

}  // namespace alcap
