// SPDX-License-Identifier: MIT
//
// Designs on flat surfaces and on several components: controls make systems with parallel fields regular, components
// without a control get their smoothest field, and the residual is that of everything that was solved.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>
#include <string>
#include <vector>

#include "alcap/alignment.h"
#include "alcap/connected_surface.h"
#include "alcap/design_run.h"
#include "alcap/designer.h"
#include "alcap/generators.h"
#include "alcap/smoothest.h"
#include "tests/support/mesh_families.h"

using namespace alcap;

namespace {

Surface surface_of(const MeshData& m) { return {m.V, m.F}; }

bool has(const DesignRun& run, const char* code) {
  return std::any_of(run.remarks.begin(), run.remarks.end(), [&](const Remark& r) { return r.code == code; });
}

std::vector<int> sorted_indices(const DesignRun& run) {
  std::vector<int> indices;
  for (const Singularity& s : run.singularities) indices.push_back(s.index);
  std::sort(indices.begin(), indices.end());
  return indices;
}

/// A regular polygon around the origin, in rings.
MeshData polygon(int sides, int rings) {
  const int around = sides * 4;
  MeshData m{Positions<double>(1 + around * rings, 3), Faces(around * (2 * rings - 1), 3)};
  m.V.row(0).setZero();
  Eigen::Index face = 0;
  for (int r = 1; r <= rings; ++r)
    for (int k = 0; k < around; ++k) {
      const int corner = k / 4;
      const double f = (k % 4) / 4.0, a = 2 * pi<double> * corner / sides, b = 2 * pi<double> * (corner + 1) / sides;
      const double x = (1 - f) * std::cos(a) + f * std::cos(b), y = (1 - f) * std::sin(a) + f * std::sin(b);
      m.V.row(1 + (r - 1) * around + k) << x * r / rings, y * r / rings, 0;
      const Index here = 1 + (r - 1) * around + k, next = 1 + (r - 1) * around + (k + 1) % around;
      if (r == 1) {
        m.F.row(face++) << 0, here, next;
        continue;
      }
      m.F.row(face++) << here - around, here, next;
      m.F.row(face++) << here - around, next, next - around;
    }
  return m;
}

DesignFile plain(int n) {
  DesignFile design;
  design.n = n;
  return design;
}

}  // namespace

TEST_CASE("a fixed vertex or a stroke decides which parallel field a flat surface has") {
  for (const MeshData& m : {grid(7, 5, 3, 2), disk(4), cylinder(16, 6)})
    for (const int n : {1, 4}) {
      CAPTURE(n);
      const Surface surface = surface_of(m);
      DesignFile design = plain(n);
      design.fixed = {{.vertex = 0, .direction = Vector3{0.6, 0.3, 0.7}}};
      const DesignRun run = run_design(surface, design);
      CHECK(run.certificate.holds());
      CHECK(run.residual > 0);
      CHECK(run.residual < 1e-8);
      CHECK(run.singularities.empty());
      // Parallel: of one length, to the little that makes the system regular.
      const auto lengths = run.field.u.cwiseAbs();
      CHECK(lengths.maxCoeff() / lengths.minCoeff() == doctest::Approx(1).epsilon(1e-6));
    }
}

