// SPDX-License-Identifier: MIT
//
// even.cpp: evenly spaced curves (Jobard and Lefer 1997), on surfaces and in rounds. Seeds lie beside the
// curves that are there, at the distance of the spacing. Every round takes at most one seed from each side of the
// oldest curves, traces all of them in parallel against the curves that are there, and accepts them in order, cut where
// an earlier one of the same round is in the way.
//
// After a change of the field, what still follows it of the earlier curves is there from the start, and goes on where
// it was cut. Room for more is then only where something went.
#include <Eigen/Geometry>
#include <algorithm>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "src/base/array.h"
#include "src/base/cancel.h"
#include "src/base/numbers.h"
#include "src/base/parallel.h"
#include "src/curves/streamlines/curves.h"
#include "src/curves/streamlines/grid.h"
#include "src/curves/streamlines/reuse.h"

namespace alcap::detail {
namespace {

constexpr std::size_t round_size = 64;  // sides that may give a seed in one round: enough for many threads
constexpr std::size_t batch_size = 4;   // curves traced at the same time: more would get into each other's way
constexpr double seed_distance = 0.9;   // of the spacing: straight lines over curved surfaces end closer in space
constexpr double samples_apart = 0.5;   // of the smallest distance allowed
constexpr double plane_error = 0.15;    // of the spacing: seeds on bent surfaces lie so far from the tangent plane
constexpr std::size_t seed_stride = 2;  // samples from one place of seeds to the next along a curve
constexpr double own_past = 3;          // smallest distances: so much of its own past a curve is always close to
constexpr double closing = 0.1;         // of the smallest distance: a curve that passes its start closer is closed
constexpr double same_direction = 0.9;  // cosine
constexpr double shortest_kept = 4;     // spacings: shorter parts of earlier curves would be crumbs
constexpr double around_changes = 2;    // spacings: so close to what went, a curve may have room beside it

/// A point of a curve, where it is on the surface.
struct Station {
  SurfacePoint point;
  Cplx v;
  double arc;
  CurveSample sample;
};

/// One side of a curve: where seeds beside it may be.
struct Side {
  std::shared_ptr<const std::vector<Station>> stations;
  double turn;  // +1 left, -1 right
  std::size_t next = 0;
  std::int64_t work = 0;  // edges crossed on the way to places beside the curve, since last counted
};

struct Seed {
  SurfacePoint point;
  Cplx v;
  CurveSample sample;
};

/// A traced curve before it is accepted.
struct Draft {
  Path forward, backward;
  std::vector<Station> ahead, behind;  // stations of the two halves; the seed is the first one ahead
};

/// What is left of an earlier curve.
struct Kept {
  Path path;
  std::vector<Station> stations;
  SurfacePoint start;  // as the first segment sees it
  Cplx v_start, v_end;
  CurveEnd start_reason, end_reason;  // separation: it may go on
};

class EvenlySpaced {
 public:
  EvenlySpaced(const Flow& flow, const StreamlineOptions& options)
      : flow_(flow),
        options_(options),
        spacing_(options.spacing * flow.diagonal()),
        closest_(options.separation * spacing_),
        families_(flow.n() % 2 == 0 ? flow.n() / 2 : flow.n()),
        same_family_(std::cos(pi<double> / (2 * families_)) - 1e-9),
        limits_(limits(flow, options)),
        budget_(flow, options, samples_of(flow, options),
                2 * options.max_length / (options.spacing * sample_step(options))),
        all_(spacing_),
        round_(spacing_),
        gone_(around_changes * spacing_) {
    limits_.sample_step = sample_step(options) * spacing_;
    limits_.close_within = closing * closest_;
  }

  std::vector<Curve> run(const CurveSet* earlier, bool& complete) {
    if (earlier != nullptr) take_over(*earlier);
    grow();
    trace_all();
    complete = !budget_.used_up() && !looked_enough();
    return std::move(curves_);
  }

 private:
  /// Distance of the samples on curves, in spacings.
  static double sample_step(const StreamlineOptions& options) { return samples_apart * options.separation; }
  /// About as many as evenly spaced curves of all families have.
  static double samples_of(const Flow& flow, const StreamlineOptions& options) {
    const double spacing = options.spacing * flow.diagonal(), families = flow.n() % 2 == 0 ? flow.n() / 2.0 : flow.n();
    return families * flow.geometry().total_area() / (options.separation * spacing * sample_step(options) * spacing);
  }

