// SPDX-License-Identifier: MIT
//
// reuse.cpp: earlier curves against the field of now. Every segment is compared with the field itself, not with the
// field that it was traced in, so that nothing adds up over many edits.
#include "src/curves/streamlines/reuse.h"

#include <cmath>
#include <string>

#include "src/base/array.h"
#include "src/base/cancel.h"
#include "src/base/parallel.h"

namespace alcap::detail {
namespace {

void check(const Flow& flow, const CurveSet& set) {
  const auto bad = [](const std::string& what, const char* rule) { throw OptionError("earlier", what, rule); };
  const std::int64_t points = set.points.rows();
  if (set.offsets.empty() || set.offsets.front() != 0 || set.offsets.back() != points ||
      set.barycentric.rows() != points || count_of(set.faces) != points || count_of(set.start_reason) != set.size() ||
      count_of(set.end_reason) != set.size())
    bad("sizes", "must be a set of curves as streamlines() makes it");
  for (std::size_t k = 0; k + 1 < set.offsets.size(); ++k)
    if (set.offsets[k + 1] < set.offsets[k]) bad("offsets", "must not decrease");
  for (const Index t : set.faces)
    if (t < 0 || t >= flow.mesh().faces()) bad("face " + std::to_string(t), "must be a face of this mesh");
  if (!set.points.allFinite() || !set.barycentric.allFinite()) bad("points", "must be finite");
}

/// The direction of a segment in the face that it lies in, and whether the field follows it.
class Comparison {
 public:
  Comparison(const Flow& flow, const CurveSet& set, double degrees)
      : flow_(flow), set_(set), within_(std::cos(degrees * pi<double> / 180)) {}

  bool follows(std::int64_t i, Cplx& direction) const {
    const FaceChart chart = flow_.chart(set_.faces[at(i)]);
    const Eigen::RowVector3d way = set_.points.row(i) - set_.points.row(i - 1);
    const Cplx d{way.dot(flow_.direction(chart, {1, 0})), way.dot(flow_.direction(chart, {0, 1}))};
    const double length = modulus(d);
    if (!(length > 1e-12 * chart.size)) return true;
    direction = (1 / length) * d;
    const Barycentric end{set_.barycentric(i, 0), set_.barycentric(i, 1), set_.barycentric(i, 2)};
    const RootNear roots(direction, flow_.n());
    Cplx middle;
    if (!branch(roots, chart, chart.moved(end, -0.5 * d), middle)) return false;
    if (dot(direction, middle) >= within_) return true;
    // The field turns along it, as around a zero: the chord has the mean of the directions (Simpson's rule).
    Cplx a, b;
    if (!branch(roots, chart, chart.moved(end, -1.0 * d), a) || !branch(roots, chart, end, b)) return false;
    const Cplx mean = a + 4.0 * middle + b;
    return dot(direction, mean) >= within_ * modulus(mean) || slides(chart, i, d, middle);
  }

 private:
  /// Whether the segment lies on an edge towards which the field points from both sides, as it does where curves follow
  /// an edge.
  [[nodiscard]] bool slides(const FaceChart& chart, std::int64_t i, const Cplx& d, const Cplx& middle) const {
    const Barycentric end{set_.barycentric(i, 0), set_.barycentric(i, 1), set_.barycentric(i, 2)};
    const Barycentric half = chart.moved(end, -0.5 * d);
    for (Index c = 0; c < 3; ++c) {
      if (end[at(c)] != 0 || std::abs(half[at(c)]) > 1e-9) continue;
      const Index h = 3 * chart.face + (c + 1) % 3, g = flow_.mesh().twin(h);
      if (g == none || dot(middle, d) <= 0 || dot(chart.grad[c], middle) > 0) return false;
      const FaceChart other = flow_.chart(Mesh::face(g));
      const double s = half[at((c + 2) % 3)];
      return dot(other.grad[(g + 2) % 3], middle * flow_.across(h, s)) <= 0;
    }
    return false;
  }
  static bool branch(const RootNear& roots, const FaceChart& chart, const Barycentric& b, Cplx& v) {
    const Cplx u = chart.at(b);
    if (!(modulus(u) > 0)) return false;
    v = roots.nearest(u);
    return true;
  }

  const Flow& flow_;
  const CurveSet& set_;
  double within_;
};

}  // namespace

Reuse still_followed(const Flow& flow, const CurveSet& earlier, double degrees, double shortest) {
  check(flow, earlier);
  const auto points = at(earlier.points.rows());
  Reuse out{{}, std::vector<Cplx>(points), std::vector<char>(points)};
  std::vector<char> follows(points);
  const Comparison comparison(flow, earlier, degrees);
  parallel_for(
      earlier.size(),
      [&](std::int64_t k) {
        Cplx direction{1, 0};
        for (std::int64_t i = earlier.offsets[at(k)] + 1; i < earlier.offsets[at(k) + 1]; ++i) {
          check_cancelled_at(i);
          follows[at(i)] = comparison.follows(i, direction) ? 1 : 0;
          out.directions[at(i)] = direction;
        }
      },
      1);
  for (std::int64_t k = 0; k < earlier.size(); ++k) {
    const std::int64_t begin = earlier.offsets[at(k)], end = earlier.offsets[at(k) + 1];
    for (std::int64_t first = begin; first + 1 < end;) {
      std::int64_t last = first;
      double length = 0;
      for (; last + 1 < end && follows[at(last + 1)] != 0; ++last)
        length += (earlier.points.row(last + 1) - earlier.points.row(last)).norm();
      if (last > first && length >= shortest) {
        out.runs.push_back({at(k), first, last, first > begin, last + 1 < end});
        for (std::int64_t i = first + 1; i <= last; ++i) out.kept[at(i)] = 1;
      }
      first = std::max(last, first + 1);
    }
  }
  return out;
}

}  // namespace alcap::detail
