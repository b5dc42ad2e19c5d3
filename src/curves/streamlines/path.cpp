// SPDX-License-Identifier: MIT
//
// path.cpp: integration inside faces, exits through edges, the walk along edges towards which the field
// points from both sides, and the choice of the face behind a vertex.
#include "src/curves/streamlines/path.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <unordered_map>

#include "src/base/array.h"
#include "src/base/cancel.h"
#include "src/curves/streamlines/step.h"

namespace alcap::detail {
namespace {

// An exit this close to a vertex, as a fraction of the edge, goes through the vertex.
constexpr double at_vertex = 1e-9;
// Steps below this, in mean edges, mean that the direction has no limit here.
constexpr double smallest_step = 1e-10;
// So many crossings without the progress of one smallest step: more than any ring of a vertex needs, because a curve
// that close to a vertex goes through it.
constexpr int patience = 4096;
// A remaining way this short, relative to the step, is made up with the curvature of the step, at the tolerance 1e-6;
// its error is of third order.
constexpr double last_bit = 0.02;

std::size_t mod3(Index c) { return at(c % 3); }

class Tracer {
 public:
  Tracer(const Flow& flow, int sign, const PathLimits& limits, const Guard& guard)
      : flow_(flow), mesh_(flow.mesh()), sign_(sign), limits_(limits), guard_(guard) {
    last_bit_ = last_bit * std::min(1.0, std::cbrt(limits.tolerance / 1e-6));
  }

  Path run(const SurfacePoint& start, const Cplx& v) {
    chart_ = flow_.chart(start.face, sign_);
    b_ = start.barycentric;
    path_.points.push_back({start.face, b_, start.face, b_, 0});
    seed_ = chart_.position(b_);
    trial_ = chart_.size;
    if (const Cplx u = chart_.at(b_); modulus(u) > 0) {
      seed_v_ = v_ = RootNear(v, flow_.n()).nearest(u);
      if (may_stay()) walk();
    } else {
      path_.end = CurveEnd::singularity;
    }
    path_.work = work_;
    return std::move(path_);
  }

 private:
  void walk() {
    double arc = 0;
    int crossings = 0;
    for (bool on = true; on;) {
      const std::optional<Index> opposite = traverse();
      on = opposite && leave(*opposite);
      if (arc_ > arc + smallest_step * flow_.mean_edge()) {
        arc = arc_;
        crossings = 0;
      } else if (++crossings > patience) {
        on = end(CurveEnd::stuck);
      }
    }
  }

  /// Counts a step; false when there have been too many.
  bool may_work() {
    check_cancelled_at(work_);
    return ++work_ <= limits_.work;
  }
  bool end(CurveEnd reason) {
    path_.end = reason;
    return false;
  }
  /// The same, unless the guard does not let the curve come here.
  bool end_if_allowed(CurveEnd reason) {
    const bool allowed = !(limits_.sample_step > 0) || arc_ == 0 || guard_(chart_, b_, v_, arc_);
    return end(allowed ? reason : CurveEnd::separation);
  }
  void record() {
    PathPoint& last = path_.points.back();
    if (arc_ > last.arc + 1e-13 * flow_.mean_edge()) {
      path_.points.push_back({chart_.face, b_, chart_.face, b_, arc_});
    } else {
      last.next_face = chart_.face;
      last.next_b = b_;
    }
  }
  double rate(Index corner) const { return dot(chart_.grad[corner % 3], v_); }

  // ---- inside a face

  /// To the next edge; the corner opposite to it, or nothing when the curve has ended.
  std::optional<Index> traverse() {
    for (;;) {
      if (!may_work()) {
        end(CurveEnd::budget);
        return std::nullopt;
      }
      Index exit = none;
      double ahead = std::numeric_limits<double>::infinity();  // straight on, to the edge
      for (Index c = 0; c < 3; ++c)
        if (rate(c) < 0 && -b_[mod3(c)] / rate(c) < ahead) {
          exit = c;
          ahead = -b_[mod3(c)] / rate(c);
        }
      if (exit == none) {
        end(CurveEnd::stuck);
        return std::nullopt;
      }
      if (ahead <= 1e-14 * chart_.size) return out_of(exit);
      const Barycentric from = b_;
      const Cplx v_from = v_;
      const double h = step(std::min(ahead, longest_step()));
      if (h <= 0) {
        end(h < 0 ? CurveEnd::stuck : CurveEnd::singularity);
        return std::nullopt;
      }
      arc_ += h;
      const std::optional<Index> through = finish(v_from, h);
      if (closes(from, v_from, h)) return std::nullopt;
      if (through) return out_of(*through);
      b_ = clamped(b_);
      record();
      if (!may_stay()) return std::nullopt;
    }
  }

