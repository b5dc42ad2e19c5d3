// SPDX-License-Identifier: MIT
//
// Runs of designs and sessions of them: a session's edits give what fresh runs give, what was kept costs no solve, and
// what is wrong is named by its place in the design.
#include "alcap/design_run.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "alcap/alignment.h"
#include "alcap/designer.h"
#include "alcap/eigen_design.h"
#include "alcap/generators.h"
#include "alcap/smoothest.h"
#include "tests/io/output_fixture.h"

using namespace alcap;

namespace {

Surface ball() {
  const MeshData s = bumpy_sphere(3, 0.2, 3);
  return {s.V, s.F};
}

DesignFile crosses() {
  DesignFile design;
  design.n = 4;
  design.guidance.source = DesignGuidance::Source::smoothest;
  design.singularities = {{.face = 100, .kind = SingularityKind::saddle, .angle = 20}, {.face = 700}};
  return design;
}

double relative(const Field& a, const Field& b) { return (a.u - b.u).norm() / b.u.norm(); }

template <class Call>
std::string field_of(Call&& call) {
  try {
    call();
  } catch (const OptionError& e) {
    return e.field();
  }
  return "nothing was thrown";
}

}  // namespace

TEST_CASE("a session's edits give the fields of fresh runs") {
  const Surface surface = ball();
  DesignSession session(surface);
  DesignFile design = crosses();
  const auto check = [&](const char* edit) {
    CAPTURE(edit);
    const DesignRun kept = session.solve(design), fresh = run_design(surface, design);
    CHECK(relative(kept.field, fresh.field) < 1e-7);
    CHECK(kept.indices == fresh.indices);
    REQUIRE(kept.outcomes.size() == fresh.outcomes.size());
    for (std::size_t k = 0; k < kept.outcomes.size(); ++k) {
      CHECK(kept.outcomes[k].path == fresh.outcomes[k].path);
      CHECK(kept.outcomes[k].met == fresh.outcomes[k].met);
      CHECK(kept.outcomes[k].error_degrees == doctest::Approx(fresh.outcomes[k].error_degrees).epsilon(1e-4));
    }
    CHECK(kept.certificate.holds() == fresh.certificate.holds());
    return kept;
  };
  check("the first");
  design.singularities[0].angle = 35;
  (void)check("a target is turned");
  design.singularities[0].angle = 50;
  CHECK(check("and again").solves == 0);  // it keeps a solution of its own
  design.fixed = {{.vertex = 17, .direction = Vector3{1, 0.2, 0.1}}};
  check("a vertex is fixed");
  design.singularities.erase(design.singularities.begin());
  check("the first control goes");
  design.strokes = {{.vertices = {3, 200}, .weight = 2}};
  check("a stroke comes");
  design.guidance.weight = 0.3;
  check("another weight");
  design.guidance.source = DesignGuidance::Source::curvature;
  check("another guidance");
  design.connection.kind = ConnectionKind::polar;
  check("another connection");
  design.n = 2;
  check("another degree");
  design.connection.kind = ConnectionKind::trivial;
  design.connection.balance = true;
  const DesignRun flat = check("a trivial connection");
  CHECK(flat.design.connection.cones.size() == 4);
  CHECK(flat.outcomes.back().type == DesignOutcome::Type::cone);
  CHECK(flat.outcomes.back().met);
  CHECK_FALSE(flat.design.connection.balance);
  design.method = DesignMethod::eigen;
  design.guidance = {};
  design.fixed.clear();
  check("the other method");
  design.singularities[0].pin = true;
  design.guidance = {.source = DesignGuidance::Source::curvature, .weight = 2};
  const DesignRun pinned = check("with guidance and a pin");
  CHECK(pinned.outcomes[0].length_at_pin < 1e-9);
  CHECK(pinned.guidance);
  design.singularities[0].pin = false;
  design.method = DesignMethod::variational;
  check("and the first method again");
  design = crosses();
  check("everything as at first");
}

