// SPDX-License-Identifier: MIT
//
// separatrices.cpp: the directions in which a field leaves its zeros, found on a small circle around them,
// and the curves that start there.
#include <algorithm>
#include <string>

#include "src/base/array.h"
#include "src/base/cancel.h"
#include "src/base/parallel.h"
#include "src/curves/streamlines/curves.h"

namespace alcap {
namespace detail {
namespace {

// Places on the circle. The field turns |index| times along it and, close to a zero, not much faster anywhere.
constexpr int places = 360;
// The curve starts this far out, in radii within which curves end.
constexpr double start_radius = 1.001;

// The angles phi at which a branch of the field, or the opposite of one for sign -1, points away from the centre:
// n phi = arg u (+ n pi for the opposite), modulo 2 pi.
std::vector<double> outward_angles(const FaceChart& chart, int n, const Singularity& zero, double radius) {
  const auto mismatch = [&](double phi) {
    const Cplx u = chart.at(chart.moved(zero.barycentric, radius * kernels::unit(phi)));
    return wrap(n * phi - std::atan2(u.im, u.re));
  };
  std::vector<double> angles;
  const double step = 2 * pi<double> / places;
  const double first = mismatch(0);
  double before = first;
  for (int k = 0; k < places; ++k) {
    const double after = k + 1 == places ? first : mismatch((k + 1) * step);
    // A change of sign, and not the jump of wrap().
    if ((before < 0) != (after < 0) && std::abs(after - before) < pi<double>) {
      double low = k * step, high = (k + 1) * step;
      for (int halvings = 0; halvings < 50; ++halvings) {
        const double middle = (low + high) / 2;
        ((mismatch(middle) < 0) == (before < 0) ? low : high) = middle;
      }
      angles.push_back((low + high) / 2);
    }
    before = after;
  }
  return angles;
}

Curve leave(const Flow& flow, const Singularity& zero, double radius, double phi, int sign, const PathLimits& limits,
            std::int64_t& work) {
  Curve curve;
  curve.start = CurveEnd::singularity;
  std::vector<SurfacePoint> way;
  Cplx turned{1, 0};
  const SurfacePoint centre{zero.face, zero.barycentric};
  const Straight first = flow.straight_on(centre, kernels::unit(phi), radius, limits.work, way, turned);
  work += count_of(way);
  if (first != Straight::there) {
    curve.points = way;
    curve.end = first == Straight::boundary ? CurveEnd::boundary : CurveEnd::budget;
    return curve;
  }
  PathLimits left = limits;
  left.work -= count_of(way);
  const Path path = trace_path(flow, way.back(), kernels::unit(phi) * turned, sign, left);
  work += path.work;
  curve.points = way;
  for (std::size_t k = 1; k < path.points.size(); ++k) curve.points.push_back({path.points[k].face, path.points[k].b});
  curve.end = path.end;
  return curve;
}

/// What leaves one singularity, and the work of it.
struct Leaving {
  std::vector<Curve> curves;
  std::int64_t work = 0;
};

Leaving leave_all(const Flow& flow, const Singularity& zero, const PathLimits& limits) {
  Leaving out;
  if (!zero.located || zero.index == flow.n()) return out;
  const double radius = start_radius * limits.zero_radius;
  const std::int64_t all = limits.work * (flow.n() + 1);
  PathLimits within = limits;
  for (const int sign : {1, -1}) {
    if (sign < 0 && flow.n() % 2 == 0) break;  // the opposite of a branch is one
    const FaceChart chart = flow.chart(zero.face, sign);
    for (const double phi : outward_angles(chart, flow.n(), zero, radius)) {
      if (out.work >= all) return out;
      within.work = std::min(limits.work, all - out.work);
      out.curves.push_back(leave(flow, zero, radius, phi, sign, within, out.work));
    }
  }
  return out;
}

}  // namespace
}  // namespace detail

CurveSet separatrices(const ConnectedSurface& surface, const Field& field, std::span<const Singularity> singularities,
                      const StreamlineOptions& options) {
  detail::check(options);
  return controlled(options.control, [&] {
    detail::report_phase("curves");
    const detail::Flow flow(surface, field);
    const detail::PathLimits limits = detail::limits(flow, options);
    for (std::size_t k = 0; k < singularities.size(); ++k)
      if (singularities[k].face < 0 || singularities[k].face >= surface.mesh().faces())
        throw OptionError("singularities[" + std::to_string(k) + "]", singularities[k].face, "there is no such face");
    detail::CurveBudget budget(
        flow, options, detail::usual_work(flow, options) * double(field.n + 1) * double(singularities.size()), 0);
    std::vector<detail::Curve> curves;
    // What a block may cost depends on what the blocks before it have cost, whatever the number of threads.
    constexpr std::size_t block = 16;
    for (std::size_t first = 0; first < singularities.size() && !budget.used_up(); first += block) {
      const auto some = singularities.subspan(first, std::min(block, singularities.size() - first));
      std::vector<detail::Leaving> found(some.size());
      detail::PathLimits within = limits;
      within.work = budget.each_of(detail::count_of(some) * (field.n + 1));
      parallel_for(
          detail::count_of(some),
          [&](std::int64_t k) { found[detail::at(k)] = detail::leave_all(flow, some[detail::at(k)], within); }, 1);
      for (detail::Leaving& from : found) {
        budget.spend(from.work);
        for (detail::Curve& curve : from.curves) curves.push_back(std::move(curve));
      }
    }
    CurveSet set = detail::collect(flow, curves);
    set.complete = set.complete && !budget.used_up();
    return set;
  });
}

}  // namespace alcap
