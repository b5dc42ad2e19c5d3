// SPDX-License-Identifier: MIT
//
// Intrinsic triangulations: Delaunay, of the same surface, whatever the triangles were.
#include "alcap/intrinsic.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "src/base/parallel.h"
#include "tests/support/mesh_families.h"
#include "tests/support/slivers.h"
#include "tests/support/surfaces.h"

using namespace alcap;

namespace {

Surface surface_of(const MeshData& s) { return {s.V, s.F}; }

void check_same_surface(const Surface& given, const IntrinsicTriangulation& now) {
  const Geometry &a = given.geometry(), &b = now.surface.geometry();
  CHECK(b.total_area() == doctest::Approx(a.total_area()).epsilon(1e-9));
  CHECK(now.surface.topology().euler() == given.topology().euler());
  CHECK(now.surface.topology().loops.size() == given.topology().loops.size());
  for (Index v = 0; v < given.mesh().vertices(); ++v) CHECK(std::abs(a.angle_sum(v) - b.angle_sum(v)) < 1e-7);
  for (Index v = now.given_vertices; v < now.surface.mesh().vertices(); ++v)
    CHECK(std::abs(b.defect(now.surface.mesh(), v)) < 1e-7);  // the surface is flat there
}

/// Every length by the angles of its faces: what the triangulation says of itself fits together.
void check_consistent(const Surface& surface) {
  const Mesh& mesh = surface.mesh();
  const Geometry& g = surface.geometry();
  for (Index h = 0; h < mesh.halfedges(); ++h) {
    const double l = g.length(mesh.edge(h)), sum = g.cot(h) + g.cot(Mesh::next(h));
    CHECK(sum * 2 * g.area(Mesh::face(h)) == doctest::Approx(l * l).epsilon(1e-5));
  }
}

}  // namespace

TEST_CASE("flips make every mesh Delaunay, and leave the surface as it is") {
  for (const test::Family& family : test::mesh_families(3)) {
    CAPTURE(family.name);
    const Surface given = surface_of(family.surface);
    const IntrinsicTriangulation now = intrinsic_delaunay(given);
    CHECK(now.complete);
    CHECK(now.after.not_delaunay == now.barred);
    CHECK(now.after.angle_min >= now.before.angle_min * (1 - 1e-9));  // Delaunay maximises the smallest angle
    CHECK(now.added == 0);
    CHECK(now.surface.mesh().vertices() == given.mesh().vertices());
    check_same_surface(given, now);
    check_consistent(now.surface);
    if (now.before.not_delaunay == 0) CHECK(now.flips == 0);
  }
}

TEST_CASE("slivers of a millionth of an edge, inside and on the boundary, leave nothing behind") {
  for (const double height : {1e-3, 1e-6, 1e-9}) {
    CAPTURE(height);
    const Surface given = surface_of(test::with_slivers(bumpy_sphere(4, 0.2, 3), 37, height));
    const IntrinsicTriangulation now = intrinsic_delaunay(given);
    CHECK(now.before.slivers > 20);
    CHECK(now.after.slivers == 0);
    CHECK(now.barred == 0);
    CHECK(now.flips >= now.before.slivers);
    check_same_surface(given, now);
    check_consistent(now.surface);
  }
}

TEST_CASE("a flat piece stays flat: its corners lie where they were") {
  // Distances from one vertex to its neighbours, unfolded by the directions, are distances in the plane.
  MeshData plate = test::with_slivers(grid(8, 6, 4, 1), 5, 1e-4);
  const Surface given = surface_of(plate);
  const IntrinsicTriangulation now = intrinsic_delaunay(given);
  const Mesh& mesh = now.surface.mesh();
  for (Index e = 0; e < mesh.edges(); ++e) {
    const Index h = mesh.halfedge(e);
    const double distance = (plate.V.row(mesh.tail(h)) - plate.V.row(mesh.tip(h))).norm();
    CHECK(now.surface.geometry().length(e) == doctest::Approx(distance).epsilon(1e-9));
  }
  // First halfedges point where the plate says: the turn is the angle in the plane from one to the other.
  for (Index v = 0; v < given.mesh().vertices(); ++v) {
    const auto along = [&](const Mesh& m) {
      const Index h = m.first(v);
      const Eigen::RowVector3d d = plate.V.row(m.tip(h)) - plate.V.row(v);
      return std::atan2(d.y(), d.x());
    };
    CHECK(std::abs(wrap(along(mesh) - along(given.mesh()) - now.turn[v])) < 1e-6);
  }
}

TEST_CASE("kept edges stay, and are split only by refinement") {
  const Surface given = surface_of(test::with_slivers(torus(24, 12, 1, 0.4), 3, 1e-3));
  std::vector<Index> keep;
  for (Index e = 0; e < given.mesh().edges(); e += 11) keep.push_back(e);
  for (const double angle : {0.0, 20.0}) {
    const IntrinsicTriangulation now = intrinsic_delaunay(given, {.keep = keep, .min_angle = angle * pi<double> / 180});
    REQUIRE(now.kept.size() == keep.size());
    for (std::size_t k = 0; k < keep.size(); ++k) {
      const std::vector<Index>& chain = now.kept[k];
      const Index h = given.mesh().halfedge(keep[k]);
      CHECK(chain.front() == given.mesh().tail(h));
      CHECK(chain.back() == given.mesh().tip(h));
      double length = 0;
      for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
        const Index e = now.surface.mesh().edge(chain[i], chain[i + 1]);
        REQUIRE(e != none);
        length += now.surface.geometry().length(e);
      }
      CHECK(length == doctest::Approx(given.geometry().length(keep[k])).epsilon(1e-12));
      if (angle == 0) CHECK(chain.size() == 2);
    }
    check_same_surface(given, now);
  }
}

