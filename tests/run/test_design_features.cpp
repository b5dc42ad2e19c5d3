// SPDX-License-Identifier: MIT
//
// Features in design runs: held and drawn, along and across, by angle and by a file, by both methods and in sessions.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "alcap/design_run.h"
#include "alcap/generators.h"
#include "alcap/output.h"
#include "tests/support/folder.h"
#include "tests/support/parts.h"

using namespace alcap;

namespace {

constexpr auto in_features = DesignOutcome::Type::features;

Surface box_surface() {
  const MeshData box = test::blocks(test::cells(3, 2, 1, [](int, int, int) { return false; }), 4);
  return {box.V, box.F};
}

DesignFile held_design(DesignMethod method) {
  DesignFile design;
  design.n = 4;
  design.method = method;
  design.features = {.wanted = true, .hold = true};
  return design;
}

bool says(const DesignRun& run, const std::string& code) {
  return std::any_of(run.remarks.begin(), run.remarks.end(), [&](const Remark& r) { return r.code == code; });
}

/// Of held vertices, in radians.
double worst_at_vertices(const DesignRun& run, bool across) {
  double worst = 0;
  for (const VertexConstraint& held : feature_directions(run.surface, run.features->graph, run.field.n, across).held)
    worst = std::max(worst, std::abs(std::arg(run.field.u[held.vertex] * std::conj(held.value))) / run.field.n);
  return worst;
}

}  // namespace

TEST_CASE("held features in design runs: exact, judged as one control, with deviations per line") {
  const Surface surface = box_surface();
  for (const DesignMethod method : {DesignMethod::variational, DesignMethod::eigen})
    for (const int n : {2, 4})
      for (const bool across : {false, true})
        for (const bool guided : {false, true}) {
          CAPTURE(static_cast<int>(method));
          CAPTURE(n);
          CAPTURE(across);
          CAPTURE(guided);
          DesignFile design = held_design(method);
          design.n = n;
          design.features.across = across;
          if (guided) design.guidance.source = DesignGuidance::Source::smoothest;
          const DesignRun run = run_design(surface, design);
          CHECK(run.certificate.holds());
          CHECK(run.met());
          REQUIRE(run.outcomes.size() == 1);
          CHECK(run.outcomes[0].type == in_features);
          CHECK(run.outcomes[0].path == "/features");
          REQUIRE(run.features);
          CHECK(run.features->graph.lines.size() == 12);
          CHECK(run.features->report.lines.size() == 12);
          CHECK(run.features->report.all.mean_degrees < 0.5);
          CHECK(run.outcomes[0].error_degrees == doctest::Approx(run.features->report.all.mean_degrees).scale(1));
          CHECK(run.features->followed);
          CHECK(run.features->free_corners.size() == 8);
          CHECK(says(run, "free_corners"));
          CHECK(worst_at_vertices(run, across) < 1e-12);
          // Alone they are solved for as an aligned field is.
          const bool alone = method == DesignMethod::variational && !guided;
          CHECK(run.features->pieces.size() == (alone ? 1 : 0));
        }
}

TEST_CASE("features alone that are held give the field of a run along them") {
  const Surface surface = box_surface();
  const DesignRun design = run_design(surface, held_design(DesignMethod::variational));
  const FieldRun field = run_field(surface, {.n = 4, .align = FieldAlignment{.features = {.boundary = false}}});
  CHECK(design.field.u == field.field.u);
}

TEST_CASE("features that are drawn are strokes, as they were; across they are a control of their own") {
  const Surface surface = box_surface();
  DesignFile design = held_design(DesignMethod::variational);
  design.n = 2;
  design.guidance.source = DesignGuidance::Source::smoothest;
  design.features = {.wanted = true, .weight = 20};
  const DesignRun drawn = run_design(surface, design);
  CHECK(drawn.outcomes.size() == 12);
  CHECK(drawn.outcomes[0].type == DesignOutcome::Type::stroke);
  REQUIRE(drawn.features);
  CHECK(drawn.features->report.all.mean_degrees < 10);
  CHECK_FALSE(says(drawn, "free_corners"));
  DesignFile strokes = design;
  strokes.features = {};
  strokes.strokes = feature_strokes(sharp_edges(surface), 20);
  CHECK(run_design(surface, strokes).field.u == drawn.field.u);
  design.features.across = true;
  const DesignRun across = run_design(surface, design);
  REQUIRE(across.outcomes.size() == 1);
  CHECK(across.outcomes[0].type == in_features);
  CHECK(across.features->report.all.mean_degrees < 10);
  const FeatureReport along =
      measure_features(across.surface, across.field, across.features->graph, across.singularities);
  CHECK(along.all.mean_degrees > 80);
}

