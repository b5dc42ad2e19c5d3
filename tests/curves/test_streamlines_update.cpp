// SPDX-License-Identifier: MIT
//
// Curves after the field has changed: what still follows it stays, what is left of the room is filled.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "alcap/field_run.h"
#include "alcap/generators.h"
#include "alcap/streamlines.h"
#include "tests/support/curve_checks.h"

namespace alcap {
namespace {

using namespace test;

/// How much of the length of curves is in others, point by point.
double share_in(const CurveSet& some, const CurveSet& all) {
  std::set<std::array<double, 3>> there;
  for (Eigen::Index i = 0; i < all.points.rows(); ++i)
    there.insert({all.points(i, 0), all.points(i, 1), all.points(i, 2)});
  double length = 0, shared = 0;
  for (std::int64_t k = 0; k < some.size(); ++k)
    for (std::int64_t i = some.offsets[static_cast<std::size_t>(k)] + 1; i <= last(some, k); ++i) {
      const double step = (some.points.row(i) - some.points.row(i - 1)).norm();
      length += step;
      if (there.contains({some.points(i, 0), some.points(i, 1), some.points(i, 2)})) shared += step;
    }
  return length > 0 ? shared / length : 0;
}

/// A field and one that is turned by so many degrees where x > 0.6, and smoothly less up to x = 0.2.
std::pair<Field, Field> turned_on_one_side(const Scene& s, const Field& field, double degrees) {
  Field other = field;
  for (Index v = 0; v < s.mesh.vertices(); ++v) {
    const double share = std::clamp((s.V(v, 0) - 0.2) / 0.4, 0.0, 1.0);
    other.u[v] *= std::polar(1.0, field.n * share * share * (3 - 2 * share) * degrees * pi<double> / 180);
  }
  return {field, other};
}

TEST_CASE("After a change somewhere, curves elsewhere stay as they are, and all follow the field at their distance") {
  for (const int n : {1, 2, 4}) {
    const MeshData surface = bumpy_sphere(4, 0.1, 3);
    const FieldRun run = run_field(surface.V, surface.F, {.n = n});
    const Scene s(surface);
    const double spacing = 0.04, diagonal = (s.V.colwise().maxCoeff() - s.V.colwise().minCoeff()).norm();
    const StreamlineOptions options{.spacing = spacing};
    const auto [before, after] = turned_on_one_side(s, run.field, 40);
    const CurveSet old = streamlines(run.surface, before, options);
    // The field of before again: hardly anything is new.
    const CurveSet same = update_streamlines(run.surface, before, old, options);
    check_well_formed(s, same);
    CHECK(share_in(old, same) > 0.97);
    CHECK(share_in(same, old) > 0.97);
    const CurveSet fresh = streamlines(run.surface, after, options),
                   c = update_streamlines(run.surface, after, old, options);
    check_well_formed(s, c);
    CHECK(c.complete);
    CHECK(share_in(old, c) > 0.4);  // a third of the surface lies in x > 0.2
    CHECK(share_in(old, c) > share_in(old, fresh));
    CHECK(off_field(s, run.surface, after, c) < std::max(0.01, off_field(s, run.surface, after, fresh)) + 0.0095);
    const Spread was = spread(s, fresh, spacing * diagonal), is = spread(s, c, spacing * diagonal);
    CHECK(is.least > 0.3);
    CHECK(is.most < was.most + 0.5);
    CHECK(is.mean < 1.15 * was.mean);
    // Turned as a whole, nothing is left to keep; of no drift at all, nothing either.
    Field turned = before;
    turned.u *= std::polar(1.0, n * 0.3);
    CHECK(share_in(old, update_streamlines(run.surface, turned, old, options)) < 0.02);
  }
}

TEST_CASE("Curves far apart are refined: they stay, and others come between them") {
  const MeshData surface = bumpy_sphere(4, 0.1, 3);
  const FieldRun run = run_field(surface.V, surface.F, {.n = 4});
  const Scene s(surface);
  const double diagonal = (s.V.colwise().maxCoeff() - s.V.colwise().minCoeff()).norm();
  const CurveSet coarse = streamlines(run.surface, run.field, {.spacing = 0.12});
  const CurveSet fine = update_streamlines(run.surface, run.field, coarse, {.spacing = 0.04});
  check_well_formed(s, fine);
  CHECK(share_in(coarse, fine) > 0.95);
  CHECK(fine.spacing == 0.04);
  const CurveSet fresh = streamlines(run.surface, run.field, {.spacing = 0.04});
  CHECK(spread(s, fine, 0.04 * diagonal).mean < 1.15 * spread(s, fresh, 0.04 * diagonal).mean);
  // Closer ones are no use: the same as from nothing.
  const CurveSet again = update_streamlines(run.surface, run.field, fresh, {.spacing = 0.12});
  CHECK(again.points == coarse.points);
  // Of lines: one family, where crosses have two.
  const FieldRun lines = run_field(surface.V, surface.F, {.n = 2});
  const CurveSet both = update_streamlines(
      run.surface, run.field, streamlines(lines.surface, lines.field, {.spacing = 0.08}), {.spacing = 0.08});
  check_well_formed(s, both);
  const CurveSet direct = streamlines(run.surface, run.field, {.spacing = 0.08});
  CHECK(spread(s, both, 0.08 * diagonal).mean < 1.15 * spread(s, direct, 0.08 * diagonal).mean);
}

TEST_CASE("Earlier curves that are not of this surface are refused") {
  const Scene s(icosphere(2));
  const Field f = s.random(2, 3);
  CurveSet c = s.even(f, {.spacing = 0.1});
  const auto refused = [&](const CurveSet& earlier) {
    try {
      (void)update_streamlines(s.connected(), f, earlier, {.spacing = 0.1});
    } catch (const OptionError& e) {
      return e.field();
    }
    return std::string("nothing thrown");
  };
  CHECK(refused(c) == "nothing thrown");
  CHECK(refused(CurveSet{}) == "nothing thrown");
  for (const auto& break_it : std::vector<std::function<void(CurveSet&)>>{
           [](CurveSet& b) { b.faces.back() = 320; }, [](CurveSet& b) { b.faces.pop_back(); },
           [](CurveSet& b) { b.offsets[1] = -1; }, [](CurveSet& b) { b.points(3, 1) = std::nan(""); },
           [](CurveSet& b) { b.offsets.clear(); }, [](CurveSet& b) { b.end_reason.clear(); }}) {
    CurveSet broken = c;
    break_it(broken);
    CHECK(refused(broken) == "earlier");
  }
}

}  // namespace
}  // namespace alcap