TEST_CASE("refinement reaches the angle asked for") {
  for (const test::Family& family : test::mesh_families(3)) {
    CAPTURE(family.name);
    const Surface given = surface_of(family.surface);
    const double wanted = 20 * pi<double> / 180;
    const IntrinsicTriangulation now = intrinsic_delaunay(given, {.min_angle = wanted});
    CHECK(now.complete);
    check_same_surface(given, now);
    check_consistent(now.surface);
    // But for small corners of the surface's own, which these do not have.
    if (now.barred == 0) CHECK(now.after.angle_min >= wanted * (1 - 1e-9));
    CHECK(now.surface.mesh().vertices() == now.given_vertices + now.added);
    if (now.before.angle_min > wanted && now.before.not_delaunay == 0 && given.topology().loops.empty())
      CHECK(now.added == 0);
  }
  // 6 lengths of a shaft between rings of 200 vertices: needles of 1 : 190.
  const IntrinsicTriangulation shaft =
      intrinsic_delaunay(surface_of(cad_like(200, 3)), {.min_angle = 20 * pi<double> / 180});
  CHECK(shaft.before.angle_min < 0.4 * pi<double> / 180);
  CHECK(shaft.after.angle_min > 20 * pi<double> / 180 * (1 - 1e-9));
  CHECK(shaft.added < 8 * shaft.given_vertices);
}

TEST_CASE("small corners of the surface's own end the refinement, and stay") {
  MeshData wedge{Positions<double>(3, 3), Faces(1, 3)};
  wedge.V << 0, 0, 0, 10, 0, 0, 10, 0.5, 0;
  wedge.F << 0, 1, 2;
  const IntrinsicTriangulation now = intrinsic_delaunay(surface_of(wedge), {.min_angle = 20 * pi<double> / 180});
  CHECK(now.complete);
  CHECK(now.added < 100);
  CHECK(now.after.angle_min == doctest::Approx(now.before.angle_min).epsilon(0.5));
}

TEST_CASE("budgets end it, whatever is asked") {
  const Surface given = surface_of(cad_like(300, 3));
  const IntrinsicTriangulation few =
      intrinsic_delaunay(given, {.min_angle = 20 * pi<double> / 180, .most_vertices = 0.1});
  CHECK_FALSE(few.complete);
  CHECK(few.added <= given.mesh().vertices() / 10 + 1);
  const Surface thin = surface_of(test::with_slivers(icosphere(4), 3, 1e-3));
  CHECK_FALSE(intrinsic_delaunay(thin, {.most_flips = 0.01}).complete);
  CHECK_THROWS_AS((void)intrinsic_delaunay(thin, {.min_angle = 1}), OptionError);
  CHECK_THROWS_AS((void)intrinsic_delaunay(thin, {.min_angle = -1}), OptionError);
  CHECK_THROWS_AS((void)intrinsic_delaunay(thin, {.keep = {-1}}), OptionError);
}

TEST_CASE("bitwise the same for any number of threads, and in any unit") {
  const MeshData mesh = test::with_slivers(noisy_scan(4, 0.2, 5), 7, 1e-5);
  const IntrinsicOptions options{.min_angle = 15 * pi<double> / 180};
  const IntrinsicTriangulation one = intrinsic_delaunay(surface_of(mesh), options);
  run_with_threads(4, [&] {
    const IntrinsicTriangulation four = intrinsic_delaunay(surface_of(mesh), options);
    CHECK(four.surface.F() == one.surface.F());
    CHECK(four.surface.geometry().lengths() == one.surface.geometry().lengths());
    CHECK(four.turn == one.turn);
  });
  MeshData large = mesh;
  large.V *= std::ldexp(1.0, 60);
  const IntrinsicTriangulation other = intrinsic_delaunay(surface_of(large), options);
  CHECK(other.surface.F() == one.surface.F());
  CHECK(other.flips == one.flips);
}

TEST_CASE("values carry over and back") {
  const Surface given = surface_of(test::with_slivers(icosphere(3), 5, 1e-4));
  const IntrinsicTriangulation now = intrinsic_delaunay(given, {.min_angle = 0.3});
  ComplexVectorX<double> u(given.mesh().vertices());
  for (Index v = 0; v < u.size(); ++v) u[v] = std::polar(1.0 + 0.1 * v, 0.7 * v);
  const ComplexVectorX<double> there = now.from_given(u, 4);
  CHECK(there.size() == now.surface.mesh().vertices());
  CHECK((now.to_given(there, 4) - u).norm() < 1e-12 * u.norm());
  CHECK_THROWS_AS((void)now.to_given(ComplexVectorX<double>(3), 4), OptionError);
}
