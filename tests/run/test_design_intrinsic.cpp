// SPDX-License-Identifier: MIT
//
// Designs that are solved on an intrinsic triangulation: what was asked on the mesh with slivers gives the field that
// the same gives on the mesh without.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "alcap/design_run.h"
#include "alcap/generators.h"
#include "src/base/parallel.h"
#include "tests/support/slivers.h"

using namespace alcap;

namespace {

const MeshData& clean() {
  static const MeshData mesh = bumpy_sphere(4, 0.2, 3);
  return mesh;
}

/// The same vertices, and more at slivers.
const Surface& bad() {
  static const MeshData mesh = test::with_slivers(clean(), 37, 1e-5);
  static const Surface surface(mesh.V, mesh.F);
  return surface;
}

const Surface& good() {
  static const Surface surface(clean().V, clean().F);
  return surface;
}

/// Mean cosine of n times the angle between them, over the vertices that both meshes have.
double agreement(const DesignRun& a, const DesignRun& b) {
  const int n = a.field.n;
  const Index shared = std::min(a.mesh().vertices(), b.mesh().vertices());
  const Positions<double> vectors = a.field.vectors(0);
  double sum = 0;
  for (Index v = 0; v < shared; ++v)
    sum += std::cos(n * std::arg(b.field.frames->component(v, vectors.row(v))) - std::arg(b.field.u[v]));
  return sum / shared;
}

/// Solves it on both meshes; returns the run with slivers, on better triangles.
DesignRun compared(const DesignFile& design, double least) {
  const DesignRun without = run_design(good(), design), with = run_design(bad(), design);
  CHECK_FALSE(without.triangulation);
  REQUIRE(with.triangulation);
  CHECK(with.triangulation->after.angle_min > 14.9 * pi<double> / 180);
  CHECK(with.certificate.holds());
  CHECK(with.field.u.size() == bad().mesh().vertices());
  CHECK(with.index_sums[0].sum == 2 * design.n);
  CHECK(agreement(without, with) > least);
  REQUIRE(with.outcomes.size() == without.outcomes.size());
  for (std::size_t k = 0; k < with.outcomes.size(); ++k) {
    CAPTURE(with.outcomes[k].path);
    CHECK(with.outcomes[k].met == without.outcomes[k].met);
    CHECK(with.outcomes[k].error_degrees < without.outcomes[k].error_degrees + 1);
  }
  return with;
}

DesignFile everything(DesignMethod method) {
  DesignFile design;
  design.n = 4;
  design.method = method;
  design.singularities = {
      {.at = Vector3{0.3, 0.2, 1}, .kind = SingularityKind::saddle, .angle = 20, .relative_to = Vector3{1, 0, 0}},
      {.at = Vector3{-1, 0.1, 0.2}, .angle = 5, .relative_to = Vector3{0, 1, 0}}};
  design.fixed = {{.vertex = 700, .direction = Vector3{0, 0.3, 1}, .free_length = method == DesignMethod::eigen}};
  design.strokes = {{.path = {{1, 0, 0}, {0.8, 0.5, 0.1}, {0.5, 0.8, 0.2}}}};
  return design;
}

}  // namespace

TEST_CASE("variational designs: singularities, pins, fixed vertices and strokes, near each kind of guidance") {
  DesignFile design = everything(DesignMethod::variational);
  design.singularities[1].pin = true;
  for (const auto source : {DesignGuidance::Source::zero, DesignGuidance::Source::curvature}) {
    CAPTURE(name(source));
    design.guidance.source = source;
    const DesignRun run = compared(design, 0.995);
    CHECK(run.outcomes[1].length_at_pin < 1e-6);
    if (source == DesignGuidance::Source::zero) continue;
    CHECK(run.guidance->size() == bad().mesh().vertices());
    CHECK(run.guidance_scale > 0);
  }
  design.strokes[0].radius = 0.2;
  compared(design, 0.995);
  const auto vertices = static_cast<std::size_t>(bad().mesh().vertices());
  design.guidance.weights = std::vector<double>(vertices, 2.0);
  CHECK(run_design(bad(), design).certificate.holds());
}

