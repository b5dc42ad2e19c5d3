// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <Eigen/Dense>

#include "alcap/eigen_design.h"
#include "alcap/energies.h"
#include "alcap/generators.h"
#include "alcap/singularities.h"
#include "alcap/smoothest.h"
#include "alcap/strokes.h"
#include "src/base/random.h"
#include "tests/design/designer_case.h"
#include "tests/support/surfaces.h"

using namespace alcap;

namespace {

using C = Complex<double>;

using Case = test::DesignerCase;

// Centers of faces met by walking through opposite edges: a polyline on the surface.
Stroke walk(const Mesh& mesh, Index face, int steps, double weight) {
  Stroke stroke{.points = {}, .weight = weight};
  Index h = 3 * face;
  for (int k = 0; k < steps; ++k) {
    stroke.points.push_back({h / 3, {1.0 / 3, 1.0 / 3, 1.0 / 3}});
    h = mesh.twin(k % 2 == 0 ? Mesh::next(h) : Mesh::prev(h));
    if (h == none) break;
  }
  return stroke;
}

}  // namespace

TEST_CASE("one target, any orientation, n = 1 to 6: index and orientation in the asked face") {
  for (const MeshData& surface : {jittered_sphere(3, 0.2, 5), torus(30, 16, 1, 0.4), genus_surface(2, 3), disk(10)}) {
    const Case s(surface);
    detail::Random random(3);
    for (int n = 1; n <= 6; ++n) {
      // A flat disk has parallel fields: it needs a guidance weight.
      auto designer = s.designer({.n = n, .guidance_weight = surface.F.rows() == 600 ? 0.1 : 0.0});
      for (const int sign : {1, -1})
        for (int k = 0; k < 8; ++k) {
          Index face = 0;
          do face = static_cast<Index>(random.below(s.mesh.faces()));
          while (s.mesh.boundary_vertex(s.mesh.tail(3 * face)) || s.mesh.boundary_vertex(s.mesh.tail(3 * face + 1)) ||
                 s.mesh.boundary_vertex(s.mesh.tail(3 * face + 2)));
          const auto id =
              designer.add(SingularityTarget{.face = face, .sign = sign, .orientation = random.uniform(-3, 3)});
          const DesignResult result = designer.solve();
          CAPTURE(n);
          CAPTURE(face);
          CAPTURE(surface.F.rows());
          CHECK(result.residual < 1e-9);
          CHECK(result.controls.at(0).index == sign);
          CHECK(result.controls.at(0).error_degrees < 0.5);
          CHECK(result.controls.at(0).met);
          designer.remove(id);
        }
    }
  }
}

TEST_CASE("turning a saddle in steps of 5 degrees keeps it in its face and turns it by as much") {
  const Case s(bumpy_sphere(3, 0.2, 3));
  for (const int n : {1, 2, 4}) {
    auto designer = s.designer({.n = n});
    const Index face = 333;
    const auto id = designer.add(SingularityTarget{.face = face, .sign = -1});
    for (int step = 0; step < 72; ++step) {
      const double beta = step * 5 * pi<double> / 180;
      designer.set(id, SingularityTarget{.face = face, .sign = -1, .orientation = beta});
      const auto result = designer.solve();
      REQUIRE(result.controls[0].met);
      bool found = false;
      for (const Singularity& x : find_singularities(s.mesh, s.geometry, s.connection, result.field))
        if (x.face == face) {
          found = x.index == -1;
          CHECK(std::abs(std::remainder(x.orientation - beta, 2 * pi<double> / (n + 1))) < 0.02);
        }
      CHECK(found);
    }
  }
}

