// SPDX-License-Identifier: MIT
//
// Runs along features of CAD parts with curved sides, and of lookalikes of what people bring: assemblies, sheet metal,
// lattices, terrain with holes where there are no data, scans with loose shells.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "alcap/design_run.h"
#include "alcap/field_run.h"
#include "alcap/generators.h"
#include "tests/support/parts.h"

using namespace alcap;

namespace {

int index_sum_of(const FieldRun& run) {
  int sum = 0;
  for (const Singularity& s : run.singularities) sum += s.index;
  return sum;
}

bool has_remark(const FieldRun& run, const std::string& code) {
  return std::any_of(run.remarks.begin(), run.remarks.end(), [&](const Remark& r) { return r.code == code; });
}

FieldRun along(const MeshData& mesh) { return run_field(mesh.V, mesh.F, {.n = 4, .align = FieldAlignment{}}); }

bool straight(const FieldRun& run, const FeatureLine& line) {
  double length = 0;
  for (const Index e : line.edges) length += run.geometry().length(e);
  const auto& V = run.surface.V();
  return (V.row(line.vertices.back()) - V.row(line.vertices.front())).norm() > (1 - 1e-6) * length;
}

void check_along(const FieldRun& run) {
  CHECK(run.certificate.holds());
  CHECK(run.certificate.index_sums_match);
  REQUIRE(run.features.has_value());
  const LineDeviation& all = run.features->report.all;
  CHECK(all.mean_degrees < 1);
  CHECK(all.worst_degrees < 10);
  for (std::size_t k = 0; k < run.features->graph.lines.size(); ++k) {
    const LineDeviation& line = run.features->report.lines[k];
    CAPTURE(run.features->graph.lines[k].edges.size());
    CAPTURE(run.surface.V().row(run.features->graph.lines[k].vertices.front()));
    CAPTURE(run.surface.V().row(run.features->graph.lines[k].vertices.back()));
    CHECK(line.mean_degrees < 1);
    CHECK(line.worst_degrees < 10);
    // Curved rims may have one beside them: on a round cap they lie near it.
    if (straight(run, run.features->graph.lines[k])) CHECK(line.singularities == 0);
  }
}

/// Cubes of `m` x `m` squares to a side at places in space, each a piece of its own.
MeshData cubes_apart(int count, int m) {
  const MeshData one = test::blocks({{0, 0, 0}}, m);
  MeshData out{Positions<double>(count * one.V.rows(), 3), Faces(count * one.F.rows(), 3)};
  for (int k = 0; k < count; ++k) {
    out.V.middleRows(k * one.V.rows(), one.V.rows()) = one.V;
    out.V.middleRows(k * one.V.rows(), one.V.rows()).rowwise() +=
        Eigen::RowVector3d(1.5 * (k % 20), 1.5 * (k / 20 % 20), 1.5 * (k / 400));
    out.F.middleRows(k * one.F.rows(), one.F.rows()) = one.F.array() + static_cast<Index>(k * one.V.rows());
  }
  return out;
}

}  // namespace

TEST_CASE(
    "parts with curved sides and creases: crosses follow every crease, and no singularity lies on a straight one") {
  const std::vector<test::Part> parts = test::curved_parts();
  CHECK(parts.size() >= 10);
  for (const test::Part& part : parts) {
    CAPTURE(part.name);
    const FieldRun run = along(part.surface);
    check_along(run);
    CHECK(index_sum_of(run) == 4 * run.topology().euler());
  }
}

TEST_CASE("some of these parts as designs that hold their features, with guidance, by either method") {
  for (const test::Part& part : test::curved_parts()) {
    if (part.name != "bent bar" && part.name != "washer" && part.name != "tapered block") continue;
    CAPTURE(part.name);
    const Surface surface(part.surface.V, part.surface.F);
    DesignFile design;
    design.n = 4;
    design.features = {.wanted = true, .hold = true};
    design.guidance.source = DesignGuidance::Source::smoothest;
    for (const DesignMethod method : {DesignMethod::variational, DesignMethod::eigen}) {
      design.method = method;
      const DesignRun run = run_design(surface, design);
      CHECK(run.certificate.holds());
      CHECK(run.met());
      CHECK(run.features->followed);
      CHECK(run.features->report.all.mean_degrees < 1);
      CHECK(run.features->report.all.worst_degrees < 10);
    }
  }
}

TEST_CASE("an assembly of thousands of parts: each is solved as if alone") {
  const int count = 2000;
  const MeshData assembly = cubes_apart(count, 2);
  const FieldRun run = along(assembly);
  CHECK(run.certificate.holds());
  CHECK(run.topology().components.size() == std::size_t{count});
  CHECK(run.index_sums.size() == std::size_t{count});
  for (const IndexSum& sum : run.index_sums) CHECK(sum.sum == 8);
  CHECK(run.features->graph.lines.size() == 12 * std::size_t{count});
  const FieldRun smooth = run_field(assembly.V, assembly.F, {.n = 4});
  CHECK(smooth.certificate.holds());
  CHECK(smooth.eigen.size() == std::size_t{count});
}

