// SPDX-License-Identifier: MIT
//
// chart.h: the field inside one face, ready for many evaluations, and the way from face to face. Internal
// to streamlines.
//
// Positions and directions in a face are complex numbers in its frame: corner 0 is the origin, halfedge 3 t the first
// axis. A curve runs along v, a unit number with v^n = u / |u|.
#pragma once

#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "alcap/connected_surface.h"
#include "alcap/streamlines.h"
#include "kernels/complex.h"
#include "src/base/array.h"

namespace alcap::detail {

using Cplx = kernels::Cplx<double>;
using Barycentric = std::array<double, 3>;

inline double dot(const Cplx& a, const Cplx& b) { return a.re * b.re + a.im * b.im; }
/// Without the care of hypot() where squares neither overflow nor vanish.
inline double modulus(const Cplx& a) {
  const double square = a.re * a.re + a.im * a.im;
  return square > 1e-280 && square < 1e280 ? std::sqrt(square) : std::hypot(a.re, a.im);
}
/// e^{i x}. Inside a face angles are small, where Taylor's polynomials give all digits in a fraction of the C library's
/// time.
inline Cplx small_unit(double x) {
  const double y = x * x;
  if (y < 4e-4) return {1 + y * (-0.5 + y * (1.0 / 24 - y / 720)), x + x * y * (-1.0 / 6 + y * (1.0 / 120 - y / 5040))};
  if (!(y < 0.0625)) return kernels::unit(x);
  return {1 + y * (-0.5 + y * (1.0 / 24 + y * (-1.0 / 720 + y * (1.0 / 40320 + y * (-1.0 / 3628800 + y / 479001600))))),
          x + x * y * (-1.0 / 6 + y * (1.0 / 120 + y * (-1.0 / 5040 + y * (1.0 / 362880 - y / 39916800))))};
}
inline Cplx power(const Cplx& a, int n) {
  Cplx p{1, 0}, square = a;
  for (int k = n; k > 0; k /= 2) {
    if (k % 2 == 1) p = p * square;
    square = square * square;
  }
  return p;
}

/// The n-th roots of values of a field next to a direction.
class RootNear {
 public:
  RootNear(const Cplx& direction, int n) : direction_(direction), back_(kernels::conj(power(direction, n))), n_(n) {}
  /// The root of u nearest to the direction; false where u is zero, or turned so far that the choice is not safe.
  [[nodiscard]] bool find(const Cplx& u, Cplx& root) const {
    const Cplx z = u * back_;
    if (const double a = z.im / z.re;
        z.re > 0 && a * a < 0.01) {  // nearly always; the arc tangent's series has all digits
      const double y = a * a;
      const double angle =
          a * (1 + y * (-1.0 / 3 + y * (0.2 + y * (-1.0 / 7 + y * (1.0 / 9 + y * (-1.0 / 11 + y * (1.0 / 13)))))));
      root = direction_ * small_unit(angle / n_);
      return true;
    }
    const double size = modulus(z);
    if (!(size > 0) || !(z.re > 0)) return false;
    root = direction_ * turn((1 / size) * z);
    return true;
  }
  /// The same without the safety.
  [[nodiscard]] Cplx nearest(const Cplx& u) const {
    const Cplx z = u * back_;
    return direction_ * kernels::unit(std::atan2(z.im, z.re) / n_);
  }

 private:
  // The n-th root of a unit number on the right side.
  [[nodiscard]] Cplx turn(Cplx z) const {
    int n = n_;
    for (; n % 2 == 0; n /= 2) {
      const double c = std::sqrt((1 + z.re) / 2);
      z = {c, z.im / (2 * c)};
    }
    return n == 1 ? z : kernels::unit(std::atan2(z.im, z.re) / n);
  }

  Cplx direction_, back_;
  int n_;
};

struct FaceChart {
  Index face = none;
  double size = 0;      ///< the longest edge
  Cplx corner[3];       ///< where the corners are
  Cplx grad[3];         ///< gradients of the hat functions
  Cplx value[3];        ///< of the field at the corners
  double turn[3] = {};  ///< n tau of the halfedges