  void trace_all() {
    // Every so many-th face tries a seed in its middle: often enough to find every gap that a curve fits into.
    const double face_area = flow_.geometry().total_area() / static_cast<double>(flow_.mesh().faces());
    const std::int64_t stride =
        to_integer(0.2 * spacing_ * spacing_ / face_area, std::int64_t{1}, std::int64_t{flow_.mesh().faces()});
    const std::int64_t tries = (flow_.mesh().faces() + stride - 1) / stride * families_;
    constexpr std::int64_t block = 4096;
    for (std::int64_t first = 0; first < tries && !full(); first += block) {
      std::vector<std::optional<Seed>> seeds(at(std::min(block, tries - first)));
      parallel_for(
          static_cast<std::int64_t>(seeds.size()),
          [&](std::int64_t k) {
            const std::int64_t i = first + k;
            const auto t = static_cast<Index>(i / families_ * stride);
            if (may_have_room(flow_.position(t, {1.0 / 3, 1.0 / 3, 1.0 / 3})))
              seeds[at(k)] = middle(t, static_cast<int>(i % families_));
          },
          64);
      for (const std::optional<Seed>& seed : seeds) {
        if (!seed || !free(all_, seed->sample, seed_distance * spacing_)) continue;
        trace_and_accept({*seed});
        grow();
        if (full()) return;
      }
    }
  }

  bool looked_enough() const { return all_.looks() > budget_.looks(); }
  bool full() const { return count_of(curves_) >= options_.max_curves || budget_.used_up() || looked_enough(); }

  // ---- distances

  [[nodiscard]] CurveSample sample(const FaceChart& chart, const Barycentric& b, const Cplx& v, double arc) const {
    return {flow_.position(chart.face, b), flow_.direction(chart, v).stableNormalized(), flow_.normal(chart.face), arc};
  }
  /// Whether two curves with these points belong to one family on one sheet of the surface.
  [[nodiscard]] bool related(const CurveSample& a, const CurveSample& b) const {
    return std::abs(a.direction.dot(b.direction)) >= same_family_ && !(a.normal.dot(b.normal) < 0);
  }
  [[nodiscard]] bool free(const SampleGrid& grid, const CurveSample& here, double radius) const {
    return !grid.any_near(here.x, radius, [&](const CurveSample& s) { return related(here, s); });
  }

  // ---- seeds

  /// The middle of face t along one family, if the field and the other curves allow a seed there.
  [[nodiscard]] std::optional<Seed> middle(Index t, int family) const {
    const FaceChart chart = flow_.chart(t);
    const Barycentric b{1.0 / 3, 1.0 / 3, 1.0 / 3};
    const Cplx u = chart.at(b);
    if (!(modulus(u) > 0)) return std::nullopt;
    const Cplx v = kernels::unit((std::atan2(u.im, u.re) + 2 * pi<double> * family) / flow_.n());
    return checked({t, b}, chart, v);
  }
  [[nodiscard]] std::optional<Seed> checked(const SurfacePoint& p, const FaceChart& chart, const Cplx& v) const {
    Seed seed{p, v, sample(chart, p.barycentric, v, 0)};
    if (!free(all_, seed.sample, seed_distance * spacing_)) return std::nullopt;
    return seed;
  }
  /// Whether a curve passes the place beside a station closely, as seen in the tangent plane: spares the walk there.
  [[nodiscard]] bool surely_taken(const Station& s, double turn) const {
    CurveSample there = s.sample;
    there.x += turn * spacing_ * s.sample.normal.cross(s.sample.direction);
    return !free(all_, there, (seed_distance - plane_error) * spacing_);
  }
  /// The next seed beside a curve; `side.next` is then its station, or past the end.
  [[nodiscard]] std::optional<Seed> beside(Side& side) const {
    for (; side.next < side.stations->size(); side.next += seed_stride) {
      const Station& s = (*side.stations)[side.next];
      if (surely_taken(s, side.turn)) continue;
      std::vector<SurfacePoint> way;
      Cplx turned{1, 0};
      const Straight there =
          flow_.straight_on(s.point, side.turn * kernels::times_i(s.v), spacing_, limits_.work, way, turned);
      side.work += count_of(way);
      if (side.work > limits_.work) {
        side.next = side.stations->size();  // the faces here are so thin that there is no end to it
        return std::nullopt;
      }
      if (there != Straight::there) continue;
      const FaceChart chart = flow_.chart(way.back().face);
      const Cplx u = chart.at(way.back().barycentric);
      if (!(modulus(u) > 0)) continue;
      if (auto seed = checked(way.back(), chart, RootNear(s.v * turned, flow_.n()).nearest(u))) return seed;
    }
    return std::nullopt;
  }