TEST_CASE("handles of a run outlive the session, and unchanged parts are shared") {
  DesignRun first, second;
  {
    DesignSession session(ball());
    DesignFile design = crosses();
    first = session.solve(design);
    design.singularities[1].strength = 2;
    second = session.solve(design);
  }
  CHECK(&first.connection() == &second.connection());
  CHECK(first.guidance == second.guidance);
  CHECK(first.field.frames == second.field.frames);
  CHECK(first.mesh().vertices() == 642);
}

TEST_CASE("a design that asks for nothing gets the smoothest field, of unit size") {
  const Surface surface = ball();
  DesignFile nothing;
  nothing.n = 4;
  const DesignRun run = run_design(surface, nothing);
  CHECK(run.outcomes.empty());
  CHECK(run.certificate.holds());
  CHECK(root_mean_square(surface, run.field.u) == doctest::Approx(1));
  const Field smooth = smoothest_field(run.surface, {.n = 4}).field;
  CHECK((run.field.u - run.guidance_scale * smooth.u).norm() < 1e-12 * run.field.u.norm());
}

TEST_CASE("the guidance that was used is told: its size is one, whatever the file's") {
  const test::Folder folder;
  const Surface surface = ball();
  const DesignRun made = run_design(surface, crosses());
  Field scaled = made.field;
  scaled.u *= 37;
  const auto path = folder.path / "f.ply";
  (void)write_field({.surface = made.surface, .field = scaled, .singularities = made.singularities}, path);
  DesignFile again;
  again.n = 4;
  again.guidance = {.source = DesignGuidance::Source::file, .file = path, .weight = 1e6};
  again.fixed = {{.vertex = 5, .angle = 10.0}};
  const DesignRun run = run_design(surface, again);
  REQUIRE(run.guidance);
  CHECK(root_mean_square(surface, *run.guidance) == doctest::Approx(1));
  CHECK(run.guidance_scale == doctest::Approx(1 / root_mean_square(surface, scaled.u)));
  CHECK((*run.guidance - run.guidance_scale * scaled.u).norm() < 1e-12 * run.guidance->norm());

  const auto refused = [&](const Surface& on, const char* why) {
    CHECK_THROWS_WITH_AS((void)run_design(on, again), doctest::Contains(why), FileError);
  };
  again.n = 2;
  refused(surface, "f.ply: holds a field of n = 4, and the design has n = 2");
  again.n = 4;
  refused(Surface(icosphere(2).V, icosphere(2).F), "f.ply: holds a field on another mesh");
  scaled.u.setZero();
  (void)write_field({.surface = made.surface, .field = scaled}, path);
  refused(surface, "f.ply: the field is zero or not finite everywhere");
}

TEST_CASE("what is wrong is named by its place in the design, and a session goes on after it") {
  const Surface surface = ball();
  DesignSession session(surface);
  const DesignRun before = session.solve(crosses());
  DesignFile bad = crosses();
  bad.singularities[1].face = 1280;
  CHECK(field_of([&] { (void)session.solve(bad); }) == "/singularities/1/face");
  bad = crosses();
  bad.fixed = {{.vertex = 3, .direction = Vector3{0, 0, 1}}, {.vertex = 3, .at = Vector3{0, 0, 1}, .angle = 0.0}};
  CHECK(field_of([&] { (void)session.solve(bad); }) == "/fixed/1");
  bad = crosses();
  bad.n = 1;  // principal directions are lines
  bad.guidance.source = DesignGuidance::Source::curvature;
  CHECK_THROWS_AS((void)session.solve(bad), OptionError);
  DesignFile round;
  round.n = 4;
  round.guidance.source = DesignGuidance::Source::curvature;
  const MeshData plane = grid(8, 8);
  CHECK(field_of([&] { (void)run_design(Surface(plane.V, plane.F), round); }) == "/guidance/field");
  DesignFile cones = crosses();
  cones.connection = {.kind = ConnectionKind::trivial, .cones = {{0, 0.25}}};
  CHECK_THROWS_AS((void)session.solve(cones), OptionError);
  const DesignRun after = session.solve(crosses());
  CHECK(relative(after.field, before.field) < 1e-10);
  CHECK(field_of([&] { (void)run_design(surface, crosses(), {.threads = -1}); }) == "threads");
  // A certificate that accepts anything is none.
  for (const double residual : {0.0, -1.0, 1.0, 1e300, std::numeric_limits<double>::infinity(), std::nan("")})
    CHECK(field_of([&] { (void)run_design(surface, crosses(), {.residual = residual}); }) == "residual");
}

