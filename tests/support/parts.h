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

/// A plate in the plane z = 0, `height` thick, the sides along its rims cut into `layers`.
inline MeshData extrude(const MeshData& plate, double height, int layers) {
  PartBuilder part;
  const auto at = [&](Index v, double z) { return PartBuilder::Point{plate.V(v, 0), plate.V(v, 1), z}; };
  std::set<std::array<Index, 2>> sides;
  for (Eigen::Index t = 0; t < plate.F.rows(); ++t) {
    const Index a = plate.F(t, 0), b = plate.F(t, 1), c = plate.F(t, 2);
    part.triangle(at(a, height), at(b, height), at(c, height));
    part.triangle(at(a, 0), at(c, 0), at(b, 0));
    for (const auto& [i, j] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
      if (sides.erase({j, i}) == 0) sides.insert({i, j});
  }
  for (const auto& [i, j] : sides)
    for (int layer = 0; layer < layers; ++layer) {
      const double low = height * layer / layers, high = height * (layer + 1) / layers;
      part.quad(at(i, low), at(j, low), at(j, high), at(i, high));
    }
  return part.finish();
}

/// A solid of revolution about z: (radius, z) from the axis to the axis, counter-clockwise around the material seen
/// with z up, each side of the profile cut into pieces as long as those around it.
inline MeshData revolve(const Outline& profile, int around) {
  PartBuilder part;
  double widest = 0;
  for (const auto& p : profile) widest = std::max(widest, p[0]);
  const double piece = 2 * pi<double> * widest / around;
  const auto at = [&](double r, double z, int k) {
    const double angle = 2 * pi<double> * (k % around) / around;
    return PartBuilder::Point{r * std::cos(angle), r * std::sin(angle), z};
  };
  for (std::size_t side = 0; side + 1 < profile.size(); ++side) {
    const auto &a = profile[side], &b = profile[side + 1];
    const int pieces = std::max(1, static_cast<int>(std::lround(std::hypot(b[0] - a[0], b[1] - a[1]) / piece)));
    for (int i = 0; i < pieces; ++i) {
      const double s = double(i) / pieces, t = double(i + 1) / pieces;
      const double r = (1 - s) * a[0] + s * b[0], z = (1 - s) * a[1] + s * b[1];
      const double r2 = (1 - t) * a[0] + t * b[0], z2 = (1 - t) * a[1] + t * b[1];
      for (int k = 0; k < around; ++k) {
        if (r > 1e-9) part.triangle(at(r, z, k), at(r, z, k + 1), at(r2, z2, k));
        if (r2 > 1e-9) part.triangle(at(r, z, k + 1), at(r2, z2, k + 1), at(r2, z2, k));
      }
    }
  }
  return part.finish();
}

/// `move` takes and gives points.
template <class Move>
MeshData deformed(MeshData mesh, Move&& move) {
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) mesh.V.row(v) = move(Eigen::RowVector3d(mesh.V.row(v)));
  return mesh;
}

/// Points of an arc about (x, y) from angle `from` to `to`, in degrees, both included.
inline void add_arc(Outline& outline, double x, double y, double radius, double from, double to, int pieces) {
  for (int k = 0; k <= pieces; ++k) {
    const double angle = (from + (to - from) * k / pieces) * pi<double> / 180;
    outline.push_back({x + radius * std::cos(angle), y + radius * std::sin(angle)});
  }
}

/// A plate of `rings` copies of an outline around (x, y), from where it must be star-shaped. Its sides are not cut.
inline MeshData radial_plate(const Outline& outline, double x, double y, int rings) {
  PartBuilder part;
  const auto at = [&](std::size_t k, int ring) {
    const auto& p = outline[k % outline.size()];
    const double s = double(ring) / rings;
    return PartBuilder::Point{x + s * (p[0] - x), y + s * (p[1] - y), 0};
  };
  for (std::size_t k = 0; k < outline.size(); ++k) {
    part.triangle(at(k, 0), at(k, 1), at(k + 1, 1));
    for (int ring = 1; ring < rings; ++ring)
      part.quad(at(k, ring), at(k, ring + 1), at(k + 1, ring + 1), at(k + 1, ring));
  }
  return part.finish();
}