  /// Rounds until no side of a curve has room beside it.
  void grow() {
    while (!sides_.empty() && !full()) {
      const std::size_t count = std::min(round_size, sides_.size());
      limits_.work = budget_.each_of(count_of(sides_));
      std::vector<std::optional<Seed>> found(count);
      parallel_for(
          static_cast<std::int64_t>(count), [&](std::int64_t k) { found[at(k)] = beside(sides_[at(k)]); }, 1);
      // Seeds of one round keep their distance too; the later one waits for the next round.
      std::vector<Seed> seeds;
      SampleGrid taken(spacing_);
      std::deque<Side> left;
      for (std::size_t k = 0; k < count; ++k) {
        budget_.spend(std::exchange(sides_[k].work, 0));
        if (!found[k]) continue;
        left.push_back(sides_[k]);
        if (!free(taken, found[k]->sample, spacing_)) continue;
        taken.insert(found[k]->sample);
        seeds.push_back(*found[k]);
        left.back().next += seed_stride;
      }
      sides_.erase(sides_.begin(), sides_.begin() + static_cast<std::ptrdiff_t>(count));
      sides_.insert(sides_.begin(), left.begin(), left.end());
      trace_and_accept(seeds);
    }
  }

  // ---- curves

  [[nodiscard]] Draft trace(const Seed& seed) const {
    Draft draft;
    SampleGrid own(spacing_);
    const auto half = [&](int sign, std::vector<Station>& stations) {
      bool refused = false;
      const Guard guard = [&](const FaceChart& chart, const Barycentric& b, const Cplx& v, double arc) {
        const CurveSample here = sample(chart, b, v, sign * arc);
        refused = !free(all_, here, closest_) || own.any_near(here.x, closest_, [&](const CurveSample& s) {
          if (std::abs(s.arc - here.arc) < own_past * closest_ || !related(here, s)) return false;
          return !(std::abs(s.arc) <= 2 * closest_ && in_line(here, s, sign));
        });
        if (refused) return false;
        own.insert(here);
        if (sign > 0 || arc > 0) stations.push_back({{chart.face, b}, v, arc, here});
        return true;
      };
      Path path = trace_path(flow_, seed.point, sign < 0 ? -seed.v : seed.v, sign, limits_, guard);
      // What lies behind the last sample has not been compared with other curves.
      if (refused) path.end = CurveEnd::separation;
      if (refused || path.end == CurveEnd::budget) cut(path, stations.empty() ? 0 : stations.back().arc);
      return path;
    };
    draft.forward = half(1, draft.ahead);
    if (draft.forward.end == CurveEnd::loop) return draft;
    draft.backward = half(-1, draft.behind);
    return draft;
  }
  /// Whether the start of the curve is straight ahead, so that the curve may close.
  static bool in_line(const CurveSample& here, const CurveSample& start, int sign) {
    // Directions of the backward half are those of tracing; the start belongs to both halves.
    const double along = here.direction.dot(start.direction) * (sign * start.arc < 0 ? -1 : 1);
    const Eigen::RowVector3d way = start.x - here.x;
    return along > same_direction &&
           (way - way.dot(here.direction) * here.direction).norm() <= 2 * closing * way.norm();
  }