TEST_CASE("pins, fixed vertices and strokes solve the constrained problem: against a dense system") {
  const Case s(jittered_sphere(1, 0.1, 2));
  const int n = 2;
  const HermitianPattern pattern(s.mesh);
  const auto [S, M] = stiffness_and_mass(s.mesh, pattern, s.geometry, s.connection, n);
  const double w = 0.7 * 8 * pi<double> * n / s.geometry.total_area();
  auto designer = s.designer({.n = n, .guidance_weight = 0.7});
  ComplexVectorX<double> u0(s.mesh.vertices());
  detail::Random random(1);
  for (C& z : u0) z = {random.uniform(-1, 1), random.uniform(-1, 1)};
  designer.set_guidance(u0);
  const std::array<double, 3> at = {0.2, 0.5, 0.3};
  designer.add(SingularityTarget{.face = 10, .sign = -1, .orientation = 0.4, .pin = at});
  designer.add(VertexConstraint{.vertex = 7, .value = {0.3, -2}});
  const auto result = designer.solve();
  CHECK(result.rows == 2);

  // The zero is where it was pinned, the vertex has its value, and elsewhere the gradient vanishes: what is left of
  // A u - b lies in the span of the two rows.
  const auto there = face_field(s.mesh, s.geometry, s.connection, n, result.field.u, 10).at(at);
  CHECK(std::abs(there.u) < 1e-9 * result.field.u.cwiseAbs().maxCoeff());
  CHECK(std::abs(result.field.u[7] - C(0.3, -2)) < 1e-9);
  const auto operators = first_order_operators(s.mesh, s.geometry, s.connection, {.n = n});
  ComplexVectorX<double> rest = 2.0 * (S * result.field.u) + w * (M * (result.field.u - u0));
  const double scale = rest.cwiseAbs().maxCoeff();
  for (Index v = 0; v < s.mesh.vertices(); ++v) {
    if (v == 7 || v == s.mesh.F()(10, 0) || v == s.mesh.F()(10, 1) || v == s.mesh.F()(10, 2)) continue;
    CHECK(std::abs(rest[v]) < 1e-9 * scale);
  }
}

TEST_CASE("strokes as an update and inside the matrix give the same field, and align more the more they weigh") {
  const Case s(bumpy_sphere(3, 0.2, 3));
  double last = 1e9;
  for (const double weight : {0.01, 0.1, 1.0, 10.0, 100.0}) {
    auto update = s.designer({.n = 4, .guidance_weight = 0.2});
    auto folded = s.designer({.n = 4, .guidance_weight = 0.2, .largest_rank = 0});
    const auto u0 = smoothest_field(s.mesh, s.geometry, s.connection, nullptr, {.n = 4}).field.u;
    DesignResult results[2];
    int k = 0;
    for (Designer* d : {&update, &folded}) {
      d->set_guidance(u0);
      d->add(walk(s.mesh, 5, 40, weight));
      d->add(SingularityTarget{.face = 700, .pin = std::array<double, 3>{0.3, 0.3, 0.4}});
      results[k++] = d->solve();
    }
    CHECK(results[0].rows == 41);
    CHECK(results[1].rows == 1);
    CHECK((results[0].field.u - results[1].field.u).cwiseAbs().maxCoeff() <
          1e-8 * results[0].field.u.cwiseAbs().maxCoeff());
    CHECK(results[0].controls[0].error_degrees < last);
    last = results[0].controls[0].error_degrees;
    if (weight >= 1) CHECK(results[0].controls[0].met);
  }
}

TEST_CASE("strength 1 holds against a unit guidance field, in millimetres and in kilometres") {
  for (const double scale : {1e-3, 1e3}) {
    MeshData surface = jittered_sphere(3, 0.15, 5);
    surface.V *= scale;
    const Case s(surface);
    for (const int n : {1, 4}) {
      auto designer = s.designer({.n = n, .guidance_weight = 1});
      auto smooth = smoothest_field(s.mesh, s.geometry, s.connection, nullptr, {.n = n}).field;
      designer.set_guidance(normalised(smooth).u);
      for (Index face = 40; face < s.mesh.faces(); face += 300)
        for (const int sign : {1, -1}) {
          const auto id = designer.add(SingularityTarget{.face = face, .sign = sign, .orientation = 0.2});
          CHECK(designer.solve().controls[0].index == sign);
          designer.remove(id);
        }
    }
  }
}

