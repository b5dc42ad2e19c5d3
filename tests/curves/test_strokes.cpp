// SPDX-License-Identifier: MIT
#include "alcap/strokes.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <set>

#include "alcap/frames.h"
#include "alcap/generators.h"
#include "src/base/random.h"
#include "tests/support/mesh_case.h"
#include "tests/support/mesh_helpers.h"

using namespace alcap;

namespace {

using Row = Eigen::RowVector3d;

struct Case : test::MeshCase {
  using MeshCase::MeshCase;
  Frames frames = face_frames(mesh, surface.V);
  [[nodiscard]] Surface whole() const { return {surface.V, surface.F}; }
  [[nodiscard]] Row at(Index face, const std::array<double, 3>& b) const {
    Row x = Row::Zero();
    for (Index c = 0; c < 3; ++c) x += b[static_cast<std::size_t>(c)] * surface.V.row(mesh.F()(face, c));
    return x;
  }
  [[nodiscard]] SurfacePolyline through(const std::vector<SurfacePoint>& points) const {
    return stroke_through_points(whole(), points);
  }
  [[nodiscard]] SurfacePolyline drawn(const Positions<double>& points) const {
    return stroke_from_space(whole(), points);
  }
};

bool share_edge(const Mesh& mesh, Index s, Index t) {
  for (Index h = 3 * s; h < 3 * s + 3; ++h)
    if (mesh.twin(h) != none && mesh.twin(h) / 3 == t) return true;
  return s == t;
}

bool share_vertex(const Mesh& mesh, Index s, Index t) {
  for (Index c = 0; c < 3; ++c)
    for (Index d = 0; d < 3; ++d)
      if (mesh.F()(s, c) == mesh.F()(t, d)) return true;
  return false;
}

// What every stroke must be: connected in space, in neighbouring faces, with coordinates inside faces, and tangents and
// lengths that are those of the segments in space.
void check_stroke(const Case& s, const SurfacePolyline& line, const Row* start = nullptr, const Row* end = nullptr) {
  REQUIRE(!line.segments.empty());
  const double size = std::sqrt(s.geometry.total_area());
  for (std::size_t k = 0; k < line.segments.size(); ++k) {
    const SurfaceSegment& here = line.segments[k];
    for (const auto* b : {&here.a, &here.b}) {
      CHECK(std::abs((*b)[0] + (*b)[1] + (*b)[2] - 1) < 1e-12);
      for (const double x : *b) CHECK(x >= 0);
    }
    const Row d = s.at(here.face, here.b) - s.at(here.face, here.a);
    CHECK(std::abs(d.norm() - here.length) < 1e-9 * size);
    CHECK(std::abs(std::abs(here.tangent) - 1) < 1e-12);
    CHECK((s.frames.vector(here.face, here.tangent * here.length) - d).norm() < 1e-9 * size);
    if (k + 1 == line.segments.size()) break;
    const SurfaceSegment& next = line.segments[k + 1];
    const Row x = s.at(here.face, here.b);
    CHECK((x - s.at(next.face, next.a)).norm() < 1e-9 * size);
    if (!share_edge(s.mesh, here.face, next.face)) {
      REQUIRE(share_vertex(s.mesh, here.face, next.face));
      CHECK(*std::max_element(here.b.begin(), here.b.end()) > 1 - 1e-9);  // at that vertex
    }
  }
  const SurfaceSegment &first = line.segments.front(), &last = line.segments.back();
  if (start) CHECK((s.at(first.face, first.a) - *start).norm() < 1e-8 * size);
  if (end) CHECK((s.at(last.face, last.b) - *end).norm() < 1e-8 * size);
}

void check_reversed(const SurfacePolyline& line, const SurfacePolyline& backwards) {
  const SurfacePolyline turned = backwards.reversed();
  REQUIRE(turned.segments.size() == line.segments.size());
  for (std::size_t k = 0; k < line.segments.size(); ++k) {
    CHECK(turned.segments[k].face == line.segments[k].face);
    CHECK(turned.segments[k].a == line.segments[k].a);
    CHECK(turned.segments[k].b == line.segments[k].b);
    CHECK(std::abs(turned.segments[k].tangent - line.segments[k].tangent) < 1e-15);
  }
}

SurfacePoint random_point(const Mesh& mesh, detail::Random& random) {
  const double r = std::sqrt(random.uniform()), q = random.uniform();
  return {static_cast<Index>(random.below(mesh.faces())), {1 - r, r * (1 - q), r * q}};
}

// A corner, a point of an edge or of the inside.
SurfacePoint special_point(const Mesh& mesh, detail::Random& random) {
  const Index t = static_cast<Index>(random.below(mesh.faces()));
  switch (random.below(3)) {
    case 0:
      return {t, {0, 1, 0}};
    case 1:
      return {t, {0.25, 0, 0.75}};
    default:
      return {t, {1.0 / 3, 1.0 / 3, 1.0 / 3}};
  }
}

}  // namespace