/// The outline with a side from its last point to (x, y), in so many pieces, its end left out where it is the start.
inline void add_side(Outline& outline, double x, double y, int pieces) {
  const auto from = outline.back();
  for (int k = 1; k <= pieces; ++k) {
    const std::array<double, 2> p{from[0] + (x - from[0]) * k / pieces, from[1] + (y - from[1]) * k / pieces};
    if (std::hypot(p[0] - outline[0][0], p[1] - outline[0][1]) > 1e-9) outline.push_back(p);
  }
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

/// Parts with curved sides and creases, as fandisk and rocker arms have them, about 1,500 to 6,000 faces each.
inline std::vector<Part> curved_parts() {
  const auto all = [](int, int, int) { return false; };
  Outline stadium, sector, half, arm;
  add_arc(stadium, 1, 0, 0.6, -90, 90, 30);
  add_side(stadium, -1, 0.6, 30);
  add_arc(stadium, -1, 0, 0.6, 93, 270, 29);
  add_side(stadium, 1, -0.6, 30);
  sector.push_back({0, 0});
  add_side(sector, 1, 0, 20);
  add_arc(sector, 0, 0, 1, 3, 90, 29);
  add_side(sector, 0, 0, 20);
  add_arc(half, 0, 0, 1, 0, 180, 60);
  add_side(half, 1, 0, 40);
  // Two circles and the tangents of both.
  const double tilt = std::acos((0.8 - 0.5) / 2.6) * 180 / pi<double>;
  add_arc(arm, 1.4, 0, 0.5, -tilt, tilt, 30);
  add_side(arm, -1.2 + 0.8 * std::cos(tilt * pi<double> / 180), 0.8 * std::sin(tilt * pi<double> / 180), 40);
  add_arc(arm, -1.2, 0, 0.8, tilt + 4, 360 - tilt, 52);
  add_side(arm, arm[0][0], arm[0][1], 40);
  const MeshData bar = blocks(cells(4, 1, 1, all), 8);
  return {
      {"rocker arm", extrude(radial_plate(arm, 0, 0, 12), 0.6, 8)},
      {"stadium", extrude(radial_plate(stadium, 0, 0, 10), 0.5, 7)},
      {"fandisk-like sector", deformed(extrude(radial_plate(sector, 0.4, 0.4, 10), 0.8, 14),
                                       [](Eigen::RowVector3d p) -> Eigen::RowVector3d {
                                         p[2] *= 1 + 0.3 * p[0] * p[0];
                                         return p;
                                       })},
      {"half cylinder", extrude(radial_plate(half, 0, 0.4, 12), 1.2, 20)},
      {"bent bar", deformed(bar,
                            [](const Eigen::RowVector3d& p) -> Eigen::RowVector3d {
                              const double angle = p[0] / 4 * pi<double> / 2, r = 2 + p[1];
                              return {r * std::sin(angle), r * std::cos(angle), p[2]};
                            })},
      {"twisted bar",
       deformed(bar,
                [](const Eigen::RowVector3d& p) -> Eigen::RowVector3d {
                  const double angle = p[0] / 4 * pi<double> / 4, y = p[1] - 0.5, z = p[2] - 0.5;
                  return {p[0], y * std::cos(angle) - z * std::sin(angle), y * std::sin(angle) + z * std::cos(angle)};
                })},
      {"tapered block", deformed(blocks(cells(2, 2, 1, all), 8),
                                 [](Eigen::RowVector3d p) -> Eigen::RowVector3d {
                                   const double narrow = 1 - 0.2 * p[2];
                                   return {1 + narrow * (p[0] - 1), 1 + narrow * (p[1] - 1), p[2]};
                                 })},
      {"plate with a round hole", extrude(plate_with_hole(0.4, 5, 7), 0.3, 3)},
      {"washer", extrude(ring_plate(0.5, 60, 6), 0.2, 2)},
      {"stepped shaft",
       revolve({{0, 0}, {0.5, 0}, {0.5, 1}, {0.8, 1}, {0.8, 1.8}, {0.3, 1.8}, {0.3, 2.6}, {0, 2.6}}, 48)},
      {"frustum", revolve({{0, 0}, {1, 0}, {0.5, 1.2}, {0, 1.2}}, 48)},
  };
}

}  // namespace alcap::test
