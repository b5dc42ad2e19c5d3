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

Curve leave(const Flow& flow, const Singularity& zero, double radius, double phi, int sign, const PathLimits& limits) {
  Curve curve;
  curve.start = CurveEnd::singularity;
  std::vector<SurfacePoint> way;
  Cplx turned{1, 0};
  if (!flow.straight_on({zero.face, zero.barycentric}, kernels::unit(phi), radius, way, turned)) {
    curve.points = way;
    curve.end = CurveEnd::boundary;
    return curve;
  }
  const Path path = trace_path(flow, way.back(), kernels::unit(phi) * turned, sign, limits);
  curve.points = way;
  for (std::size_t k = 1; k < path.points.size(); ++k) curve.points.push_back({path.points[k].face, path.points[k].b});
  curve.end = path.end;
  return curve;
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
    std::vector<std::vector<detail::Curve>> found(singularities.size());
    parallel_for(
        static_cast<std::int64_t>(singularities.size()),
        [&](std::int64_t i) {
          const Singularity& zero = singularities[detail::at(i)];
          if (!zero.located || zero.index == field.n) return;
          const double radius = detail::start_radius * limits.zero_radius;
          for (const int sign : {1, -1}) {
            if (sign < 0 && field.n % 2 == 0) break;  // the opposite of a branch is one
            const detail::FaceChart chart = flow.chart(zero.face, sign);
            for (const double phi : detail::outward_angles(chart, field.n, zero, radius))
              found[detail::at(i)].push_back(detail::leave(flow, zero, radius, phi, sign, limits));
          }
        },
        1);
    std::vector<detail::Curve> curves;
    for (auto& from : found)
      for (auto& curve : from) curves.push_back(std::move(curve));
    return detail::collect(flow, curves);
  });
}

}  // namespace alcap
