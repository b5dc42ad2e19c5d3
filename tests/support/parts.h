// SPDX-License-Identifier: MIT
//
// parts.h: CAD-like solids and plates with sharp edges, finely triangulated: unions of cubes, prisms over polygons and
// disks.
#pragma once

#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/support/mesh_helpers.h"

namespace alcap::test {

/// Collects triangles of points; points at the same place (to 1e-9) are one vertex.
class PartBuilder {
 public:
  using Point = std::array<double, 3>;
  Index vertex(const Point& p) {
    const auto key = [](double x) { return std::llround(x * 1e9); };
    const auto [at, isnew] =
        number_.emplace(std::array{key(p[0]), key(p[1]), key(p[2])}, static_cast<Index>(points_.size()));
    if (isnew) points_.push_back(p);
    return at->second;
  }
  void triangle(const Point& a, const Point& b, const Point& c) { faces_.push_back({vertex(a), vertex(b), vertex(c)}); }
  void quad(const Point& a, const Point& b, const Point& c, const Point& d) {
    triangle(a, b, c);
    triangle(a, c, d);
  }
  [[nodiscard]] MeshData finish() const {
    MeshData out{Positions<double>(static_cast<Eigen::Index>(points_.size()), 3),
                 Faces(static_cast<Eigen::Index>(faces_.size()), 3)};
    for (std::size_t v = 0; v < points_.size(); ++v)
      out.V.row(static_cast<Eigen::Index>(v)) << points_[v][0], points_[v][1], points_[v][2];
    for (std::size_t t = 0; t < faces_.size(); ++t)
      out.F.row(static_cast<Eigen::Index>(t)) << faces_[t][0], faces_[t][1], faces_[t][2];
    return out;
  }

 private:
  std::map<std::array<long long, 3>, Index> number_;
  std::vector<Point> points_;
  std::vector<std::array<Index, 3>> faces_;
};

using Cell = std::array<int, 3>;

/// The surface of a union of unit cubes, each square cut into m x m. Cubes must not touch along an edge alone.
inline MeshData blocks(const std::set<Cell>& cells, int m) {
  PartBuilder part;
  for (const Cell& cell : cells)
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int side : {0, 1}) {
        Cell other = cell;
        other[axis] += side == 1 ? 1 : -1;
        if (cells.count(other) != 0) continue;
        const std::size_t u = side == 1 ? (axis + 1) % 3 : (axis + 2) % 3, v = 3 - axis - u;
        const auto at = [&](int i, int j) {
          PartBuilder::Point p{double(cell[0]), double(cell[1]), double(cell[2])};
          p[axis] += side;
          p[u] += double(i) / m;
          p[v] += double(j) / m;
          return p;
        };
        for (int i = 0; i < m; ++i)
          for (int j = 0; j < m; ++j) part.quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      }
  return part.finish();
}

/// Cells of a box of x by y by z cubes without those that `left_out` says.
template <class LeftOut>
std::set<Cell> cells(int x, int y, int z, LeftOut&& left_out) {
  std::set<Cell> out;
  for (int i = 0; i < x; ++i)
    for (int j = 0; j < y; ++j)
      for (int k = 0; k < z; ++k)
        if (!left_out(i, j, k)) out.insert({i, j, k});
  return out;
}

using Outline = std::vector<std::array<double, 2>>;

/// Corners of a regular polygon on the unit circle.
inline Outline regular(int corners) {
  Outline out;
  for (int k = 0; k < corners; ++k)
    out.push_back({std::cos(2 * pi<double> * k / corners), std::sin(2 * pi<double> * k / corners)});
  return out;
}

/// Rings around the centroid of a polygon that is star-shaped from there (counter-clockwise): sectors of one side each,
/// `rings` pieces to a side. With `round` all rings are circles around the origin.
inline void add_plate(PartBuilder& part, const Outline& outline, int rings, double z, bool up, bool round = false) {
  double cx = 0, cy = 0;
  for (const auto& p : outline) {
    cx += p[0] / static_cast<double>(outline.size());
    cy += p[1] / static_cast<double>(outline.size());
  }
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const auto& a = outline[k];
    const auto& b = outline[(k + 1) % outline.size()];
    const auto at = [&](int ring, int i) {
      const double r = double(ring) / rings, s = ring == 0 ? 0 : double(i) / ring;
      double x = (1 - s) * a[0] + s * b[0] - cx, y = (1 - s) * a[1] + s * b[1] - cy;
      if (round) {
        const double start = std::atan2(a[1], a[0]), turn = 2 * pi<double> / static_cast<double>(outline.size());
        x = std::cos(start + s * turn);
        y = std::sin(start + s * turn);
      }
      return PartBuilder::Point{cx + r * x, cy + r * y, z};
    };
    const auto add = [&](const auto& p, const auto& q, const auto& r) {
      up ? part.triangle(p, q, r) : part.triangle(p, r, q);
    };
    for (int ring = 1; ring <= rings; ++ring)
      for (int i = 0; i < ring; ++i) {
        add(at(ring - 1, i), at(ring, i), at(ring, i + 1));
        if (i + 1 < ring) add(at(ring - 1, i), at(ring, i + 1), at(ring - 1, i + 1));
      }
  }
}

