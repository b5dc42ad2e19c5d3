// SPDX-License-Identifier: MIT
//
// test_refusals.cpp: what public functions refuse, by the name of the option: arrays of another mesh's size, elements
// that are not there, numbers out of range. Options that other tests go through one by one are not repeated here.
#include <doctest/doctest.h>

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "alcap/alcap.h"

using namespace alcap;

namespace {

/// A call that is to be refused, and the field that it names.
struct Refusal {
  const char* field;
  std::function<void()> call;
};

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

/// A plate with a boundary, and a smaller mesh whose parts do not fit it.
struct Scene {
  MeshData plate = grid(4, 4);
  Surface surface{plate.V, plate.F}, other{icosphere(1).V, icosphere(1).F};
  ConnectedSurface connected = connect(surface);
  Field field{.n = 4, .u = ComplexVectorX<double>::Ones(plate.V.rows()), .frames = connected.frames()};
  FeatureGraph features = sharp_edges(surface);
  CurveSet curves = streamlines(connected, field);

  [[nodiscard]] const Mesh& mesh() const { return surface.mesh(); }
  [[nodiscard]] Index faces() const { return mesh().faces(); }
};

void check_all(const std::vector<Refusal>& refusals) {
  for (const Refusal& refusal : refusals) {
    CAPTURE(std::string(refusal.field));
    try {
      refusal.call();
      FAIL("was not refused");
    } catch (const OptionError& error) {
      CAPTURE(std::string(error.what()));
      CHECK(error.field() == refusal.field);
      CHECK(!error.rule().empty());
    }
  }
}

std::vector<Refusal> mesh_refusals(const Scene& s) {
  const auto measures = [&s](Eigen::Index lengths, Eigen::Index cots, Eigen::Index areas) {
    (void)Geometry::from_measures(s.mesh(), VectorX<double>::Ones(lengths), VectorX<double>::Ones(cots),
                                  VectorX<double>::Ones(areas));
  };
  const Index edges = s.mesh().edges();
  const auto delaunay = [&s](const IntrinsicOptions& options) { (void)intrinsic_delaunay(s.surface, options); };
  return {
      {"V", [&s] { (void)Geometry(s.mesh(), s.other.positions()); }},
      {"lengths", [=, &s] { (void)Geometry::from_lengths(s.mesh(), VectorX<double>::Ones(edges + 1)); }},
      {"cots", [=, &s] { measures(edges, 2 * s.faces(), s.faces()); }},
      {"areas", [=, &s] { measures(edges, 3 * s.faces(), s.faces() - 1); }},
      {"geometry", [&s] { (void)Surface::from_geometry(s.mesh(), s.other.geometry()); }},
      {"component", [&s] { (void)extract_component(s.surface, 1); }},
      {"component", [&s] { (void)extract_component(s.surface, -1); }},
      {"point.face",
       [&s] {
         (void)position(s.surface, {s.faces(), {1, 0, 0}});
       }},
      {"pairs",
       [&s] {
         (void)edges_between(s.surface, {{0, 24}});
       }},
      {"vertices[1]",
       [&s] {
         (void)stroke_along_vertices(s.surface, {0, 25});
       }},
      {"low_angle", [&s] { (void)sharp_edges(s.surface, {.angle = 0.5, .low_angle = 0.6}); }},
      {"low_angle", [&s] { (void)sharp_edges(s.surface, {.low_angle = nan}); }},
      {"min_angle", [=] { delaunay({.min_angle = 0.6}); }},
      {"min_angle", [=] { delaunay({.min_angle = nan}); }},
      {"max_radius", [=] { delaunay({.min_angle = 0.2, .max_radius = infinity}); }},
      {"most_flips", [=] { delaunay({.most_flips = -1}); }},
      {"most_vertices", [=] { delaunay({.most_vertices = 1e7}); }},
      {"keep", [=] { delaunay({.keep = {edges}}); }},
      {"weld_tolerance", [&s] { (void)repair_mesh(s.plate.V, s.plate.F, {.weld_tolerance = 0.2}); }},
  };
}

std::vector<Refusal> field_refusals(const Scene& s) {
  const Field no_frames{.n = 4, .u = s.field.u, .frames = nullptr};
  const auto at_boundary = [&s] {
    Loop strip;
    for (Index h = 0; h < s.mesh().halfedges() && strip.halfedges.empty(); ++h)
      if (s.mesh().twin(h) == none) strip.halfedges = {h};
    (void)holonomy(s.connected, strip);
  };
  return {
      {"k", [&s] { (void)s.field.vectors(4); }},
      {"k", [&s] { (void)s.field.vectors(-1); }},
      {"frames", [=] { (void)no_frames.vectors(0); }},
      {"face_field.u", [&s] { (void)vertex_indices(s.surface, s.field); }},
      {"indices", [&s] { (void)find_singularities(s.connected, s.field, std::vector<int>(3)); }},
      {"pattern",
       [&s] {
         (void)stiffness_and_mass(s.mesh(), HermitianPattern(s.other.mesh()), s.surface.geometry(),
                                  s.connected.connection(), 4);
       }},
      {"strip", at_boundary},
      {"k", [&s] { (void)s.curves.path(s.curves.size()); }},
      {"max_points", [&s] { (void)streamlines(s.connected, s.field, {.max_points = -1}); }},
      {"seeds[0].angle",
       [&s] {
         (void)trace_curves(s.connected, s.field, std::vector<CurveSeed>{{{0, {0.3, 0.3, 0.4}}, nan}});
       }},
      {"singularities[0]",
       [&s] { (void)separatrices(s.connected, s.field, std::vector<Singularity>{{.face = s.faces()}}); }},
      {"max_steps", [&s] { (void)aligned_field(s.connected, s.features, {.max_steps = -1}); }},
      {"settled_degrees", [&s] { (void)aligned_field(s.connected, s.features, {.settled_degrees = 0}); }},
      {"finest", [&s] { (void)aligned_field(s.connected, s.features, {.finest = 0.5}); }},
      {"features", [&s] { (void)aligned_field(s.connected, FeatureGraph{}); }},
  };
}

std::vector<Refusal> run_refusals(const Scene& s) {
  const auto matrices = energy_matrices(s.connected, 4);
  const auto run = [&s](const EigenOptions& eigen) { (void)run_field(s.surface, {.n = 4, .eigen = eigen}); };
  const auto merged = [&s] {
    Designer designer(s.connected, {.n = 4, .guidance_weight = 1});
    const ControlId id = designer.add(SingularityTarget{.face = 3});
    (void)designer.merge(id, id);
  };
  const auto nothing = [](Context&, std::int64_t) {};
  const auto failed = [](std::int64_t, const std::exception&) {};
  return {
      {"repairs", [&s] { (void)run_field(s.surface, {.repairs = {Repair::weld}}); }},
      {"angle_tolerance", [=] { run({.angle_tolerance = 11}); }},
      {"angle_tolerance", [=] { run({.angle_tolerance = nan}); }},
      {"sigma", [=] { (void)inertia(matrices.S, matrices.M, infinity); }},
      {"right_hand_sides", [] { (void)make_linear_solver<double>({.right_hand_sides = -1}); }},
      {"other", merged},
      {"count", [=] { run_batch(-1, {}, nothing, failed); }},
      {"jobs", [=] { run_batch(1, {.jobs = -1}, nothing, failed); }},
      {"memory", [] { (void)plan_field({.faces = 10, .memory = -1}); }},
      {"formats", [] { (void)plan_field({.faces = 10, .formats = {"exe"}}); }},
      {"speed", [] { (void)plan_field({.faces = 10, .speed = infinity}); }},
      {"vertices", [] { (void)plan_field({.faces = 10, .vertices = -1}); }},
  };
}

}  // namespace

TEST_CASE("what a public function refuses has the name of the option: meshes and surfaces") {
  const Scene scene;
  check_all(mesh_refusals(scene));
}

TEST_CASE("what a public function refuses has the name of the option: fields, curves, connections") {
  const Scene scene;
  check_all(field_refusals(scene));
}

TEST_CASE("what a public function refuses has the name of the option: solvers, runs, designs") {
  const Scene scene;
  check_all(run_refusals(scene));
}
