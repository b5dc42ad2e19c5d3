// SPDX-License-Identifier: MIT
#include "alcap/frames.h"

#include <Eigen/Geometry>

#include "alcap/parallel.h"

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
  Frames<T> frames{Positions<T>::Zero(mesh.vertices(), 3), Positions<T>::Zero(mesh.vertices(), 3)};
  parallel_for(mesh.vertices(), [&](std::int64_t i) {
    const Index v = static_cast<Index>(i);
    if (!mesh.referenced(v)) return;
    const Row<T> p = V.row(v);
    Row<T> normal = Row<T>::Zero();
    T ring_area = 0;
    mesh.for_each_outgoing(v, [&](Index h) {
      const Row<T> face_normal = (V.row(mesh.tip(h)) - p).cross(V.row(mesh.tail(Mesh::prev(h))) - p);
      normal += face_normal;
      ring_area += face_normal.norm();
    });
    // Rings whose normals cancel (a vertex between two coincident sheets) take the normal of their first face.
    if (!(normal.norm() > T(1e-6) * ring_area)) {
      const Index h = mesh.first(v);
      normal = (V.row(mesh.tip(h)) - p).cross(V.row(mesh.tail(Mesh::prev(h))) - p);
    }
    normal.normalize();
    const Row<T> a = any_orthogonal<T>(normal), b = normal.cross(a);
    Complex<T> axis = 0;
    T total = 0;
    const auto fit = [&](const Row<T>& edge, T direction, T weight) {
      const Complex<T> flat(edge.dot(a), edge.dot(b));
      const T length = std::abs(flat);
      if (length > T(0)) axis += weight * flat / length * std::polar(T(1), -direction);
      total += weight;
    };
    // Every edge weighs half of the angles of its two corners, so dense fans count no more than wide ones.
    mesh.for_each_outgoing(v, [&](Index h) {
      const Index p_h = Mesh::prev(h);
      const Row<T> first = V.row(mesh.tip(h)) - p, second = V.row(mesh.tail(p_h)) - p;
      const T angle = std::atan2(first.cross(second).norm(), first.dot(second)) / 2;
      fit(first, connection.rho_start(mesh, h), angle);
      fit(second, connection.rho_end(mesh, p_h) - pi<T>, angle);
    });
    if (!(std::abs(axis) > T(1e-6) * total)) {  // nothing to prefer: the first edge alone
      axis = 0;
      fit(V.row(mesh.tip(mesh.first(v))) - p, connection.rho_start(mesh, mesh.first(v)), T(1));
      if (axis == Complex<T>(0)) axis = 1;
    }
    axis /= std::abs(axis);
    frames.N.row(v) = normal;
    frames.X.row(v) = axis.real() * a + axis.imag() * b;
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
template Frames<float> face_frames(const Mesh&, const Positions<float>&);
template Frames<double> face_frames(const Mesh&, const Positions<double>&);

}  // namespace alcap
