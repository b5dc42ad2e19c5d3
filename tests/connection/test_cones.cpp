// SPDX-License-Identifier: MIT
#include "alcap/cones.h"

#include <doctest/doctest.h>

#include <cmath>

#include "alcap/generators.h"
#include "alcap/singularities.h"
#include "alcap/smoothest.h"
#include "tests/support/mesh_helpers.h"

using namespace alcap;

namespace {

double sum_of(const std::vector<Cone>& cones) {
  double sum = 0;
  for (const Cone& cone : cones) sum += cone.index;
  return sum;
}

}  // namespace

TEST_CASE(
    "balanced cones sum to chi on genus 0 to 3, keep those given, and make a connection whose field has only them") {
  for (const MeshData& surface :
       {bumpy_sphere(3, 0.3, 3), torus(30, 16, 1, 0.4), genus_surface(2, 3), genus_surface(3, 2)}) {
    const Mesh mesh(surface.F, surface.V.rows());
    const Geometry geometry(mesh, surface.V);
    const int euler = find_topology(mesh).components[0].euler;
    for (const int n : {1, 2, 4}) {
      const std::vector<Cone> given = {{.vertex = 3, .index = 1.0 / n}};
      const std::vector<Cone> cones = balance_cones(mesh, geometry, given, {.n = n});
      CHECK(sum_of(cones) == doctest::Approx(euler));
      CHECK(cones[0].vertex == 3);
      CHECK(cones[0].index == 1.0 / n);
      const Connection connection = trivial(mesh, geometry, cones, {.n = n});
      const Field field = smoothest_field(mesh, geometry, connection, nullptr, {.n = n}).field;
      const std::vector<int> indices = face_indices(mesh, connection, field);
      for (Index t = 0; t < mesh.faces(); ++t) {
        bool touches = false;
        for (const Cone& cone : cones)
          for (Index c = 0; c < 3; ++c) touches |= mesh.F()(t, c) == cone.vertex;
        if (!touches) CHECK(indices[static_cast<std::size_t>(t)] == 0);
      }
    }
  }
}

TEST_CASE("cones go where the curvature is: the corners of a box, the ends of a cigar") {
  // A cube, refined: every corner has curvature pi/2 and takes one cone of 1/4.
  MeshData box = icosphere(4);
  for (Eigen::Index v = 0; v < box.V.rows(); ++v)
    box.V.row(v) /= std::pow(box.V.row(v).array().pow(16).sum(), 1.0 / 16);
  const Mesh mesh(box.F, box.V.rows());
  const Geometry geometry(mesh, box.V);
  const std::vector<Cone> corners = balance_cones(mesh, geometry, {}, {.n = 4});
  CHECK(corners.size() == 8);
  for (const Cone& cone : corners) CHECK(box.V.row(cone.vertex).cwiseAbs().minCoeff() > 0.6);

  MeshData cigar = icosphere(3);
  cigar.V.col(2) *= 6;
  const Mesh other(cigar.F, cigar.V.rows());
  const std::vector<Cone> ends = balance_cones(other, Geometry(other, cigar.V), {}, {.n = 1});
  REQUIRE(ends.size() == 2);
  for (const Cone& cone : ends) CHECK(std::abs(cigar.V(cone.vertex, 2)) > 4);
  CHECK(cigar.V(ends[0].vertex, 2) * cigar.V(ends[1].vertex, 2) < 0);
}

TEST_CASE("an index that no number of cones can balance is refused, whatever its size") {
  const MeshData surface = icosphere(2);
  const Mesh mesh(surface.F, surface.V.rows());
  const Geometry geometry(mesh, surface.V);
  for (const double index : {-1e300, 1e300, -1e17, 1e9}) {
    CAPTURE(index);
    CHECK_THROWS_AS((void)balance_cones(mesh, geometry, {{.vertex = 0, .index = index}}, {.n = 1}), OptionError);
  }
  // Far from balance, but within what the surface can carry.
  const std::vector<Cone> cones = balance_cones(mesh, geometry, {{.vertex = 0, .index = 12}}, {.n = 1});
  CHECK(sum_of(cones) == doctest::Approx(2));
}

TEST_CASE("what is balanced stays, pieces are balanced on their own, boundaries need nothing, too much is taken back") {
  const MeshData two = test::together(icosphere(2), torus(20, 10, 1, 0.4));
  const Mesh mesh(two.F, two.V.rows());
  const Geometry geometry(mesh, two.V);
  CHECK(balance_cones(mesh, geometry, {{0, 1}, {40, 1}}, {.n = 1}).size() == 2);
  const std::vector<Cone> cones = balance_cones(mesh, geometry, {{0, 3}, {200, 0.5}}, {.n = 2});
  double sphere = 0, ring = 0;
  for (const Cone& cone : cones) (cone.vertex < 162 ? sphere : ring) += cone.index;
  CHECK(sphere == doctest::Approx(2));
  CHECK(ring == doctest::Approx(0));

  const MeshData open = disk(5);
  const Mesh rim(open.F, open.V.rows());
  CHECK(balance_cones(rim, Geometry(rim, open.V), {}, {.n = 4}).empty());
  CHECK_THROWS_AS((void)balance_cones(mesh, geometry, {{0, 0.3}}, {.n = 2}), OptionError);
  CHECK_THROWS_AS((void)balance_cones(mesh, geometry, {{-1, 1}}, {.n = 2}), OptionError);
  CHECK_THROWS_AS((void)balance_cones(mesh, geometry, {}, {.n = 0}), OptionError);
}