TEST_CASE("phases are told in order, and an exception thrown from one leaves the session usable") {
  std::vector<std::string> phases;
  bool stop = false;
  DesignSession session(ball(), {.progress = [&](std::string_view phase) {
                          phases.emplace_back(phase);
                          if (stop && phase == "solve") throw std::runtime_error("stop");
                        }});
  const DesignRun before = session.solve(crosses());
  CHECK(phases == std::vector<std::string>{"connection", "guidance", "prepare", "solve", "analysis"});
  stop = true;
  CHECK_THROWS_AS((void)session.solve(crosses()), std::runtime_error);
  stop = false;
  CHECK(relative(session.solve(crosses()).field, before.field) < 1e-10);
}

TEST_CASE("a plan is what is solved: points of space become elements, and balancing adds its cones") {
  const Surface surface = ball();
  DesignFile design;
  design.n = 4;
  design.singularities = {{.at = Vector3{0, 0, 1.1}}};
  design.connection = {.kind = ConnectionKind::trivial, .balance = true};
  design.guidance.source = DesignGuidance::Source::zero;
  const DesignFile plan = plan_design(design, surface);
  const DesignRun run = run_design(surface, design);
  CHECK(plan.singularities[0].face == run.design.singularities[0].face);
  CHECK_FALSE(plan.singularities[0].at.has_value());
  REQUIRE(plan.connection.cones.size() == 8);
  REQUIRE(run.design.connection.cones.size() == 8);
  for (std::size_t k = 0; k < 8; ++k) CHECK(plan.connection.cones[k].vertex == run.design.connection.cones[k].vertex);
}

namespace {

using Type = DesignOutcome::Type;

/// The outcomes of a type, with one tolerance set and all others as they are.
std::vector<DesignOutcome> outcomes_within(const Surface& surface, const DesignFile& design, Type type,
                                           double ControlTolerances::*kind, double tolerance) {
  DesignRunOptions options;
  options.tolerances.*kind = tolerance;
  std::vector<DesignOutcome> found;
  for (DesignOutcome& o : run_design(surface, design, options).outcomes)
    if (o.type == type) found.push_back(std::move(o));
  return found;
}

/// What is off by more than rounding is met within a little more than that, and not within a little less.
void check_decides(const Surface& surface, const DesignFile& design, Type type, double ControlTolerances::*kind) {
  const std::vector<DesignOutcome> usual = outcomes_within(surface, design, type, kind, ControlTolerances{}.*kind);
  int tried = 0;
  for (std::size_t k = 0; k < usual.size(); ++k) {
    CAPTURE(usual[k].path);
    const double error = usual[k].error_degrees;
    CHECK(usual[k].tolerance_degrees == ControlTolerances{}.*kind);
    if (!(error > 0)) continue;
    ++tried;
    const DesignOutcome looser = outcomes_within(surface, design, type, kind, 1.01 * error)[k];
    const DesignOutcome tighter = outcomes_within(surface, design, type, kind, 0.99 * error)[k];
    CHECK(looser.error_degrees == error);
    CHECK(looser.tolerance_degrees == 1.01 * error);
    CHECK(looser.met);
    CHECK_FALSE(tighter.met);
  }
  CHECK(tried > 0);
}

}  // namespace

