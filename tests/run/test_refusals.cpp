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

/// A call that is to be refused, the field that it names, and parts of the value and the rule.
struct Refusal {
  const char* field;
  std::function<void()> call;
  const char* value = "";
  const char* rule = "";
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
      CHECK(error.value().find(refusal.value) != std::string::npos);
      CHECK(!error.rule().empty());
      CHECK(error.rule().find(refusal.rule) != std::string::npos);
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
      {"u", [&s] { (void)intrinsic_delaunay(s.surface).from_given(ComplexVectorX<double>(3), 4); }, "3 values",
       "one per given vertex"},
#ifndef ALCAP_INDEX_64  // where no memory holds what cannot be numbered
      {"steps", [] { (void)cad_like(100'000, 2000); }, "2000", "more faces than can be numbered"},
      {"F",
       [] {
         const std::int32_t face[3] = {0, 1, 2};  // all rows are this one
         (void)detail::copy_faces<std::int32_t>({face, std::int64_t{1} << 31, 0, 1});
       },
       "2147483648 rows", "2^31 / 3"},
#endif
  };
}

/// A triangle with edges of length 1 whose corners are where it is said, for what only positions can be wrong about.
ConnectedSurface triangle_at(const Positions<double>& V) {
  const Mesh mesh(single_triangle().F, 3);
  return connect(Surface::from_lengths(mesh, VectorX<double>::Ones(mesh.edges()), V));
}

std::vector<Refusal> position_refusals(const Scene& s) {
  const auto curves = [](const Positions<double>& V) {
    (void)streamlines(triangle_at(V), {.n = 1, .u = ComplexVectorX<double>::Ones(3), .frames = nullptr});
  };
  Positions<double> nowhere = single_triangle().V;
  nowhere(1, 2) = nan;
  Field hole = s.field, none = s.field;
  hole.u[3] = {0, infinity};
  none.n = 0;
  return {
      {"V", [=] { curves(nowhere); }, "not finite", "vertex 1"},
      {"V", [=] { curves(Positions<double>::Zero(3, 3)); }, "0", "diagonal"},
      {"field.u", [=, &s] { (void)streamlines(s.connected, hole); }, "not finite", "vertex 3"},
      {"field.n", [=, &s] { (void)streamlines(s.connected, none); }, "0", "at least 1"},
      {"n", [&s] { (void)smoothest_modes(s.connected, 1, {.n = 0}); }, "0", "at least 1"},
      {"points",
       [] {
         // Different points of a needle, no further apart than rounding at its size.
         Positions<double> needle = single_triangle().V;
         needle << 0, 0, 0, 1e-3, 0, 0, 0, 1, 0;
         (void)stroke_through_points({needle, single_triangle().F},
                                     {{0, {0.5, 0.5, 0}}, {0, {0.5 - 2e-12, 0.5 + 2e-12, 0}}});
       },
       "all at one place", "some length"},
      {"V",
       [=] {
         const ConnectedSurface lost = triangle_at(nowhere);
         (void)write_field(
             {.surface = lost, .field = {.n = 1, .u = ComplexVectorX<double>::Ones(3), .frames = lost.frames()}},
             "none.vtp");
       },
       "not finite", "vertex 1"},
  };
}

std::vector<Refusal> field_refusals(const Scene& s) {
  const Field no_frames{.n = 4, .u = s.field.u, .frames = nullptr};
  FeatureGraph torn = s.features;
  torn.edges.push_back(-1);
  Field vectors = s.field;
  vectors.n = 1;
  Positions<double> five = Positions<double>::Zero(5, 3);  // the last one is used by no face
  five.topRows(4) = tetrahedron().V;
  const Surface loose(five, tetrahedron().F);
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
      {"u", [&s] { (void)at_faces(s.connected, {.n = 4, .u = ComplexVectorX<double>::Ones(3), .frames = nullptr}); },
       "3 entries", "one entry per vertex"},
      {"features", [=, &s] { write_sharp(s.surface, torn, "none.sharp"); }, "-1", "a graph of this surface"},
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
      {"features", [&s] { (void)aligned_field(s.connected, FeatureGraph{}); }, "0 vertices", "of this surface"},
      {"features", [=, &s] { (void)aligned_field(s.connected, torn); }, "-1", "no such edge"},
      {"n", [=, &s] { (void)aligned_field(s.connected, s.features, {.n = 0}); }, "0", "at least 1"},
      {"fixed", [=, &s] { (void)aligned_field(s.connected, s.features, {.fixed = {{.vertex = -1}}}); }, "-1",
       "a face uses"},
      {"features", [&s] { (void)measure_features(s.connected, s.field, FeatureGraph{}, {}); }, "0 vertices",
       "of this surface"},
      {"n", [=, &s] { (void)measure_features(s.connected, vectors, s.features, {}); }, "1", "must be even"},
      {"field", [=, &s] { (void)measure_features(s.connected, {.n = 4, .u = {}, .frames = nullptr}, s.features, {}); },
       "0 values", "one per vertex"},
      {"loop_index",
       [=, &s] {
         (void)connect(s.surface, {.kind = ConnectionKind::trivial, .loop_index = {1, 1}});
       },
       "2 entries", "one per boundary loop, 1"},
      {"cones",
       [=] {
         (void)connect(loose, {.kind = ConnectionKind::trivial, .cones = {{4, 1}}});
       },
       "4", "no face uses this vertex"},
      {"balance_cones",
       [&s] { (void)balance_cones(s.other.mesh(), s.other.geometry(), {{.vertex = 0, .index = 100}}, {.n = 1}); }, "98",
       "on component 0, which has 42 vertices"},
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
      {"degree", [=] { (void)smallest_eigenpair(matrices.S, matrices.M, 1, {.degree = 0}); }, "0", "at least 1"},
      {"count", [=] { (void)eigenpairs(matrices.S, matrices.M, 1, 0); }, "0", "number of rows"},
      {"max_iterations", [=] { run({.max_iterations = 0}); }, "0", "at least 1"},
      {"modes", [&s] { (void)run_field(s.surface, {.modes = 0}); }, "0", "at least 1"},
      {"threads", [&s] { (void)run_field(s.surface, {.threads = -1}); }, "-1", "1 to 4096"},
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

/// A linear solver whose answer is its right-hand side, scaled; without a factor where the scale is 0.
template <class Scalar>
class Nonsense final : public LinearSolver<Scalar> {
 public:
  explicit Nonsense(double scale) : scale_(scale) {}
  void analyse(const SparseMatrix<Scalar>&) override {}
  void factorise(const SparseMatrix<Scalar>&) override {
    if (scale_ == 0) throw SolveError("nonsense: no factor");
  }
  SolveReport solve(const Eigen::Ref<const MatrixX<Scalar>>& B, Eigen::Ref<MatrixX<Scalar>> X) const override {
    X = scale_ * B;
    SolveReport report;
    report.converged = true;
    return report;
  }
  [[nodiscard]] std::string name() const override { return "nonsense"; }

 private:
  double scale_;
};

/// What the SolveError of a call says while the solver "nonsense" answers so.
std::string said_with(double scale, const std::function<void()>& call) {
  const auto registration = register_linear_solver(
      "nonsense", [=](const SolverOptions&) { return std::make_unique<Nonsense<Complex<double>>>(scale); },
      [=](const SolverOptions&) { return std::make_unique<Nonsense<double>>(scale); });
  try {
    call();
  } catch (const SolveError& e) {
    return e.what();
  }
  return "nothing";
}

}  // namespace

TEST_CASE("a linear solver that answers nonsense is told, with what to try next") {
  constexpr double no_number = std::numeric_limits<double>::quiet_NaN();
  const MeshData plate = grid(12, 12);
  const ConnectedSurface surface = connect(Surface(plate.V, plate.F));
  const StiffnessMass m = energy_matrices(surface, 4);
  const double area = surface.geometry().total_area();
  const EigenOptions eigen{.tolerance = 1e-8, .solver = "nonsense"};
  const auto told = [](double scale, const char* what, const std::function<void()>& call) {
    const std::string said = said_with(scale, call);
    CAPTURE(said);
    CHECK(said.find(what) != std::string::npos);
  };
  for (const char* method : {"lanczos", "inverse-iteration"}) {
    CAPTURE(std::string(method));
    EigenOptions how = eigen;
    how.method = method;
    told(no_number, "EigenOptions::", [&] { (void)smallest_eigenpair(m.S, m.M, area, how); });
    told(no_number, "EigenOptions::", [&] { (void)eigenpairs(m.S, m.M, area, 3, how); });
    told(0, "nonsense: no factor (the matrix is S - sigma M", [&] { (void)smallest_eigenpair(m.S, m.M, area, how); });
  }
  const FeatureGraph features = sharp_edges(surface);
  told(no_number, "not finite; try another EigenOptions::solver",
       [&] { (void)aligned_field(surface, features, {.weight = 1, .eigen = eigen}); });
  told(1e300, "is not positive; try another EigenOptions::solver",
       [&] { (void)aligned_field(surface, features, {.weight = 1, .eigen = eigen}); });
  const SurfacePolyline line = stroke_along_vertices(surface, {14, 15, 16, 17});
  const auto design = [&](EigenPath path) {
    (void)eigen_design(surface, {.strokes = {{line, 1}}}, {.n = 2, .eigen = eigen, .path = path});
  };
  told(-1e6, "EigenDesignOptions::largest_rank 0", [=] { design(EigenPath::low_rank); });
  told(0, "nonsense: no factor", [=] { design(EigenPath::real_view); });
  told(no_number, "Repair::mollify",
       [&] { (void)trivial(surface.mesh(), surface.geometry(), {}, {.n = 1, .solver = "nonsense"}); });
}

TEST_CASE("what a public function refuses has the name of the option: meshes and surfaces") {
  const Scene scene;
  check_all(mesh_refusals(scene));
}

TEST_CASE("what a public function refuses has the name of the option: fields, curves, connections") {
  const Scene scene;
  check_all(position_refusals(scene));
  check_all(field_refusals(scene));
}

TEST_CASE("what a public function refuses has the name of the option: solvers, runs, designs") {
  const Scene scene;
  check_all(run_refusals(scene));
}