TEST_CASE("features by angle, by a list of edges and by files are the same") {
  const Surface surface = box_surface();
  const test::Folder folder;
  const FeatureGraph creases = sharp_edges(surface);
  write_sharp(surface, creases, folder.path / "box.sharp");
  DesignFile design = held_design(DesignMethod::eigen);
  const DesignRun by_angle = run_design(surface, design);
  design.features = {.wanted = true, .hold = true, .file = folder.path / "box.sharp"};
  CHECK(run_design(surface, design).field.u == by_angle.field.u);
  design.features = {.wanted = true, .hold = true};
  for (const Index e : creases.edges) {
    const Index h = surface.mesh().halfedge(e);
    design.features.edges.push_back({surface.mesh().tip(h), surface.mesh().tail(h)});
  }
  CHECK(run_design(surface, design).field.u == by_angle.field.u);
  design.features.edges = {{0, 0}};
  CHECK_THROWS_AS((void)run_design(surface, design), OptionError);
  design.features = {.wanted = true, .hold = true, .file = folder.path / "none.sharp"};
  CHECK_THROWS_AS((void)run_design(surface, design), FileError);
}

TEST_CASE("gaps are closed and spurs removed where the design says so, of edges that are listed as well") {
  const Surface surface = box_surface();
  const Mesh& mesh = surface.mesh();
  DesignFile design = held_design(DesignMethod::variational);
  const FeatureGraph creases = sharp_edges(surface);
  // Without the edges in the middle of the longest lines.
  std::size_t left_out = 0;
  std::vector<Index> skip;
  for (const FeatureLine& line : creases.lines)
    if (line.edges.size() == 12) skip.push_back(line.edges[5]);
  for (const Index e : creases.edges) {
    if (std::find(skip.begin(), skip.end(), e) != skip.end()) {
      ++left_out;
      continue;
    }
    design.features.edges.push_back({mesh.tail(mesh.halfedge(e)), mesh.tip(mesh.halfedge(e))});
  }
  REQUIRE(left_out == 4);
  CHECK(run_design(surface, design).features->graph.edges.size() == creases.edges.size() - 4);
  design.features.gap = 0.3;
  CHECK(run_design(surface, design).features->graph.edges == creases.edges);
  // One edge that goes off into a face.
  design.features.gap = 0;
  design.features.edges.clear();
  for (const Index e : creases.edges)
    design.features.edges.push_back({mesh.tail(mesh.halfedge(e)), mesh.tip(mesh.halfedge(e))});
  Index off = 0;
  const auto feature = [&](Index v) { return creases.vertices[static_cast<std::size_t>(v)] != FeatureVertex::smooth; };
  while (feature(mesh.tail(mesh.halfedge(off))) == feature(mesh.tip(mesh.halfedge(off)))) ++off;
  design.features.edges.push_back({mesh.tail(mesh.halfedge(off)), mesh.tip(mesh.halfedge(off))});
  CHECK(run_design(surface, design).features->graph.edges.size() == creases.edges.size() + 1);
  design.features.spur = 0.5;
  CHECK(run_design(surface, design).features->graph.edges == creases.edges);
}

TEST_CASE("a session goes from one kind of features to another as fresh runs do") {
  const Surface surface = box_surface();
  DesignSession session(surface);
  DesignFile design = held_design(DesignMethod::variational);
  design.guidance.source = DesignGuidance::Source::smoothest;
  design.singularities = {{.face = 3, .kind = SingularityKind::saddle}};
  const auto check = [&](const char* what) {
    CAPTURE(what);
    const DesignRun kept = session.solve(design), fresh = run_design(surface, design);
    CHECK((kept.field.u - fresh.field.u).norm() < 1e-7 * fresh.field.u.norm());
    CHECK(kept.outcomes.size() == fresh.outcomes.size());
  };
  check("held");
  design.features.weight = 10;
  check("another weight");
  design.features.hold = false;
  check("drawn");
  design.features.across = true;
  check("across");
  design.features = {};
  check("none");
  design.features = {.wanted = true, .angle = 170, .hold = true};
  check("none found");
  CHECK(says(session.solve(design), "no_features"));
  design.features.angle = 40;
  check("held again");
}

TEST_CASE("a mesh of needles keeps its features where the design is solved on better triangles") {
  // A bar whose long sides are cut into thin strips.
  const MeshData bar = test::prism({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 16, 10, 2);
  const Surface surface(bar.V, bar.F);
  for (const DesignMethod method : {DesignMethod::variational, DesignMethod::eigen})
    for (const bool guided : {false, true}) {
      DesignFile design = held_design(method);
      if (guided) design.guidance.source = DesignGuidance::Source::smoothest;
      const DesignRun run = run_design(surface, design, {.triangulation = Triangulation::intrinsic});
      CHECK(run.triangulation.has_value());
      CHECK(run.met());
      CHECK(run.features->report.all.mean_degrees < 1);
      CHECK(run.features->report.all.worst_degrees < 5);
    }
}
