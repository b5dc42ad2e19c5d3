// SPDX-License-Identifier: MIT
//
// The generated meshes are what their names say: counts, topology, orientation, shape.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <limits>

#include "alcap/generators.h"
#include "alcap/mesh_check.h"
#include "alcap/topology.h"
#include "tests/support/mesh_helpers.h"

using namespace alcap;

namespace {

double volume(const MeshData& s) {
  double sum = 0;
  for (Eigen::Index t = 0; t < s.F.rows(); ++t) {
    const Eigen::RowVector3d a = s.V.row(s.F(t, 0)), b = s.V.row(s.F(t, 1)), c = s.V.row(s.F(t, 2));
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

Eigen::RowVector3d vector_area(const MeshData& s) {
  Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
  for (Eigen::Index t = 0; t < s.F.rows(); ++t) {
    const Eigen::RowVector3d a = s.V.row(s.F(t, 0)), b = s.V.row(s.F(t, 1)), c = s.V.row(s.F(t, 2));
    sum += (b - a).cross(c - a) / 2;
  }
  return sum;
}

/// Whether every face has its normal to the same side as the direction from `from`(centroid).
template <class From>
bool outward(const MeshData& s, From&& from) {
  for (Eigen::Index t = 0; t < s.F.rows(); ++t) {
    const Eigen::RowVector3d a = s.V.row(s.F(t, 0)), b = s.V.row(s.F(t, 1)), c = s.V.row(s.F(t, 2));
    const Eigen::RowVector3d middle = (a + b + c) / 3;
    if (!((b - a).cross(c - a).dot(middle - from(middle)) > 0)) return false;
  }
  return true;
}

Eigen::RowVector3d origin(const Eigen::RowVector3d&) { return Eigen::RowVector3d::Zero(); }

/// One component of the given genus and number of loops, no defects, every vertex used.
void check_shape(const MeshData& s, Index genus, Index loops) {
  REQUIRE(find_defects(s.F, s.V.rows()).empty());
  CHECK(find_defects(s.V, s.F).empty());
  const Mesh mesh(s.F, s.V.rows());
  CHECK(mesh.referenced_vertices() == mesh.vertices());
  const Topology topology = find_topology(mesh);
  REQUIRE(topology.components.size() == 1);
  CHECK(topology.components[0].genus == genus);
  CHECK(topology.components[0].boundary_loops == loops);
}

bool same(const MeshData& a, const MeshData& b) { return a.V == b.V && a.F == b.F; }

}  // namespace

TEST_CASE("small meshes") {
  check_shape(single_triangle(), 0, 1);
  check_shape(tetrahedron(), 0, 0);
  check_shape(cube(), 0, 0);
  CHECK(volume(cube()) == doctest::Approx(8));
  CHECK(volume(tetrahedron()) == doctest::Approx(8 / (9 * std::sqrt(3.0))));
  CHECK(outward(cube(), origin));
  CHECK(outward(tetrahedron(), origin));
}

TEST_CASE("icospheres lie on the sphere, face outward and nest") {
  for (int level = 0; level <= 4; ++level) {
    const MeshData s = icosphere(level);
    const Index power = Index{1} << 2 * level;
    CHECK(s.V.rows() == 10 * power + 2);
    CHECK(s.F.rows() == 20 * power);
    check_shape(s, 0, 0);
    CHECK((s.V.rowwise().norm().array() - 1).abs().maxCoeff() < 1e-15);
    CHECK(outward(s, origin));
    CHECK(icosphere(level + 1).V.topRows(s.V.rows()) == s.V);
  }
  // The volume tends to 4 pi / 3 with second order.
  const double exact = 4 * pi<double> / 3;
  CHECK((exact - volume(icosphere(3))) / (exact - volume(icosphere(4))) == doctest::Approx(4).epsilon(0.02));
}

TEST_CASE("jittered spheres stay on the sphere, move by at most the amount and do not fold") {
  const MeshData clean = icosphere(3);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const MeshData s = jittered_sphere(3, 0.2, seed);
    check_shape(s, 0, 0);
    CHECK(s.F == clean.F);
    CHECK((s.V.rowwise().norm().array() - 1).abs().maxCoeff() < 1e-15);
    CHECK(outward(s, origin));
    const double farthest = (s.V - clean.V).rowwise().norm().maxCoeff();
    CHECK(farthest < 0.2 * 0.16);  // the mean edge at level 3 is 0.15
    CHECK(farthest > 0.1 * 0.14);
    CHECK(same(s, jittered_sphere(3, 0.2, seed)));
    CHECK_FALSE(same(s, jittered_sphere(3, 0.2, seed + 1)));
  }
  CHECK((jittered_sphere(2, 0, 1).V - icosphere(2).V).cwiseAbs().maxCoeff() < 1e-15);
}

TEST_CASE("bumpy spheres have the stated radius") {
  const MeshData s = bumpy_sphere(3, 0.3, 6), round = icosphere(3);
  check_shape(s, 0, 0);
  CHECK(outward(s, origin));
  double worst = 0;
  for (Eigen::Index v = 0; v < s.V.rows(); ++v) {
    const Eigen::RowVector3d p = round.V.row(v);
    const double radius = 1 + 0.1 * (std::sin(6 * p[0]) + std::sin(6 * p[1]) + std::sin(6 * p[2]));
    worst = std::max(worst, std::abs(s.V.row(v).norm() - radius));
  }
  CHECK(worst < 1e-14);
}

TEST_CASE("tori have genus 1, lie on the torus and face outward") {
  const double R = 1, r = 0.4;
  const auto core = [&](const Eigen::RowVector3d& p) {
    Eigen::RowVector3d c(p[0], p[1], 0);
    return Eigen::RowVector3d(c * (R / c.norm()));
  };
  for (const MeshData& s : {torus(40, 20, R, r), torus_random_diagonals(40, 20, R, r, 3)}) {
    check_shape(s, 1, 0);
    CHECK(s.V.rows() == 800);
    CHECK(s.F.rows() == 1600);
    CHECK(outward(s, core));
    for (Eigen::Index v = 0; v < s.V.rows(); ++v) {
      REQUIRE((s.V.row(v) - core(s.V.row(v))).norm() == doctest::Approx(r).epsilon(1e-13));
    }
  }
  check_shape(torus(3, 3, R, r), 1, 0);
  const MeshData s = torus(40, 20, R, r);
  // Quad (i, j) = (2, 5): a b c and a c d, with vertex (i, j) at i nv + j.
  CHECK(s.F.row(2 * (2 * 20 + 5)) == Eigen::RowVector3<Index>(45, 65, 66));
  CHECK(s.F.row(2 * (2 * 20 + 5) + 1) == Eigen::RowVector3<Index>(45, 66, 46));
  const Faces random = torus_random_diagonals(40, 20, R, r, 3).F;
  Index differ = 0;
  for (Eigen::Index t = 0; t < 1600; t += 2) differ += random.row(t) != s.F.row(t);
  CHECK(differ > 300);
  CHECK(differ < 500);
}

TEST_CASE("the flat torus closes up with angle 2 pi at every vertex and area 1") {
  const FlatTorus s = flat_torus(5, 4);
  const Mesh mesh(s.F, s.vertices);
  const Topology topology = find_topology(mesh);
  CHECK(topology.components.size() == 1);
  CHECK(topology.euler() == 0);
  CHECK(topology.loops.empty());
  CHECK(s.F == torus(5, 4, 1, 0.4).F);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(s.vertices);
  double area = 0;
  for (Index h = 0; h < mesh.halfedges(); ++h) {
    const auto length = [&](Index k) { return s.lengths(k / 3, k % 3); };
    CHECK(length(h) == length(mesh.twin(h)));
    const double a = length(h), b = length(Mesh::prev(h)), c = length(Mesh::next(h));
    const double angle = std::acos((a * a + b * b - c * c) / (2 * a * b));
    sum[mesh.tail(h)] += angle;
    area += a * b * std::sin(angle) / 6;
  }
  CHECK((sum.array() - 2 * pi<double>).abs().maxCoeff() < 1e-13);
  CHECK(area == doctest::Approx(1));
}

TEST_CASE("flat pieces cover their area once, facing +z") {
  check_shape(grid(3, 4, 2, 5), 0, 1);
  check_shape(grid(1, 1), 0, 1);
  CHECK(vector_area(grid(3, 4, 2, 5))[2] == doctest::Approx(10));
  for (const int rings : {1, 2, 7}) {
    check_shape(disk(rings), 0, 1);
    CHECK(disk(rings).V.rows() == 1 + 3 * rings * (rings + 1));
    CHECK(disk(rings).F.rows() == 6 * rings * rings);
    const double sides = 6 * rings;
    CHECK(vector_area(disk(rings))[2] == doctest::Approx(sides / 2 * std::sin(2 * pi<double> / sides)));
  }
  check_shape(fan(3), 0, 1);
  check_shape(fan(2000), 0, 1);
  for (const MeshData& s : {grid(3, 4, 2, 5), disk(7), fan(9)}) {
    const auto below = [](const Eigen::RowVector3d& p) { return Eigen::RowVector3d(p[0], p[1], -1); };
    CHECK(outward(s, below));
  }
}

TEST_CASE("cylinders have two loops and face outward") {
  const MeshData s = cylinder(12, 5, 2, 3);
  check_shape(s, 0, 2);
  CHECK(outward(s, [](const Eigen::RowVector3d& p) { return Eigen::RowVector3d(0, 0, p[2]); }));
  check_shape(cylinder(3, 1), 0, 2);
}

TEST_CASE("surfaces of any genus") {
  for (int genus = 0; genus <= 4; ++genus) {
    for (const int resolution : {1, 2, 4}) {
      const MeshData s = genus_surface(genus, resolution);
      check_shape(s, genus, 0);
      CHECK(volume(s) > 0);
    }
  }
  check_shape(genus_surface(40, 1), 40, 0);
}

TEST_CASE("the CAD stand-in is closed and has slivers") {
  for (const int steps : {1, 2, 6}) {
    const MeshData s = cad_like(64, steps);
    check_shape(s, 0, 0);
    CHECK(volume(s) > 0);
  }
  check_shape(cad_like(3, 1), 0, 0);
  const MeshData s = cad_like(200, 4);
  double thinnest = 1;
  for (Eigen::Index t = 0; t < s.F.rows(); ++t) {
    const Eigen::RowVector3d a = s.V.row(s.F(t, 0)), b = s.V.row(s.F(t, 1)), c = s.V.row(s.F(t, 2));
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    thinnest = std::min(thinnest, (b - a).cross(c - a).norm() / (longest * longest));
  }
  CHECK(thinnest < 0.01);
}

TEST_CASE("the scan stand-in has five holes and irregular valences") {
  for (int level = 3; level <= 5; ++level) {
    const MeshData s = noisy_scan(level, 0.1, 7);
    check_shape(s, 0, 5);
    Eigen::VectorXi valence = Eigen::VectorXi::Zero(s.V.rows());
    for (Eigen::Index k = 0; k < s.F.size(); ++k) ++valence[s.F.data()[k]];
    CHECK((valence.array() == 6).cast<double>().mean() < 0.75);
    CHECK(same(s, noisy_scan(level, 0.1, 7)));
  }
}

TEST_CASE("bad arguments are refused by name") {
  const auto field = [](auto&& make) {
    try {
      (void)make();
    } catch (const OptionError& e) {
      return e.field();
    }
    return std::string("accepted");
  };
  CHECK(field([] { return icosphere(-1); }) == "level");
  CHECK(field([] { return icosphere(13); }) == "level");
  CHECK(field([] { return jittered_sphere(1, -0.1, 0); }) == "amount");
  CHECK(field([] { return bumpy_sphere(1, 1, 1); }) == "amplitude");
  CHECK(field([] { return torus(2, 5, 1, 0.4); }) == "nu");
  CHECK(field([] { return torus(5, 2, 1, 0.4); }) == "nv");
  CHECK(field([] { return torus(5, 5, 1, 1); }) == "R");
  CHECK(field([] { return torus(5, 5, 1, -1); }) == "r");
  CHECK(field([] { return flat_torus(1, 5); }) == "nu");
  CHECK(field([] { return grid(0, 5); }) == "nx");
  CHECK(field([] { return grid(std::numeric_limits<int>::max(), 1); }) == "ny");
#ifndef ALCAP_INDEX_64
  CHECK(field([] { return grid(50000, 50000); }) == "ny");
#endif
  CHECK(field([] { return grid(5, 5, 0); }) == "width");
  CHECK(field([] { return disk(0); }) == "rings");
  CHECK(field([] { return fan(2); }) == "count");
  CHECK(field([] { return cylinder(2, 1); }) == "nu");
  CHECK(field([] { return genus_surface(-1, 1); }) == "genus");
  CHECK(field([] { return genus_surface(1, 0); }) == "resolution");
  CHECK(field([] { return cad_like(2, 1); }) == "segments");
  CHECK(field([] { return cad_like(5, 0); }) == "steps");
  CHECK(field([] { return noisy_scan(2, 0.1, 1); }) == "level");
  CHECK(field([] { return noisy_scan(3, 2, 1); }) == "noise");
}