TEST_CASE(
    "between any two points of spheres, tori and disks: connected, in neighbouring faces, and the same backwards") {
  for (const MeshData& surface :
       {icosphere(2), jittered_sphere(3, 0.2, 4), disk(9), grid(8, 8), bumpy_sphere(3, 0.1, 3)}) {
    const Case s(surface);
    detail::Random random(7);
    for (int k = 0; k < 60; ++k) {
      const bool special = k % 2 == 1;
      const SurfacePoint p = special ? special_point(s.mesh, random) : random_point(s.mesh, random);
      const SurfacePoint q = special ? special_point(s.mesh, random) : random_point(s.mesh, random);
      const Row x = s.at(p.face, p.barycentric), y = s.at(q.face, q.barycentric);
      if ((x - y).norm() < 1e-6 || (x + y).norm() < 0.2) continue;
      CAPTURE(surface.F.rows());
      CAPTURE(k);
      const SurfacePolyline line = s.through({p, q});
      check_stroke(s, line, &x, &y);
      check_reversed(line, s.through({q, p}));
      CHECK(line.length() >= (x - y).norm() * (1 - 1e-12));
      // A flat stroke is the straight one; on a sphere the plane is nearly that of the great circle.
      if (surface.V.col(2).isZero(0)) CHECK(line.length() == doctest::Approx((x - y).norm()));
    }
  }
}

TEST_CASE("short strokes on tori and on a surface of genus 2, through several points") {
  for (const MeshData& surface :
       {torus(40, 20, 1, 0.4), torus_random_diagonals(30, 15, 1, 0.4, 2), genus_surface(2, 4)}) {
    const Case s(surface);
    detail::Random random(9);
    for (int k = 0; k < 40; ++k) {
      // Centers of faces a few steps apart.
      std::vector<SurfacePoint> points;
      Index h = static_cast<Index>(random.below(s.mesh.halfedges()));
      for (int step = 0; step < 30; ++step) {
        if (step % 6 == 0) points.push_back({h / 3, {0.3, 0.3, 0.4}});
        h = s.mesh.twin(step % 2 == 0 ? Mesh::next(h) : Mesh::prev(h));
      }
      const SurfacePolyline line = s.through(points);
      const Row x = s.at(points.front().face, points.front().barycentric);
      const Row y = s.at(points.back().face, points.back().barycentric);
      check_stroke(s, line, &x, &y);
      std::reverse(points.begin(), points.end());
      check_reversed(line, s.through(points));
    }
  }
}

