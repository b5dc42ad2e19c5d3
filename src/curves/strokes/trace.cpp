// SPDX-License-Identifier: MIT
//
// trace.cpp: the walk along a cutting plane.
//
// Each vertex is on one side of the plane; those on it (to rounding) count to one side, the same for all. A face with
// vertices on both sides has then one edge through which the plane enters and one through which it leaves, whatever
// happens at vertices: crossing points may coincide there, but the walk never has to choose, and being a path in which
// each face has one successor and one predecessor it ends at the boundary or returns to its first face.
#include "src/curves/strokes/trace.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "src/base/array.h"
#include "src/base/cancel.h"
#include "src/mesh/position.h"
#include "src/mesh/surface_points.h"

namespace alcap::detail {
namespace {

using Point = Eigen::RowVector3d;

// Distances to the plane, relative to the size of the numbers they come from, that are rounding.
constexpr double on_plane = 1e-13;

Point normal(const Mesh& mesh, const Positions<double>& V, Index t) {
  const Point a = V.row(mesh.F()(t, 0));
  return (Point(V.row(mesh.F()(t, 1))) - a).cross(Point(V.row(mesh.F()(t, 2))) - a).normalized();
}

// The plane through two points that holds the direction `up`.
class Cut {
 public:
  Cut(const Mesh& mesh, const Positions<double>& V, const Point& from, const Point& to, const Point& up,
      bool zero_is_up)
      : mesh_(mesh), V_(V), origin_(from), m_((to - from).cross(up)), zero_is_up_(zero_is_up) {
    rounding_ = on_plane * (from.cwiseAbs().maxCoeff() + to.cwiseAbs().maxCoeff());
    const double size = m_.norm();
    if (size > 1e-9 * (to - from).norm())
      m_ /= size;
    else
      m_.setZero();
  }
  [[nodiscard]] bool exists() const { return !m_.isZero(0); }
  [[nodiscard]] double distance(Index v) const {
    const Point x = Point(V_.row(v)) - origin_;
    const double d = m_.dot(x);
    return std::abs(d) <= rounding_ + on_plane * x.norm() ? 0 : d;
  }
  [[nodiscard]] bool above(Index v) const {
    const double d = distance(v);
    return d > 0 || (zero_is_up_ && d == 0);
  }
  // The halfedge of face t through which a walk with the upper side on its right leaves, or none.
  [[nodiscard]] Index exit(Index t) const {
    for (Index h = 3 * t; h < 3 * t + 3; ++h)
      if (above(mesh_.tail(h)) && !above(mesh_.tip(h))) return h;
    return none;
  }
  // Where the plane crosses halfedge h: the fraction of the way to its tip. Both sides of an edge agree.
  [[nodiscard]] double crossing(Index h) const {
    const Index c = mesh_.halfedge(mesh_.edge(h));
    const double a = distance(mesh_.tail(c)), b = distance(mesh_.tip(c));
    const double s = std::clamp(a / (a - b), 0.0, 1.0);
    return c == h ? s : 1 - s;
  }

 private:
  const Mesh& mesh_;
  const Positions<double>& V_;
  Point origin_, m_;
  bool zero_is_up_;
  double rounding_ = 0;
};

std::optional<std::vector<Step>> walk(const Mesh& mesh, const Cut& cut, const SurfacePoint& start,
                                      const std::vector<SurfacePoint>& ends) {
  std::vector<Step> steps;
  SurfacePoint at = start;
  do {
    check_cancelled();
    for (const SurfacePoint& end : ends)
      if (end.face == at.face) {
        steps.push_back({at.face, at.barycentric, end.barycentric});
        return steps;
      }
    const Index h = cut.exit(at.face);
    if (h == none) return std::nullopt;
    const double s = cut.crossing(h);
    steps.push_back({at.face, at.barycentric, on_halfedge(h, s).barycentric});
    const Index g = mesh.twin(h);
    if (g == none) return std::nullopt;
    at = on_halfedge(g, 1 - s);
  } while (at.face != start.face);
  return std::nullopt;
}

/// The planes to try, in this order: with the mean normal; where it does not lead there (sharp folds, a point on a
/// boundary that vertices of the plane share), the other side for vertices on the plane, then the normals of the two
/// ends.
std::vector<Cut> cuts(const Mesh& mesh, const Positions<double>& V, const TraceEnds& ends) {
  std::vector<Cut> all;
  for (const Point& up : {Point(ends.from_normal + ends.to_normal), ends.from_normal, ends.to_normal})
    for (const bool zero_is_up : {true, false}) {
      const Cut cut(mesh, V, ends.from, ends.to, up, zero_is_up);
      if (cut.exists()) all.push_back(cut);
    }
  return all;
}

}  // namespace

TraceEnds ends_of(const Mesh& mesh, const Positions<double>& V, const SurfacePoint& from, const SurfacePoint& to) {
  return {position(mesh, V, from), position(mesh, V, to), normal(mesh, V, from.face), normal(mesh, V, to.face)};
}

void mark_crossed(const Mesh& mesh, const Positions<double>& V, const TraceEnds& ends, std::vector<char>& marks) {
  for (const Cut& cut : cuts(mesh, V, ends))
    for (Index t = 0; t < mesh.faces(); ++t) {
      check_cancelled_at(t);
      if (cut.exit(t) != none) marks[at(t)] = 1;
    }
}

std::optional<std::vector<Step>> trace(const Mesh& mesh, const Positions<double>& V, const SurfacePoint& from,
                                       const SurfacePoint& to) {
  const std::vector<SurfacePoint> starts = representations(mesh, from), ends = representations(mesh, to);
  for (const SurfacePoint& a : starts)
    for (const SurfacePoint& b : ends)
      if (a.face == b.face) return std::vector<Step>{{a.face, a.barycentric, b.barycentric}};
  const TraceEnds ends_in_space = ends_of(mesh, V, from, to);
  const Point &x = ends_in_space.from, &y = ends_in_space.to;
  for (const Cut& cut : cuts(mesh, V, ends_in_space)) {
    // From a vertex several faces may lead on: the one that leads most towards the goal first.
    std::vector<std::pair<double, const SurfacePoint*>> order;
    for (const SurfacePoint& start : starts) {
      const Index h = cut.exit(start.face);
      if (h == none) continue;
      const Point step = position(mesh, V, on_halfedge(h, cut.crossing(h))) - x;
      order.emplace_back(-step.dot(y - x) / std::max(step.norm(), 1e-12 * (y - x).norm()), &start);
    }
    std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [score, start] : order)
      if (auto steps = walk(mesh, cut, *start, ends)) return steps;
  }
  return std::nullopt;
}

}  // namespace alcap::detail