TEST_CASE("after 200 random edits the field is the one solved from scratch") {
  const Case s(jittered_sphere(2, 0.2, 9));
  const DesignerOptions options{.n = 3, .guidance_weight = 0.3, .largest_rank = 30};
  auto edited = s.designer(options);
  detail::Random random(7);
  const auto face = [&] { return static_cast<Index>(random.below(s.mesh.faces())); };
  const auto control = [&]() -> Control {
    switch (random.below(4)) {
      case 0:
        return SingularityTarget{
            .face = face(), .sign = random.below(2) ? 1 : -1, .orientation = random.uniform(-3, 3)};
      case 1:
        return SingularityTarget{.face = face(), .pin = std::array<double, 3>{0.2, 0.5, 0.3}};
      case 2:
        return VertexConstraint{.vertex = static_cast<Index>(random.below(s.mesh.vertices())), .value = {1, 0.5}};
      default:
        return walk(s.mesh, face(), 12, 1.0);
    }
  };
  std::vector<ControlId> ids;
  for (int edit = 0; edit < 200; ++edit) {
    const auto which = random.below(3);
    if (which == 0 || ids.size() < 3) {
      ids.push_back(edited.add(control()));
    } else if (which == 1) {
      edited.set(ids[static_cast<std::size_t>(random.below(static_cast<std::int64_t>(ids.size())))], control());
    } else {
      const auto k = static_cast<std::ptrdiff_t>(random.below(static_cast<std::int64_t>(ids.size())));
      edited.remove(ids[static_cast<std::size_t>(k)]);
      ids.erase(ids.begin() + k);
    }
    if (edit % 10 != 9) continue;
    auto fresh = s.designer(options);
    for (const auto& [id, c] : edited.controls()) fresh.add(c);
    const auto a = edited.solve(), b = fresh.solve();
    REQUIRE((a.field.u - b.field.u).cwiseAbs().maxCoeff() < 1e-7 * b.field.u.cwiseAbs().maxCoeff());
  }
}

TEST_CASE("singular systems, empty designs and bad controls are refused with the reason") {
  const Case sphere(icosphere(2)), flat(disk(4));
  auto lone = flat.designer({.n = 1});
  (void)lone.add(SingularityTarget{.face = 7});
  CHECK_THROWS_AS((void)lone.solve(), OptionError);
  CHECK_NOTHROW((void)flat.designer({.n = 1, .guidance_weight = 1}));
  const auto parallel = trivial(sphere.mesh, sphere.geometry, {{0, 1}, {11, 1}}, {.n = 1});
  CHECK_NOTHROW((void)Designer({Surface(sphere.surface.V, sphere.surface.F), parallel}, {.n = 1}));
  auto designer = sphere.designer({.n = 2});
  CHECK_THROWS_AS((void)designer.solve(), OptionError);
  const auto field_of = [&](Control c) -> std::string {
    try {
      (void)designer.add(std::move(c));
    } catch (const OptionError& e) {
      return e.field();
    }
    return "";
  };
  CHECK(field_of(SingularityTarget{.face = -1}) == "face");
  CHECK(field_of(SingularityTarget{.face = 0, .sign = 2}) == "sign");
  CHECK(field_of(SingularityTarget{.face = 0, .strength = 0}) == "strength");
  CHECK(field_of(SingularityTarget{.face = 0, .pin = std::array<double, 3>{2, -1, 0}}) == "face");
  CHECK(field_of(VertexConstraint{.vertex = 100000}) == "vertex");
  CHECK(field_of(Stroke{}) == "points");
  CHECK(field_of(Stroke{.points = {{0, {1, 0, 0}}, {0, {1, 0, 0}}}}) == "points");
  CHECK_THROWS_AS(designer.remove(ControlId{5}), OptionError);
  CHECK_THROWS_AS(designer.set_guidance(ComplexVectorX<double>::Zero(sphere.mesh.vertices())), OptionError);
  CHECK_THROWS_AS((void)sphere.designer({.n = 0}), OptionError);
  CHECK_THROWS_AS((void)sphere.designer({.n = 1, .guidance_weight = -1}), OptionError);
}

