// SPDX-License-Identifier: MIT
#include "alcap/frames.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "src/simd/angles.h"
#include "src/base/parallel.h"

namespace alcap {
namespace {

template <class T>
using Row = Eigen::Matrix<T, 1, 3>;

// A unit vector orthogonal to the unit vector n, continuous except at one direction.
template <class T>
Row<T> any_orthogonal(const Row<T>& n) {
  const Row<T> axis = std::abs(n.x()) < T(0.6) ? Row<T>::UnitX() : Row<T>::UnitY();
  return (axis - axis.dot(n) * n).normalized();
}

// The edges around some vertices, one vertex after the other: those of the leaving halfedges in order and, at a
// boundary, the last one.
template <class T>
class Rings {
 public:
  void collect(const Mesh& mesh, const Positions<T>& V, const Connection<T>& connection, std::int64_t begin,
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
      if (mesh.boundary_vertex(v)) add(none, V.row(mesh.tail(last)) - V.row(v), connection.rho_end(mesh, last) - pi<T>);
      end_[static_cast<std::size_t>(v - begin)] = corner_.size();
    }
    unit_.resize(direction_.size());
    detail::unit_numbers(static_cast<std::int64_t>(unit_.size()), direction_.data(), T(-1), unit_.data());
  }

  static constexpr std::int64_t most = 256;  // vertices at a time

  struct Ring {
    std::span<const Index> corner;     // halfedge whose corner lies after the edge, `none` after the last at a boundary
    std::span<const Row<T>> edge;      // from the vertex
    std::span<const Complex<T>> unit;  // exp(-i direction of the edge)
  };
  [[nodiscard]] Ring ring(std::int64_t i) const {
    const std::size_t from = i == 0 ? 0 : end_[static_cast<std::size_t>(i) - 1];
    const std::size_t count = end_[static_cast<std::size_t>(i)] - from;
    return {std::span(corner_).subspan(from, count), std::span(edge_).subspan(from, count),
            std::span(unit_).subspan(from, count)};
  }

 private:
  void add(Index corner, const Row<T>& edge, T direction) {
    corner_.push_back(corner);
    edge_.push_back(edge);
    direction_.push_back(direction);
  }

  std::array<std::size_t, most> end_ = {};
  std::vector<Index> corner_;
  std::vector<Row<T>> edge_;
  std::vector<T> direction_;
  std::vector<Complex<T>> unit_;
};

template <class T>
void set_frame(const Geometry<T>& geometry, const typename Rings<T>::Ring& ring, Index v, Frames<T>& frames) {
  const std::size_t count = ring.edge.size();
  if (count == 0) {
    frames.X.row(v).setZero();
    frames.N.row(v).setZero();
    return;
  }
  const auto after = [&](std::size_t k) -> const Row<T>& { return ring.edge[k + 1 == count ? 0 : k + 1]; };
  Row<T> normal = Row<T>::Zero();
  T ring_area = 0;
  for (std::size_t k = 0; k < count; ++k) {
    if (ring.corner[k] == none) continue;
    const Row<T> face_normal = ring.edge[k].cross(after(k));
    normal += face_normal;
    ring_area += face_normal.norm();
  }
  // Rings whose normals cancel (a vertex between two coincident sheets) take the normal of their first face.
  if (!(normal.norm() > T(1e-6) * ring_area)) normal = ring.edge[0].cross(after(0));
  normal.normalize();
  const Row<T> a = any_orthogonal<T>(normal), b = normal.cross(a);

  // The turn from the connection's direction of an edge to the edge as it is seen in the tangent plane.
  const auto turn = [&](std::size_t k) -> Complex<T> {
    const T x = ring.edge[k].dot(a), y = ring.edge[k].dot(b), length = std::sqrt(x * x + y * y);
    if (!(length > T(0))) return 0;
    const T c = ring.unit[k].real(), s = ring.unit[k].imag();
    return {(x * c - y * s) / length, (y * c + x * s) / length};
  };
  // Every edge weighs half of the angles of its two corners, so dense fans count no more than wide ones.
  const auto angle_after = [&](std::size_t k) {
    return ring.corner[k] == none ? T(0) : geometry.angle(ring.corner[k]);
  };
  Complex<T> axis = 0;
  T total = 0, before = angle_after(count - 1);
  for (std::size_t k = 0; k < count; ++k) {
    const T angle = angle_after(k);
    axis += (before + angle) / 2 * turn(k);
    total += angle;
    before = angle;
  }
  if (!(std::abs(axis) > T(1e-6) * total)) {  // nothing to prefer: the first edge alone
    axis = turn(0);
    if (axis == Complex<T>(0)) axis = 1;
  }
  axis /= std::abs(axis);
  frames.N.row(v) = normal;
  frames.X.row(v) = axis.real() * a + axis.imag() * b;
}

}  // namespace

