// SPDX-License-Identifier: MIT
//
// triangulate.cpp: fan when it is good, ears otherwise.
#include "src/io/mesh/triangulate.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace alcap::detail {
namespace {

using Point = Eigen::Vector2d;

// Twice the signed area over the squared longest side below which a triangle counts as flat: far above the rounding of
// coordinates written with six digits, far below any triangle somebody meant.
constexpr double flat = 1e-5;

// Point-in-triangle tests per corner before we give up; polygons that people draw need far fewer.
constexpr std::size_t tests_per_corner = 20000;

double turn(const Point& a, const Point& b, const Point& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

double shape(const Point& a, const Point& b, const Point& c) {
  const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return longest > 0 ? turn(a, b, c) / longest : 0.0;
}

// The corners in the plane across the area vector, relative to corner 0 and to the polygon's size.
std::vector<Point> project(const Positions<double>& V, std::span<const Index> corners) {
  const Eigen::RowVector3d origin = V.row(corners[0]);
  double size = 0;
  for (const Index v : corners) size = std::max(size, (V.row(v) - origin).cwiseAbs().maxCoeff());
  if (!(size > 0)) size = 1;
  const auto local = [&](std::size_t i) -> Eigen::Vector3d {
    return ((V.row(corners[i]) / size - origin / size)).transpose();
  };
  Eigen::Vector3d area = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) area += local(i).cross(local(i + 1));
  const Eigen::Vector3d normal = area.norm() > 0 ? area.normalized().eval() : Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d x = normal.unitOrthogonal();
  const Eigen::Vector3d y = normal.cross(x);
  std::vector<Point> points(corners.size());
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = {local(i).dot(x), local(i).dot(y)};
  return points;
}

bool fan_is_good(const std::vector<Point>& p) {
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    if (shape(p[0], p[i], p[i + 1]) < flat) return false;
  }
  return true;
}

// Cuts ears off the ring of corners that are left.
class EarCutter {
 public:
  EarCutter(const std::vector<Point>& points, std::vector<Index>& triangles)
      : p_(points), triangles_(triangles), budget_(tests_per_corner * points.size()) {
    for (std::size_t i = 0; i < p_.size(); ++i) ring_.push_back(i);
  }

  /// False when it takes too long.
  bool run() {
    std::size_t at = 0;
    while (ring_.size() > 3) {
      const std::size_t ear = next_ear(at);
      if (budget_ == 0) return false;
      if (ear == ring_.size()) break;  // no simple polygon has no ear
      emit(ear, ear + 1, ear + ring_.size() - 1);
      ring_.erase(ring_.begin() + static_cast<std::ptrdiff_t>(ear));
      at = ear + 1;  // not the neighbour: triangles shall not pile up at one corner
    }
    for (std::size_t i = 1; i + 1 < ring_.size(); ++i) emit(i, i + 1, 0);
    return true;
  }

 private:
  // Ring positions, taken modulo the ring; the triangle starts at the corner before the ear.
  void emit(std::size_t ear, std::size_t next, std::size_t previous) {
    for (const std::size_t i : {previous, ear, next}) triangles_.push_back(static_cast<Index>(ring_[i % ring_.size()]));
  }

  // Convex, and no other corner inside or on it, except at the very position of one of its own corners.
  bool is_ear(std::size_t i, double least_shape) {
    const std::size_t k = ring_.size();
    const Point &a = p_[ring_[(i + k - 1) % k]], &b = p_[ring_[i]], &c = p_[ring_[(i + 1) % k]];
    if (!(shape(a, b, c) > least_shape)) return false;
    budget_ -= std::min(budget_, k);
    return std::ranges::none_of(ring_, [&](std::size_t j) {
      const Point& q = p_[j];
      if (q == a || q == b || q == c) return false;
      return turn(a, b, q) >= 0 && turn(b, c, q) >= 0 && turn(c, a, q) >= 0;
    });
  }

  // The ear nearest to position `at` along the ring, flat ones last; the ring's size when there is none.
  std::size_t next_ear(std::size_t at) {
    const std::size_t k = ring_.size();
    for (const double least_shape : {flat, 0.0}) {
      for (std::size_t step = 0; step < k && budget_ > 0; ++step) {
        const std::size_t i = (at + k + (step % 2 == 1 ? (step + 1) / 2 : k - step / 2)) % k;
        if (is_ear(i, least_shape)) return i;
      }
    }
    return k;
  }

  const std::vector<Point>& p_;
  std::vector<Index>& triangles_;
  std::vector<std::size_t> ring_;
  std::size_t budget_;
};

}  // namespace

bool triangulate(const Positions<double>& V, std::span<const Index> corners, std::vector<Index>& triangles) {
  if (corners.size() == 3) {
    triangles.insert(triangles.end(), {0, 1, 2});
    return true;
  }
  const std::vector<Point> points = project(V, corners);
  if (fan_is_good(points)) {
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
      triangles.insert(triangles.end(), {0, static_cast<Index>(i), static_cast<Index>(i + 1)});
    }
    return true;
  }
  if (points.size() > most_corners) return false;
  const std::size_t before = triangles.size();
  if (EarCutter(points, triangles).run()) return true;
  triangles.resize(before);
  return false;
}

}  // namespace alcap::detail
