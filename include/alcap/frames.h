// SPDX-License-Identifier: MIT
//
// frames.h: how complex numbers become vectors in space. A frame is a unit axis X and a unit normal N; Y = N x X.
// A component z = |z| exp(i a) is the vector |z| (cos(a) X + sin(a) Y).
//
//   auto frames = connected.frames();       // of the vertices; made once, see connected_surface.h
//   Eigen::RowVector3d d = frames->vector(v, std::polar(1.0, angle));
#pragma once

#include <memory>

#include "alcap/connection.h"
#include "alcap/geometry.h"
#include "alcap/mesh.h"

namespace alcap {

/// Unit axes and normals of vertices or of faces.
struct Frames {
  Positions<double> X;  ///< one unit tangent axis per element; zero where the element is not used
  Positions<double> N;  ///< one unit normal per element; zero where the element is not used

  /// The second axis, N x X.
  [[nodiscard]] Eigen::Matrix<double, 1, 3> Y(Index element) const;
  /// The tangent vector with component z in the frame of an element.
  [[nodiscard]] Eigen::Matrix<double, 1, 3> vector(Index element, Complex<double> z) const;
  /// The component of the projection of vector w to the tangent plane of an element.
  [[nodiscard]] Complex<double> component(Index element, const Eigen::Matrix<double, 1, 3>& w) const;
  /// Equal to the last bit.
  [[nodiscard]] bool operator==(const Frames& other) const;
};

/// Frames of the vertices (#V rows). The normal is the area-weighted mean of the incident faces' normals; X is the axis
/// that makes the connection's edge directions rho_{v->e} fit the edges' projections best (least squares over the
/// ring), so turning the gauge of a vertex turns X with it and no vector in space changes.
[[nodiscard]] Frames vertex_frames(const Mesh& mesh, const Positions<double>& V, const Connection& connection);

/// The same, to the last bit, where the geometry of mesh and V is at hand.
[[nodiscard]] Frames vertex_frames(const Mesh& mesh, const Positions<double>& V, const Geometry& geometry,
                                   const Connection& connection);

/// Frames of the faces (#F rows): X along halfedge 3 t, N the face's normal. Throws OptionError on a surface that lies
/// in no space.
[[nodiscard]] Frames face_frames(const Surface& surface);
[[nodiscard]] Frames face_frames(const Mesh& mesh, const Positions<double>& V);

}  // namespace alcap