TEST_CASE("a control is met within the tolerance of its kind, by both methods, and the field is the same") {
  using T = ControlTolerances;
  const MeshData flat = disk(6);
  const Surface surface = ball(), plate(flat.V, flat.F);
  DesignFile design = crosses();
  design.strokes = {{.vertices = {0, 30}, .weight = 0.1}};
  check_decides(surface, design, Type::singularity, &T::singularity_degrees);
  check_decides(surface, design, Type::stroke, &T::stroke_degrees);
  design.connection = {.kind = ConnectionKind::trivial, .balance = true};
  check_decides(surface, design, Type::cone, &T::cone_degrees);

  DesignFile edge;
  edge.n = 4;
  edge.fixed = {{.vertex = 0, .angle = 20, .free_length = true}};
  edge.boundary.wanted = true;
  check_decides(plate, edge, Type::boundary, &T::boundary_degrees);  // as an aligned field
  edge.guidance.source = DesignGuidance::Source::zero;
  check_decides(plate, edge, Type::boundary, &T::boundary_degrees);
  edge.guidance = {};
  edge.method = DesignMethod::eigen;
  edge.singularities = {{.face = 40, .angle = 10}};
  edge.strokes = {{.vertices = {1, 20}}};
  check_decides(plate, edge, Type::boundary, &T::boundary_degrees);
  check_decides(plate, edge, Type::stroke, &T::stroke_degrees);
  check_decides(plate, edge, Type::fixed, &T::fixed_degrees);
  check_decides(plate, edge, Type::singularity, &T::singularity_degrees);

  const DesignRun loose = run_design(surface, crosses(), {.tolerances = {.singularity_degrees = 180}});
  CHECK((loose.field.u == run_design(surface, crosses()).field.u));
}

TEST_CASE("tolerances out of their range are named, wherever they are given") {
  const Surface surface = ball();
  const ConnectedSurface connected = connect(surface, {});
  const auto refused = [&](const ControlTolerances& tolerances, const char* field, const char* value,
                           const char* rule) {
    const auto check = [&](auto&& call) {
      try {
        call();
        FAIL("nothing was thrown");
      } catch (const OptionError& e) {
        CHECK(e.field() == std::string(field));
        CHECK(e.value() == value);
        CHECK(e.rule() == std::string(rule));
      }
    };
    check([&] { (void)run_design(surface, crosses(), {.tolerances = tolerances}); });
    check([&] { (void)DesignSession(surface, {.tolerances = tolerances}); });
    check([&] { (void)Designer(connected, {.guidance_weight = 1, .tolerances = tolerances}); });
    check([&] { (void)eigen_design(connected, {}, {.tolerances = tolerances}); });
  };
  const char *const degrees = "must be in (0, 180], degrees", *const relative_rule = "must be in (0, 1]";
  refused({.singularity_degrees = 0}, "tolerances.singularity_degrees", "0", degrees);
  refused({.fixed_degrees = -1}, "tolerances.fixed_degrees", "-1", degrees);
  refused({.stroke_degrees = 181}, "tolerances.stroke_degrees", "181", degrees);
  refused({.boundary_degrees = std::nan("")}, "tolerances.boundary_degrees", "nan", degrees);
  refused({.cone_degrees = std::numeric_limits<double>::infinity()}, "tolerances.cone_degrees", "infinity", degrees);
  refused({.fixed_value = 2}, "tolerances.fixed_value", "2", relative_rule);
  refused({.pin_length = 0}, "tolerances.pin_length", "0", relative_rule);
}

TEST_CASE("pins, and vertices with a length, are met within relative tolerances, which outcomes tell") {
  const Surface surface = ball();
  DesignFile design = crosses();
  design.singularities[1].pin = true;
  design.fixed = {{.vertex = 5, .angle = 10, .length = 2}, {.vertex = 400, .angle = 0, .free_length = true}};
  DesignRunOptions options;
  options.tolerances.pin_length = 1e-300;
  options.tolerances.fixed_value = 1e-300;
  const DesignRun usual = run_design(surface, design), exact = run_design(surface, design, options);
  CHECK_FALSE(usual.outcomes[0].tolerance_relative);
  CHECK(usual.outcomes[1].tolerance_relative == 1e-6);
  CHECK(usual.outcomes[2].tolerance_relative == 1e-6);
  CHECK_FALSE(usual.outcomes[3].tolerance_relative);
  CHECK(exact.outcomes[1].tolerance_relative == 1e-300);
  CHECK(usual.outcomes[1].met);
  CHECK(usual.outcomes[2].met);
  // Exact but for rounding.
  CHECK(exact.outcomes[1].met == (exact.outcomes[1].length_at_pin <= 1e-300));
  const Complex<double> value = std::get<VertexConstraint>(*exact.outcomes[2].control).value;
  CHECK(exact.outcomes[2].met == (exact.field.u[5] == value));
}
