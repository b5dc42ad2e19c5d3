// SPDX-License-Identifier: MIT
//
// Repairs: what each changes, what it leaves, and that the result is a surface.
#include <doctest/doctest.h>

#include <algorithm>

#include "alcap/generators.h"
#include "alcap/mesh_check.h"
#include "alcap/mesh_repair.h"
#include "alcap/surface.h"
#include "tests/support/mesh_helpers.h"

using namespace alcap;

namespace {

RepairedMesh repaired(const MeshData& mesh, std::vector<Repair> repairs, double tolerance = 0) {
  return repair_mesh(mesh.V, mesh.F, {.repairs = std::move(repairs), .weld_tolerance = tolerance});
}

bool usable(const RepairedMesh& mesh) {
  return find_defects(mesh.F, mesh.V.rows()).empty() && find_defects(mesh.V, mesh.F).empty();
}

/// The same triangles in space, whatever the numbers of their corners.
double distance(const RepairedMesh& after, const MeshData& before) {
  double largest = 0;
  for (Eigen::Index t = 0; t < after.F.rows(); ++t) {
    const Eigen::Index given = after.face_of.empty() ? t : after.face_of[static_cast<std::size_t>(t)];
    for (int c = 0; c < 3; ++c)
      largest = std::max(largest, (after.V.row(after.F(t, c)) - before.V.row(before.F(given, c))).norm());
  }
  return largest;
}

/// Two spheres that share a vertex, and a third at another one.
MeshData bow_ties() {
  const MeshData ball = icosphere(1);
  MeshData mesh = test::together(test::together(ball, ball), ball);
  const Index n = static_cast<Index>(ball.V.rows());
  mesh.V.middleRows(n, n).rowwise() += ball.V.row(0) - ball.V.row(3);
  mesh.V.bottomRows(n).rowwise() += ball.V.row(5) - ball.V.row(3);
  for (Eigen::Index t = 0; t < mesh.F.rows(); ++t)
    for (int c = 0; c < 3; ++c) {
      if (mesh.F(t, c) == n + 3) mesh.F(t, c) = 0;
      if (mesh.F(t, c) == 2 * n + 3) mesh.F(t, c) = 5;
    }
  return mesh;
}

}  // namespace

TEST_CASE("bow-ties are split: nothing moves, numbers stay, copies are appended and mapped") {
  const MeshData mesh = bow_ties();
  CHECK_THROWS_AS(Surface(mesh.V, mesh.F), MeshError);
  const RepairedMesh split = repaired(mesh, {});
  REQUIRE(usable(split));
  CHECK(split.copies_of == std::vector<Index>{0, 5});
  CHECK(split.face_of.empty());
  CHECK(distance(split, mesh) == 0);
  CHECK(split.V.topRows(mesh.V.rows()) == mesh.V);
  const Surface surface(split.V, split.F);
  CHECK(surface.topology().components.size() == 3);
  for (const ComponentInfo& c : surface.topology().components) CHECK(c.euler == 2);
  REQUIRE(split.steps.size() == 1);
  CHECK(split.steps[0].code == "bow_ties_split");
  CHECK(split.steps[0].count == 2);
  CHECK(split.steps[0].first == std::vector<Index>{0, 5});
  // A mesh without any is left as it is.
  const RepairedMesh same = repair_mesh(icosphere(2).V, icosphere(2).F);
  CHECK(same.steps.empty());
  CHECK(same.F == icosphere(2).F);
  CHECK_FALSE(usable(repair_mesh(mesh.V, mesh.F, {.bow_ties = false})));
}

TEST_CASE("many fans at one vertex become as many vertices") {
  const int fans = 5;
  MeshData mesh{Positions<double>(1 + 2 * fans, 3), Faces(fans, 3)};
  mesh.V.row(0).setZero();
  for (int k = 0; k < fans; ++k) {
    mesh.V.row(1 + 2 * k) << std::cos(k), std::sin(k), 0;
    mesh.V.row(2 + 2 * k) << std::cos(k + 0.5), std::sin(k + 0.5), 0;
    mesh.F.row(k) << 0, 1 + 2 * k, 2 + 2 * k;
  }
  const RepairedMesh split = repaired(mesh, {});
  CHECK(usable(split));
  CHECK(split.copies_of == std::vector<Index>(fans - 1, 0));
  CHECK(distance(split, mesh) == 0);
}