TEST_CASE("what a designer refuses is told with its value and the rule") {
  const Case sphere(icosphere(2));
  const Index vertices = sphere.mesh.vertices();
  auto designer = sphere.designer({.n = 2, .guidance_weight = 1});
  auto by_t = sphere.designer({.n = 2, .t = -1.0});
  const ComplexVectorX<double> u0 = ComplexVectorX<double>::Ones(vertices);
  ComplexVectorX<double> hole = u0;
  hole[5] = std::nan("");
  const auto says = [](const char* what, const auto& call) {
    CAPTURE(std::string(what));
    CHECK_THROWS_WITH_AS(call(), doctest::Contains(what), OptionError);
  };
  says("option 'largest_rank' = -1: must not be negative",
       [&] { (void)sphere.designer({.n = 2, .largest_rank = -1}); });
  says("option 'id' = 7: there is no such control", [&] { designer.set(ControlId{7}, BoundaryAlignment{}); });
  says("option 'u0' = 3 values: needs one per vertex", [&] { designer.set_guidance(u0.head(3)); });
  says("option 'u0' = not finite: every value must be finite", [&] { designer.set_guidance(hole); });
  says("option 't' = -1: cannot be combined with weights per vertex",
       [&] { by_t.set_guidance_weights(VectorX<double>::Ones(vertices)); });
  designer.set_guidance(u0);
  says("option 'guidance_weight' = 0: a guidance field needs a weight", [&] { designer.set_guidance_weight(0); });
  says("option 'value' = not finite: must be a finite complex number", [&] {
    designer.add(VertexConstraint{.vertex = 1, .value = {0, std::nan("")}});
  });
  says("option 'orientation' = nan: must be finite",
       [&] { designer.add(SingularityTarget{.face = 1, .orientation = std::nan("")}); });
  says("option 'radius' = 0.5: needs a line", [&] {
    designer.add(Stroke{.points = {{0, {1, 0, 0}}, {0, {0, 1, 0}}}, .radius = 0.5});
  });
  const Surface nowhere = test::flat_torus_surface(6, 6);
  Designer flat(connect(nowhere), {.n = 2});
  says("option 'points' = 2 points: need a surface that lies in space", [&] {
    flat.add(Stroke{.points = {{0, {1, 0, 0}}, {1, {1, 0, 0}}}});
  });
  // A singularity stays on its component.
  const MeshData ball = icosphere(1);
  const auto count = static_cast<Index>(ball.V.rows());
  Positions<double> V(2 * count, 3);
  V << ball.V, ball.V.array() + 5;
  Faces F(2 * ball.F.rows(), 3);
  F << ball.F, ball.F.array() + count;
  const ConnectedSurface both = connect(Surface(V, F));
  Designer two(both, {.n = 1});
  const ControlId source = two.add(SingularityTarget{.face = 3});
  says("option 'face' = 80: lies on another component than face 3", [&] { two.move(source, 80); });
  SurfacePolyline across = stroke_through_points(both, {{0, {1, 0, 0}}, {0, {0, 1, 0}}});
  across.segments.push_back(across.segments.front());
  across.segments.back().face = 80;
  says("option 'strokes[0].line' = 80: a stroke stays on one component", [&] {
    (void)eigen_design(both, {.strokes = {{across, 1}}}, {.n = 1});
  });
  across.segments.back().length = 0;
  says("option 'strokes[0].line' = 0: segments have a positive length", [&] {
    (void)eigen_design(both, {.strokes = {{across, 1}}}, {.n = 1});
  });
}

