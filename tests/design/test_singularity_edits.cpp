// SPDX-License-Identifier: MIT
//
// Singularities of index +-k/n in one control, and designs that are edited by moving, merging and splitting them.
#include <doctest/doctest.h>

#include <set>

#include "alcap/design_file.h"
#include "alcap/design_run.h"
#include "alcap/designer.h"
#include "alcap/eigen_design.h"
#include "alcap/singularities.h"
#include "src/design/singularity_parts.h"
#include "tests/support/surfaces.h"

using namespace alcap;
using namespace alcap::test;

namespace {

/// Sum of the indices of all faces whose barycenters are this close to that of face t.
int index_near(const ConnectedSurface& s, const Field& field, Index t, double radius) {
  const auto middle = [&](Index f) -> Eigen::RowVector3d {
    return position(s, SurfacePoint{f, {1.0 / 3, 1.0 / 3, 1.0 / 3}});
  };
  const std::vector<int> indices = face_indices(s, field);
  int sum = 0;
  for (Index f = 0; f < s.mesh().faces(); ++f)
    if ((middle(f) - middle(t)).norm() < radius) sum += indices[static_cast<std::size_t>(f)];
  return sum;
}

double apart(const Field& a, const Field& b) { return (a.u - b.u).cwiseAbs().maxCoeff() / b.u.cwiseAbs().maxCoeff(); }

DesignResult fresh(const ConnectedSurface& s, int n, const std::vector<SingularityTarget>& targets) {
  Designer designer(s, {.n = n});
  for (const SingularityTarget& t : targets) designer.add(t);
  return designer.solve();
}

const SingularityTarget& target(const Designer& designer, ControlId id) {
  return std::get<SingularityTarget>(designer.controls().at(id));
}

}  // namespace

TEST_CASE("index +-k/n in one control: every zero in its face, k of them, turned as asked") {
  const ConnectedSurface s = connected(jittered_sphere(4, 0.2, 5));
  for (const int n : {1, 2, 4}) {
    for (const int sign : {1, -1}) {
      for (const int count : {1, 2, 3, 4}) {
        Designer designer(s, {.n = n});
        const Index face = 1700;
        designer.add(SingularityTarget{.face = face, .sign = sign, .count = count, .orientation = 0.4});
        const DesignResult result = designer.solve();
        CAPTURE(n);
        CAPTURE(sign * count);
        CHECK(result.controls[0].index == sign * count);
        CHECK(result.controls[0].met);
        CHECK(index_near(s, result.field, face, 0.2) == sign * count);
      }
    }
  }
}

TEST_CASE("turning a control of several zeros turns the pattern: the field around is the one turned") {
  const ConnectedSurface s = connected(icosphere(4));
  const Index face = 2000;
  for (const int n : {2, 4}) {
    // u = c z^k: turning by beta multiplies c by e^{i (n - k) beta}, and the field is linear in it.
    const int k = -2;
    const SingularityTarget still{.face = face, .sign = -1, .count = 2};
    SingularityTarget turned = still;
    turned.orientation = 0.3;
    const DesignResult a = fresh(s, n, {still}), b = fresh(s, n, {turned});
    const Complex<double> factor = std::polar(1.0, (n - k) * 0.3);
    CHECK((b.field.u - factor * a.field.u).norm() < 1e-9 * a.field.u.norm());
  }
}

TEST_CASE("zeros of a control are apart, start in its face, and are refused where there is no room") {
  const ConnectedSurface s = connected(jittered_sphere(3, 0.2, 5));
  const auto parts = detail::singularity_parts(s.mesh(), s.geometry(), 2, {.face = 77, .count = 5});
  REQUIRE(parts.size() == 5);
  CHECK(parts[0].face == 77);
  std::set<Index> vertices;
  for (const auto& part : parts) {
    CHECK(std::abs(part.factor) >= 1 - 1e-12);
    for (Index c = 0; c < 3; ++c) CHECK(vertices.insert(s.F()(part.face, c)).second);
  }
  const ConnectedSurface small = connected(tetrahedron());
  Designer designer(small, {.n = 2});
  CHECK_THROWS_AS(designer.add(SingularityTarget{.face = 0, .count = 2}), OptionError);
  CHECK_THROWS_AS(designer.add(SingularityTarget{.face = 0, .count = 0}), OptionError);
  CHECK_THROWS_AS(designer.add(SingularityTarget{.face = 0, .count = 1000}), OptionError);
}