  /// No further than to the next sample, the end, or where a zero would be jumped over.
  double longest_step() const {
    double h = std::min(2 * trial_, chart_.size);
    h = std::min(h, std::max(limits_.length - arc_, smallest_step * flow_.mean_edge()));
    if (limits_.sample_step > 0) h = std::min(h, std::max(next_sample_ - arc_, 1e-3 * limits_.sample_step));
    if (const Singularity* zero = flow_.zero_in(chart_.face))
      h = std::min(h, std::max(distance(*zero) / 2, limits_.zero_radius / 2));
    return h;
  }
  double distance(const Singularity& zero) const {
    return modulus(chart_.position(zero.barycentric) - chart_.position(b_));
  }

  /// One accepted step of at most h: moves b_ and v_, returns its length; 0 at a zero, negative when lost.
  double step(double h) {
    const double least = smallest_step * std::min(flow_.mean_edge(), chart_.size);
    for (; h > least;) {
      const RungeKuttaStep s = runge_kutta_step(chart_, flow_.n(), b_, v_, h);
      if (!s.safe) {
        h /= 3;
        continue;
      }
      // Error per unit of length is of fourth order.
      const double ratio = limits_.tolerance * h / std::max(s.error, 1e-30 * h);
      const double factor = std::clamp(0.9 * std::sqrt(std::sqrt(ratio)), 0.2, 5.0);
      if (ratio < 1) {
        h *= factor;
        continue;
      }
      const Barycentric to = chart_.moved(b_, s.w);
      if (const double shorter = inside(to, s.v, h); shorter < h) {
        if (shorter <= least) return -1;
        h = shorter;
        continue;
      }
      trial_ = h * factor;
      b_ = to;
      v_ = s.v;
      return h;
    }
    return 0;
  }

  /// h, or less when the step overshoots an edge by more than the last bit, or leaves the face and comes back.
  double inside(const Barycentric& to, const Cplx& v, double h) const {
    double shorter = h;
    for (Index c = 0; c < 3; ++c) {
      const double r0 = rate(c), r1 = dot(chart_.grad[c], v), b = to[mod3(c)];
      if (b < 0) {
        if (r1 < 0 && b >= last_bit_ * h * r1) continue;
        shorter = std::min(shorter, r1 < 0 ? std::clamp(h - b / r1, 0.1 * h, 0.97 * h) : 0.5 * h);
      } else if (r0 < 0 && r1 > 0) {
        const double lowest = -r0 * h / (r1 - r0);
        if (b_[mod3(c)] + r0 * lowest / 2 < -1e-12) shorter = std::min(shorter, std::max(lowest, 0.1 * h));
      }
    }
    return shorter;
  }

  /// When the step ended at an edge but for the last bit, goes there: the corner opposite to the edge.
  std::optional<Index> finish(const Cplx& v_from, double h) {
    std::optional<Index> exit;
    double ahead = last_bit_ * h;
    for (Index c = 0; c < 3; ++c)
      if (rate(c) < 0 && -b_[mod3(c)] / rate(c) <= ahead) {
        exit = c;
        ahead = -b_[mod3(c)] / rate(c);
      }
    if (!exit) return exit;
    const double bend = (v_from.re * v_.im - v_from.im * v_.re) / h;
    const Cplx turn = bend * kernels::times_i(v_);
    ahead -= ahead * ahead / 2 * dot(chart_.grad[*exit], turn) / rate(*exit);
    b_ = chart_.moved(b_, ahead * v_ + (ahead * ahead / 2) * turn);
    arc_ += ahead;
    Cplx v;
    if (RootNear(v_, flow_.n()).find(chart_.at(b_), v)) v_ = v;
    return exit;
  }