TEST_CASE("a design solved once: multigrid gives the field of the factorisation, and refuses what that refuses") {
  const Case s(icosphere(5)), flat(disk(60));
  std::vector<DesignResult> results;
  for (const int right_hand_sides : {0, 3}) {
    auto designer = s.designer({.n = 2, .right_hand_sides = right_hand_sides});
    (void)designer.add(SingularityTarget{.face = 77, .sign = 1, .orientation = 0.3});
    (void)designer.add(VertexConstraint{.vertex = 5000, .value = {0.5, 1}});
    results.push_back(designer.solve());
    for (const ControlReport& c : results.back().controls) CHECK(c.met);
    CHECK(results.back().residual < 1e-9);
    // A flat disk has parallel fields.
    auto parallel = flat.designer({.n = 1, .right_hand_sides = right_hand_sides});
    (void)parallel.add(SingularityTarget{.face = 77});
    CHECK_THROWS_AS((void)parallel.solve(), OptionError);
  }
  CHECK(results[0].solver != "multigrid");
  CHECK(results[1].solver == "multigrid");
  CHECK((results[0].field.u - results[1].field.u).norm() <= 1e-7 * results[0].field.u.norm());
}

TEST_CASE("a traced line aligns the field in every face it crosses, however few points were drawn") {
  const Case s(bumpy_sphere(4, 0.1, 3));
  Positions<double> points(5, 3);
  for (int k = 0; k < 5; ++k) {
    const double a = 0.3 + 0.3 * k;
    points.row(k) << 2 * std::cos(a), 1.2 * std::sin(a), 1.6 * std::sin(a);
  }
  const SurfacePolyline line = stroke_from_space(s.connected(), points);
  REQUIRE(line.segments.size() > 20);
  for (const int n : {1, 4}) {
    double last = 1e9;
    for (const double weight : {0.1, 1.0, 10.0}) {
      auto designer = s.designer({.n = n});
      const auto id = designer.add(Stroke{.weight = weight, .line = line});
      const auto result = designer.solve();
      CHECK(result.controls[0].met);
      CHECK(result.controls[0].error_degrees < last + 1e-9);
      last = result.controls[0].error_degrees;
      // Between the rows, and as a direction in the faces: at both ends of every segment.
      double worst = 0;
      for (const SurfaceSegment& segment : line.segments) {
        const auto u =
            face_field(s.mesh, s.geometry, s.connection, n, result.field.u, segment.face).at(segment.at(0.9)).u;
        worst = std::max(worst, std::abs(wrap(std::arg(u) - n * std::arg(segment.tangent))) / n);
      }
      if (weight == 10.0) CHECK(worst < 0.3);
      // Backwards: the opposite vectors, the same crosses.
      designer.set(id, Stroke{.weight = weight, .line = line.reversed()});
      const auto back = designer.solve();
      CHECK((back.field.u - (n % 2 ? -1.0 : 1.0) * result.field.u).norm() < 1e-7 * result.field.u.norm());
    }
    CHECK(last < 3);
  }
  auto designer = s.designer({.n = 1});
  CHECK_THROWS_AS(designer.add(Stroke{.points = {{0, {1, 0, 0}}}, .line = line}), OptionError);
  SurfacePolyline broken = line;
  broken.segments[3].face = -1;
  CHECK_THROWS_AS(designer.add(Stroke{.line = broken}), OptionError);
}