  /// Removes what lies behind the arc length.
  static void cut(Path& path, double arc) {
    while (path.points.size() > 1 && path.points.back().arc > arc * (1 + 1e-12)) path.points.pop_back();
  }
  /// Cuts a half where a curve of this round is in the way.
  void cut_for_round(Path& path, std::vector<Station>& stations) const {
    for (std::size_t k = 0; k < stations.size(); ++k) {
      if (free(round_, stations[k].sample, closest_)) continue;
      cut(path, k == 0 ? 0 : stations[k - 1].arc);
      path.end = CurveEnd::separation;
      stations.resize(k);
      return;
    }
  }

  void trace_and_accept(const std::vector<Seed>& seeds) {
    for (std::size_t first = 0; first < seeds.size() && !full(); first += batch_size)
      trace_batch({seeds.data() + first, std::min(batch_size, seeds.size() - first)});
  }

  void trace_batch(std::span<const Seed> all) {
    std::vector<Seed> seeds;
    for (const Seed& seed : all)
      if (free(all_, seed.sample, seed_distance * spacing_)) seeds.push_back(seed);
    std::vector<Draft> drafts(seeds.size());
    limits_.work = budget_.each_of(2 * count_of(seeds));
    parallel_for(
        static_cast<std::int64_t>(seeds.size()), [&](std::int64_t k) { drafts[at(k)] = trace(seeds[at(k)]); }, 1);
    round_.clear();
    for (const Draft& d : drafts) budget_.spend(d.forward.work + d.backward.work);
    for (std::size_t k = 0; k < drafts.size() && count_of(curves_) < options_.max_curves; ++k) {
      Draft& d = drafts[k];
      if (!free(round_, seeds[k].sample, seed_distance * spacing_)) continue;
      cut_for_round(d.forward, d.ahead);
      cut_for_round(d.backward, d.behind);
      const double length = d.forward.length() + (d.backward.points.empty() ? 0 : d.backward.length());
      if (!(length >= options_.min_length * flow_.diagonal())) continue;
      accept(d);
    }
  }

  void accept(const Draft& d) {
    curves_.push_back(join(d.forward, d.backward));
    auto stations = std::make_shared<std::vector<Station>>(d.behind.rbegin(), d.behind.rend());
    stations->insert(stations->end(), d.ahead.begin(), d.ahead.end());
    for (const Station& s : *stations) {
      all_.insert(s.sample);
      round_.insert(s.sample);
    }
    add_sides(stations);
  }
  void add_sides(const std::shared_ptr<const std::vector<Station>>& stations) {
    for (const double turn : {1.0, -1.0}) sides_.push_back({stations, turn});
  }

  // ---- earlier curves

  /// Where the earlier curves left no room, and all of them are still there, there is none.
  [[nodiscard]] bool may_have_room(const Eigen::RowVector3d& x) const {
    return anywhere_ || gone_.any_near(x, around_changes * spacing_, [](const CurveSample&) { return true; });
  }

  /// Curves further apart than they are to be leave room between them, closer ones are no use.
  void take_over(const CurveSet& earlier) {
    if (!(earlier.spacing >= options_.spacing * (1 - 1e-9))) return;
    anywhere_ = !earlier.complete || earlier.spacing > options_.spacing * (1 + 1e-9) || earlier.n != flow_.n();
    const double shortest = std::max(options_.min_length * flow_.diagonal(), shortest_kept * spacing_);
    const Reuse reuse = still_followed(flow_, earlier, options_.drift, shortest);
    std::vector<Kept> kept(reuse.runs.size());
    parallel_for(
        count_of(kept), [&](std::int64_t k) { kept[at(k)] = kept_run(earlier, reuse, k); }, 1);
    if (!anywhere_) note_gone(earlier, reuse);
    for (const Kept& k : kept) {
      for (const Station& s : k.stations) all_.insert(s.sample);
      budget_.spend(count_of(k.path.points));
    }
    for (std::size_t first = 0; first < kept.size() && !full(); first += batch_size)
      go_on(first, {kept.data() + first, std::min(batch_size, kept.size() - first)});
  }

