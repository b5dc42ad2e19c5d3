// SPDX-License-Identifier: MIT
//
// Features in designs: directions held exactly along creases, with a length of their own, by both methods.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "alcap/aligned.h"
#include "alcap/backends.h"
#include "alcap/designer.h"
#include "alcap/eigen_design.h"
#include "alcap/generators.h"
#include "alcap/smoothest.h"
#include "tests/support/parts.h"
#include "tests/support/surfaces.h"

using namespace alcap;

namespace {

using C = Complex<double>;

struct FeatureCase {
  std::string name;
  ConnectedSurface surface;
  FeatureGraph features;

  FeatureCase(std::string called, const MeshData& data)
      : name(std::move(called)), surface(test::connected(data)), features(sharp_edges(surface)) {}
};

std::vector<FeatureCase> known_parts() {
  const auto all = [](int, int, int) { return false; };
  std::vector<FeatureCase> out;
  out.emplace_back("box", test::blocks(test::cells(3, 2, 1, all), 4));
  out.emplace_back("L", test::blocks(test::cells(2, 1, 2, [](int i, int, int k) { return i > 0 && k > 0; }), 5));
  out.emplace_back("plate", grid(10, 10));
  return out;
}

/// The largest angle between the field and a held direction, in radians, as an n-field's.
double worst_held(const FeatureCase& part, const Field& field, bool across) {
  double worst = 0;
  for (const VertexConstraint& held : feature_directions(part.surface, part.features, field.n, across).held)
    worst = std::max(worst, std::abs(std::arg(field.u[held.vertex] * std::conj(held.value))) / field.n);
  return worst;
}

void check_held(const FeatureCase& part, const Field& field, bool across, const ControlReport& report) {
  CAPTURE(part.name);
  CAPTURE(field.n);
  CAPTURE(across);
  CHECK(field.u.allFinite());
  CHECK(worst_held(part, field, across) < 1e-12);
  const FeatureReport along = measure_features(part.surface, field, part.features, {}, across);
  // Between held vertices, as far as the connection turns along an edge.
  CHECK(along.all.worst_degrees < 0.5);
  CHECK(report.met);
  CHECK(report.error_degrees == along.all.mean_degrees);
  // Across is perpendicular: for lines the farthest from along, for crosses the same.
  const double turned = measure_features(part.surface, field, part.features, {}, !across).all.mean_degrees;
  CHECK(turned == doctest::Approx(field.n == 2 ? 90 : 0).scale(1).epsilon(0.2));
}

/// A backend that tells how often it factorised.
class CountedFactors final : public LinearSolver<double> {
 public:
  explicit CountedFactors(int& count) : count_(count) {}
  void analyse(const SparseMatrix<double>& A) override { inner_->analyse(A); }
  void factorise(const SparseMatrix<double>& A) override {
    ++count_;
    inner_->factorise(A);
  }
  SolveReport solve(const Eigen::Ref<const MatrixX<double>>& B, Eigen::Ref<MatrixX<double>> X) const override {
    return inner_->solve(B, X);
  }
  [[nodiscard]] std::string name() const override { return inner_->name(); }

 private:
  int& count_;
  std::unique_ptr<LinearSolver<double>> inner_ = make_linear_solver<double>();
};

}  // namespace

TEST_CASE("held features are followed to rounding off their corners, along and across, by both methods") {
  for (const FeatureCase& part : known_parts())
    for (const int n : {2, 4})
      for (const bool across : {false, true}) {
        Designer designer(part.surface, {.n = n, .guidance_weight = 1});
        designer.set_guidance(smoothest_field(part.surface, {.n = n}).field.u);
        const ControlId id = designer.add(FeatureAlignment{.features = part.features, .across = across});
        const DesignResult result = designer.solve();
        REQUIRE(result.controls.size() == 1);
        CHECK(result.controls[0].id == id);
        CHECK(result.residual < 1e-10);
        check_held(part, result.field, across, result.controls[0]);
        const EigenDesignResult smooth =
            eigen_design(part.surface, {.features = {{.features = part.features, .across = across}}}, {.n = n});
        REQUIRE(smooth.features.size() == 1);
        CHECK(smooth.strokes.empty());
        for (const EigenReport& e : smooth.components) {
          CHECK(e.converged);
          CHECK(e.smallest == Smallest::proven);
        }
        check_held(part, smooth.field, across, smooth.features[0]);
      }
}

TEST_CASE("a vertex where features meet that no n-field can follow at once is free, and told") {
  const FeatureCase box = known_parts().at(0);
  const FeatureDirections crosses = feature_directions(box.surface, box.features, 4);
  CHECK(crosses.free_corners.size() == 8);
  const auto on_lines = std::count_if(box.features.vertices.begin(), box.features.vertices.end(),
                                      [](FeatureVertex v) { return v != FeatureVertex::smooth; });
  CHECK(static_cast<std::ptrdiff_t>(crosses.held.size()) == on_lines - 8);
  for (const VertexConstraint& held : crosses.held) {
    CHECK(held.direction_only);
    CHECK(std::abs(held.value) == doctest::Approx(1));
  }
  const FeatureCase plate = known_parts().at(2);
  CHECK(feature_directions(plate.surface, plate.features, 4).free_corners.empty());
  CHECK(feature_directions(plate.surface, plate.features, 2).free_corners.size() == 4);
  CHECK(feature_directions(plate.surface, plate.features, 6).free_corners.size() == 4);
}

