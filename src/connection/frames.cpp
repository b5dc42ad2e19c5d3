// SPDX-License-Identifier: MIT
#include "alcap/frames.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "src/base/array.h"
#include "src/base/parallel.h"
#include "src/simd/angles.h"

namespace alcap {
namespace {

using Row = Eigen::Matrix<double, 1, 3>;

// A unit vector orthogonal to the unit vector n, continuous except at one direction.
Row any_orthogonal(const Row& n) {
  const Row axis = std::abs(n.x()) < double(0.6) ? Row::UnitX() : Row::UnitY();
  return (axis - axis.dot(n) * n).normalized();
}

// The edges around some vertices, one vertex after the other: those of the leaving halfedges in order and, at a
// boundary, the last one.
class Rings {
 public:
  void collect(const Mesh& mesh, const Positions<double>& V, const Connection& connection, std::int64_t begin,
               std::int64_t end) {
    corner_.clear();
    edge_.clear();
    direction_.clear();
    for (auto v = static_cast<Index>(begin); v < end; ++v) {
      Index last = none;
      mesh.for_each_outgoing(v, [&](Index h) {
        add(h, V.row(mesh.tip(h)) - V.row(v), connection.rho_start(mesh, h));
        last = Mesh::prev(h);
      });
      if (mesh.boundary_vertex(v))
        add(none, V.row(mesh.tail(last)) - V.row(v), connection.rho_end(mesh, last) - pi<double>);
      end_[detail::at(v - begin)] = corner_.size();
    }
    unit_.resize(direction_.size());
    detail::unit_numbers(static_cast<std::int64_t>(unit_.size()), direction_.data(), double(-1), unit_.data());
  }

  static constexpr std::int64_t most = 256;  // vertices at a time

  struct Ring {
    std::span<const Index> corner;  // halfedge whose corner lies after the edge, `none` after the last at a boundary
    std::span<const Row> edge;      // from the vertex
    std::span<const Complex<double>> unit;  // exp(-i direction of the edge)
  };
  [[nodiscard]] Ring ring(std::int64_t i) const {
    const std::size_t from = i == 0 ? 0 : end_[detail::at(i - 1)];
    const std::size_t count = end_[detail::at(i)] - from;
    return {std::span(corner_).subspan(from, count), std::span(edge_).subspan(from, count),
            std::span(unit_).subspan(from, count)};
  }

 private:
  void add(Index corner, const Row& edge, double direction) {
    corner_.push_back(corner);
    edge_.push_back(edge);
    direction_.push_back(direction);
  }

  std::array<std::size_t, most> end_ = {};
  std::vector<Index> corner_;
  std::vector<Row> edge_;
  std::vector<double> direction_;
  std::vector<Complex<double>> unit_;
};

void set_frame(const Geometry& geometry, const Rings::Ring& ring, Index v, Frames& frames) {
  const std::size_t count = ring.edge.size();
  if (count == 0) {
    frames.X.row(v).setZero();
    frames.N.row(v).setZero();
    return;
  }
  const auto after = [&](std::size_t k) -> const Row& { return ring.edge[k + 1 == count ? 0 : k + 1]; };
  Row normal = Row::Zero();
  double ring_area = 0;
  for (std::size_t k = 0; k < count; ++k) {
    if (ring.corner[k] == none) continue;
    const Row face_normal = ring.edge[k].cross(after(k));
    normal += face_normal;
    ring_area += face_normal.norm();
  }
  // Rings whose normals cancel (a vertex between two coincident sheets) take the normal of their first face.
  if (!(normal.norm() > double(1e-6) * ring_area)) normal = ring.edge[0].cross(after(0));
  normal.normalize();
  const Row a = any_orthogonal(normal), b = normal.cross(a);

  // The turn from the connection's direction of an edge to the edge as it is seen in the tangent plane.
  const auto turn = [&](std::size_t k) -> Complex<double> {
    const double x = ring.edge[k].dot(a), y = ring.edge[k].dot(b), length = std::sqrt(x * x + y * y);
    if (!(length > double(0))) return 0;
    const double c = ring.unit[k].real(), s = ring.unit[k].imag();
    return {(x * c - y * s) / length, (y * c + x * s) / length};
  };
  // Every edge weighs half of the angles of its two corners, so dense fans count no more than wide ones.
  const auto angle_after = [&](std::size_t k) {
    return ring.corner[k] == none ? double(0) : geometry.angle(ring.corner[k]);
  };
  Complex<double> axis = 0;
  double total = 0, before = angle_after(count - 1);
  for (std::size_t k = 0; k < count; ++k) {
    const double angle = angle_after(k);
    axis += (before + angle) / 2 * turn(k);
    total += angle;
    before = angle;
  }
  if (!(std::abs(axis) > double(1e-6) * total)) {  // nothing to prefer: the first edge alone
    axis = turn(0);
    if (axis == Complex<double>(0)) axis = 1;
  }
  axis /= std::abs(axis);
  frames.N.row(v) = normal;
  frames.X.row(v) = axis.real() * a + axis.imag() * b;
}

}  // namespace

Eigen::Matrix<double, 1, 3> Frames::Y(Index element) const { return Row(N.row(element)).cross(Row(X.row(element))); }

Eigen::Matrix<double, 1, 3> Frames::vector(Index element, Complex<double> z) const {
  return z.real() * X.row(element) + z.imag() * Y(element);
}

Complex<double> Frames::component(Index element, const Eigen::Matrix<double, 1, 3>& w) const {
  return {w.dot(X.row(element)), w.dot(Y(element))};
}

bool Frames::operator==(const Frames& other) const {
  return X.rows() == other.X.rows() && N.rows() == other.N.rows() && X == other.X && N == other.N;
}

Frames vertex_frames(const Mesh& mesh, const Positions<double>& V, const Connection& connection) {
  return vertex_frames(mesh, V, Geometry(mesh, V), connection);
}

Frames vertex_frames(const Mesh& mesh, const Positions<double>& V, const Geometry& geometry,
                     const Connection& connection) {
  constexpr std::int64_t block = Rings::most;
  Frames frames{Positions<double>(mesh.vertices(), 3), Positions<double>(mesh.vertices(), 3)};
  parallel_ranges(mesh.vertices(), block, [&](std::int64_t begin, std::int64_t end) {
    Rings rings;
    for (std::int64_t first = begin; first < end; first += block) {
      const std::int64_t stop = std::min(end, first + block);
      rings.collect(mesh, V, connection, first, stop);
      for (std::int64_t v = first; v < stop; ++v)
        set_frame(geometry, rings.ring(v - first), static_cast<Index>(v), frames);
    }
  });
  return frames;
}

Frames face_frames(const Mesh& mesh, const Positions<double>& V) {
  Frames frames{Positions<double>(mesh.faces(), 3), Positions<double>(mesh.faces(), 3)};
  parallel_for(mesh.faces(), [&](std::int64_t t) {
    const Row p = V.row(mesh.F()(t, 0));
    const Row first = V.row(mesh.F()(t, 1)) - p, second = V.row(mesh.F()(t, 2)) - p;
    frames.X.row(t) = first.normalized();
    frames.N.row(t) = first.cross(second).normalized();
  });
  return frames;
}

}  // namespace alcap