template <class T>
Eigen::Matrix<T, 1, 3> Frames<T>::Y(Index element) const {
  return Row<T>(N.row(element)).cross(Row<T>(X.row(element)));
}

template <class T>
Eigen::Matrix<T, 1, 3> Frames<T>::vector(Index element, Complex<T> z) const {
  return z.real() * X.row(element) + z.imag() * Y(element);
}

template <class T>
Complex<T> Frames<T>::component(Index element, const Eigen::Matrix<T, 1, 3>& w) const {
  return {w.dot(X.row(element)), w.dot(Y(element))};
}

template <class T>
Frames<T> vertex_frames(const Mesh& mesh, const Positions<T>& V, const Connection<T>& connection) {
  return vertex_frames(mesh, V, Geometry<T>(mesh, V), connection);
}

template <class T>
Frames<T> vertex_frames(const Mesh& mesh, const Positions<T>& V, const Geometry<T>& geometry,
                        const Connection<T>& connection) {
  constexpr std::int64_t block = Rings<T>::most;
  Frames<T> frames{Positions<T>(mesh.vertices(), 3), Positions<T>(mesh.vertices(), 3)};
  parallel_ranges(mesh.vertices(), block, [&](std::int64_t begin, std::int64_t end) {
    Rings<T> rings;
    for (std::int64_t first = begin; first < end; first += block) {
      const std::int64_t stop = std::min(end, first + block);
      rings.collect(mesh, V, connection, first, stop);
      for (std::int64_t v = first; v < stop; ++v)
        set_frame<T>(geometry, rings.ring(v - first), static_cast<Index>(v), frames);
    }
  });
  return frames;
}

template <class T>
Frames<T> face_frames(const Mesh& mesh, const Positions<T>& V) {
  Frames<T> frames{Positions<T>(mesh.faces(), 3), Positions<T>(mesh.faces(), 3)};
  parallel_for(mesh.faces(), [&](std::int64_t t) {
    const Row<T> p = V.row(mesh.F()(t, 0));
    const Row<T> first = V.row(mesh.F()(t, 1)) - p, second = V.row(mesh.F()(t, 2)) - p;
    frames.X.row(t) = first.normalized();
    frames.N.row(t) = first.cross(second).normalized();
  });
  return frames;
}

template struct Frames<float>;
template struct Frames<double>;
template Frames<float> vertex_frames(const Mesh&, const Positions<float>&, const Connection<float>&);
template Frames<double> vertex_frames(const Mesh&, const Positions<double>&, const Connection<double>&);
template Frames<float> vertex_frames(const Mesh&, const Positions<float>&, const Geometry<float>&,
                                     const Connection<float>&);
template Frames<double> vertex_frames(const Mesh&, const Positions<double>&, const Geometry<double>&,
                                      const Connection<double>&);
template Frames<float> face_frames(const Mesh&, const Positions<float>&);
template Frames<double> face_frames(const Mesh&, const Positions<double>&);

}  // namespace alcap