TEST_CASE("lengths: a great circle, a circle around a torus, a straight line across a disk") {
  {
    const Case s(icosphere(5));
    Positions<double> points(61, 3);
    for (int k = 0; k < 61; ++k) {
      const double a = 2 * pi<double> * (k % 60) / 60 + 0.1;
      points.row(k) = Row(std::cos(a), 0.6 * std::sin(a), 0.8 * std::sin(a));
    }
    const SurfacePolyline line = s.drawn(points);
    check_stroke(s, line);
    CHECK(line.closed);
    CHECK(line.length() == doctest::Approx(2 * pi<double>).epsilon(2e-3));
    CHECK(line.reversed().closed);
  }
  {
    const Case s(torus(120, 60, 1, 0.4));
    Positions<double> points(41, 3);
    for (int k = 0; k < 41; ++k) {
      const double a = 2 * pi<double> * k / 40;
      points.row(k) = Row(2 * std::cos(a), 2 * std::sin(a), 0.0);
    }
    const SurfacePolyline line = s.drawn(points);
    check_stroke(s, line);
    CHECK(line.closed);
    CHECK(line.length() == doctest::Approx(2 * pi<double> * 1.4).epsilon(3e-3));
  }
  {
    const Case s(disk(12));
    const Row x(-0.7, -0.1, 5), y(0.6, 0.2, -3);
    Positions<double> points(2, 3);
    points << x, y;
    const SurfacePolyline line = s.drawn(points);
    check_stroke(s, line);
    CHECK(line.length() == doctest::Approx((x - y).head<2>().norm()));
    CHECK(!line.closed);
  }
}

TEST_CASE("straight through vertices and along edges of a grid, inside and on the boundary, turned by any angle") {
  for (const double turn : {0.0, 0.3, 1.0, 2.2}) {
    MeshData surface = grid(6, 6);
    const Eigen::AngleAxisd rotation(turn, Eigen::Vector3d(1, 2, 3).normalized());
    surface.V = surface.V * rotation.toRotationMatrix().transpose();
    surface.V.rowwise() += Row(10, -20, 5);
    const Case s(surface);
    const auto vertex = [](int i, int j) { return j * 7 + i; };
    const auto line_of = [&](Index v, Index w) {
      Positions<double> points(2, 3);
      points << s.surface.V.row(v), s.surface.V.row(w);
      const SurfacePolyline line = s.drawn(points);
      const Row x = s.surface.V.row(v), y = s.surface.V.row(w);
      check_stroke(s, line, &x, &y);
      CHECK(line.length() == doctest::Approx((x - y).norm()));
    };
    line_of(vertex(0, 0), vertex(6, 6));
    line_of(vertex(6, 0), vertex(0, 6));
    line_of(vertex(0, 3), vertex(6, 3));
    for (const auto& [v, w] : {std::pair{vertex(0, 0), vertex(6, 0)},
                               {vertex(6, 0), vertex(6, 6)},
                               {vertex(6, 6), vertex(0, 6)},
                               {vertex(0, 6), vertex(0, 0)}}) {
      line_of(v, w);
      line_of(w, v);
    }
    line_of(vertex(1, 0), vertex(5, 4));
    line_of(vertex(1, 0), vertex(3, 6));
  }
}

TEST_CASE("projection agrees with brute force, near and far") {
  const Case s(bumpy_sphere(2, 0.3, 4));
  const SurfaceLocator locator(s.whole());
  detail::Random random(5);
  for (int k = 0; k < 200; ++k) {
    const double reach = k % 4 == 0 ? 50 : 1.5;
    const Row x(random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-reach, reach));
    const SurfacePoint p = locator.closest(x);
    const double found = (s.at(p.face, p.barycentric) - x).norm();
    // No point of a fine sampling of the surface is nearer, and the truth is not much nearer than the best sample.
    double best = 1e300;
    for (Index t = 0; t < s.mesh.faces(); ++t)
      for (int i = 0; i <= 12; ++i)
        for (int j = 0; i + j <= 12; ++j)
          best = std::min(best, (s.at(t, {i / 12.0, j / 12.0, (12 - i - j) / 12.0}) - x).norm());
    CHECK(found <= best * (1 + 1e-12));
    CHECK(found >= best - 0.05);
  }
  // A vertex, an edge's middle and a face's center are their own closest points.
  for (Index t = 0; t < s.mesh.faces(); t += 7)
    for (const std::array<double, 3>& b : {std::array<double, 3>{0, 1, 0}, {0.5, 0.5, 0}, {0.3, 0.3, 0.4}}) {
      const Row x = s.at(t, b);
      const SurfacePoint p = locator.closest(x);
      CHECK((s.at(p.face, p.barycentric) - x).norm() < 1e-12);
    }
  CHECK_THROWS_AS((void)locator.closest(Row(0, std::nan(""), 0)), OptionError);
  CHECK_THROWS_AS((void)locator.closest(Row(0, 1e200, 0)), OptionError);
}