inline MeshData plate(const Outline& outline, int rings, bool round = false) {
  PartBuilder part;
  add_plate(part, outline, rings, 0, true, round);
  return part.finish();
}

/// A plate of this outline, `height` thick, its sides cut into `layers`.
inline MeshData prism(const Outline& outline, int rings, double height, int layers, bool round = false) {
  PartBuilder part;
  add_plate(part, outline, rings, 0, false, round);
  add_plate(part, outline, rings, height, true, round);
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const auto& a = outline[k];
    const auto& b = outline[(k + 1) % outline.size()];
    const auto at = [&](int i, int layer) {
      const double s = double(i) / rings, z = height * layer / layers;
      if (!round) return PartBuilder::Point{(1 - s) * a[0] + s * b[0], (1 - s) * a[1] + s * b[1], z};
      const double angle = std::atan2(a[1], a[0]) + s * 2 * pi<double> / static_cast<double>(outline.size());
      return PartBuilder::Point{std::cos(angle), std::sin(angle), z};
    };
    for (int i = 0; i < rings; ++i)
      for (int layer = 0; layer < layers; ++layer)
        part.quad(at(i, layer), at(i + 1, layer), at(i + 1, layer + 1), at(i, layer + 1));
  }
  return part.finish();
}

/// A square with corners (-1, -1) to (1, 1) around a round hole of this radius: `around` x 8 points, `rings` rings.
inline MeshData plate_with_hole(double radius, int around, int rings) {
  PartBuilder part;
  const int count = 8 * around;
  const auto at = [&](int k, int ring) {
    const double angle = 2 * pi<double> * (k % count) / count, t = double(ring) / rings;
    const double c = std::cos(angle), s = std::sin(angle), edge = 1 / std::max(std::abs(c), std::abs(s));
    const double r = (1 - t) * radius + t * edge;
    return PartBuilder::Point{r * c, r * s, 0};
  };
  for (int k = 0; k < count; ++k)
    for (int ring = 0; ring < rings; ++ring)
      part.quad(at(k, ring), at(k, ring + 1), at(k + 1, ring + 1), at(k + 1, ring));
  return part.finish();
}

/// A ring between circles of radius `inner` and 1.
inline MeshData ring_plate(double inner, int around, int rings) {
  PartBuilder part;
  const auto at = [&](int k, int ring) {
    const double angle = 2 * pi<double> * (k % around) / around, r = inner + (1 - inner) * ring / rings;
    return PartBuilder::Point{r * std::cos(angle), r * std::sin(angle), 0};
  };
  for (int k = 0; k < around; ++k)
    for (int ring = 0; ring < rings; ++ring)
      part.quad(at(k, ring), at(k, ring + 1), at(k + 1, ring + 1), at(k + 1, ring));
  return part.finish();
}

struct Part {
  std::string name;
  MeshData surface;
};

/// Solids as CAD systems make them, about 2,000 to 6,000 faces each.
inline std::vector<Part> cad_parts() {
  const auto all = [](int, int, int) { return false; };
  return {
      {"box", blocks(cells(3, 2, 1, all), 8)},
      {"L-bracket", blocks(cells(4, 3, 4, [](int i, int, int k) { return i > 0 && k > 0; }), 5)},
      {"U-channel", blocks(cells(3, 5, 3, [](int i, int, int k) { return i == 1 && k > 0; }), 5)},
      {"stairs", blocks(cells(4, 2, 4, [](int i, int, int k) { return i + k > 3; }), 5)},
      {"frame", blocks(cells(5, 5, 1, [](int i, int j, int) { return i > 0 && i < 4 && j > 0 && j < 4; }), 5)},
      {"plate with four holes", blocks(cells(5, 5, 1, [](int i, int j, int) { return i % 2 == 1 && j % 2 == 1; }), 5)},
      {"cross block",
       blocks(cells(3, 3, 3, [](int i, int j, int k) { return (i != 1) + (j != 1) + (k != 1) > 1; }), 6)},
      {"wedge", prism({{0, 0}, {2, 0}, {0, 1}}, 16, 1, 10)},
      {"hexagonal prism", prism(regular(6), 10, 1, 10)},
      {"chamfered bar", prism({{0, 0}, {2, 0}, {2, 0.7}, {1.7, 1}, {0, 1}}, 12, 2, 16)},
      {"cylinder", prism(regular(6), 10, 2, 18, true)},
  };
}

}  // namespace alcap::test