TEST_CASE("where parallel fields exist, whatever holds or draws the field makes the design regular") {
  const Case flat(grid(12, 10));
  const Index middle = 5 * 13 + 6;
  REQUIRE_FALSE(flat.mesh.boundary_vertex(middle));
  // One fixed vertex: the field is parallel, by hand.
  for (const int n : {1, 2, 4}) {
    auto designer = flat.designer({.n = n});
    const C value = std::polar(2.0, 0.7);
    const auto id = designer.add(VertexConstraint{.vertex = middle, .value = value});
    const DesignResult result = designer.solve();
    CHECK(result.controls.at(0).met);
    CHECK(result.residual < 1e-9);
    CHECK(result.residual > 0);
    const ComplexVectorX<double> u = result.field.u;
    CHECK(std::abs(field_energies(flat.connected(), n, u).dirichlet) < 1e-16 * u.squaredNorm() + 1e-12);
    CHECK(u.cwiseAbs().minCoeff() == doctest::Approx(2).epsilon(1e-6));
    CHECK(u.cwiseAbs().maxCoeff() == doctest::Approx(2).epsilon(1e-6));
    // Turned, and its direction alone: a target decides the rest.
    designer.set(id, VertexConstraint{.vertex = middle, .value = std::polar(1.0, -0.4), .direction_only = true});
    (void)designer.add(SingularityTarget{.face = 30, .sign = -1});
    const DesignResult free = designer.solve();
    CHECK(free.residual < 1e-9);
    CHECK(std::abs(std::sin(std::arg(free.field.u[middle]) + 0.4)) < 1e-6);
    // The same with a little guidance towards zero is nearly the same field.
    auto guided = flat.designer({.n = n, .guidance_weight = 1e-7});
    (void)guided.add(VertexConstraint{.vertex = middle, .value = std::polar(1.0, -0.4), .direction_only = true});
    (void)guided.add(SingularityTarget{.face = 30, .sign = -1});
    const DesignResult near = guided.solve();
    const ComplexVectorX<double> away = free.field.u - near.field.u;
    CHECK(away.norm() <= 1e-3 * free.field.u.norm());
  }
  // Two fixed vertices with a target, against a direct solve with those rows left out of the matrix.
  auto two = flat.designer({.n = 4});
  (void)two.add(VertexConstraint{.vertex = middle, .value = 1});
  (void)two.add(VertexConstraint{.vertex = 3, .value = C(0, 1)});
  const ComplexVectorX<double> u = two.solve().field.u;
  const StiffnessMass parts = energy_matrices(flat.connected(), 4);
  ComplexVectorX<double> rest = parts.S * u;
  rest[middle] = rest[3] = 0;
  CHECK(rest.norm() < 1e-9 * u.norm());
  CHECK(std::abs(u[middle] - C(1)) < 1e-9);
  CHECK(std::abs(u[3] - C(0, 1)) < 1e-9);
}

TEST_CASE(
    "boundary alignment alone on a flat square: no singularities; a control that goes leaves the design as it was") {
  const Case flat(grid(14, 14));
  auto designer = flat.designer({.n = 4});
  const auto rim = designer.add(BoundaryAlignment{});
  const DesignResult aligned = designer.solve();
  CHECK(aligned.controls.at(0).met);
  CHECK(find_singularities(flat.connected(), aligned.field).empty());
  const auto id = designer.add(VertexConstraint{.vertex = 100, .value = 1});
  CHECK(designer.solve().controls.at(1).met);
  designer.remove(id);
  CHECK((designer.solve().field.u - aligned.field.u).norm() < 1e-9 * aligned.field.u.norm());
  designer.remove(rim);
  (void)designer.add(SingularityTarget{.face = 9});
  CHECK_THROWS_AS((void)designer.solve(), OptionError);
  designer.set_guidance_weight(0.5);
  CHECK_NOTHROW((void)designer.solve());
}

TEST_CASE("a flat piece beside the one that is designed does not stop the design") {
  const MeshData plate = grid(6, 6), ball = jittered_sphere(3, 0.1, 4);
  MeshData both{Positions<double>(ball.V.rows() + plate.V.rows(), 3), Faces(ball.F.rows() + plate.F.rows(), 3)};
  both.V << ball.V, plate.V;
  both.F << ball.F, (plate.F.array() + static_cast<Index>(ball.V.rows())).matrix();
  const Case s(both);
  auto designer = s.designer({.n = 4});
  (void)designer.add(SingularityTarget{.face = 12, .sign = 1});
  (void)designer.add(SingularityTarget{.face = 700, .sign = -1, .pin = std::array<double, 3>{0.3, 0.3, 0.4}});
  const DesignResult result = designer.solve();
  for (const ControlReport& c : result.controls) CHECK(c.met);
  const Case alone(ball);
  auto single = alone.designer({.n = 4});
  (void)single.add(SingularityTarget{.face = 12, .sign = 1});
  (void)single.add(SingularityTarget{.face = 700, .sign = -1, .pin = std::array<double, 3>{0.3, 0.3, 0.4}});
  const ComplexVectorX<double> u = single.solve().field.u;
  CHECK(std::abs(result.field.u.head(u.size()).norm() - u.norm()) < 0.2 * u.norm());
}
