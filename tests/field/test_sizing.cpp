// SPDX-License-Identifier: MIT
//
// test_sizing.cpp: target edge lengths against what geometry says on spheres, cylinders and boxes, and their
// invariances.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "alcap/generators.h"
#include "alcap/sizing.h"
#include "tests/support/parts.h"
#include "tests/support/surfaces.h"

namespace {

using namespace alcap;
using namespace alcap::test;

constexpr SizingOptions free_growth = {.smallest = 1e-9, .largest = 1, .growth = 1e9};

double diagonal(const Surface& s) { return (s.V().colwise().maxCoeff() - s.V().colwise().minCoeff()).norm(); }

// Of a circle of radius r: half a chord, by Pythagoras.
double chord_of(double r, double error) { return 2 * std::sqrt(r * r - (r - error) * (r - error)); }

VectorX<double> sizes(const Surface& s, const SizingOptions& options = {}) {
  return target_edge_lengths(s, sharp_edges(s), options);
}

}  // namespace

TEST_CASE("on a sphere every length is a chord whose middle is as far away as asked for") {
  const MeshData ball = icosphere(4);
  for (const double radius : {1.0, 250.0}) {
    const Surface s(Positions<double>(radius * ball.V), ball.F);
    for (const double error : {0.0005, 0.002}) {
      SizingOptions options = free_growth;
      options.error = error;
      const VectorX<double> h = sizes(s, options);
      const double expected = chord_of(radius, error * diagonal(s));
      CHECK(h.minCoeff() > 0.95 * expected);
      CHECK(h.maxCoeff() < 1.05 * expected);
    }
  }
}

TEST_CASE("on a cylinder it is that of its circle, at the rim as well, whichever side faces are seen from") {
  for (const bool turned : {false, true}) {
    MeshData tube = cylinder(60, 30, 0.7, 3);
    if (turned) tube.F.col(1).swap(tube.F.col(2));
    const Surface s(tube.V, tube.F);
    const VectorX<double> h = sizes(s, free_growth);
    const double expected = chord_of(0.7, free_growth.error * diagonal(s));
    CHECK(h.minCoeff() > 0.95 * expected);
    CHECK(h.maxCoeff() < 1.05 * expected);
  }
}

TEST_CASE(
    "a capped cylinder: creases are no curvature, the rim bends as the side does, the caps are as large as allowed") {
  const MeshData solid = prism(regular(6), 10, 2, 18, true);
  const Surface s(solid.V, solid.F);
  SizingOptions options = free_growth;
  options.largest = 0.4;
  const VectorX<double> h = sizes(s, options);
  const double expected = chord_of(1, options.error * diagonal(s)), most = 0.4 * diagonal(s);
  for (Index v = 0; v < s.mesh().vertices(); ++v) {
    const double r = std::hypot(s.V()(v, 0), s.V()(v, 1));
    if (r > 0.999) CHECK(std::abs(h[v] - expected) < 0.06 * expected);
    if (r < 0.75) CHECK(h[v] == doctest::Approx(most));  // a ring of neighbours away from the rim
  }
}

TEST_CASE("a box: as large as allowed, but no longer than the crease, and a closed line has three edges") {
  const Surface box([] {
    const MeshData m = blocks(cells(6, 6, 1, [](int, int, int) { return false; }), 3);
    return Surface(m.V, m.F);
  }());
  const VectorX<double> h = sizes(box, free_growth);
  CHECK(h.maxCoeff() == doctest::Approx(diagonal(box)));
  for (const FeatureLine& line : sharp_edges(box).lines)
    for (const Index v : line.vertices) CHECK(h[v] <= double(line.edges.size()) / 3 + 1e-12);  // edges are 1/3 long
  const MeshData flat = disk(8);
  const Surface round(flat.V, flat.F);
  const FeatureGraph rim = sharp_edges(round);
  REQUIRE(rim.lines.size() == 1);
  SizingOptions coarse = free_growth;
  coarse.error = 0.9;  // curvature asks for nothing
  const VectorX<double> around = target_edge_lengths(round, rim, coarse);
  const auto n = static_cast<double>(rim.lines[0].edges.size());
  for (const Index v : rim.lines[0].vertices) CHECK(around[v] <= n * 2 * std::sin(pi<double> / n) / 3 + 1e-12);
}

TEST_CASE("growth: no edge sees a larger step, it only makes smaller, and zero is one length everywhere") {
  const MeshData mesh = noisy_scan(4, 0.1, 3);
  const Surface s(mesh.V, mesh.F);
  const VectorX<double> free = sizes(s, free_growth);
  for (const double growth : {0.0, 0.1, 0.5}) {
    SizingOptions options = free_growth;
    options.growth = growth;
    const VectorX<double> h = sizes(s, options);
    CHECK((free - h).minCoeff() >= 0);
    CHECK(h.minCoeff() == free.minCoeff());
    for (Index e = 0; e < s.mesh().edges(); ++e) {
      const Index a = s.mesh().tail(s.mesh().halfedge(e)), b = s.mesh().tip(s.mesh().halfedge(e));
      CHECK(std::abs(h[a] - h[b]) <= growth * s.geometry().length(e) * (1 + 1e-12));
    }
    if (growth == 0) CHECK(h.maxCoeff() == h.minCoeff());
  }
}

TEST_CASE("lengths scale with the mesh, turn with it, and stay within the range") {
  const MeshData mesh = bumpy_sphere(4, 0.3, 4);
  const Surface s(mesh.V, mesh.F);
  const VectorX<double> h = sizes(s);
  Eigen::Matrix3d turn = (Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized())).toRotationMatrix();
  // A turned box has another diagonal, so the error is given in lengths.
  const Surface other(Positions<double>(1000 * mesh.V * turn.transpose()), mesh.F);
  const double ratio = 1000 * diagonal(s) / diagonal(other);
  const SizingOptions same = {.error = 0.001 * ratio, .smallest = 0.001 * ratio, .largest = 0.1 * ratio};
  CHECK((sizes(other, same) - 1000 * h).cwiseAbs().maxCoeff() < 1e-8 * 1000 * h.maxCoeff());
  const VectorX<double> narrow = sizes(s, {.smallest = 0.03, .largest = 0.04});
  CHECK(narrow.minCoeff() >= 0.03 * diagonal(s) * (1 - 1e-12));
  CHECK(narrow.maxCoeff() <= 0.04 * diagonal(s) * (1 + 1e-12));
}

TEST_CASE("bad options, another surface's features and a surface without points are refused by name") {
  const MeshData mesh = icosphere(1);
  const Surface s(mesh.V, mesh.F);
  const FeatureGraph none_sharp = sharp_edges(s);
  const auto refused = [&](const SizingOptions& options, const char* field) {
    try {
      (void)target_edge_lengths(s, none_sharp, options);
    } catch (const OptionError& e) {
      return e.field() == field;
    }
    return false;
  };
  CHECK(refused({.error = 0}, "error"));
  CHECK(refused({.error = std::nan("")}, "error"));
  CHECK(refused({.smallest = -1}, "smallest"));
  CHECK(refused({.smallest = 0.2, .largest = 0.1}, "largest"));
  CHECK(refused({.growth = -0.1}, "growth"));
  CHECK(refused({.rings = -1}, "rings"));
  FeatureGraph foreign = none_sharp;
  foreign.edges.push_back(s.mesh().edges());
  CHECK_THROWS_AS((void)target_edge_lengths(s, foreign), OptionError);
  CHECK_THROWS_AS((void)target_edge_lengths(flat_torus_surface(5, 5), FeatureGraph{}), OptionError);
}