TEST_CASE("eigen designs take them as well") {
  const ConnectedSurface s = connected(jittered_sphere(4, 0.1, 5));
  for (const int sign : {1, -1}) {
    const EigenDesignResult result =
        eigen_design(s, {.singularities = {{.face = 900, .sign = sign, .count = 2}}}, {.n = 2});
    CHECK(result.singularities[0].index == 2 * sign);
    CHECK(index_near(s, result.field, 900, 0.2) == 2 * sign);
  }
}

TEST_CASE("a direction is carried to another face as on the unfolded strip between them") {
  const ConnectedSurface s = connected(grid(8, 6, 3, 2));
  // In the plane the same direction of space.
  const Frames frames = face_frames(s);
  for (Index to = 1; to < s.mesh().faces(); to += 7) {
    const SingularityTarget there =
        detail::moved(s.mesh(), s.geometry(), 2, {.face = 0, .sign = -1, .orientation = 0.7}, to);
    const Eigen::RowVector3d before = frames.vector(0, std::polar(1.0, 0.7));
    CHECK((frames.vector(to, std::polar(1.0, there.orientation)) - before).norm() < 1e-12);
    // A swirl is the same everywhere.
    CHECK(detail::moved(s.mesh(), s.geometry(), 1, {.face = 0, .orientation = 0.7}, to).orientation == 0.7);
  }
}

TEST_CASE("moving, merging and splitting give the field of a fresh design, with the index in its face") {
  const ConnectedSurface s = connected(jittered_sphere(4, 0.2, 5));
  const int n = 4;
  Designer designer(s, {.n = n});
  const ControlId a = designer.add(SingularityTarget{.face = 100, .sign = -1, .orientation = 0.2});
  const ControlId b = designer.add(SingularityTarget{.face = 3000, .sign = 1});
  static_cast<void>(designer.solve());

  designer.move(a, 1500);
  DesignResult now = designer.solve();
  CHECK(face_index(s, now.field, 1500) == -1);
  CHECK(target(designer, a).face == 1500);
  CHECK(apart(now.field, fresh(s, n, {target(designer, a), target(designer, b)}).field) < 1e-9);

  const ControlId c = designer.add(SingularityTarget{.face = 2200, .sign = -1});
  REQUIRE(designer.merge(a, c) == a);
  CHECK(target(designer, a).count == 2);
  CHECK(target(designer, a).sign == -1);
  CHECK(designer.controls().count(c) == 0);
  now = designer.solve();
  CHECK(now.controls[0].index == -2);
  CHECK(apart(now.field, fresh(s, n, {target(designer, a), target(designer, b)}).field) < 1e-9);

  const ControlId d = designer.split(a, 4000);
  CHECK(target(designer, a).count == 1);
  CHECK(target(designer, d).sign == -1);
  now = designer.solve();
  CHECK(face_index(s, now.field, 1500) == -1);
  CHECK(face_index(s, now.field, 4000) == -1);
  CHECK(apart(now.field, fresh(s, n, {target(designer, a), target(designer, b), target(designer, d)}).field) < 1e-9);

  // Opposite ones cancel, and both are gone.
  CHECK(!designer.merge(b, d).has_value());
  CHECK(designer.controls().size() == 1);
  CHECK(apart(designer.solve().field, fresh(s, n, {target(designer, a)}).field) < 1e-9);
}