  /// Samples of a segment of an earlier curve that begins at the arc length `from`; `next` is that of the next one.
  template <class Visit>
  void sample_segment(const CurveSet& earlier, const Cplx& v, std::int64_t i, double from, double length, double& next,
                      Visit&& visit) const {
    if (next > from + length) return;
    const Index t = earlier.faces[at(i)];
    const FaceChart chart = flow_.chart(t);
    const Barycentric end{earlier.barycentric(i, 0), earlier.barycentric(i, 1), earlier.barycentric(i, 2)};
    for (; next <= from + length; next += limits_.sample_step) {
      const Barycentric b = clamped(chart.moved(end, -(from + length - next) * v));
      visit(Station{{t, b}, v, next, sample(chart, b, v, next)});
    }
  }

  void note_gone(const CurveSet& earlier, const Reuse& reuse) {
    for (std::int64_t k = 0; k < earlier.size(); ++k) {
      double arc = 0, next = 0;
      for (std::int64_t i = earlier.offsets[at(k)] + 1; i < earlier.offsets[at(k) + 1]; ++i) {
        const double length = (earlier.points.row(i) - earlier.points.row(i - 1)).norm();
        if (reuse.kept[at(i)] == 0)
          sample_segment(earlier, reuse.directions[at(i)], i, arc, length, next,
                         [&](const Station& s) { gone_.insert(s.sample); });
        arc += length;
        next = std::max(next, arc);
      }
    }
  }

  [[nodiscard]] Kept kept_run(const CurveSet& earlier, const Reuse& reuse, std::int64_t number) const {
    const KeptRun& run = reuse.runs[at(number)];
    const auto point = [&](std::int64_t i) {
      return SurfacePoint{earlier.faces[at(i)],
                          {earlier.barycentric(i, 0), earlier.barycentric(i, 1), earlier.barycentric(i, 2)}};
    };
    Kept out;
    out.start = point(run.first + 1);
    const FaceChart chart = flow_.chart(out.start.face);
    const double step = (earlier.points.row(run.first + 1) - earlier.points.row(run.first)).norm();
    out.start.barycentric = clamped(chart.moved(out.start.barycentric, -step * reuse.directions[at(run.first + 1)]));
    if (earlier.faces[at(run.first)] == out.start.face) out.start = point(run.first);
    out.path.points.push_back({out.start.face, out.start.barycentric, out.start.face, out.start.barycentric, 0});
    double arc = 0, next = 0;
    for (std::int64_t i = run.first + 1; i <= run.last; ++i) {
      const double length = (earlier.points.row(i) - earlier.points.row(i - 1)).norm();
      sample_segment(earlier, reuse.directions[at(i)], i, arc, length, next, [&](Station s) {
        s.sample.curve = number;
        out.stations.push_back(s);
      });
      const SurfacePoint p = point(i);
      out.path.points.push_back({p.face, p.barycentric, p.face, p.barycentric, arc += length});
    }
    out.v_start = reuse.directions[at(run.first + 1)];
    out.v_end = reuse.directions[at(run.last)];
    out.start_reason = run.open_start ? CurveEnd::separation : earlier.start_reason[run.curve];
    out.end_reason = run.open_end ? CurveEnd::separation : earlier.end_reason[run.curve];
    out.path.end = out.end_reason;
    return out;
  }

  /// On from one end of what is left of a curve, as far as it may.
  [[nodiscard]] Path beyond(const Kept& kept, std::int64_t number, int sign, SampleGrid& own,
                            std::vector<Station>& stations) const {
    const double length = kept.path.length();
    bool refused = false;
    const Guard guard = [&](const FaceChart& chart, const Barycentric& b, const Cplx& v, double arc) {
      CurveSample here = sample(chart, b, v, sign > 0 ? length + arc : -arc);
      here.curve = number;
      const auto in_the_way = [&](const CurveSample& s) {
        return related(here, s) && !(s.curve == number && std::abs(s.arc - here.arc) < own_past * closest_);
      };
      refused = all_.any_near(here.x, closest_, in_the_way) || own.any_near(here.x, closest_, in_the_way);
      if (refused) return false;
      own.insert(here);
      if (arc > 0) stations.push_back({{chart.face, b}, v, arc, here});
      return true;
    };
    PathLimits limits = limits_;
    limits.length = std::min(limits.length, 2 * limits.length - length);
    const PathPoint& last = kept.path.points.back();
    const SurfacePoint from = sign > 0 ? SurfacePoint{last.face, last.b} : kept.start;
    Path path;
    if (limits.length > 0) path = trace_path(flow_, from, sign > 0 ? kept.v_end : -kept.v_start, sign, limits, guard);
    if (path.points.empty()) path.points.push_back({from.face, from.barycentric, from.face, from.barycentric, 0});
    if (refused) path.end = CurveEnd::separation;
    if (refused || path.end == CurveEnd::budget) cut(path, stations.empty() ? 0 : stations.back().arc);
    return path;
  }