TEST_CASE("sheet metal: a thin plate with two sides, bent, holes and all") {
  const MeshData flat = test::extrude(test::plate_with_hole(0.3, 5, 8), 0.02, 1);
  const MeshData bent = test::deformed(flat, [](const Eigen::RowVector3d& p) -> Eigen::RowVector3d {
    if (p[0] < 0) return p;
    const double angle = p[0] * pi<double> / 2, r = 2 / pi<double> + p[2];  // a quarter circle
    return {r * std::sin(angle), p[1], r * std::cos(angle) - 2 / pi<double>};
  });
  for (const MeshData& sheet : {flat, bent}) {
    const FieldRun run = along(sheet);
    check_along(run);
    CHECK(index_sum_of(run) == 0);  // one hole through: a torus
  }
}

TEST_CASE("a lattice of bars: many holes through, every crease followed") {
  const MeshData lattice =
      test::blocks(test::cells(5, 5, 5, [](int i, int j, int k) { return i % 2 + j % 2 + k % 2 > 1; }), 4);
  const FieldRun run = along(lattice);
  check_along(run);
  // 27 knots and 54 bars: a graph with 28 loops.
  REQUIRE(run.topology().components.size() == 1);
  CHECK(run.topology().components[0].genus == 28);
  CHECK(index_sum_of(run) == 4 * (2 - 2 * 28));
}

TEST_CASE("terrain with holes where there are no data: corners that only touch are split, the rest is free") {
  const int size = 48;
  MeshData terrain = grid(size, size, 10, 10);
  std::mt19937 random(5);
  for (Eigen::Index v = 0; v < terrain.V.rows(); ++v)
    terrain.V(v, 2) = std::sin(terrain.V(v, 0)) + 0.3 * std::cos(2.3 * terrain.V(v, 1)) +
                      0.02 * static_cast<double>(random() % 100) / 100;
  // Squares without data, here and there and in patches, some of which touch at a corner.
  std::vector<char> gone(static_cast<std::size_t>(size * size), 0);
  for (int k = 0; k < 60; ++k) gone[random() % gone.size()] = 1;
  for (int i = 20; i < 27; ++i)
    for (int j = 10; j < 18; ++j) gone[static_cast<std::size_t>(i * size + j)] = 1;
  gone[static_cast<std::size_t>(27 * size + 18)] = 1;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index t = 0; t < terrain.F.rows(); ++t)
    if (gone[static_cast<std::size_t>(t / 2)] == 0) kept.push_back(t);
  Faces F(static_cast<Eigen::Index>(kept.size()), 3);
  for (std::size_t k = 0; k < kept.size(); ++k) F.row(static_cast<Eigen::Index>(k)) = terrain.F.row(kept[k]);
  terrain.F = F;
  const FieldRun run = run_field(terrain.V, terrain.F, {.n = 4});
  CHECK(run.certificate.holds());
  CHECK(run.topology().loops.size() > 40);
  CHECK(has_remark(run, "bow_ties_split"));
  CHECK(has_remark(run, "unreferenced_vertices"));
  CHECK_FALSE(run.copies_of.empty());
  const FieldRun rim = along(terrain);
  CHECK(rim.certificate.holds());
  CHECK(rim.features->report.all.mean_degrees < 5);
}

TEST_CASE("a scan with loose shells, one inside and turned: every piece has its field") {
  MeshData scan = noisy_scan(4, 0.05, 3);
  MeshData inner = icosphere(2);
  inner.V *= 0.3;
  inner.F.col(1).swap(inner.F.col(2));  // the inside of a shell
  scan = test::together(scan, inner);
  for (int k = 0; k < 12; ++k) {
    MeshData crumb = k % 2 == 0 ? icosphere(0) : tetrahedron();
    crumb.V *= 0.01;
    crumb.V.rowwise() += Eigen::RowVector3d(2 + 0.1 * k, 0, 0.05 * k);
    scan = test::together(scan, crumb);
  }
  const FieldRun run = run_field(scan.V, scan.F, {.n = 4});
  CHECK(run.certificate.holds());
  CHECK(run.topology().components.size() == 14);
  for (const IndexSum& sum : run.index_sums) CHECK(sum.sum == 8);
  // Shells that share a face are none: refused, and what helps is known.
  MeshData twice = scan;
  twice.F.conservativeResize(scan.F.rows() + 1, 3);
  twice.F.bottomRows(1) = scan.F.topRows(1);
  CHECK_THROWS_AS((void)run_field(twice.V, twice.F, {.n = 4}), MeshError);
  CHECK(run_field(twice.V, twice.F, {.n = 4, .repairs = {Repair::duplicates}}).certificate.holds());
}