  Index out_of(Index corner) {
    b_[mod3(corner)] = 0;
    b_ = clamped(b_);
    return corner;
  }

  /// Whether the last step passed the start close enough to end there; then the path ends.
  bool closes(const Barycentric& from, const Cplx& v_from, double h) {
    if (chart_.face != path_.points.front().face || arc_ <= 1.5 * h) return false;
    const auto ahead = [&](const Barycentric& b) { return dot(chart_.position(b) - seed_, seed_v_); };
    const double before = ahead(from), after = ahead(b_);
    if (!(before < 0 && after >= 0) || dot(v_, seed_v_) < 0.9) return false;
    const double rest = arc_ - h;  // the step began here, but for the last bit
    double s = h * -before / (after - before);
    Barycentric b = from;
    for (int k = 0; k < 4; ++k) {
      const RungeKuttaStep last = runge_kutta_step(chart_, flow_.n(), from, v_from, s);
      if (!last.safe) return false;
      b = chart_.moved(from, last.w);
      s -= ahead(b) / dot(last.v, seed_v_);
    }
    const double gap = modulus(chart_.position(b) - seed_);
    const bool loop = gap <= limits_.tolerance * arc_;
    if (!loop && gap > limits_.close_within) return false;
    arc_ = rest + s;
    b_ = clamped(b);
    record();
    end(loop ? CurveEnd::loop : CurveEnd::separation);
    return true;
  }

  /// What ends a curve inside a face.
  bool may_stay() {
    if (const Singularity* zero = flow_.zero_in(chart_.face); zero && distance(*zero) <= limits_.zero_radius)
      return end_if_allowed(CurveEnd::singularity);
    if (arc_ >= limits_.length * (1 - 1e-12)) return end_if_allowed(CurveEnd::length);
    if (limits_.sample_step > 0 && arc_ >= next_sample_ - 1e-3 * limits_.sample_step) {
      if (!guard_(chart_, b_, v_, arc_)) return end(CurveEnd::separation);
      next_sample_ = arc_ + limits_.sample_step;
    }
    return true;
  }

  // ---- from face to face

  /// From the edge opposite to `corner` into the next face; false when the curve has ended.
  bool leave(Index corner) {
    record();
    if (arc_ >= limits_.length * (1 - 1e-12)) return end_if_allowed(CurveEnd::length);
    const Index h = 3 * chart_.face + (corner + 1) % 3;
    const double s = b_[mod3(corner + 2)];
    if (s <= at_vertex) return through_vertex((corner + 1) % 3);
    if (1 - s <= at_vertex) return through_vertex((corner + 2) % 3);
    if (mesh_.twin(h) == none) return end_if_allowed(CurveEnd::boundary);
    if (came_back(h, s)) return end(CurveEnd::loop);
    enter(h, s);
    const Index g = mesh_.twin(h);
    return rate(g + 2) > 0 || slide(g, 1 - s, dot(v_, chart_edge(g)) > 0);
  }

  /// Whether the path crosses halfedge h where and as it did before.
  bool came_back(Index h, double s) {
    if (guard_) return false;  // which knows better
    auto& before = crossings_[h];
    for (const Crossed& c : before)
      if (std::abs(c.s - s) * chart_.size <= limits_.tolerance * (arc_ - c.arc) && dot(c.v, v_) > 0.9) return true;
    before.push_back({s, arc_, v_});
    return false;
  }

  /// Into the face of the twin of h, at the fraction s of h.
  void enter(Index h, double s) {
    const Index g = mesh_.twin(h);
    Cplx v = v_ * flow_.across(h, s);
    chart_ = flow_.chart(Mesh::face(g), sign_);
    b_ = on_halfedge(g, 1 - s).barycentric;
    settle(v);
  }
  /// Makes v_ exactly a branch, and the last point a point of this face too.
  void settle(Cplx v) {
    v = (1 / modulus(v)) * v;
    if (!RootNear(v, flow_.n()).find(chart_.at(b_), v_)) v_ = v;
    path_.points.back().next_face = chart_.face;
    path_.points.back().next_b = b_;
  }