TEST_CASE("what cannot be moved, merged or split is refused, and nothing has changed") {
  const ConnectedSurface s = connected(icosphere(3));
  Designer designer(s, {.n = 2});
  const ControlId a = designer.add(SingularityTarget{.face = 100, .sign = -1});
  const ControlId v = designer.add(VertexConstraint{.vertex = 5});
  CHECK_THROWS_AS(designer.move(v, 3), OptionError);
  CHECK_THROWS_AS(designer.move(a, s.mesh().faces()), OptionError);
  CHECK_THROWS_AS(designer.move(ControlId{99}, 3), OptionError);
  CHECK_THROWS_AS(static_cast<void>(designer.merge(a, v)), OptionError);
  CHECK_THROWS_AS(static_cast<void>(designer.merge(a, a)), OptionError);
  CHECK_THROWS_AS(static_cast<void>(designer.split(a, 7)), OptionError);
  CHECK(designer.controls().size() == 2);
  CHECK(target(designer, a).face == 100);
}

TEST_CASE("edits in a design file are the design that they lead to") {
  const MeshData data = jittered_sphere(4, 0.2, 5);
  const Surface surface(data.V, data.F);
  const std::string text = R"({"alcap_design": 1, "n": 4, "singularities": [
    {"face": 100, "kind": "saddle", "angle": 20},
    {"face": 3000, "kind": "source"},
    {"face": 2200, "kind": "saddle", "relative_to": [1, 0, 0]}],
    "edits": [{"move": 0, "to": 1500}, {"merge": [2, 0]}, {"split": 2, "to": 4000}, {"move": 3, "to": 4100},
              {"merge": [1, 3]}]})";
  const DesignFile edited = parse_design(text);
  CHECK(parse_design(design_text(edited)).edits.size() == 5);
  const DesignFile placed = place_design(edited, surface);
  CHECK(placed.edits.empty());
  REQUIRE(placed.singularities.size() == 1);
  CHECK(placed.singularities[0].face == 2200);
  CHECK(placed.singularities[0].count == 1);
  const DesignRun run = run_design(surface, edited);
  CHECK(run.certificate.holds());
  CHECK(face_index(run.surface, run.field, 2200) == -1);
  const DesignFile alone = parse_design(
      R"({"alcap_design": 1, "n": 4, "singularities": [{"face": 2200, "kind": "saddle", "relative_to": [1, 0, 0]}]})");
  CHECK(apart(run.field, run_design(surface, alone).field) < 1e-9);

  // A move alone: the direction goes along.
  const DesignFile moved = place_design(
      parse_design(R"({"alcap_design": 1, "n": 4, "singularities": [{"face": 100, "kind": "saddle", "angle": 20}],
                       "edits": [{"move": 0, "to": 1500}]})"),
      surface);
  const double turn = detail::carried_turn(surface.mesh(), surface.geometry(), 100, 1500);
  CHECK(moved.singularities[0].angle == doctest::Approx(20 + turn * 180 / pi<double>));

  const auto refused = [](const std::string& edits) -> std::string {
    try {
      static_cast<void>(parse_design(R"({"alcap_design": 1, "n": 4, "singularities": [
        {"face": 1, "kind": "saddle"}, {"face": 9, "kind": "source"}], "edits": [)" +
                                     edits + "]}"));
    } catch (const FileError& e) {
      return e.what();
    }
    return "";
  };
  CHECK(refused(R"({"move": 2, "to": 1})").find("/edits/0/move = 2") != std::string::npos);
  CHECK(refused(R"({"merge": [0, 1]}, {"move": 1, "to": 3})").find("/edits/1/move = 1") != std::string::npos);
  CHECK(refused(R"({"split": 0, "to": 1})").find("/edits/0/count") != std::string::npos);
  CHECK(refused(R"({"merge": [0, 0]})").find("two different") != std::string::npos);
  CHECK(refused(R"({"move": 0, "to": -1})").find("/edits/0/to") != std::string::npos);
  CHECK(refused(R"({"turn": 0})").find("one of the keys") != std::string::npos);
}