TEST_CASE("duplicate faces go, the first one stays, whatever their corners' order") {
  const MeshData ball = icosphere(1);
  MeshData mesh{ball.V, Faces(ball.F.rows() + 2, 3)};
  mesh.F << ball.F, ball.F(7, 1), ball.F(7, 2), ball.F(7, 0), ball.F(3, 1), ball.F(3, 0), ball.F(3, 2);
  const RepairedMesh clean = repaired(mesh, {Repair::duplicates});
  CHECK(usable(clean));
  CHECK(clean.F == ball.F);
  CHECK(clean.face_of.size() == static_cast<std::size_t>(ball.F.rows()));
  REQUIRE(clean.steps.size() == 1);
  CHECK(clean.steps[0].count == 2);
  CHECK(clean.steps[0].first == std::vector<Index>{80, 81});
}

TEST_CASE("faces without area: collapsed sides, flat corners inside and at the rim") {
  // A square of two triangles; a vertex in the middle of the diagonal makes a flat face between them.
  MeshData flat{Positions<double>(5, 3), test::faces({{0, 1, 2}, {0, 2, 4}, {0, 4, 3}, {4, 2, 3}})};
  flat.V << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0.5, 0.5, 0;
  CHECK_THROWS_AS(Surface(flat.V, flat.F), MeshError);
  const RepairedMesh flipped = repaired(flat, {Repair::degenerate});
  REQUIRE(usable(flipped));
  const Surface square(flipped.V, flipped.F);
  CHECK(square.geometry().total_area() == doctest::Approx(1));
  CHECK(square.topology().loops.size() == 1);  // no crack
  CHECK(square.mesh().faces() == 4);

  // A vertex given twice, joined by a side of length 0 with two faces that collapse.
  MeshData ball = icosphere(1);
  const Index v = static_cast<Index>(ball.V.rows()), a = ball.F(0, 0), b = ball.F(0, 1);
  ball.V.conservativeResize(v + 1, 3);
  ball.V.row(v) = ball.V.row(a);
  ball.F.conservativeResize(ball.F.rows() + 1, 3);
  ball.F.bottomRows(1) << a, v, b;
  ball.F(0, 0) = v;
  const RepairedMesh joined = repaired(ball, {Repair::degenerate});
  REQUIRE(usable(joined));
  CHECK(Surface(joined.V, joined.F).topology().euler() == 2);
  CHECK(joined.F.rows() == 80);

  // Face 1 is flat at the rim: it goes.
  const MeshData rim{(Positions<double>(4, 3) << 0, 0, 0, 1, 0, 0, 0, 1, 0, 2, 0, 0).finished(),
                     test::faces({{0, 1, 2}, {1, 0, 3}})};
  const RepairedMesh cut = repaired(rim, {Repair::degenerate});
  CHECK(usable(cut));
  CHECK(cut.face_of == std::vector<Index>{0});
}

TEST_CASE("split cuts along edges of more than two faces") {
  // Two cubes that share an edge.
  MeshData cubes = test::together(cube(), cube());
  cubes.V.bottomRows(8).rowwise() += Eigen::RowVector3d(2, 2, 0);
  const Faces welded = repair_weld(cubes.V, cubes.F);
  CHECK(find_defects(welded, cubes.V.rows()).front().defect == Defect::non_manifold_edge);
  const RepairedMesh split = repair_mesh(cubes.V, welded, {.repairs = {Repair::split}});
  REQUIRE(usable(split));
  const Surface surface(split.V, split.F);
  CHECK(surface.topology().components.size() == 2);
  CHECK(surface.topology().loops.empty());
  CHECK(distance(split, cubes) == 0);
  // A fin that stands on a sheet: cut off, the sheet stays whole.
  MeshData fin = grid(4, 4);
  const Index top = static_cast<Index>(fin.V.rows());
  fin.V.conservativeResize(top + 1, 3);
  fin.V.row(top) << 0.1, 0.2, 1;
  fin.F.conservativeResize(fin.F.rows() + 1, 3);
  fin.F.bottomRows(1) << 6, 7, top;
  const RepairedMesh free = repaired(fin, {Repair::split});
  REQUIRE(usable(free));
  CHECK(Surface(free.V, free.F).topology().components.size() == 2);
}