TEST_CASE("crosses along the boundary of flat pieces have the singularities that their corners leave") {
  const auto along_boundary = [](const MeshData& m) {
    DesignFile design = plain(4);
    design.boundary.wanted = true;
    return run_design(surface_of(m), design);
  };
  struct Case {
    const char* name;
    MeshData mesh;
    std::vector<int> indices;
  };
  for (const auto& [name, mesh, indices] :
       {Case{"triangle", polygon(3, 8), {1}}, Case{"square", grid(8, 8), {}}, Case{"pentagon", polygon(5, 8), {-1}},
        Case{"hexagon", polygon(6, 12), {-1, -1}}, Case{"cylinder", cylinder(16, 6), {}}}) {
    const std::string shown = name;
    CAPTURE(shown);
    const DesignRun run = along_boundary(mesh);
    CHECK(run.certificate.holds());
    CHECK(run.residual > 0);
    CHECK(sorted_indices(run) == indices);
  }
  // On a round disk one linear solve gives r^4 turned four times: a zero of index 4/4 in the middle, which breaks up as
  // the mesh is. Renormalised and diffused its four zeros move apart.
  const DesignRun round = along_boundary(disk(24));
  CHECK(round.certificate.holds());
  CHECK(sorted_indices(round) == std::vector<int>{1, 1, 1, 1});
  for (const Singularity& s : round.singularities) {
    const double radius = position(round.surface, s).norm();
    CHECK(radius > 0.55);
    CHECK(radius < 0.95);  // edges are 0.04 long
  }
  // Directions at vertices go with it; targets make it a linear design as before.
  DesignFile design = plain(4);
  design.boundary.wanted = true;
  design.fixed = {{.vertex = 0, .angle = 20, .free_length = true}};
  const DesignRun turned = run_design(surface_of(disk(24)), design);
  CHECK(turned.met());
  CHECK(turned.outcomes[0].error_degrees < 0.5);
  CHECK(turned.certificate.holds());
}

TEST_CASE("targets alone on a flat component are refused; beside it they are solved") {
  const MeshData plate = grid(5, 4), both = test::together(icosphere(2), plate);
  DesignFile design = plain(4);
  design.singularities = {{.face = 12, .kind = SingularityKind::source},
                          {.face = 200, .kind = SingularityKind::saddle, .angle = 30}};
  DesignFile flat = plain(4);
  flat.singularities = {{.face = 3}};
  CHECK_THROWS_AS((void)run_design(surface_of(plate), flat), OptionError);

  const DesignRun run = run_design(surface_of(both), design);
  CHECK(run.certificate.holds());
  CHECK(has(run, "pieces_without_control"));
  // The plate has a parallel field, and the sphere what it has on its own.
  const Index sphere = static_cast<Index>(icosphere(2).F.rows());
  for (const Singularity& s : run.singularities) CHECK(s.face < sphere);
  const DesignRun alone = run_design(surface_of(icosphere(2)), design);
  CHECK(alone.singularities.size() == run.singularities.size());
  CHECK(run.field.u.cwiseAbs().minCoeff() > 0);
  flat.singularities[0].face = sphere + 3;
  CHECK_THROWS_AS((void)run_design(surface_of(both), flat), OptionError);
}

TEST_CASE("components without a control have their smoothest field, in sessions too") {
  const MeshData both = test::together(icosphere(3), bumpy_sphere(3, 0.2, 4));
  const Surface surface = surface_of(both);
  const Index first = static_cast<Index>(icosphere(3).F.rows()), vertices = static_cast<Index>(icosphere(3).V.rows());
  DesignSession session(surface);
  for (const Index face : {12, 300}) {
    DesignFile design = plain(4);
    design.singularities = {{.face = face}, {.face = 900, .kind = SingularityKind::saddle, .angle = 30}};
    const DesignRun run = session.solve(design);
    CHECK(run.certificate.holds());
    CHECK(has(run, "pieces_without_control"));
    const Field smooth = smoothest_field(run.surface, {.n = 4}).field;
    const auto here = run.field.u.tail(run.field.u.size() - vertices), there = smooth.u.tail(here.size());
    const double cosine = std::abs(here.dot(there)) / (here.norm() * there.norm());
    CHECK(cosine == doctest::Approx(1).epsilon(1e-6));
    std::int64_t count = 0;
    for (const Singularity& s : run.singularities) count += s.face >= first;
    CHECK(count < 40);
  }
  // A control there, or guidance, and there is nothing to fill.
  DesignFile design = plain(4);
  design.singularities = {{.face = 12}, {.face = first + 5}};
  CHECK(!has(session.solve(design), "pieces_without_control"));
  design.singularities.pop_back();
  design.guidance.source = DesignGuidance::Source::smoothest;
  CHECK(!has(session.solve(design), "pieces_without_control"));
}