TEST_CASE("held features are strokes with directions fixed at their vertices; drawn ones are strokes") {
  const FeatureCase part = known_parts().at(0);
  const int n = 4;
  const auto guided = [&] {
    Designer designer(part.surface, {.n = n, .guidance_weight = 1});
    designer.set_guidance(smoothest_field(part.surface, {.n = n}).field.u);
    for (const FeatureLine& line : part.features.lines)
      designer.add(Stroke{.weight = 2, .line = stroke_along_vertices(part.surface, line.vertices)});
    return designer;
  };
  const auto aligned = [&](bool hold) {
    Designer designer(part.surface, {.n = n, .guidance_weight = 1});
    designer.set_guidance(smoothest_field(part.surface, {.n = n}).field.u);
    designer.add(FeatureAlignment{.features = part.features, .weight = 2, .hold = hold});
    return designer.solve().field;
  };
  Designer drawn = guided();
  const Field soft = aligned(false), hard = aligned(true);
  const Field strokes = drawn.solve().field;
  CHECK((soft.u - strokes.u).norm() < 1e-9 * strokes.u.norm());
  // The multipliers of single vertices find the same field: no length came out short here.
  Designer fixed = guided();
  for (const VertexConstraint& held : feature_directions(part.surface, part.features, n).held) fixed.add(held);
  const Field expected = fixed.solve().field;
  CHECK((hard.u - expected.u).norm() < 1e-7 * expected.u.norm());
  CHECK((hard.u - soft.u).norm() > 1e-3 * soft.u.norm());
}

TEST_CASE("no feature is left for the opposite direction, whatever the guidance says") {
  for (const FeatureCase& part : known_parts()) {
    CAPTURE(part.name);
    const int n = 4;
    // As wrong as can be: at 45 degrees to every feature, and strong.
    ComplexVectorX<double> wrong = smoothest_field(part.surface, {.n = n}).field.u;
    for (const VertexConstraint& held : feature_directions(part.surface, part.features, n).held)
      wrong[held.vertex] = -held.value;
    Designer designer(part.surface, {.n = n, .guidance_weight = 1e4});
    designer.set_guidance(wrong);
    designer.add(FeatureAlignment{.features = part.features, .weight = 1e-3});
    const DesignResult result = designer.solve();
    CHECK(worst_held(part, result.field, false) < 1e-12);
    CHECK(result.controls[0].met);
    CHECK(result.residual < 1e-10);
  }
}

TEST_CASE("held features go with targets, pins, fixed vertices and strokes, in one design by either method") {
  const FeatureCase part = known_parts().at(1);
  const int n = 4;
  const auto smooth_vertex = [&](Index v) {
    return part.features.vertices[static_cast<std::size_t>(v)] == FeatureVertex::smooth;
  };
  Index face = 0, vertex = part.surface.mesh().vertices() - 1;
  while (!smooth_vertex(part.surface.F()(face, 0)) || !smooth_vertex(part.surface.F()(face, 1)) ||
         !smooth_vertex(part.surface.F()(face, 2)))
    ++face;
  while (!smooth_vertex(vertex)) --vertex;
  const SingularityTarget target{.face = face, .sign = -1, .strength = 3, .pin = std::array<double, 3>{0.2, 0.3, 0.5}};
  Designer designer(part.surface, {.n = n, .guidance_weight = 1});
  designer.set_guidance(smoothest_field(part.surface, {.n = n}).field.u);
  const ControlId pinned = designer.add(target);
  const ControlId exact = designer.add(VertexConstraint{.vertex = vertex, .value = std::polar(0.7, 0.4)});
  designer.add(FeatureAlignment{.features = part.features});
  const DesignResult result = designer.solve();
  CHECK(worst_held(part, result.field, false) < 1e-12);
  CHECK(result.residual < 1e-10);
  CHECK(std::abs(result.field.u[vertex] - std::polar(0.7, 0.4)) < 1e-12);
  CHECK(result.controls.at(static_cast<std::size_t>(exact)).met);
  CHECK(result.controls.at(static_cast<std::size_t>(pinned)).index == -1);
  const EigenDesignResult smooth = eigen_design(part.surface,
                                                {.singularities = {target},
                                                 .fixed = {{.vertex = vertex, .value = std::polar(1.0, 0.4)}},
                                                 .features = {{.features = part.features}}},
                                                {.n = n});
  CHECK(worst_held(part, smooth.field, false) < 1e-12);
  CHECK(smooth.fixed.at(0).met);
  CHECK(smooth.singularities.at(0).index == -1);
  // The zero lies where it was put.
  const Field fields[2] = {result.field, smooth.field};
  for (const Field& field : fields) {
    const auto zeros = find_singularities(part.surface, field);
    const auto zero = std::find_if(zeros.begin(), zeros.end(), [&](const Singularity& s) { return s.face == face; });
    REQUIRE(zero != zeros.end());
    for (std::size_t c = 0; c < 3; ++c) CHECK(zero->barycentric[c] == doctest::Approx((*target.pin)[c]).epsilon(1e-9));
  }
  // Gone again, the design is what it was without.
  Designer plain(part.surface, {.n = n, .guidance_weight = 1});
  plain.set_guidance(smoothest_field(part.surface, {.n = n}).field.u);
  plain.add(target);
  const Field before = plain.solve().field;
  const ControlId features = plain.add(FeatureAlignment{.features = part.features});
  CHECK((plain.solve().field.u - before.u).norm() > 1e-3 * before.u.norm());
  plain.remove(features);
  CHECK((plain.solve().field.u - before.u).norm() < 1e-9 * before.u.norm());
}

