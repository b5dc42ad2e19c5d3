// SPDX-License-Identifier: MIT
//
// Points, directions and lines carried to an intrinsic triangulation: in a plane they stay where they are, on any
// surface lines keep their lengths and end at the vertices that they ended at.
#include <doctest/doctest.h>

#include <cmath>

#include "alcap/generators.h"
#include "src/mesh/intrinsic_trace.h"
#include "tests/support/slivers.h"

using namespace alcap;

namespace {

/// Of a surface whose vertices are those of V, in the plane.
Complex<double> place(const Surface& s, const Positions<double>& V, Index t, const std::array<double, 3>& b) {
  Complex<double> x = 0;
  for (Index c = 0; c < 3; ++c) {
    const Index v = s.mesh().F()(t, c);
    x += b[static_cast<std::size_t>(c)] * Complex<double>(V(v, 0), V(v, 1));
  }
  return x;
}

Complex<double> axis(const Surface& s, const Positions<double>& V, Index t) {
  const Complex<double> d = place(s, V, t, {0, 1, 0}) - place(s, V, t, {1, 0, 0});
  return d / std::abs(d);
}

}  // namespace

TEST_CASE("in a plane everything stays where it is") {
  const MeshData mesh = test::with_slivers(grid(9, 7, 3, 2), 5, 1e-5);
  const Surface given(mesh.V, mesh.F);
  const IntrinsicTriangulation now = intrinsic_delaunay(given);
  REQUIRE(now.flips > 0);
  const detail::IntrinsicTrace trace(given, now);
  for (Index t = 0; t < given.mesh().faces(); ++t)
    for (const std::array<double, 3> b :
         {std::array<double, 3>{1.0 / 3, 1.0 / 3, 1.0 / 3}, {0.1, 0.7, 0.2}, {0.5, 0.5, 0}, {0, 0, 1}}) {
      const auto there = trace.point({t, b});
      CHECK(std::abs(place(given, mesh.V, t, b) -
                     place(now.surface, mesh.V, there.point.face, there.point.barycentric)) < 1e-9);
      // The same direction, in both frames.
      const Complex<double> d = axis(given, mesh.V, t) / axis(now.surface, mesh.V, there.point.face);
      CHECK(std::abs(d - std::polar(1.0, there.turn)) < 1e-6);
    }
  const SurfacePolyline line =
      polyline_through(given, {{0, {1, 0, 0}}, {0, {0.2, 0.3, 0.5}}, {0, {0, 0, 1}}, {0, {0, 1, 0}}});
  const SurfacePolyline there = trace.line(line);
  CHECK(there.length() == doctest::Approx(line.length()).epsilon(1e-9));
  Complex<double> end = place(given, mesh.V, line.segments[0].face, line.segments[0].a);
  for (const SurfaceSegment& s : there.segments) {
    CHECK(std::abs(end - place(now.surface, mesh.V, s.face, s.a)) < 1e-8);
    const Complex<double> a = place(now.surface, mesh.V, s.face, s.a);
    end = place(now.surface, mesh.V, s.face, s.b);
    CHECK(std::abs((end - a) / s.length - s.tangent * axis(now.surface, mesh.V, s.face)) < 1e-6);
  }
}

TEST_CASE("edges of a shaft of needles, refined: lines keep their lengths and end where they ended") {
  const MeshData shaft = cad_like(60, 2);
  const Surface given(shaft.V, shaft.F);
  const IntrinsicTriangulation now = intrinsic_delaunay(given, {.min_angle = 20 * pi<double> / 180, .max_radius = 0.5});
  const detail::IntrinsicTrace trace(given, now);
  const Mesh& mesh = given.mesh();
  for (Index e = 0; e < mesh.edges(); e += 3) {
    const Index h = mesh.halfedge(e);
    const SurfacePolyline line = polyline_through(given, {detail::on_halfedge(h, 0), detail::on_halfedge(h, 1)});
    const SurfacePolyline there = trace.line(line);
    CHECK(there.length() == doctest::Approx(given.geometry().length(e)).epsilon(1e-9));
    const auto at_vertex = [&](const SurfaceSegment& s, const std::array<double, 3>& b, Index v) {
      for (std::size_t c = 0; c < 3; ++c)
        if (b[c] > 1 - 1e-7 && now.surface.mesh().F()(s.face, static_cast<Index>(c)) == v) return true;
      return false;
    };
    CHECK(at_vertex(there.segments.front(), there.segments.front().a, mesh.tail(h)));
    CHECK(at_vertex(there.segments.back(), there.segments.back().b, mesh.tip(h)));
  }
}