  /// Lets the ends of a few earlier curves go on, and accepts them.
  void go_on(std::size_t number, std::span<const Kept> all) {
    std::vector<Draft> drafts(all.size());
    limits_.work = budget_.each_of(2 * count_of(all));
    parallel_for(
        count_of(all),
        [&](std::int64_t k) {
          const Kept& kept = all[at(k)];
          Draft& d = drafts[at(k)];
          SampleGrid own(spacing_);
          const auto id = static_cast<std::int64_t>(number) + k;
          if (kept.end_reason == CurveEnd::separation) d.forward = beyond(kept, id, 1, own, d.ahead);
          if (kept.start_reason == CurveEnd::separation) d.backward = beyond(kept, id, -1, own, d.behind);
        },
        1);
    round_.clear();
    for (std::size_t k = 0; k < drafts.size(); ++k) {
      budget_.spend(drafts[k].forward.work + drafts[k].backward.work);
      if (count_of(curves_) < options_.max_curves) accept(all[k], drafts[k]);
    }
  }

  void accept(const Kept& kept, Draft& d) {
    cut_for_round(d.forward, d.ahead);
    cut_for_round(d.backward, d.behind);
    Path whole = kept.path;
    for (std::size_t k = 1; k < d.forward.points.size(); ++k) {
      whole.points.push_back(d.forward.points[k]);
      whole.points.back().arc += kept.path.length();
    }
    Curve curve = join(whole, d.backward);
    curve.start = d.backward.points.empty() ? kept.start_reason : d.backward.end;
    curve.end = d.forward.points.empty() ? kept.end_reason : d.forward.end;
    curves_.push_back(std::move(curve));
    auto stations = std::make_shared<std::vector<Station>>();
    const auto add = [&](const Station& s) {
      if (may_have_room(s.sample.x)) stations->push_back(s);
    };
    for (const std::vector<Station>* part : {&d.behind, &d.ahead})
      for (const Station& s : *part) {
        all_.insert(s.sample);
        round_.insert(s.sample);
      }
    std::for_each(d.behind.rbegin(), d.behind.rend(), add);
    std::for_each(kept.stations.begin(), kept.stations.end(), add);
    std::for_each(d.ahead.begin(), d.ahead.end(), add);
    if (!stations->empty()) add_sides(stations);
  }

  const Flow& flow_;
  const StreamlineOptions& options_;
  double spacing_, closest_;
  int families_;
  double same_family_;
  PathLimits limits_;
  CurveBudget budget_;
  SampleGrid all_, round_;
  SampleGrid gone_;       // samples of what is left out of the earlier curves
  bool anywhere_ = true;  // there may be room where nothing has gone
  std::deque<Side> sides_;
  std::vector<Curve> curves_;
};

}  // namespace
}  // namespace alcap::detail

namespace alcap {

namespace {

CurveSet even_curves(const ConnectedSurface& surface, const Field& field, const CurveSet* earlier,
                     const StreamlineOptions& options) {
  detail::check(options);
  return controlled(options.control, [&] {
    detail::report_phase("curves");
    detail::Flow flow(surface, field);
    flow.keep_charts();
    bool complete = true;
    CurveSet set = detail::collect(flow, detail::EvenlySpaced(flow, options).run(earlier, complete));
    set.complete = set.complete && complete;
    set.spacing = options.spacing;
    set.n = field.n;
    return set;
  });
}

}  // namespace

CurveSet streamlines(const ConnectedSurface& surface, const Field& field, const StreamlineOptions& options) {
  return even_curves(surface, field, nullptr, options);
}

CurveSet update_streamlines(const ConnectedSurface& surface, const Field& field, const CurveSet& earlier,
                            const StreamlineOptions& options) {
  return even_curves(surface, field, &earlier, options);
}

}  // namespace alcap