TEST_CASE("the residual is that of the rows too, and fields that fade to rounding are told") {
  const Surface surface = surface_of(icosphere(3));
  for (const auto source : {DesignGuidance::Source::nothing, DesignGuidance::Source::zero}) {
    DesignFile design = plain(4);
    design.guidance.source = source;
    design.fixed = {{.vertex = 100, .direction = Vector3{0.3, 1, 0.2}}};
    DesignRun run = run_design(surface, design);
    CHECK(run.residual > 0);
    CHECK(run.certificate.residual_small);
    design.fixed.clear();
    design.strokes = {{.vertices = {0, 5}}};
    run = run_design(surface, design);
    CHECK(run.residual > 0);
    CHECK(run.certificate.residual_small);
  }
  DesignFile design = plain(4);
  design.guidance.source = DesignGuidance::Source::zero;
  design.guidance.weight = 300;
  design.fixed = {{.vertex = 100, .direction = Vector3{0.3, 1, 0.2}}};
  CHECK(has(run_design(surface_of(icosphere(4)), design), "field_vanishes"));
  design.guidance.weight = 1;
  CHECK(!has(run_design(surface, design), "field_vanishes"));
}

TEST_CASE("targets in faces that share a vertex are told to be too close") {
  const Surface surface = surface_of(icosphere(3));
  const Index other = Mesh::face(surface.mesh().twin(3 * 100));
  DesignFile design = plain(1);
  design.singularities = {{.face = 100, .kind = SingularityKind::source},
                          {.face = other, .kind = SingularityKind::saddle}};
  const DesignRun run = run_design(surface, design);
  const bool met = run.met();
  const bool told = std::any_of(run.remarks.begin(), run.remarks.end(), [](const Remark& r) {
    return r.code == "control_not_met" && r.message.find("too close") != std::string::npos;
  });
  CHECK((met || told));
}

TEST_CASE("curvature guidance has a sign, and one by magnitude has none") {
  MeshData out = cylinder(24, 8, 1, 4), in = out;
  in.F.col(1).swap(in.F.col(2));
  const auto around = [](const MeshData& m, const CurvatureOptions& options) {
    const ConnectedSurface s = connect(surface_of(m));
    const Field field = curvature_field(s, options);
    const Positions<double> d = field.vectors(0);
    double along = 0, across = 0;
    for (Index v = 0; v < s.mesh().vertices(); ++v) {
      along += std::abs(d(v, 2));
      across += std::hypot(d(v, 0), d(v, 1));
    }
    return across > along;
  };
  CHECK(around(out, {.n = 2}));
  CHECK(!around(in, {.n = 2}));
  CHECK(around(out, {.n = 2, .by_magnitude = true}));
  CHECK(around(in, {.n = 2, .by_magnitude = true}));
  CHECK(!around(in, {.n = 2, .smallest = true, .by_magnitude = true}));
}

TEST_CASE("eigen designs take the boundary and fixed directions") {
  DesignFile design = plain(4);
  design.method = DesignMethod::eigen;
  design.boundary = {.wanted = true, .normal = false, .weight = 1};
  const DesignRun square = run_design(surface_of(grid(10, 10)), design);
  CHECK(square.certificate.holds());
  CHECK(square.met());
  CHECK(square.singularities.empty());
  const DesignRun ring = run_design(surface_of(cylinder(20, 8)), design);
  CHECK(ring.met());
  CHECK(ring.outcomes.size() == 1);
  design.n = 1;
  design.boundary.normal = true;
  design.fixed = {{.vertex = 85, .angle = 90, .free_length = true}};
  const DesignRun across = run_design(surface_of(cylinder(20, 8)), design);
  REQUIRE(across.outcomes.size() == 2);
  CHECK(across.outcomes[0].type == DesignOutcome::Type::fixed);
  CHECK(across.outcomes[1].type == DesignOutcome::Type::boundary);
  design.boundary = {};
  const DesignRun fixed = run_design(surface_of(icosphere(3)), design);
  CHECK(fixed.met());
  design.boundary.wanted = true;
  CHECK_THROWS_AS((void)run_design(surface_of(icosphere(2)), design), OptionError);
}
