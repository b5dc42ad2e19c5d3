// SPDX-License-Identifier: MIT
//
// Integral curves against fields whose curves are known: circles, straight lines, meridians; and on meshes and fields
// that are as bad as they come.
#include <doctest/doctest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "alcap/field_run.h"
#include "alcap/generators.h"
#include "alcap/operators.h"
#include "alcap/streamlines.h"
#include "src/base/parallel.h"
#include "src/base/random.h"
#include "tests/support/curve_checks.h"

namespace alcap {
namespace {

using namespace test;

TEST_CASE("On a disk the curves of the rotation are circles, closed to rounding") {
  const Scene s(disk(12));
  const Field f = s.planar(1, [](Complex<double> w) { return Complex<double>(0, 1) * w; });
  std::vector<CurveSeed> seeds;
  for (Index t = 10; t < 600; t += 61) seeds.push_back({{t, {0.5, 0.3, 0.2}}, 0.3});
  for (const CurveSides sides : {CurveSides::forward, CurveSides::backward}) {
    const CurveSet c = s.trace(f, seeds, {.max_length = 10, .tolerance = 1e-10, .sides = sides});
    check_well_formed(s, c);
    for (std::int64_t k = 0; k < c.size(); ++k) {
      CHECK((sides == CurveSides::forward ? c.end_reason : c.start_reason)[static_cast<std::size_t>(k)] ==
            CurveEnd::loop);
      const Point x = c.points.row(static_cast<Eigen::Index>(first(c, k)));
      CHECK((Point(c.points.row(last(c, k))) - x).norm() < 1e-8);
      for (std::int64_t i = c.offsets[static_cast<std::size_t>(k)]; i <= last(c, k); ++i)
        CHECK(c.points.row(i).norm() == doctest::Approx(x.norm()).epsilon(1e-8));
      // Counter-clockwise, once around.
      double turn = 0;
      for (std::int64_t i = c.offsets[static_cast<std::size_t>(k)]; i < last(c, k); ++i) {
        const Point a = c.points.row(i), b = c.points.row(i + 1);
        turn += std::atan2(a.cross(b)[2], a.dot(b));
      }
      CHECK(turn == doctest::Approx(2 * pi<double>));
    }
  }
}

TEST_CASE("On the sphere the curves of a rotation close to 1e-6") {
  // The mesh is symmetric about planes that hold the axis, so that its curves are closed too, though no circles.
  for (const int level : {2, 3, 4}) {
    const Scene s(icosphere(level));
    const Field f = s.field(1, [](const Point& x) { return Point(-x[1], x[0], 0); });
    std::vector<CurveSeed> seeds;
    for (Index t = 3; t < s.mesh.faces(); t += 37) seeds.push_back({{t, {0.5, 0.3, 0.2}}, 0.0});
    const CurveSet c = s.trace(f, seeds, {.max_length = 10, .sides = CurveSides::forward});
    check_well_formed(s, c);
    double gap = 0, off = 0;
    for (std::int64_t k = 0; k < c.size(); ++k) {
      CHECK(c.end_reason[static_cast<std::size_t>(k)] == CurveEnd::loop);
      const Point x = c.points.row(static_cast<Eigen::Index>(first(c, k)));
      gap = std::max(gap, (Point(c.points.row(last(c, k))) - x).norm());
      for (std::int64_t i = c.offsets[static_cast<std::size_t>(k)]; i <= last(c, k); ++i)
        off = std::max(off, std::abs(c.points(i, 2) - x[2]));
    }
    CHECK(gap < 1e-6);
    CHECK(off < 0.4 * std::pow(0.25, level));  // the exact curves are parallels
  }
}

TEST_CASE("On the flat torus the curves of parallel fields are straight and close when their slope is rational") {
  const int nu = 8, nv = 6;
  const FlatTorus torus = flat_torus(nu, nv);
  const Mesh mesh(torus.F, torus.vertices);
  VectorX<double> lengths(mesh.edges());
  for (Index h = 0; h < mesh.halfedges(); ++h) lengths[mesh.edge(h)] = torus.lengths(h / 3, h % 3);
  const auto geometry = Geometry::from_lengths(mesh, lengths);
  const auto connection = globally_optimal(mesh, geometry);
  // In the plane, vertex (i,j) at (i / nu, j / nv). Differences are taken modulo 1.
  Positions<double> V(torus.vertices, 3);
  for (int i = 0; i < nu; ++i)
    for (int j = 0; j < nv; ++j) V.row(i * nv + j) << double(i) / nu, double(j) / nv, 0;
  const ConnectedSurface surface(Surface::from_lengths(mesh, lengths, V), connection);
  const auto along = [&](Index h) {
    Point d = V.row(mesh.tip(h)) - V.row(mesh.tail(h));
    for (int c = 0; c < 2; ++c) d[c] -= std::nearbyint(d[c]);
    return d;
  };
  for (const int n : {1, 2, 4})
    for (const double slope : {0.5, 0.0, -3.0, std::sqrt(2.0)}) {
      const double angle = std::atan(slope);
      Field f{.n = n, .u = ComplexVectorX<double>::Zero(torus.vertices), .frames = {}};
      for (Index v = 0; v < mesh.vertices(); ++v) {
        const Index h = mesh.first(v);
        const Point d = along(h);
        f.u[v] = std::polar(1.0, n * (angle - std::atan2(d[1], d[0]) + connection.rho_start(mesh, h)));
      }
      std::vector<CurveSeed> seeds;
      for (Index t = 0; t < mesh.faces(); t += 5) {
        const Point d = along(3 * t);
        seeds.push_back({{t, {0.2, 0.5, 0.3}}, angle - std::atan2(d[1], d[0])});
        seeds.push_back({{t, {0, 1, 0}}, angle - std::atan2(d[1], d[0])});
      }
      const CurveSet c = trace_curves(surface, f, seeds, {.max_length = 4, .sides = CurveSides::forward});
      const bool rational = slope != std::sqrt(2.0);
      const double expected =
          rational ? std::sqrt(1 + slope * slope) * (slope == 0.5 ? 2 : 1) : 4 * V.row(nu * nv - 1).norm();
      for (std::int64_t k = 0; k < c.size(); ++k) {
        CAPTURE(n);
        CAPTURE(slope);
        CAPTURE(k);
        CHECK(c.end_reason[static_cast<std::size_t>(k)] == (rational ? CurveEnd::loop : CurveEnd::length));
        // Where points are in the plane, modulo 1: V is wrong in faces across the seam.
        const auto place = [&](std::int64_t i) {
          const Index t = c.faces[static_cast<std::size_t>(i)];
          return Point(V.row(mesh.tail(3 * t)) + c.barycentric(i, 1) * along(3 * t) +
                       c.barycentric(i, 2) * (along(3 * t) + along(3 * t + 1)));
        };
        double length = 0, bend = 0;
        for (std::int64_t i = c.offsets[static_cast<std::size_t>(k)] + 1; i <= last(c, k); ++i) {
          Point d = place(i) - place(i - 1);
          for (int a = 0; a < 2; ++a) d[a] -= std::nearbyint(d[a]);
          length += d.norm();
          if (d.norm() > 1e-6) bend = std::max(bend, std::abs(std::sin(std::atan2(d[1], d[0]) - angle)));
        }
        CHECK(length == doctest::Approx(expected).epsilon(1e-9));
        CHECK(bend < 1e-9);
      }
    }
}

TEST_CASE("Along the curves of a gradient the potential rises, from one zero to the other") {
  const Scene s(icosphere(3));
  const Field f = s.field(1, [](const Point& x) { return Point(Point(0, 0, 1) - x[2] * x); });
  const CurveSet c = s.trace(f, seeds_everywhere(s, 17));
  check_well_formed(s, c);
  for (std::int64_t k = 0; k < c.size(); ++k) {
    bool rises = true;
    for (std::int64_t i = c.offsets[static_cast<std::size_t>(k)]; i < last(c, k); ++i)
      rises = rises && c.points(i + 1, 2) > c.points(i, 2);
    CHECK(rises);
    CHECK(c.start_reason[static_cast<std::size_t>(k)] == CurveEnd::singularity);
    CHECK(c.end_reason[static_cast<std::size_t>(k)] == CurveEnd::singularity);
    CHECK(c.points(last(c, k), 2) > 0.97);
    CHECK(c.points(c.offsets[static_cast<std::size_t>(k)], 2) < -0.97);
  }
}

TEST_CASE("Back from the end a curve returns to its start") {
  for (const int n : {1, 2, 3, 4, 6}) {
    const FieldRun run = run_field(bumpy_sphere(3, 0.3, 3).V, bumpy_sphere(3, 0.3, 3).F, {.n = n});
    const Scene s(bumpy_sphere(3, 0.3, 3));
    const auto trace = [&](const std::vector<CurveSeed>& seeds, double length, CurveSides sides) {
      return trace_curves(run.surface, run.field, seeds, {.max_length = length, .tolerance = 1e-9, .sides = sides});
    };
    std::vector<CurveSeed> seeds;
    for (Index t = 0; t < run.mesh().faces(); t += 41) seeds.push_back({{t, middle}, 0.7});
    const CurveSet there = trace(seeds, 0.3, CurveSides::forward);
    check_well_formed(s, there);
    const double diagonal = (s.V.colwise().maxCoeff() - s.V.colwise().minCoeff()).norm();
    int tried = 0, returned = 0;
    for (std::int64_t k = 0; k < there.size(); ++k) {
      if (there.end_reason[static_cast<std::size_t>(k)] != CurveEnd::length) continue;
      const std::int64_t i = last(there, k);
      const Index t = there.faces[static_cast<std::size_t>(i)];
      // The direction of arrival in the face's frame.
      const Point axis = (s.corner(t, 1) - s.corner(t, 0)).normalized();
      const Point normal = axis.cross(s.corner(t, 2) - s.corner(t, 0)).normalized();
      const Point d = there.points.row(i) - there.points.row(i - 1);
      const CurveSeed seed{{t, {there.barycentric(i, 0), there.barycentric(i, 1), there.barycentric(i, 2)}},
                           std::atan2(d.dot(normal.cross(axis)), d.dot(axis))};
      const CurveSet back = trace({seed}, 0.3, CurveSides::backward);
      REQUIRE(back.start_reason[0] == CurveEnd::length);
      const Point x = there.points.row(static_cast<Eigen::Index>(first(there, k)));
      returned += (Point(back.points.row(0)) - x).norm() < 1e-6 * diagonal;
      ++tried;
    }
    // Where the field jumps at an edge so that it points there from both sides, curves merge and there is no way back.
    CHECK(tried > 10);
    CHECK(returned >= 0.95 * tried);
  }
}

TEST_CASE("Segments run along a branch of the field that FaceField evaluates") {
  for (const int n : {1, 2, 4, 5}) {
    const MeshData surface = torus(24, 12, 1, 0.4);
    const FieldRun run = run_field(surface.V, surface.F, {.n = n});
    const Scene s(surface);
    const CurveSet c = streamlines(run.surface, run.field, {.spacing = 0.05});
    check_well_formed(s, c);
    REQUIRE(c.size() > 3);
    CHECK(off_field(s, run.surface, run.field, c) < 0.01);
  }
}

TEST_CASE("Evenly spaced curves keep their distance and leave no gaps") {
  for (const int n : {1, 2, 4}) {
    const MeshData surface = bumpy_sphere(3, 0.2, 3);
    const FieldRun run = run_field(surface.V, surface.F, {.n = n});
    const Scene s(surface);
    const double diagonal = (s.V.colwise().maxCoeff() - s.V.colwise().minCoeff()).norm();
    for (const double spacing : {0.05, 0.03}) {
      const CurveSet c = streamlines(run.surface, run.field, {.spacing = spacing});
      check_well_formed(s, c);
      const Spread d = spread(s, c, spacing * diagonal);
      CAPTURE(n);
      CAPTURE(spacing);
      CAPTURE(c.size());
      CHECK(d.least > 0.4);  // separation 0.5 less a tenth
      CHECK(d.mean < 0.4);   // 0.25 when perfectly even and parallel
      CHECK(d.most < 2.5);
      for (std::int64_t k = 0; k < c.size(); ++k) {
        CHECK(c.length(k) > 0.0199 * diagonal);
        CHECK(c.end_reason[static_cast<std::size_t>(k)] != CurveEnd::stuck);
        CHECK(c.start_reason[static_cast<std::size_t>(k)] != CurveEnd::stuck);
      }
    }
  }
}

TEST_CASE("The circles of a rotation come out closed when they are evenly spaced") {
  const Scene s(disk(20));
  const Field f = s.planar(1, [](Complex<double> w) { return Complex<double>(0, 1) * w; });
  const CurveSet c = s.even(f, {.spacing = 0.03});
  check_well_formed(s, c);
  std::int64_t loops = 0;
  for (const CurveEnd end : c.end_reason) loops += end == CurveEnd::loop;
  CHECK(c.size() > 8);
  CHECK(loops >= c.size() - 3);  // next to the rim and the centre they may be cut
}

TEST_CASE("Separatrices are the straight branches of known singularities") {
  const Scene s(disk(10));
  struct Case {
    int n, index;
    std::size_t outward;
  };
  for (const Case& known : {Case{2, -1, 3}, Case{2, 1, 1}, Case{4, 1, 3}, Case{4, -1, 5}, Case{1, -1, 4}, Case{1, 1, 0},
                            Case{3, 1, 4}, Case{3, -1, 8}, Case{6, -1, 7}}) {
    for (const double turned : {0.0, 0.4, 2.0}) {
      // u = e^{i turned} w or its mirror image, w from a point inside a face.
      const Complex<double> centre(0.031, 0.017);
      const Field f = s.planar(known.n, [&](Complex<double> w) {
        return std::polar(1.0, turned) * (known.index > 0 ? w - centre : std::conj(w - centre));
      });
      const auto zeros = find_singularities(s.mesh, s.geometry, s.connection, f);
      REQUIRE(zeros.size() == 1);
      REQUIRE(zeros[0].index == known.index);
      const CurveSet c = separatrices(s.connected(), f, zeros);
      check_well_formed(s, c);
      CAPTURE(known.n);
      CAPTURE(known.index);
      CHECK(static_cast<std::size_t>(c.size()) == known.outward);
      for (std::int64_t k = 0; k < c.size(); ++k) {
        CHECK(c.start_reason[static_cast<std::size_t>(k)] == CurveEnd::singularity);
        CHECK(c.end_reason[static_cast<std::size_t>(k)] == CurveEnd::boundary);
        const auto w = [&](std::int64_t i) { return Complex<double>(c.points(i, 0), c.points(i, 1)) - centre; };
        CHECK(std::abs(w(c.offsets[static_cast<std::size_t>(k)])) < 1e-9);
        // (n - index) phi = turned modulo 2 pi, or modulo pi for odd n: rays, all the way to the rim.
        const double phi = std::arg(w(last(c, k))), period = known.n % 2 == 0 ? 1 : 2;
        CHECK(std::abs(wrap(period * ((known.n - known.index) * phi - turned))) < 1e-4);
        for (std::int64_t i = c.offsets[static_cast<std::size_t>(k)] + 1; i <= last(c, k); ++i)
          CHECK(std::abs(wrap(std::arg(w(i)) - phi)) < 1e-4);
      }
    }
  }
}

TEST_CASE("Curves end, finite and on the surface, on slivers, at vertices and for wild fields") {
  struct Named {
    std::string name;
    MeshData surface;
  };
  MeshData needle = grid(40, 3, 1, 1e-3);
  std::vector<Named> meshes;
  meshes.push_back({"tetrahedron", tetrahedron()});
  meshes.push_back({"cube", cube()});
  meshes.push_back({"one triangle", single_triangle()});
  meshes.push_back({"fan of 500", fan(500)});
  meshes.push_back({"shaft of slivers", cad_like(64, 3)});
  meshes.push_back({"needle", needle});
  meshes.push_back({"scan", noisy_scan(3, 0.3, 7)});
  meshes.push_back({"torus", torus(12, 8, 1, 0.4)});
  for (const Named& m : meshes) {
    const Scene s(m.surface);
    for (const int n : {1, 4, 30}) {
      CAPTURE(m.name);
      CAPTURE(n);
      const Field f = s.random(n, 5);
      const Index every = std::max<Index>(1, s.mesh.faces() / 12);
      const CurveSet c = s.trace(f, seeds_everywhere(s, every), {.max_length = 1});
      check_well_formed(s, c);
      CHECK(c.size() == static_cast<std::int64_t>(seeds_everywhere(s, every).size()));
      for (std::int64_t k = 0; k < c.size(); ++k)
        CHECK(c.length(k) <= 2.001 * (s.V.colwise().maxCoeff() - s.V.colwise().minCoeff()).norm());
      if (n != 4) check_well_formed(s, s.even(f, {.spacing = 0.1}));
      const auto zeros = find_singularities(s.mesh, s.geometry, s.connection, f);
      check_well_formed(s, separatrices(s.connected(), f, zeros, {.max_length = 0.3}));
    }
  }
}

TEST_CASE("Smooth fields on slivers do not get stuck") {
  for (const MeshData& surface : {cad_like(64, 3), noisy_scan(3, 0.3, 7), torus_random_diagonals(20, 12, 1, 0.4, 3)}) {
    for (const int n : {1, 2, 4}) {
      const FieldRun run = run_field(surface.V, surface.F, {.n = n});
      const Scene s(surface);
      const CurveSet c = trace_curves(run.surface, run.field, seeds_everywhere(s, 23));
      check_well_formed(s, c);
      std::int64_t stuck = 0;
      for (const auto* reasons : {&c.start_reason, &c.end_reason})
        stuck += std::count(reasons->begin(), reasons->end(), CurveEnd::stuck);
      CHECK(stuck == 0);
    }
  }
}

/// Two cones of `sides` faces each, base to base.
MeshData bipyramid(Index sides, double height) {
  MeshData m{Positions<double>(sides + 2, 3), Faces(2 * sides, 3)};
  m.V.row(0) << 0, 0, height;
  m.V.row(1) << 0, 0, -height;
  for (Index k = 0; k < sides; ++k) {
    const double angle = 2 * pi<double> * k / sides;
    m.V.row(k + 2) << std::cos(angle), std::sin(angle), 0;
    const Index a = k + 2, b = (k + 1) % sides + 2;
    m.F.row(2 * k) << 0, a, b;
    m.F.row(2 * k + 1) << 1, b, a;
  }
  return m;
}

std::int64_t most_points(const Scene& s) { return 2'000'000 + 100 * std::int64_t{s.mesh.faces()}; }

TEST_CASE("Curves on needles are as many points as the mesh has room for, and say so") {
  bool cut = false;
  for (const Index sides : {3, 20, 100})
    for (const double height : {1e7}) {
      const Scene s(bipyramid(sides, height));
      for (const int n : {1, 2, 4}) {
        CAPTURE(sides);
        CAPTURE(height);
        CAPTURE(n);
        const Field random = s.random(n, 3);
        const Field smooth = smoothest_field(s.connected(), {.n = n}).field;
        for (const Field* f : {&random, &smooth}) {
          const CurveSet even = s.even(*f);
          const CurveSet seeded = s.trace(*f, seeds_everywhere(s, 1));
          const CurveSet leaving = separatrices(s.connected(), *f, find_singularities(s.connected(), *f));
          CHECK(seeded.size() == static_cast<std::int64_t>(seeds_everywhere(s, 1).size()));
          for (const CurveSet* c : {&even, &seeded, &leaving}) {
            CHECK(c->points.allFinite());
            CHECK(c->points.rows() < most_points(s));
            cut = cut || !c->complete;
            for (const auto* reasons : {&c->start_reason, &c->end_reason})
              if (std::find(reasons->begin(), reasons->end(), CurveEnd::budget) != reasons->end()) CHECK(!c->complete);
          }
        }
      }
    }
  CHECK(cut);
}

TEST_CASE("Usual meshes have room for all curves; a smaller bound is kept, by any number of threads") {
  const Scene s(icosphere(3));
  const Field f = smoothest_field(s.connected(), {.n = 4}).field;
  const auto zeros = find_singularities(s.connected(), f);
  CHECK(s.even(f).complete);
  CHECK(s.even(f, {.spacing = 0.003, .tolerance = 1e-10}).complete);
  CHECK(s.trace(f, seeds_everywhere(s, 1), {.max_length = 1}).complete);
  CHECK(separatrices(s.connected(), f, zeros).complete);
  std::vector<std::int64_t> sizes;
  for (const int threads : {1, 3}) {
    CurveSet even, seeded, leaving;
    run_with_threads(threads, [&] {
      even = s.even(f, {.max_points = 20'000});
      seeded = s.trace(f, seeds_everywhere(s, 1), {.max_points = 20'000});
      leaving = separatrices(s.connected(), f, zeros, {.max_points = 1});
    });
    for (const CurveSet* c : {&even, &seeded, &leaving}) {
      CHECK(!c->complete);
      CHECK(c->points.rows() <= (c == &leaving ? 1 : 20'000) + 4 * c->size());
      sizes.push_back(c->points.rows());
    }
    CHECK(seeded.size() == static_cast<std::int64_t>(seeds_everywhere(s, 1).size()));
    check_well_formed(s, even);
    check_well_formed(s, seeded);
    check_well_formed(s, leaving);
  }
  CHECK(std::equal(sizes.begin(), sizes.begin() + 3, sizes.begin() + 3));
}

TEST_CASE("Curves of hundreds of families end when too many of them are in each other's way") {
  const Scene s(icosphere(0));
  const Field f = smoothest_field(s.connected(), {.n = 1000}).field;
  std::vector<CurveSet> sets(2);
  for (std::size_t k = 0; k < 2; ++k) run_with_threads(k == 0 ? 1 : 2, [&] { sets[k] = s.even(f, {.spacing = 0.2}); });
  CHECK(!sets[0].complete);
  check_well_formed(s, sets[0]);
  CHECK(sets[0].points == sets[1].points);
  CHECK(s.even(smoothest_field(s.connected(), {.n = 30}).field, {.spacing = 0.05}).complete);
}

TEST_CASE("A field that vanishes, on a face or everywhere, has curves of one point there") {
  const Scene s(icosphere(1));
  Field f = s.random(2, 3);
  f.u.setZero();
  const CurveSet c = s.trace(f, seeds_everywhere(s, 5));
  check_well_formed(s, c);
  for (std::int64_t k = 0; k < c.size(); ++k) {
    CHECK(first(c, k) == static_cast<std::size_t>(last(c, k)));
    CHECK(c.end_reason[static_cast<std::size_t>(k)] == CurveEnd::singularity);
  }
  CHECK(s.even(f).size() == 0);
  f = s.random(2, 3);
  for (Index k = 0; k < 3; ++k) f.u[s.mesh.F()(0, k)] = 0;
  check_well_formed(s, s.trace(f, seeds_everywhere(s, 1)));
  check_well_formed(s, s.even(f));
}

TEST_CASE("Curves do not depend on the number of threads") {
  const MeshData surface = bumpy_sphere(4, 0.2, 3);
  const FieldRun run = run_field(surface.V, surface.F, {.n = 4});
  const auto all = [&] {
    CurveSet c = streamlines(run.surface, run.field, {.spacing = 0.02});
    Field turned = run.field;
    for (Index v = 0; v < run.mesh().vertices() / 3; ++v) turned.u[v] *= std::polar(1.0, 0.1);
    c = update_streamlines(run.surface, turned, c, {.spacing = 0.02});
    c.append(separatrices(run.surface, run.field, run.singularities));
    return c;
  };
  CurveSet one, four;
  run_with_threads(1, [&] { one = all(); });
  tbb::global_control more(tbb::global_control::max_allowed_parallelism, 4);
  run_with_threads(4, [&] { four = all(); });
  CHECK(one.offsets == four.offsets);
  CHECK(one.points == four.points);
  CHECK(one.barycentric == four.barycentric);
  CHECK(one.faces == four.faces);
  CHECK(one.start_reason == four.start_reason);
  CHECK(one.end_reason == four.end_reason);
}

TEST_CASE("Curves scale with the mesh") {
  MeshData surface = bumpy_sphere(3, 0.2, 3);
  const auto curves = [&](double scale) {
    const Positions<double> V = scale * surface.V;
    const FieldRun run = run_field(V, surface.F, {.n = 2});
    return streamlines(run.surface, run.field, {.spacing = 0.03});
  };
  const CurveSet a = curves(1), b = curves(1024);  // a power of two: exactly the same numbers but for the eigenvector
  CHECK(a.size() == b.size());
  REQUIRE(a.points.rows() == b.points.rows());
  CHECK((1024 * a.points - b.points).cwiseAbs().maxCoeff() < 1e-3 * 1024);
}

TEST_CASE("Bad options and seeds are named") {
  const Scene s(icosphere(1));
  const Field f = s.random(2, 3);
  const auto field_of = [](const auto& call) -> std::string {
    try {
      call();
    } catch (const OptionError& e) {
      return e.field();
    }
    return "nothing thrown";
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(field_of([&] { s.even(f, {.spacing = 0}); }) == "spacing");
  CHECK(field_of([&] { s.even(f, {.spacing = nan}); }) == "spacing");
  CHECK(field_of([&] { s.even(f, {.separation = 1}); }) == "separation");
  CHECK(field_of([&] { s.even(f, {.min_length = -1}); }) == "min_length");
  CHECK(field_of([&] { s.even(f, {.max_length = 0}); }) == "max_length");
  CHECK(field_of([&] { s.even(f, {.tolerance = 0}); }) == "tolerance");
  CHECK(field_of([&] { s.even(f, {.singularity_radius = 0}); }) == "singularity_radius");
  CHECK(field_of([&] { s.even(f, {.drift = -1}); }) == "drift");
  CHECK(field_of([&] { s.even(f, {.drift = nan}); }) == "drift");
  CHECK(field_of([&] { s.even(f, {.max_curves = 0}); }) == "max_curves");
  CHECK(field_of([&] { s.trace(f, {{{80, middle}, 0}}); }) == "seeds[0]");
  CHECK(field_of([&] { s.trace(f, {{{0, middle}, 0}, {{0, {2, -1, 0}}, 0}}); }) == "seeds[1]");
  CHECK(field_of([&] { s.trace(f, {{{0, middle}, nan}}); }) == "seeds[0].angle");
  Field bad = f;
  bad.u[7] = nan;
  CHECK(field_of([&] { s.even(bad); }) == "field.u");
  bad.u.conservativeResize(3);
  CHECK(field_of([&] { s.even(bad); }) == "field.u");
  CHECK(s.even(f, {.spacing = 0.02, .max_curves = 2}).size() == 2);
}

}  // namespace
}  // namespace alcap