TEST_CASE("weld joins within a tolerance relative to the size") {
  MeshData soup = test::soup(icosphere(2));
  detail::Random random(5);
  for (Eigen::Index v = 0; v < soup.V.rows(); ++v)
    for (int d = 0; d < 3; ++d) soup.V(v, d) += 1e-7 * random.uniform(-1, 1);
  CHECK(Surface(soup.V, soup.F).topology().components.size() == 320);
  for (const double scale : {1.0, 1e-6, 1e6}) {
    MeshData scaled = soup;
    scaled.V *= scale;
    const RepairedMesh whole = repaired(scaled, {Repair::weld}, 1e-6);
    REQUIRE(usable(whole));
    CHECK(Surface(whole.V, whole.F).topology().components.size() == 1);
    CHECK(whole.V == scaled.V);
    CHECK(repaired(scaled, {Repair::weld}).F == soup.F);
  }
  CHECK_THROWS_AS(repaired(soup, {Repair::weld}, -1), OptionError);
  CHECK_THROWS_AS(repaired(soup, {Repair::weld}, 0.5), OptionError);
}

TEST_CASE("auto does what is needed and no more") {
  const auto codes = [](const RepairedMesh& mesh) {
    std::vector<std::string> out;
    for (const RepairStep& s : mesh.steps) out.push_back(s.code);
    return out;
  };
  using Codes = std::vector<std::string>;
  const auto automatic = [](const MeshData& mesh) { return repaired(mesh, {Repair::automatic}); };
  CHECK(automatic(icosphere(2)).steps.empty());
  CHECK(codes(automatic(test::soup(icosphere(2)))) == Codes{"welded"});
  CHECK(codes(automatic(bow_ties())) == Codes{"bow_ties_split"});
  const MeshData ball = icosphere(2);
  CHECK(codes(automatic({ball.V, test::randomly_turned(ball.F, 3)})) == Codes{"reoriented"});
  MeshData all = bow_ties();
  all.F = test::randomly_turned(all.F, 4);
  all.F.conservativeResize(all.F.rows() + 2, 3);
  all.F.bottomRows(2) << all.F(9, 2), all.F(9, 0), all.F(9, 1), 4, 4, 2;
  const RepairedMesh mended = automatic(all);
  CHECK(usable(mended));
  CHECK(codes(mended) == Codes{"degenerate_repaired", "duplicates_removed", "reoriented", "bow_ties_split"});
  // One-sided: there is no repair, and none is tried.
  const Faces moebius = test::moebius_strip(9);
  Positions<double> V(18, 3);
  for (Index v = 0; v < 18; ++v) V.row(v) << std::cos(v / 2), std::sin(v / 2), v % 2;
  CHECK(repair_mesh(V, moebius, {.repairs = {Repair::automatic}}).steps.empty());
}

TEST_CASE("repairs refuse numbers out of range by name") {
  const MeshData ball = icosphere(0);
  Faces F = ball.F;
  F(3, 1) = 99;
  for (const Repair r : {Repair::weld, Repair::degenerate, Repair::duplicates, Repair::split})
    CHECK_THROWS_AS((void)repair_mesh(ball.V, F, {.repairs = {r}}), MeshError);
  CHECK(repair_mesh(ball.V, F, {.repairs = {Repair::automatic}}).steps.empty());
}