  /// The field (LTGD 2016, Sec. 4.3).
  [[nodiscard]] Cplx at(const Barycentric& b) const {
    Cplx sum{0, 0};
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      sum = sum + b[detail::at(i)] * (value[i] * small_unit(turn[k] * b[detail::at(k)] - turn[i] * b[detail::at(j)]));
    }
    return sum;
  }
  [[nodiscard]] Barycentric moved(const Barycentric& b, const Cplx& w) const {
    return {b[0] + dot(grad[0], w), b[1] + dot(grad[1], w), b[2] + dot(grad[2], w)};
  }
  [[nodiscard]] Cplx position(const Barycentric& b) const {
    return b[0] * corner[0] + b[1] * corner[1] + b[2] * corner[2];
  }
};

/// Coordinates that may be a rounding error outside, back on the face.
[[nodiscard]] inline Barycentric clamped(Barycentric b) {
  for (double& x : b) x = x > 0 ? x : 0.0;
  const double sum = b[0] + b[1] + b[2];
  for (double& x : b) x /= sum;
  return b;
}

/// How a straight way ends.
enum class Straight { there, boundary, lost };

/// A field on its surface, with what tracing needs to know of the whole. Refers to both. Checks its arguments: throws
/// OptionError.
class Flow {
 public:
  Flow(const ConnectedSurface& surface, const Field& field);

  [[nodiscard]] const Mesh& mesh() const { return mesh_; }
  [[nodiscard]] const Geometry& geometry() const { return geometry_; }
  [[nodiscard]] const Connection& connection() const { return connection_; }
  [[nodiscard]] int n() const { return field_.n; }
  [[nodiscard]] double diagonal() const { return diagonal_; }
  [[nodiscard]] double mean_edge() const { return mean_edge_; }
  [[nodiscard]] bool zero_at(Index v) const { return field_.u[v] == 0.0; }

  /// Computes what every chart needs once, for many charts, on meshes of up to 1.5 million faces
  /// (130 MB).
  void keep_charts();

  /// The field in face t; with sign -1 the field whose branches are the opposites of the field's.
  [[nodiscard]] FaceChart chart(Index t, int sign = 1) const;
  /// Multiplies a direction in the face of h, at the fraction s of h: its components in the face of twin(h).
  [[nodiscard]] Cplx across(Index h, double s) const;
  /// Where the field vanishes in face t, if it does.
  [[nodiscard]] const Singularity* zero_in(Index t) const {
    const Index k = zero_of_[detail::at(t)];
    return k == none ? nullptr : &zeros_[detail::at(k)];
  }

  /// Straight on over the surface from p, `length` in the direction of the unit number w in the face of p, unless a
  /// boundary is in the way or there are more than `most` faces. `crossed` receives p, the points on edges, and the
  /// end, each in the face before it; `turned` times a direction at p is that direction at the end, carried by
  /// unfolding.
  [[nodiscard]] Straight straight_on(const SurfacePoint& p, Cplx w, double length, std::int64_t most,
                                     std::vector<SurfacePoint>& crossed, Cplx& turned) const;

  [[nodiscard]] Eigen::RowVector3d position(Index t, const Barycentric& b) const;
  /// A direction of a face in space, of length about 1.
  [[nodiscard]] Eigen::RowVector3d direction(const FaceChart& chart, const Cplx& v) const;
  [[nodiscard]] Eigen::RowVector3d normal(Index t) const;

 private:
  /// The part of a chart that takes sines and cosines, and the normal.
  struct Kept {
    Cplx corner;    ///< the last one
    Cplx value[3];  ///< of the field
    std::array<double, 3> normal;
  };
  [[nodiscard]] Kept kept(Index t) const;

  const Mesh& mesh_;
  const Positions<double>& V_;
  const Geometry& geometry_;
  const Connection& connection_;
  const Field& field_;
  std::vector<Singularity> zeros_;
  std::vector<Index> zero_of_;
  std::vector<Kept> kept_;  ///< none, or one per face
  double diagonal_ = 0, mean_edge_ = 0;
};

}  // namespace alcap::detail
