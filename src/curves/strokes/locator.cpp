// SPDX-License-Identifier: MIT
//
// locator.cpp: closest points by a tree of boxes, split at the median of the longest axis.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "alcap/strokes.h"
#include "alcap/surface.h"
#include "src/base/array.h"
#include "src/base/cancel.h"
#include "src/curves/strokes/closest.h"

namespace alcap {
namespace {

using Point = Eigen::RowVector3d;
constexpr Index leaf_size = 4;
constexpr double farthest = 1e150;  // distances are squared

double squared_distance(const Point& low, const Point& high, const Point& x) {
  return (low - x).cwiseMax(x - high).cwiseMax(0.0).squaredNorm();
}

}  // namespace

std::array<double, 3> detail::closest_in(const std::array<Point, 3>& p, const Point& x, double& squared) {
  std::array<double, 3> best{1, 0, 0};
  squared = std::numeric_limits<double>::infinity();
  const auto offer = [&](const std::array<double, 3>& b) {
    const double d = (b[0] * (p[0] - x) + b[1] * (p[1] - x) + b[2] * (p[2] - x)).squaredNorm();
    if (!(d < squared)) return;
    squared = d;
    best = b;
  };
  const Point e = p[1] - p[0], f = p[2] - p[0], n = e.cross(f);
  const double area = n.squaredNorm();
  if (area > 0) {
    const Point d = x - p[0];
    const double b = d.cross(f).dot(n) / area, c = e.cross(d).dot(n) / area;
    if (b >= 0 && c >= 0 && b + c <= 1) {
      offer({1 - b - c, b, c});
      return best;
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t j = (k + 1) % 3;
    const Point edge = p[j] - p[k];
    const double s = std::clamp((x - p[k]).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    std::array<double, 3> b{};
    b[k] = 1 - s;
    b[j] = s;
    offer(b);
  }
  return best;
}

SurfaceLocator::SurfaceLocator(const Surface& surface) {
  const Mesh& mesh = surface.mesh();
  const Positions<double>& V = surface.positions();
  corners_.resize(detail::at(mesh.faces()));
  for (Index t = 0; t < mesh.faces(); ++t)
    for (Index c = 0; c < 3; ++c) corners_[detail::at(t)][detail::at(c)] = V.row(mesh.F()(t, c));
  order_.resize(corners_.size());
  std::iota(order_.begin(), order_.end(), Index{0});
  boxes_.reserve(corners_.size());
  build(0, mesh.faces());
}

Index SurfaceLocator::build(Index begin, Index end) {
  detail::check_cancelled();
  const Index at = static_cast<Index>(boxes_.size());
  const double infinity = std::numeric_limits<double>::infinity();
  Box box{Point::Constant(infinity), Point::Constant(-infinity), begin, end, none};
  for (Index k = begin; k < end; ++k)
    for (const Point& p : corners_[detail::at(order_[static_cast<std::size_t>(k)])]) {
      box.low = box.low.cwiseMin(p);
      box.high = box.high.cwiseMax(p);
    }
  boxes_.push_back(box);
  if (end - begin <= leaf_size) return at;
  Eigen::Index axis = 0;
  (box.high - box.low).maxCoeff(&axis);
  const Index middle = begin + (end - begin) / 2;
  const auto center = [&](Index t) {
    const auto& p = corners_[detail::at(t)];
    return p[0][axis] + p[1][axis] + p[2][axis];
  };
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, [&](Index s, Index t) {
    const double a = center(s), b = center(t);
    return a != b ? a < b : s < t;
  });
  build(begin, middle);
  boxes_[detail::at(at)].right = build(middle, end);
  return at;
}

SurfacePoint SurfaceLocator::closest(const Eigen::RowVector3d& point) const {
  if (!point.allFinite()) throw OptionError("point", "not finite", "coordinates must be finite");
  if (point.cwiseAbs().maxCoeff() > farthest)
    throw OptionError("point", "too far away", "the square of its distance must not overflow");
  SurfacePoint best;
  double least = std::numeric_limits<double>::infinity();
  std::vector<std::pair<Index, double>> stack{{0, 0.0}};
  while (!stack.empty()) {
    const auto [at, bound] = stack.back();
    stack.pop_back();
    if (bound > least) continue;
    const Box& box = boxes_[detail::at(at)];
    if (box.right == none) {
      for (Index k = box.begin; k < box.end; ++k) {
        const Index t = order_[detail::at(k)];
        double squared = 0;
        const auto b = detail::closest_in(corners_[detail::at(t)], point, squared);
        if (squared < least || (squared == least && t < best.face)) {
          least = squared;
          best = {t, b};
        }
      }
      continue;
    }
    const auto distance = [&](Index b) {
      const Box& child = boxes_[detail::at(b)];
      return std::pair{b, squared_distance(child.low, child.high, point)};
    };
    auto near = distance(at + 1), far = distance(box.right);
    if (far.second < near.second) std::swap(near, far);
    stack.push_back(far);
    stack.push_back(near);
  }
  return best;
}

}  // namespace alcap