  /// Unit vector along halfedge h of this face.
  Cplx chart_edge(Index h) const {
    const Cplx e = chart_.corner[(h + 1) % 3] - chart_.corner[h % 3];
    return (1 / modulus(e)) * e;
  }

  /// Along halfedge g of this face, from the fraction s on, to its tip or its tail, until the field points away from
  /// the edge on one side (Filippov 1988, the sliding mode of a field that jumps).
  bool slide(Index g, double s, bool to_tip) {
    const Index h = mesh_.twin(g);
    if (h == none) return end(CurveEnd::boundary);
    const double length = flow_.geometry().length(mesh_.edge(g));
    const FaceChart other = flow_.chart(Mesh::face(h), sign_);
    for (double stride = 1.0 / 1024;; stride = std::min(2 * stride, 1.0 / 16)) {
      if (!may_work()) return end(CurveEnd::budget);
      const double to = to_tip ? std::min(s + stride, 1.0) : std::max(s - stride, 0.0);
      arc_ += std::abs(to - s) * length;
      s = to;
      b_ = on_halfedge(g, s).barycentric;
      Cplx v;
      if (!RootNear(v_, flow_.n()).find(chart_.at(b_), v)) return end(CurveEnd::singularity);
      v_ = v;
      record();
      if (!may_stay()) return false;
      if (s >= 1 || s <= 0) return through_vertex(s >= 1 ? (g + 1) % 3 : g % 3);
      if ((dot(v_, chart_edge(g)) > 0) != to_tip) return end(CurveEnd::stuck);
      if (rate(g + 2) >= 0) return true;
      if (dot(other.grad[(h + 2) % 3], v_ * flow_.across(g, s)) >= 0) {
        enter(g, s);
        return true;
      }
    }
  }

  /// Through a corner of this face into the face of that vertex that the curve points into. In the vertex frame the
  /// faces are sectors that may leave gaps (the curve then follows the edge) or overlap.
  bool through_vertex(Index corner) {
    const Index from = 3 * chart_.face + corner, vertex = mesh_.tail(from);
    if (flow_.zero_at(vertex)) return end(CurveEnd::singularity);
    const auto& rho_t = flow_.connection().rho_t;
    const double angle = std::atan2(v_.im, v_.re) + rho_t[from];
    Index best = none;
    double excess = std::numeric_limits<double>::infinity(), best_turn = 0;
    mesh_.for_each_outgoing(vertex, [&](Index h) {
      const double sector = flow_.geometry().angle(h);
      const double turn = wrap(angle - rho_t[h] - flow_.geometry().direction(h) - sector / 2);
      if (const double e = std::abs(turn) - sector / 2; e < excess) {
        best = h;
        excess = e;
        best_turn = turn;
      }
    });
    constexpr double along_edge = 1e-9;  // radians
    if (mesh_.boundary_vertex(vertex) && excess > along_edge) return end_if_allowed(CurveEnd::boundary);
    chart_ = flow_.chart(Mesh::face(best), sign_);
    b_ = on_halfedge(best, 0).barycentric;
    settle(kernels::unit(angle - rho_t[best]));
    if (came_back(-1 - vertex, 0)) return end(CurveEnd::loop);
    if (excess < -along_edge) return true;
    return best_turn < 0 ? slide(best, 0, true) : slide(Mesh::prev(best), 1, false);
  }

  struct Crossed {
    double s, arc;
    Cplx v;
  };

  const Flow& flow_;
  const Mesh& mesh_;
  int sign_;
  PathLimits limits_;
  const Guard& guard_;
  Path path_;
  FaceChart chart_;
  Barycentric b_{};
  Cplx v_{1, 0}, seed_{0, 0}, seed_v_{1, 0};
  double arc_ = 0, next_sample_ = 0, trial_ = 0, last_bit_ = 0;
  std::int64_t work_ = 0;
  std::unordered_map<Index, std::vector<Crossed>> crossings_;
};

}  // namespace

Path trace_path(const Flow& flow, const SurfacePoint& start, const Cplx& v, int sign, const PathLimits& limits,
                const Guard& guard) {
  return Tracer(flow, sign, limits, guard).run(start, v);
}

}  // namespace alcap::detail