TEST_CASE(
    "edits beside held features factorise again only where the matrix changes, and give the bits of a fresh design") {
  int factors = 0;
  const auto counted = register_linear_solver(
      "counted-factors", [](const auto&) { return make_linear_solver<C>(); },
      [&](const auto&) { return std::make_unique<CountedFactors>(factors); });
  const FeatureCase part = known_parts().at(1);
  const ComplexVectorX<double> guidance = smoothest_field(part.surface, {.n = 4}).field.u;
  Index face = 0;
  while (std::ranges::any_of(std::array{0, 1, 2}, [&](int c) {
    return part.features.vertices[static_cast<std::size_t>(part.surface.F()(face, c))] != FeatureVertex::smooth;
  }))
    ++face;
  const auto prepare = [&](double angle, double weight, Index at) {
    Designer designer(part.surface, {.n = 4, .guidance_weight = 1, .solver = "counted-factors"});
    designer.set_guidance(guidance);
    designer.add(SingularityTarget{.face = at, .sign = -1, .orientation = angle, .strength = 3});
    designer.add(FeatureAlignment{.features = part.features, .weight = weight, .hold = true});
    return designer;
  };
  Designer edited = prepare(0, 1, face);
  const ControlId target = edited.controls().begin()->first, features = edited.controls().rbegin()->first;
  (void)edited.solve();
  const int first = std::exchange(factors, 0);
  REQUIRE(first > 0);
  const auto check_bits = [&](double angle, double weight, Index at) {
    const ComplexVectorX<double> u = edited.solve().field.u;
    const int again = std::exchange(factors, 0);
    CHECK(u == prepare(angle, weight, at).solve().field.u);
    factors = 0;
    return again;
  };
  edited.set(target, SingularityTarget{.face = face, .sign = -1, .orientation = 0.3, .strength = 3});
  CHECK(check_bits(0.3, 1, face) < first);
  CHECK(check_bits(0.3, 1, face) == 0);  // asked for twice
  edited.set(features, FeatureAlignment{.features = part.features, .weight = 5, .hold = true});
  CHECK(check_bits(0.3, 5, face) > 0);
}

TEST_CASE("on a flat plate, where parallel fields are free, held features alone make the design regular") {
  const FeatureCase plate("plate with a hole", test::plate_with_hole(0.4, 5, 6));
  Designer designer(plate.surface, {.n = 4});
  designer.add(FeatureAlignment{.features = plate.features});
  const DesignResult result = designer.solve();
  CHECK(worst_held(plate, result.field, false) < 1e-12);
  CHECK(result.controls[0].met);
  const EigenDesignResult smooth = eigen_design(plate.surface, {.features = {{.features = plate.features}}}, {.n = 4});
  CHECK(worst_held(plate, smooth.field, false) < 1e-12);
  CHECK(smooth.features[0].met);
}

TEST_CASE("what features cannot be is named") {
  const FeatureCase part = known_parts().at(0);
  Designer odd(part.surface, {.n = 3}), even(part.surface, {.n = 4});
  CHECK_THROWS_WITH_AS((void)odd.add(FeatureAlignment{.features = part.features}),
                       "option 'n' = 3: must be even: a feature has no sense of direction", OptionError);
  CHECK_THROWS_AS((void)even.add(FeatureAlignment{}), OptionError);
  CHECK_THROWS_AS((void)even.add(FeatureAlignment{.features = part.features, .weight = 0}), OptionError);
  FeatureGraph none = part.features;
  none.edges.clear();
  none.lines.clear();
  CHECK_THROWS_WITH_AS((void)even.add(FeatureAlignment{.features = none}),
                       "option 'features' = none: needs feature edges to align with", OptionError);
  CHECK_THROWS_AS((void)eigen_design(part.surface, {.features = {{.features = none}}}, {.n = 4}), OptionError);
  CHECK_THROWS_AS((void)eigen_design(part.surface, {.features = {{.features = part.features}}}, {.n = 3}), OptionError);
  CHECK_THROWS_AS((void)eigen_design(part.surface, {.features = {{.features = part.features, .weight = -1}}}, {.n = 4}),
                  OptionError);
  CHECK_THROWS_AS((void)feature_directions(part.surface, part.features, 1), OptionError);
  CHECK_THROWS_AS((void)feature_directions(part.surface, part.features, 0), OptionError);
}