TEST_CASE("vertex paths follow edges, and the shortest ones between vertices that no edge joins") {
  const Case s(grid(5, 4, 5, 4));
  const auto vertex = [](int i, int j) { return j * 6 + i; };
  const SurfacePolyline line = stroke_along_vertices(s.whole(), {vertex(0, 0), vertex(5, 0), vertex(5, 4)});
  check_stroke(s, line);
  CHECK(line.length() == doctest::Approx(9));
  CHECK(line.segments.size() == 9);
  for (const SurfaceSegment& segment : line.segments) {
    CHECK(*std::max_element(segment.a.begin(), segment.a.end()) == 1);
    CHECK(*std::max_element(segment.b.begin(), segment.b.end()) == 1);
  }
  check_reversed(line, stroke_along_vertices(s.whole(), {vertex(5, 4), vertex(5, 0), vertex(0, 0)}));
  // One diagonal of every quad exists: the way from corner to corner is 4 diagonals and one side, or 9 sides.
  const double forth = stroke_along_vertices(s.whole(), {vertex(0, 0), vertex(5, 4)}).length();
  const double cross = stroke_along_vertices(s.whole(), {vertex(5, 0), vertex(0, 4)}).length();
  CHECK(std::min(forth, cross) == doctest::Approx(4 * std::sqrt(2.0) + 1));
  CHECK(std::max(forth, cross) == doctest::Approx(9));
  CHECK(stroke_along_vertices(s.whole(), {0, 1, vertex(1, 1), vertex(0, 1), 0}).closed);
}

TEST_CASE("strokes that cannot be are refused with a reason") {
  const Case s(test::together(grid(4, 4), disk(3)));
  const auto center = [](Index t) { return SurfacePoint{t, {1.0 / 3, 1.0 / 3, 1.0 / 3}}; };
  const auto message = [&](const std::vector<SurfacePoint>& points) -> std::string {
    try {
      (void)s.through(points);
    } catch (const OptionError& e) {
      return e.what();
    }
    return "";
  };
  CHECK(message({center(0), center(40)}).find("different components") != std::string::npos);
  CHECK(message({center(0)}).find("two different") != std::string::npos);
  CHECK(message({center(0), center(0)}).find("two different") != std::string::npos);
  CHECK(message({center(0), center(1000)}).find("no such face") != std::string::npos);
  CHECK(message({center(0), {1, {0.5, 0.7, -0.2}}}).find("barycentric") != std::string::npos);
  CHECK(message({center(0), {1, {0.5, 0.5, 0.5}}}).find("barycentric") != std::string::npos);
  CHECK(message({center(0), {1, {0.5, std::nan(""), 0.5}}}).find("barycentric") != std::string::npos);
  // The same point in two faces.
  CHECK(message({{0, {1, 0, 0}}, {1, {1, 0, 0}}}).find("two different") != std::string::npos);

  CHECK_THROWS_AS((void)stroke_along_vertices(s.whole(), {0}), OptionError);
  CHECK_THROWS_AS((void)stroke_along_vertices(s.whole(), {0, 0}), OptionError);
  CHECK_THROWS_AS((void)stroke_along_vertices(s.whole(), {0, 30}), OptionError);
  CHECK_THROWS_AS((void)stroke_along_vertices(s.whole(), {0, -1}), OptionError);
  CHECK_THROWS_AS((void)s.drawn(Positions<double>::Constant(2, 3, 0.5)), OptionError);

  // Across a hole: a flat ring.
  MeshData ring = cylinder(24, 3);
  for (Eigen::Index v = 0; v < ring.V.rows(); ++v) {
    const double r = 1 + 0.3 * (ring.V(v, 2) + 1);
    ring.V.row(v) = Row(r * ring.V(v, 0), r * ring.V(v, 1), 0);
  }
  const Case hole(ring);
  Positions<double> points(2, 3);
  points << -1.2, 0.01, 0, 1.2, 0.02, 0;
  CHECK_THROWS_WITH_AS((void)hole.drawn(points), doctest::Contains("leaves the surface"), OptionError);
}
