// SPDX-License-Identifier: MIT
//
// curve_checks.h: surfaces with fields of known curves, and what every set of curves must satisfy.
#pragma once

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "alcap/connected_surface.h"
#include "alcap/generators.h"
#include "alcap/operators.h"
#include "alcap/streamlines.h"
#include "src/base/random.h"

namespace alcap::test {

using Point = Eigen::RowVector3d;

struct Scene {
  explicit Scene(MeshData s)
      : V(std::move(s.V)),
        mesh(s.F, V.rows()),
        geometry(mesh, V),
        connection(globally_optimal(mesh, geometry)),
        frames(std::make_shared<const Frames>(vertex_frames(mesh, V, connection))) {}

  /// The n-field with this vector at every vertex; its length is taken to the n-th power too.
  template <class At>
  [[nodiscard]] Field field(int n, At&& at) const {
    Positions<double> vectors(V.rows(), 3);
    for (Index v = 0; v < mesh.vertices(); ++v) vectors.row(v) = at(Point(V.row(v)));
    return from_vectors(n, vectors, frames);
  }
  /// The n-field whose n-th power is a function of x + iy, on surfaces in the plane z = 0.
  template <class At>
  [[nodiscard]] Field planar(int n, At&& at) const {
    Field out{.n = n, .u = ComplexVectorX<double>(V.rows()), .frames = frames};
    for (Index v = 0; v < mesh.vertices(); ++v) {
      const double axis = std::atan2(frames->X(v, 1), frames->X(v, 0));
      out.u[v] = at(Complex<double>(V(v, 0), V(v, 1))) * std::polar(1.0, -n * axis);
    }
    return out;
  }
  [[nodiscard]] Field random(int n, std::uint64_t seed) const {
    Field out{.n = n, .u = ComplexVectorX<double>(V.rows()), .frames = frames};
    detail::Random random(seed);
    for (Index v = 0; v < mesh.vertices(); ++v) out.u[v] = {random.uniform() - 0.5, random.uniform() - 0.5};
    return out;
  }
  [[nodiscard]] ConnectedSurface connected() const { return {Surface(V, mesh.F()), connection}; }
  CurveSet even(const Field& f, const StreamlineOptions& o = {}) const { return streamlines(connected(), f, o); }
  CurveSet trace(const Field& f, std::vector<CurveSeed> seeds, const StreamlineOptions& o = {}) const {
    return trace_curves(connected(), f, seeds, o);
  }
  [[nodiscard]] Point corner(Index t, Index c) const { return V.row(mesh.F()(t, c)); }

