// SPDX-License-Identifier: MIT
//
// conventions.h: the scalars, index types, signs and errors that every other header uses.
//
// Orientation   Faces are counter-clockwise. Halfedge h = 3 t + c runs from F(t,c) to F(t,(c+1)%3);
//               the corner at its tail carries the same number.
// Complex       A tangent vector in an orthonormal frame is one complex number; J is multiplication by i.
// Frames        rho_{s->h} is the angle that turns the frame of s into the frame of h:
//               components change by z_h = z_s exp(-i rho_{s->h}).
//                 vertex frame  a gauge per vertex (the first emanating halfedge before optimisation);
//                 edge frame    the unit vector along the edge's canonical halfedge;
//                 face frame    the unit vector along halfedge 3 t.
// Lift          tau, eps and K live on the real line, near zero on decent meshes. An n-field sees every
//               angle times n, multiplied after lifting: its curvature is n K, never wrap(n K).
// n-field       An n-vector field stores u = z^n, z one of its n branches; u transports with n rho.
// div, curl     curl is positive for counter-clockwise circulation.
//
// Source of the mathematics: Liu, Tong, de Goes, Desbrun, "Discrete Connection and Covariant
// Derivative for Vector Field Analysis and Design", ACM Trans. Graph. 35(3), 2016 (LTGD 2016 below).
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "alcap/errors.h"
#include "alcap/index.h"
#include "alcap/version.h"

namespace alcap {

/// "No such element": the twin of a boundary halfedge, the component of an unreferenced vertex.
inline constexpr Index none = -1;

/// A complex number.
template <class T>
using Complex = std::complex<T>;

/// One real per element.
template <class T>
using VectorX = Eigen::Matrix<T, Eigen::Dynamic, 1>;

/// One complex number per element.
template <class T>
using ComplexVectorX = Eigen::Matrix<std::complex<T>, Eigen::Dynamic, 1>;

/// A dense matrix, columns contiguous.
template <class T>
using MatrixX = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

/// #V x 3, one point or vector a row, rows contiguous.
template <class T>
using Positions = Eigen::Matrix<T, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// #F x 3, one counter-clockwise triangle a row, rows contiguous.
using Faces = Eigen::Matrix<Index, Eigen::Dynamic, 3, Eigen::RowMajor>;

template <class T>
inline constexpr T pi = std::numbers::pi_v<T>;  ///< The number pi.

/// The representative of `angle` modulo 2 pi in [-pi, pi] (nearest multiple removed, ties to even).
template <class T>
[[nodiscard]] inline T wrap(T angle) {
  return angle - T(2) * pi<T> * std::nearbyint(angle / (T(2) * pi<T>));
}

}  // namespace alcap