TEST_CASE("eigen designs: the same controls in the eigenproblem") {
  DesignFile design = everything(DesignMethod::eigen);
  const DesignRun run = compared(design, 0.995);
  CHECK(run.eigen.size() == 1);
  CHECK_FALSE(run.guidance);
  design.singularities[1].pin = true;
  design.strokes[0].radius = 0.2;
  design.guidance = {.source = DesignGuidance::Source::curvature, .weight = 2};
  const DesignRun guided = compared(design, 0.995);
  CHECK(guided.outcomes[1].length_at_pin < 1e-6);
  CHECK(guided.guidance->size() == bad().mesh().vertices());
  CHECK(guided.guidance_scale > 0);
  design.guidance.weights = std::vector<double>(static_cast<std::size_t>(bad().mesh().vertices()), 2.0);
  CHECK(run_design(bad(), design).certificate.holds());
}

TEST_CASE("a design with cones: they stay at their vertices") {
  DesignFile design;
  design.n = 4;
  design.connection.kind = ConnectionKind::trivial;
  for (Index v = 0; v < 8; ++v) design.connection.cones.push_back({v, 0.25});
  design.fixed = {{.vertex = 700, .direction = Vector3{0, 0.3, 1}}};
  const DesignRun run = compared(design, 0.995);
  CHECK(run.met());
  for (const DesignOutcome& outcome : run.outcomes)
    if (outcome.type == DesignOutcome::Type::cone) CHECK(outcome.cone_index == doctest::Approx(0.25));
}

TEST_CASE("crosses along the boundary of a plate with slivers are those of the axes") {
  const MeshData plate = test::with_slivers(grid(12, 9, 4, 3), 7, 1e-5);
  DesignFile design;
  design.n = 4;
  design.boundary.wanted = true;
  const DesignRun run = run_design({plate.V, plate.F}, design, {.triangulation = Triangulation::intrinsic});
  REQUIRE(run.triangulation);
  CHECK(run.met());
  CHECK(run.singularities.empty());
  const Positions<double> vectors = run.field.vectors(0);
  for (Index v = 0; v < run.mesh().vertices(); ++v)
    CHECK(std::abs(std::remainder(std::atan2(vectors(v, 1), vectors(v, 0)), pi<double> / 2)) < 1e-6);
}

TEST_CASE("sessions on a triangulation: edits give what fresh runs give; threads do not matter") {
  DesignFile design = everything(DesignMethod::variational);
  design.guidance.source = DesignGuidance::Source::smoothest;
  DesignSession session(bad());
  (void)session.solve(design);
  design.singularities[0].angle += 7;
  const DesignRun kept = session.solve(design), fresh = run_design(bad(), design, {.threads = 1});
  CHECK((kept.field.u - fresh.field.u).norm() < 1e-7 * fresh.field.u.norm());
  CHECK(run_design(bad(), design, {.threads = 3}).field.u == fresh.field.u);
  design.connection.kind = ConnectionKind::trivial;
  design.connection.balance = true;
  design.connection.holonomy = {};
  CHECK(session.solve(design).triangulation);
}

TEST_CASE("what belongs to the mesh's own triangles is refused by its name, or solved on them") {
  const MeshData mesh = test::with_slivers(torus(24, 12, 1, 0.4), 9, 1e-4);
  const Surface surface(mesh.V, mesh.F);
  DesignFile design;
  design.n = 4;
  design.connection.kind = ConnectionKind::trivial;
  design.connection.holonomy = {0.25, 0};
  design.guidance.source = DesignGuidance::Source::smoothest;
  try {
    (void)run_design(surface, design, {.triangulation = Triangulation::intrinsic});
    FAIL("not refused");
  } catch (const OptionError& e) {
    CHECK(e.field() == "triangulation");
  }
  CHECK_FALSE(run_design(surface, design).triangulation);
  CHECK_FALSE(run_design(good(), everything(DesignMethod::variational), {.triangulation = Triangulation::extrinsic})
                  .triangulation);
}