  Positions<double> V;
  Mesh mesh;
  Geometry geometry;
  Connection connection;
  std::shared_ptr<const Frames> frames;
};

inline constexpr std::array<double, 3> middle{1.0 / 3, 1.0 / 3, 1.0 / 3};

inline std::vector<CurveSeed> seeds_everywhere(const Scene& s, Index every) {
  std::vector<CurveSeed> seeds;
  for (Index t = 0; t < s.mesh.faces(); t += every) {
    const double angle = 0.1 * t;
    seeds.push_back({{t, middle}, angle});
    seeds.push_back({{t, {1, 0, 0}}, angle});        // a vertex
    seeds.push_back({{t, {0.25, 0.75, 0}}, angle});  // an edge
  }
  return seeds;
}

inline std::size_t first(const CurveSet& c, std::int64_t k) {
  return static_cast<std::size_t>(c.offsets[static_cast<std::size_t>(k)]);
}
inline std::int64_t last(const CurveSet& c, std::int64_t k) { return c.offsets[static_cast<std::size_t>(k) + 1] - 1; }

/// What every set of curves must satisfy: finite points, on the surface, segments inside their faces.
inline void check_well_formed(const Scene& s, const CurveSet& c) {
  REQUIRE(c.points.rows() == c.offsets.back());
  REQUIRE(c.faces.size() == static_cast<std::size_t>(c.offsets.back()));
  REQUIRE(c.start_reason.size() == static_cast<std::size_t>(c.size()));
  REQUIRE(c.end_reason.size() == static_cast<std::size_t>(c.size()));
  CHECK(c.points.allFinite());
  const double scale = (s.V.colwise().maxCoeff() - s.V.colwise().minCoeff()).norm();
  bool inside = true, joined = true;
  for (std::int64_t k = 0; k < c.size(); ++k) {
    REQUIRE(c.offsets[static_cast<std::size_t>(k)] < c.offsets[static_cast<std::size_t>(k) + 1]);
    for (std::int64_t i = c.offsets[static_cast<std::size_t>(k)]; i <= last(c, k); ++i) {
      const Index t = c.faces[static_cast<std::size_t>(i)];
      Point x = Point::Zero();
      for (Index j = 0; j < 3; ++j) x += c.barycentric(i, j) * s.corner(t, j);
      inside = inside && c.barycentric.row(i).minCoeff() >= 0 && std::abs(c.barycentric.row(i).sum() - 1) < 1e-12 &&
               (x - Point(c.points.row(i))).norm() <= 1e-12 * scale;
      if (i == c.offsets[static_cast<std::size_t>(k)]) continue;
      // The point before lies in this face too.
      const Point a = s.corner(t, 0), e = s.corner(t, 1) - a, f = s.corner(t, 2) - a, n = e.cross(f);
      const Point y = Point(c.points.row(i - 1)) - a;
      const double area = n.squaredNorm();
      const double b1 = y.cross(f).dot(n) / area, b2 = e.cross(y).dot(n) / area;
      const double off = std::abs(y.dot(n)) / n.norm();
      const double height = std::sqrt(area) / std::max({e.norm(), f.norm(), (e - f).norm()});
      const double slack = 1e-8 * scale / height;  // barycentric, for a distance
      joined = joined && off <= 1e-8 * scale && b1 >= -slack && b2 >= -slack && b1 + b2 <= 1 + slack;
    }
  }
  CHECK(inside);
  CHECK(joined);
}

/// The largest angle between a segment and the branch of the field at its middle, in radians.
inline double off_field(const Scene& s, const ConnectedSurface& surface, const Field& field, const CurveSet& c) {
  double worst = 0;
  for (std::int64_t k = 0; k < c.size(); ++k)
    for (std::int64_t i = c.offsets[static_cast<std::size_t>(k)] + 1; i <= last(c, k); ++i) {
      const Index t = c.faces[static_cast<std::size_t>(i)];
      const Point a = c.points.row(i - 1), b = c.points.row(i);
      if ((b - a).norm() < 1e-4) continue;
      const Point origin = s.corner(t, 0), e = s.corner(t, 1) - origin, g = s.corner(t, 2) - origin, m = e.cross(g);
      const Point y = (a + b) / 2 - origin;
      const double b1 = y.cross(g).dot(m) / m.squaredNorm(), b2 = e.cross(y).dot(m) / m.squaredNorm();
      const auto at = face_field(surface, field.n, field.u, t).at({1 - b1 - b2, b1, b2});
      const Point axis = e.normalized(), other = m.normalized().cross(axis);
      const Complex<double> d((b - a).dot(axis), (b - a).dot(other));
      worst = std::max(worst, std::abs(wrap(field.n * std::arg(d) - std::arg(at.u))) / field.n);
    }
  return worst;
}

/// Least distance between points of different curves of one family, and how far a face's middle is from all curves of
/// some family at most (both in units of the spacing).
struct Spread {
  double least = std::numeric_limits<double>::infinity(), most = 0, mean = 0;
};
inline Spread spread(const Scene& s, const CurveSet& c, double spacing) {
  std::vector<std::int64_t> curve_of(static_cast<std::size_t>(c.points.rows()));
  Positions<double> direction(c.points.rows(), 3);
  for (std::int64_t k = 0; k < c.size(); ++k)
    for (std::int64_t i = c.offsets[static_cast<std::size_t>(k)]; i <= last(c, k); ++i) {
      curve_of[static_cast<std::size_t>(i)] = k;
      const std::int64_t a = std::max(i - 1, c.offsets[static_cast<std::size_t>(k)]), b = std::min(i + 1, last(c, k));
      direction.row(i) = (c.points.row(b) - c.points.row(a)).normalized();
    }
  Spread out;
  for (Eigen::Index i = 0; i < c.points.rows(); ++i)
    for (Eigen::Index j = 0; j < i; ++j)
      if (curve_of[static_cast<std::size_t>(i)] != curve_of[static_cast<std::size_t>(j)] &&
          std::abs(direction.row(i).dot(direction.row(j))) > 0.75)
        out.least = std::min(out.least, (c.points.row(i) - c.points.row(j)).norm() / spacing);
  Index count = 0;
  for (Index t = 0; t < s.mesh.faces(); t += 3, ++count) {
    const Point x = (s.corner(t, 0) + s.corner(t, 1) + s.corner(t, 2)) / 3;
    const double d = std::sqrt((c.points.rowwise() - x).rowwise().squaredNorm().minCoeff()) / spacing;
    out.most = std::max(out.most, d);
    out.mean += d;
  }
  out.mean /= count;
  return out;
}

}  // namespace alcap::test
