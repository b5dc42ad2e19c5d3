// SPDX-License-Identifier: MIT
//
// streamlines.cpp: curves from given seeds.
#include "alcap/streamlines.h"

#include <algorithm>
#include <string>

#include "src/base/array.h"
#include "src/base/cancel.h"
#include "src/base/numbers.h"
#include "src/base/parallel.h"
#include "src/curves/streamlines/curves.h"

namespace alcap {
namespace detail {

void check(const StreamlineOptions& o) {
  const auto bad = [](const char* field, double value, const char* rule) { throw OptionError(field, value, rule); };
  if (!(o.spacing >= 1e-5 && o.spacing <= 1)) bad("spacing", o.spacing, "must be in [1e-5, 1] box diagonals");
  if (!(o.separation > 0 && o.separation <= 0.9)) bad("separation", o.separation, "must be in (0, 0.9]");
  if (!(o.min_length >= 0 && std::isfinite(o.min_length))) bad("min_length", o.min_length, "must not be negative");
  if (!(o.max_length > 0 && std::isfinite(o.max_length))) bad("max_length", o.max_length, "must be positive");
  if (!(o.tolerance >= 1e-12 && o.tolerance <= 0.1)) bad("tolerance", o.tolerance, "must be in [1e-12, 0.1]");
  if (!(o.singularity_radius >= 1e-6 && o.singularity_radius <= 1))
    bad("singularity_radius", o.singularity_radius, "must be in [1e-6, 1] mean edge lengths");
  if (!(o.drift >= 0 && o.drift <= 45)) bad("drift", o.drift, "must be in [0, 45] degrees");
  if (o.max_curves < 1) throw OptionError("max_curves", o.max_curves, "must be at least 1");
  if (o.max_points < 0)
    throw OptionError("max_points", o.max_points, "must be at least 1, or 0 for a part of the mesh");
}

PathLimits limits(const Flow& flow, const StreamlineOptions& options) {
  return {.length = options.max_length * flow.diagonal(),
          .tolerance = options.tolerance,
          .zero_radius = options.singularity_radius * flow.mean_edge()};
}

CurveBudget::CurveBudget(const Flow& flow, const StreamlineOptions& options, double all_samples, double samples) {
  constexpr std::int64_t most = std::int64_t{1} << 60;
  const double faces = static_cast<double>(flow.mesh().faces()),
               families = flow.n() % 2 == 0 ? flow.n() / 2.0 : flow.n();
  // Errors of steps are of fifth order; at 1e-6 a face takes two or three steps.
  const double finer = std::max(1.0, std::sqrt(std::sqrt(1e-6 / options.tolerance)));
  // Evenly spaced curves cross a face about once a family. A curve crosses some edges on every edge length of its way,
  // and on strips of long faces all of them.
  const double all = finer * (1e5 + 32 * faces * families + 8 * all_samples);
  const double one = finer * (4096 + 4 * faces + 64 * options.max_length * flow.diagonal() / flow.mean_edge());
  // Short of what is left, a path still gets enough to show where it goes; not where the caller has set a bound.
  least_ = options.max_points > 0 ? 1 : to_integer(finer * (4096 + 4 * samples), std::int64_t{1}, most);
  curve_ = to_integer(one + 4 * finer * samples, least_, most);
  left_ =
      options.max_points > 0 ? options.max_points : to_integer(std::min(2e7 + 2 * faces, all), std::int64_t{1}, most);
  // The samples in the way of one grow with the families, so all looks grow with their square: with the usual spacing
  // 1.4 million for a cross field, 700 million at n = 100. Each takes some 20 nanoseconds.
  looks_ = to_integer(std::min(4e8, 20 * all), std::int64_t{1}, most);
}

Curve join(const Path& forward, const Path& backward) {
  Curve out;
  out.end = forward.end;
  out.start = !backward.points.empty() ? backward.end : forward.end == CurveEnd::loop ? CurveEnd::loop : CurveEnd::seed;
  // Every point as the segment before it sees it, the first one as the segment behind it does.
  if (const std::size_t count = backward.points.size(); count > 1) {
    out.points.push_back({backward.points.back().face, backward.points.back().b});
    for (std::size_t k = count - 1; k-- > 0;)
      out.points.push_back({backward.points[k].next_face, backward.points[k].next_b});
  } else {
    out.points.push_back({forward.points.front().next_face, forward.points.front().next_b});
  }
  for (std::size_t k = 1; k < forward.points.size(); ++k)
    out.points.push_back({forward.points[k].face, forward.points[k].b});
  return out;
}

CurveSet collect(const Flow& flow, const std::vector<Curve>& curves) {
  CurveSet set;
  for (const Curve& c : curves) {
    set.offsets.push_back(set.offsets.back() + static_cast<std::int64_t>(c.points.size()));
    set.start_reason.push_back(c.start);
    set.end_reason.push_back(c.end);
  }
  const std::int64_t total = set.offsets.back();
  const auto cut = [](const std::vector<CurveEnd>& ends) {
    return std::find(ends.begin(), ends.end(), CurveEnd::budget) != ends.end();
  };
  set.complete = !cut(set.start_reason) && !cut(set.end_reason);
  set.points.resize(total, 3);
  set.barycentric.resize(total, 3);
  set.faces.resize(detail::at(total));
  parallel_for(
      set.size(),
      [&](std::int64_t k) {
        std::int64_t row = set.offsets[detail::at(k)];
        for (const SurfacePoint& p : curves[detail::at(k)].points) {
          set.points.row(row) = flow.position(p.face, p.barycentric);
          set.barycentric.row(row) << p.barycentric[0], p.barycentric[1], p.barycentric[2];
          set.faces[detail::at(row++)] = p.face;
        }
      },
      16);
  return set;
}

}  // namespace detail

namespace {

SurfacePoint checked(const Mesh& mesh, const SurfacePoint& p, std::size_t k) {
  const std::string field = "seeds[" + std::to_string(k) + "]";
  if (p.face < 0 || p.face >= mesh.faces())
    throw OptionError(field, p.face, "there is no such face; the mesh has " + std::to_string(mesh.faces()));
  double sum = 0;
  for (const double b : p.barycentric) {
    if (!(b >= -1e-6 && b <= 1 + 1e-6))
      throw OptionError(field, b, "barycentric coordinates are not negative and sum to 1");
    sum += b;
  }
  if (!(std::abs(sum - 1) <= 1e-6))
    throw OptionError(field, sum, "barycentric coordinates are not negative and sum to 1");
  return {p.face, detail::clamped(p.barycentric)};
}

}  // namespace

double CurveSet::length(std::int64_t k) const {
  double sum = 0;
  for (std::int64_t i = offsets[detail::at(k)] + 1; i < offsets[detail::at(k) + 1]; ++i)
    sum += (points.row(i) - points.row(i - 1)).norm();
  return sum;
}

std::vector<SurfacePoint> CurveSet::path(std::int64_t k) const {
  if (k < 0 || k >= size()) throw OptionError("k", k, "there is no such curve; there are " + std::to_string(size()));
  std::vector<SurfacePoint> out;
  for (std::int64_t i = offsets[detail::at(k)]; i < offsets[detail::at(k) + 1]; ++i)
    out.push_back({faces[detail::at(i)], {barycentric(i, 0), barycentric(i, 1), barycentric(i, 2)}});
  return out;
}

void CurveSet::append(const CurveSet& other) {
  if (size() > 0 && (spacing != other.spacing || n != other.n)) {
    spacing = 0;
    n = 0;
  }
  const std::int64_t base = offsets.back();
  for (std::int64_t k = 1; k <= other.size(); ++k) offsets.push_back(base + other.offsets[detail::at(k)]);
  const auto below = [](Positions<double>& a, const Positions<double>& b) {
    const Eigen::Index rows = a.rows();
    a.conservativeResize(rows + b.rows(), 3);
    a.bottomRows(b.rows()) = b;
  };
  below(points, other.points);
  below(barycentric, other.barycentric);
  faces.insert(faces.end(), other.faces.begin(), other.faces.end());
  start_reason.insert(start_reason.end(), other.start_reason.begin(), other.start_reason.end());
  end_reason.insert(end_reason.end(), other.end_reason.begin(), other.end_reason.end());
  complete = complete && other.complete;
}

namespace {

detail::Curve trace_seed(const detail::Flow& flow, const SurfacePoint& start, double angle, CurveSides sides,
                         const detail::PathLimits& limits, std::int64_t& work) {
  const detail::FaceChart chart = flow.chart(start.face);
  const detail::Cplx v = detail::RootNear(kernels::unit(angle), flow.n()).nearest(chart.at(start.barycentric));
  const auto trace = [&](int sign) {
    detail::Path path = detail::trace_path(flow, start, sign < 0 ? -v : v, sign, limits);
    work += path.work;
    return path;
  };
  detail::Path forward, backward;
  if (sides != CurveSides::backward) forward = trace(1);
  if (sides != CurveSides::forward && forward.end != CurveEnd::loop) backward = trace(-1);
  if (sides == CurveSides::backward) {
    forward.points = {backward.points.front()};
    forward.end = backward.end == CurveEnd::loop ? CurveEnd::loop : CurveEnd::seed;
  }
  return detail::join(forward, backward);
}

}  // namespace

CurveSet trace_curves(const ConnectedSurface& surface, const Field& field, std::span<const CurveSeed> seeds,
                      const StreamlineOptions& options) {
  detail::check(options);
  return controlled(options.control, [&] {
    detail::report_phase("curves");
    const detail::Flow flow(surface, field);
    const detail::PathLimits limits = detail::limits(flow, options);
    std::vector<SurfacePoint> starts;
    for (std::size_t k = 0; k < seeds.size(); ++k) {
      starts.push_back(checked(surface.mesh(), seeds[k].point, k));
      if (!std::isfinite(seeds[k].angle))
        throw OptionError("seeds[" + std::to_string(k) + "].angle", seeds[k].angle, "must be finite");
    }
    detail::CurveBudget budget(flow, options, detail::usual_work(flow, options) * double(seeds.size()), 0);
    std::vector<detail::Curve> curves(seeds.size());
    std::vector<std::int64_t> work(seeds.size());
    const auto trace = [&](std::size_t k, std::int64_t most) {
      detail::PathLimits within = limits;
      within.work = most;
      curves[k] = trace_seed(flow, starts[k], seeds[k].angle, options.sides, within, work[k]);
    };
    // What a block may cost depends on what the blocks before it have cost, whatever the number of threads.
    constexpr std::size_t block = 32;
    for (std::size_t first = 0; first < seeds.size(); first += block) {
      const std::size_t end = std::min(first + block, seeds.size());
      const std::int64_t most =
          budget.used_up() ? 0 : budget.each_of(2 * detail::count_of(seeds.subspan(first, end - first)));
      parallel_for(
          static_cast<std::int64_t>(end - first), [&](std::int64_t k) { trace(first + detail::at(k), most); }, 1);
      for (std::size_t k = first; k < end; ++k) budget.spend(work[k]);
    }
    return detail::collect(flow, curves);
  });
}

}  // namespace alcap
