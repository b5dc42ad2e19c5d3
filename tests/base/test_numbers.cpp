// SPDX-License-Identifier: MIT
//
// test_numbers.cpp: texts of numbers, and that every option of the library which is a number is refused with the
// shortest text of the value that was given.
#include "src/base/numbers.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "alcap/alcap.h"

using namespace alcap;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// What the options are tried on.
struct Small {
  MeshData data = icosphere(1);
  Surface surface{data.V, data.F};
  const Mesh& mesh = surface.mesh();
  const Geometry& geometry = surface.geometry();
  ConnectedSurface connected = connect(surface);
  Field field = smoothest_field(connected, {.n = 1}).field;
  SurfacePolyline line = stroke_along_vertices(surface, {0, 5});

  [[nodiscard]] Designer designer() const { return Designer(connected, {.n = 1, .guidance_weight = 1}); }
};

// An option by the name of its field, and a call that is given the value.
struct Option {
  const char* field;
  std::function<void(double)> call;
};

std::vector<Option> solver_options(const Small& s) {
  const auto field = [&s](const FieldRunOptions& o) { (void)run_field(s.data.V, s.data.F, o); };
  return {
      {"tolerance", [](double x) { (void)make_linear_solver<double>({.tolerance = x}); }},
      {"tolerance", [=](double x) { field({.eigen = {.tolerance = x}}); }},
      {"s", [=](double x) { field({.s = x}); }},
      {"s", [&s](double x) { (void)smoothest_field(s.connected, {.s = x}); }},
      {"detail", [=](double x) { field({.connection = {.global = {.detail = x}}}); }},
      {"detail", [&s](double x) { (void)globally_optimal(s.mesh, s.geometry, {.detail = x}); }},
      {"tan_cap", [&s](double x) { (void)globally_optimal(s.mesh, s.geometry, {.tan_cap = x}); }},
      {"tolerance", [&s](double x) { (void)globally_optimal(s.mesh, s.geometry, {.tolerance = x}); }},
      {"cones",
       [&s](double x) {
         (void)trivial(s.mesh, s.geometry, {{0, 1 + x}, {5, 1}});
       }},
      {"loop_index",
       [](double x) {
         const MeshData d = disk(2);
         const Surface flat(d.V, d.F);
         (void)trivial(flat.mesh(), flat.geometry(), {}, {.loop_index = {x}});
       }},
  };
}

std::vector<Option> design_options(const Small& s) {
  const auto designer = [&s](const DesignerOptions& o) { (void)Designer(s.connected, o); };
  const auto add = [&s](const Control& control) { (void)s.designer().add(control); };
  const auto eigen = [&s](const EigenControls& controls, const EigenDesignOptions& o) {
    (void)eigen_design(s.connected, controls, o);
  };
  return {
      {"guidance_weight", [=](double x) { designer({.guidance_weight = x}); }},
      {"t", [=](double x) { designer({.t = x < 0 ? -x : x}); }},
      {"s", [=](double x) { designer({.guidance_weight = 1, .s = x}); }},
      {"tolerances.stroke_degrees", [=](double x) { designer({.tolerances = {.stroke_degrees = x}}); }},
      {"tolerances.fixed_value", [=](double x) { eigen({}, {.tolerances = {.fixed_value = x}}); }},
      {"guidance_weight", [&s](double x) { s.designer().set_guidance_weight(x); }},
      {"weights",
       [&s](double x) {
         VectorX<double> weights = VectorX<double>::Ones(s.mesh.vertices());
         weights[3] = x;
         s.designer().set_guidance_weights(weights);
       }},
      {"orientation", [=](double x) { add(SingularityTarget{.face = 0, .orientation = x}); }},
      {"strength", [=](double x) { add(SingularityTarget{.face = 0, .strength = x}); }},
      {"weight", [=, &s](double x) { add(Stroke{.weight = x, .line = s.line}); }},
      {"radius", [=, &s](double x) { add(Stroke{.line = s.line, .radius = x}); }},
      {"weight", [=](double x) { add(BoundaryAlignment{.weight = x}); }},
      {"strokes[0].weight",
       [=, &s](double x) {
         eigen({.strokes = {{s.line, x}}}, {});
       }},
      {"offset", [=, &s](double x) { eigen({.strokes = {{s.line}}}, {.offset = x}); }},
      {"s", [=, &s](double x) { eigen({.strokes = {{s.line}}}, {.s = x}); }},
      {"/s", [](double x) { check_design(DesignFile{.s = x}); }},
      {"/connection/detail", [](double x) { check_design(DesignFile{.connection = {.detail = x}}); }},
      {"/guidance/weight",
       [](double x) { check_design(DesignFile{.guidance = {.source = DesignGuidance::Source::zero, .weight = x}}); }},
      {"/strokes/0/weight",
       [](double x) {
         check_design(DesignFile{.strokes = {{.vertices = {0, 1}, .weight = x}}});
       }},
      {"/strokes/0/radius",
       [](double x) {
         check_design(DesignFile{.strokes = {{.vertices = {0, 1}, .radius = x}}});
       }},
  };
}

std::vector<Option> shape_options(const Small& s) {
  const auto curves = [&s](const StreamlineOptions& o) { (void)streamlines(s.connected, s.field, o); };
  return {
      {"spacing", [=](double x) { curves({.spacing = x}); }},
      {"separation", [=](double x) { curves({.separation = x}); }},
      {"min_length", [=](double x) { curves({.min_length = x}); }},
      {"max_length", [=](double x) { curves({.max_length = x}); }},
      {"tolerance", [=](double x) { curves({.tolerance = x}); }},
      {"singularity_radius", [=](double x) { curves({.singularity_radius = x}); }},
      {"seeds[0].angle",
       [&s](double x) {
         const CurveSeed seed{{0, {0.5, 0.25, 0.25}}, x};
         (void)trace_curves(s.connected, s.field, std::span(&seed, 1));
       }},
      {"amount", [](double x) { (void)jittered_sphere(0, x, 1); }},
      {"amplitude", [](double x) { (void)bumpy_sphere(0, x, 1); }},
      {"frequency", [](double x) { (void)bumpy_sphere(0, 0.1, x); }},
      {"R", [](double x) { (void)torus(3, 3, x, 1); }},
      {"r", [](double x) { (void)torus(3, 3, 1, x); }},
      {"width", [](double x) { (void)grid(1, 1, x); }},
      {"height", [](double x) { (void)grid(1, 1, 1, x); }},
      {"radius", [](double x) { (void)cylinder(3, 1, x); }},
      {"height", [](double x) { (void)cylinder(3, 1, 1, x); }},
      {"noise", [](double x) { (void)noisy_scan(3, x, 1); }},
  };
}

}  // namespace

TEST_CASE("floating numbers become integers only in range") {
  using detail::rounded;
  using detail::to_integer;
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(to_integer(2.9, 0, 10) == 2);
  CHECK(to_integer(-2.9, -10, 10) == -2);
  CHECK(to_integer(nan, 3, 10) == 3);
  CHECK(to_integer(infinity, 3, 10) == 10);
  CHECK(to_integer(-infinity, 3, 10) == 3);
  CHECK(to_integer(1e300, std::int64_t{0}, std::numeric_limits<std::int64_t>::max()) ==
        std::numeric_limits<std::int64_t>::max());
  CHECK(rounded<int>(2.5) == 2);
  CHECK(rounded<int>(3.5) == 4);
  CHECK(rounded<int>(-2147483648.4) == std::numeric_limits<int>::min());
  CHECK(rounded<int>(2147483647.4) == std::numeric_limits<int>::max());
  CHECK_FALSE(rounded<int>(2147483647.6).has_value());
  CHECK_FALSE(rounded<int>(nan).has_value());
  CHECK_FALSE(rounded<std::int64_t>(9223372036854775808.0).has_value());
  CHECK(rounded<std::int64_t>(-9223372036854775808.0) == std::numeric_limits<std::int64_t>::min());
  CHECK_FALSE(rounded<unsigned>(-1).has_value());
  CHECK(rounded<std::int16_t>(-32768) == -32768);
  CHECK_FALSE(rounded<std::int16_t>(32768).has_value());
}

TEST_CASE("numbers are written in the shortest form that reads back") {
  using detail::number_text;
  CHECK(number_text(-1e-9) == "-1e-09");
  CHECK(number_text(-1e300) == "-1e+300");
  CHECK(number_text(0.1) == "0.1");
  CHECK(number_text(1.0 / 3) == "0.3333333333333333");
  CHECK(number_text(-0.0) == "-0");
  CHECK(number_text(0.1F) == "0.10000000149011612");
  CHECK(number_text(infinity) == "infinity");
  CHECK(number_text(-infinity) == "-infinity");
  CHECK(number_text(std::numeric_limits<double>::quiet_NaN()) == "nan");
  CHECK(number_text(-3) == "-3");
  CHECK(number_text(std::numeric_limits<std::uint64_t>::max()) == "18446744073709551615");
  CHECK(detail::rounded_text(2.0 / 3) == "0.666667");
  CHECK(detail::rounded_text(-1e-300) == "-1e-300");
  CHECK(detail::counted(1, "face has", "faces have") == "1 face has");
  CHECK(detail::counted(0, "face has", "faces have") == "0 faces have");
}

TEST_CASE("a message goes on behind a byte of value 0") {
  const OptionError error("controls", std::string("a\0b", 3), "must be a name");
  CHECK(std::string(error.what()) == "option 'controls' = a\\x00b: must be a name");
  CHECK(error.value() == std::string("a\0b", 3));
}

TEST_CASE("an OptionError holds field, value and rule apart, and all of them in its text") {
  const OptionError error("tolerance", -1e-9, "must be in (0, 1)");
  CHECK(error.field() == "tolerance");
  CHECK(error.value() == "-1e-09");
  CHECK(error.rule() == "must be in (0, 1)");
  CHECK(std::string(error.what()) == "option 'tolerance' = -1e-09: must be in (0, 1)");
}

TEST_CASE("a bad number in any option is named by its field, with the shortest text of its value") {
  const Small small;
  for (const auto& options : {solver_options(small), design_options(small), shape_options(small)}) {
    for (const Option& option : options) {
      CAPTURE(std::string(option.field));
      int refused = 0;
      for (const double bad : {-1e-9, -1e300, std::numeric_limits<double>::quiet_NaN()}) {
        // Some fields stand for a number made of the value: a sum of indices, a t of either sign. An index of -1e300 is
        // a whole number of turns.
        const std::string field = option.field;
        if (field == "loop_index" && !std::isnan(bad)) continue;
        const double given = field == "t" && bad < 0 ? -bad : bad;
        try {
          option.call(bad);
        } catch (const OptionError& error) {
          CAPTURE(std::string(error.what()));
          ++refused;
          CHECK(error.field() == field);
          if (field != "cones") CHECK(error.value() == detail::number_text(given));
          CHECK(std::string(error.what()).size() < 300);
          CHECK(std::string(error.what()).find(".000000") == std::string::npos);
        }
      }
      CHECK(refused > 0);
    }
  }
}
