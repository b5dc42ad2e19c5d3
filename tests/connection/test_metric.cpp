// SPDX-License-Identifier: MIT
//
// Metric connections with cones and holonomies of any size, and the connection nearest to a target.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "alcap/singularities.h"
#include "alcap/smoothest.h"
#include "alcap/strokes.h"
#include "alcap/transport.h"
#include "src/base/random.h"
#include "tests/support/mesh_families.h"
#include "tests/support/surfaces.h"

using namespace alcap;
using namespace alcap::test;

namespace {

Surface surface_of(const MeshData& data) { return {data.V, data.F}; }

/// The curvature that a vector finds on the way around interior vertex v, along the edges of its ring.
double found_around(const ConnectedSurface& s, Index v) {
  std::vector<Index> ring;
  s.mesh().for_each_outgoing(v, [&](Index h) { ring.push_back(s.mesh().tip(h)); });
  ring.push_back(ring.front());
  return transport(s, ring, 1.0).turn;
}

/// All faces that touch no cone are flat, and around a vertex without cones nearby a vector finds its cone.
void check_cones(const ConnectedSurface& s, const std::vector<Cone>& cones) {
  VectorX<double> wanted = VectorX<double>::Zero(s.mesh().vertices());
  for (const Cone& cone : cones) wanted[cone.vertex] += 2 * pi<double> * cone.index;
  for (Index t = 0; t < s.mesh().faces(); ++t) {
    double corners = 0;
    for (int c = 0; c < 3; ++c) corners += std::abs(wanted[s.mesh().F()(t, c)]);
    if (corners == 0) CHECK(std::abs(s.connection().K[t]) < 1e-11);
  }
  for (Index v = 0; v < s.mesh().vertices(); ++v) {
    if (s.mesh().boundary_vertex(v)) continue;
    double beside = 0;
    s.mesh().for_each_outgoing(v, [&](Index h) { beside += std::abs(wanted[s.mesh().tip(h)]); });
    if (beside == 0) CHECK(std::abs(wrap(found_around(s, v) - wanted[v])) < 1e-9);
  }
}

double sum_at(const ConnectedSurface& s, Index v) {
  double sum = 0;
  s.mesh().for_each_outgoing(v, [&](Index h) { sum += s.connection().K[Mesh::face(h)]; });
  return sum;
}

/// The path through the middles of a strip of faces.
std::vector<SurfacePoint> along(const Loop& strip) {
  std::vector<SurfacePoint> points;
  for (const Index h : strip.halfedges) {
    points.push_back({Mesh::face(h), {1.0 / 3, 1.0 / 3, 1.0 / 3}});
    points.push_back(detail::on_halfedge(h, 0.5));
  }
  points.push_back(points.front());
  return points;
}

double deviation(const ConnectedSurface& s, Connection c, const GlobalOptions& options) {
  measure_deviation(s.mesh(), s.geometry(), options, c);
  return c.report.D_T + options.detail * c.report.D_E;
}

/// The same connection with some angles moved: rho_ij, rho_{v->e} and rho_{v->t}, lifts kept.
Connection moved(const Mesh& mesh, Connection c, double size, bool rotations, detail::Random& random) {
  const auto any = [&] { return random.uniform(-size, size); };
  for (Index e = 0; e < mesh.edges(); ++e) {
    const double tail = any(), tip = any(), along_edge = rotations ? any() : 0.0;
    c.rho_e[2 * e] += tail;
    c.rho_e[2 * e + 1] += tip;
    c.rho[e] += along_edge;
    c.eps[e] += along_edge - tail + tip;
    const Index h = mesh.halfedge(e), g = mesh.twin(h);
    c.tau[h] += along_edge;
    if (g != none) c.tau[g] -= along_edge;
  }
  for (Index h = 0; h < mesh.halfedges(); ++h) {
    const double turn = any();
    c.rho_t[h] += turn;
    c.tau[h] -= turn;
    c.tau[Mesh::prev(h)] += turn;
  }
  return c;
}

void check_best(const ConnectedSurface& s, bool rotations) {
  const double best = deviation(s, s.connection(), {});
  CHECK(s.connection().report.converged);
  CHECK(s.connection().report.D_T + s.connection().report.D_E == doctest::Approx(best).epsilon(1e-9));
  detail::Random random(2);
  for (const double size : {1e-1, 1e-2, 1e-3})
    for (int k = 0; k < 5; ++k)
      CHECK(deviation(s, moved(s.mesh(), s.connection(), size, rotations, random), {}) > best);
}

VectorX<double> random_adjustment(const Mesh& mesh, double size, std::uint64_t seed) {
  detail::Random random(seed);
  VectorX<double> alpha(mesh.halfedges());
  for (double& a : alpha) a = random.uniform(-size, size);
  return alpha;
}

}  // namespace

TEST_CASE("cones of any size: what is asked for is what a vector finds") {
  const Surface sphere = surface_of(jittered_sphere(3, 0.2, 4));
  for (const std::vector<Cone>& cones : {std::vector<Cone>{{10, 0.3}, {200, 0.7}, {500, 1}},
                                         {{10, 2.17}, {300, -0.17}},
                                         {{1, 1 / 3.0}, {90, 5 / 3.0}}}) {
    const ConnectedSurface s(sphere, metric_connection(sphere, cones));
    CHECK(s.connection().report.converged);
    CHECK(s.connection().K.sum() == doctest::Approx(4 * pi<double>));
    check_cones(s, cones);
  }
  const Surface two = surface_of(genus_surface(2, 4));
  const std::vector<Cone> cones = {{20, -1.3}, {90, 0.45}, {150, -1.15}};
  check_cones({two, metric_connection(two, cones)}, cones);
}

TEST_CASE("holonomies of generators of any size are what a vector finds") {
  for (const MeshData& data : {torus_random_diagonals(20, 10, 1, 0.4, 2), genus_surface(2, 3)}) {
    const Surface surface = surface_of(data);
    const std::vector<Loop> strips = homology_generators(surface);
    std::vector<double> wanted;
    for (std::size_t k = 0; k < strips.size(); ++k) wanted.push_back(0.13 + 0.217 * static_cast<double>(k));
    // Cones off the strips.
    std::vector<bool> beside(static_cast<std::size_t>(surface.mesh().vertices()), false);
    for (const Loop& strip : strips)
      for (const Index h : strip.halfedges)
        for (int c = 0; c < 3; ++c) beside[static_cast<std::size_t>(surface.F()(Mesh::face(h), c))] = true;
    std::vector<Cone> cones;
    for (Index v = 0; v < surface.mesh().vertices() && cones.size() < 2; ++v)
      if (!beside[static_cast<std::size_t>(v)]) cones.push_back({v, 0});
    REQUIRE(cones.size() == 2);
    cones[0].index = 0.37;
    cones[1].index = surface.topology().euler() - 0.37;
    const ConnectedSurface s(surface, metric_connection(surface, cones, {.generator_holonomy = wanted}));
    for (std::size_t k = 0; k < strips.size(); ++k) {
      CHECK(std::abs(wrap(transport(s, along(strips[k]), 1.0).turn - 2 * pi<double> * wanted[k])) < 1e-8);
      CHECK(std::abs(wrap(2 * pi<double> * (s.connection().generator_holonomy[k] - wanted[k]))) < 1e-8);
    }
    check_cones(s, cones);
  }
}

TEST_CASE("loop indices of any size are met") {
  const Surface surface = surface_of(cylinder(16, 8));
  const std::vector<Cone> cones = {{40, 0.3}, {70, -0.6}};
  const Connection free = metric_connection(surface, cones);
  CHECK(free.loop_index[0] + free.loop_index[1] == doctest::Approx(0.3));
  const ConnectedSurface s(surface, metric_connection(surface, cones, {.loop_index = {0.05, 0.25}}));
  CHECK(s.connection().loop_index[0] == doctest::Approx(0.05));
  CHECK(s.connection().loop_index[1] == doctest::Approx(0.25));
  check_cones(s, cones);
  // Along a loop a vector turns against the boundary's direction by 2 pi times its index.
  for (std::size_t l = 0; l < 2; ++l) {
    std::vector<Index> loop;
    for (const Index h : surface.topology().loops[l].halfedges) loop.push_back(surface.mesh().tail(h));
    loop.push_back(loop.front());
    const double turn = transport(s, loop, 1.0).turn_from_path;
    CHECK(std::abs(wrap(-turn - 2 * pi<double> * s.connection().loop_index[l])) < 1e-8);
  }
}

TEST_CASE("multiples of 1/n give the trivial connection") {
  for (const MeshData& data : {jittered_sphere(3, 0.2, 4), cylinder(16, 8)}) {
    const Surface surface = surface_of(data);
    std::vector<Cone> cones = {{30, 0.25}, {70, 0.5}};
    const double rest = surface.topology().euler() - 0.75;
    if (surface.topology().loops.empty()) cones.push_back({120, rest});
    const std::vector<double> loops =
        surface.topology().loops.empty() ? std::vector<double>{} : std::vector<double>{-0.25, rest + 0.25};
    const Connection exact = trivial(surface, cones, {.n = 4, .loop_index = loops});
    const Connection any = metric_connection(surface, cones, {.loop_index = loops});
    CHECK((exact.K - any.K).cwiseAbs().maxCoeff() < 1e-9);
    CHECK((exact.tau - any.tau).cwiseAbs().maxCoeff() < 1e-7);
    CHECK(any.admits_parallel(4));
    CHECK(!any.admits_parallel(1));
    VectorX<double> curvature = VectorX<double>::Zero(surface.mesh().vertices());
    for (const Cone& cone : cones) curvature[cone.vertex] = 2 * pi<double> * cone.index;
    if (!loops.empty()) continue;
    const Connection held = nearest_connection(surface, {.vertex_curvature = curvature}, {.spread = false});
    CHECK((exact.K - held.K).cwiseAbs().maxCoeff() < 1e-9);
    CHECK((exact.tau - held.tau).cwiseAbs().maxCoeff() < 1e-7);
  }
}

TEST_CASE("no field is parallel to cones that are no multiples of 1/n, and the smoothest one is found all the same") {
  const Surface surface = surface_of(icosphere(3));
  const Connection odd = metric_connection(surface, {{10, 0.3}, {200, 0.7}, {500, 1}});
  CHECK(!odd.admits_parallel(4));
  CHECK(odd.admits_parallel(10));
  CHECK(!globally_optimal(surface).admits_parallel(1));
  const ConnectedSurface s(surface, odd);
  const SmoothestResult result = smoothest_field(s, {.n = 4});
  CHECK(result.components[0].converged);
  const std::vector<int> indices = face_indices(s, result.field);
  std::int64_t sum = 0;
  for (const int i : indices) sum += i;
  CHECK(sum == 8);
  CHECK(result.components[0].lambda > 0.01);
  // With a single-valued parallel field away from cones, only the faces around these cost anything.
  const ConnectedSurface whole(surface, metric_connection(surface, {{10, 0.25}, {200, 0.75}, {500, 1}}));
  for (const Singularity& at : find_singularities(whole, smoothest_field(whole, {.n = 4}).field)) {
    bool touches = false;
    for (int c = 0; c < 3; ++c)
      for (const Index v : {10, 200, 500}) touches = touches || surface.F()(at.face, c) == v;
    CHECK(touches);
  }
}

TEST_CASE("without a target the nearest connection is the globally optimal one, bit for bit") {
  for (const Family& family : mesh_families(2)) {
    CAPTURE(family.name);
    const Surface surface = surface_of(family.surface);
    const Connection a = globally_optimal(surface), b = nearest_connection(surface, {});
    CHECK(a.rho == b.rho);
    CHECK(a.rho_t == b.rho_t);
    CHECK(a.tau == b.tau);
    CHECK(a.K == b.K);
  }
}

TEST_CASE("the nearest connection to adjustment angles cannot be improved by any change of its angles") {
  for (const MeshData& data : {jittered_sphere(2, 0.2, 4), torus(12, 8, 1, 0.4), disk(5)}) {
    const Surface surface = surface_of(data);
    for (const double size : {0.05, 0.4}) {
      const ConnectionTarget target{.adjustment = random_adjustment(surface.mesh(), size, 7)};
      check_best({surface, nearest_connection(surface, target)}, true);
      check_best({surface, nearest_connection(surface, target, {.spread = false})}, false);
    }
  }
}

TEST_CASE("rotations and adjustment angles say the same, modulo a turn") {
  const Surface surface = surface_of(jittered_sphere(2, 0.2, 4));
  const VectorX<double> alpha = random_adjustment(surface.mesh(), 0.3, 5);
  VectorX<double> rotation(alpha.size());
  for (Index h = 0; h < surface.mesh().halfedges(); ++h)
    rotation[h] = alpha[h] - surface.geometry().direction(h) + 2 * pi<double> * (h % 5 - 2);
  const Connection a = nearest_connection(surface, {.adjustment = alpha});
  const Connection b = nearest_connection(surface, {.rotation = rotation});
  CHECK((a.K - b.K).cwiseAbs().maxCoeff() < 1e-9);
  CHECK((a.alpha - b.alpha).cwiseAbs().maxCoeff() < 1e-12);
}

TEST_CASE("curvature around vertices: held it is met to rounding, spread it is near") {
  const Surface surface = surface_of(bumpy_sphere(3, 0.1, 3));
  detail::Random random(8);
  VectorX<double> curvature(surface.mesh().vertices());
  for (double& k : curvature) k = random.uniform(0, 1);
  curvature *= 4 * pi<double> / curvature.sum();
  const ConnectedSurface held(surface, nearest_connection(surface, {.vertex_curvature = curvature}, {.spread = false}));
  // Every vertex's curvature goes to its faces in proportion to their corners.
  double worst = 0;
  for (Index t = 0; t < surface.mesh().faces(); ++t) {
    double expected = 0;
    for (Index h = 3 * t; h < 3 * t + 3; ++h) {
      const Index v = surface.mesh().tail(h);
      expected += curvature[v] * surface.geometry().angle(h) / surface.geometry().angle_sum(v);
    }
    worst = std::max(worst, std::abs(held.connection().K[t] - expected));
  }
  CHECK(worst < 1e-10);
  check_best(held, false);
  const ConnectedSurface spread(surface, nearest_connection(surface, {.vertex_curvature = curvature}));
  check_best(spread, true);
  CHECK(deviation(spread, spread.connection(), {}) < deviation(held, held.connection(), {}));
  CHECK(spread.connection().K.sum() == doctest::Approx(4 * pi<double>));
  CHECK(sum_at(spread, 7) > 0);
}

TEST_CASE("curvature of faces is met, closed and with boundary") {
  for (const MeshData& data : {jittered_sphere(3, 0.2, 4), torus(12, 8, 1, 0.4), disk(6), cad_like(12, 3)}) {
    const Surface surface = surface_of(data);
    detail::Random random(9);
    VectorX<double> curvature(surface.mesh().faces());
    for (double& k : curvature) k = random.uniform(-0.1, 0.1);
    if (surface.topology().loops.empty())
      curvature.array() += (2 * pi<double> * surface.topology().euler() - curvature.sum()) / double(curvature.size());
    const ConnectedSurface s(surface, nearest_connection(surface, {.face_curvature = curvature}));
    CHECK((s.connection().K - curvature).cwiseAbs().maxCoeff() < 1e-9);
    for (Index t = 0; t < surface.mesh().faces(); t += 5) {
      const std::vector<Index> around = {surface.F()(t, 0), surface.F()(t, 1), surface.F()(t, 2), surface.F()(t, 0)};
      CHECK(std::abs(wrap(transport(s, around, 1.0).turn - curvature[t])) < 1e-9);
    }
    check_best(s, false);
  }
}

TEST_CASE("what cannot be is refused, by name") {
  const Surface sphere = surface_of(icosphere(2)), open = surface_of(disk(3));
  const auto field_of = [](auto&& make) -> std::string {
    try {
      make();
    } catch (const OptionError& e) {
      return e.field();
    }
    return "accepted";
  };
  const auto target = [&](const Surface& s, const ConnectionTarget& t) {
    return field_of([&] { (void)nearest_connection(s, t); });
  };
  CHECK(field_of([&] { (void)metric_connection(sphere, {{0, 1.2}, {5, 0.7}}); }) == "cones");
  CHECK(field_of([&] { (void)metric_connection(sphere, {{0, 1.2}, {5, 0.8}}); }) == "accepted");
  CHECK(field_of([&] { (void)metric_connection(sphere, {{0, std::nan("")}}); }) == "cones");
  CHECK(field_of([&] {
          (void)metric_connection(sphere, {{0, 2}}, {.generator_holonomy = {0.1}});
        }) == "generator_holonomy");
  const VectorX<double> zeros = VectorX<double>::Zero(sphere.mesh().vertices());
  CHECK(target(sphere, {.vertex_curvature = zeros}) == "vertex_curvature");
  CHECK(target(sphere, {.adjustment = zeros}) == "adjustment");
  CHECK(target(sphere, {.face_curvature = VectorX<double>::Zero(sphere.mesh().faces())}) == "face_curvature");
  VectorX<double> bad = VectorX<double>::Zero(sphere.mesh().halfedges());
  bad[4] = std::nan("");
  CHECK(target(sphere, {.rotation = bad}) == "rotation[4]");
  CHECK(target(sphere, {.rotation = bad, .adjustment = bad}) == "target");
  VectorX<double> rim = VectorX<double>::Zero(open.mesh().vertices());
  rim[open.mesh().vertices() - 1] = 1;
  CHECK(target(open, {.vertex_curvature = rim}).starts_with("vertex_curvature["));
  CHECK(field_of([&] {
          (void)connect(sphere, {.kind = ConnectionKind::metric, .cones = {{0, 2}}, .target = {.adjustment = bad}});
        }) == "target");
  CHECK(field_of([&] { (void)connect(sphere, {.kind = ConnectionKind::metric, .balance_cones = true}); }) ==
        "balance_cones");
}

TEST_CASE("turns beyond what a double tells apart are refused") {
  const Surface surface = surface_of(icosphere(1));
  constexpr auto metric = ConnectionKind::metric;
  const auto refused = [&](const ConnectionOptions& options) {
    CHECK_THROWS_AS((void)connect(surface, options), OptionError);
  };
  for (const double turns : {1e7, 1e15, 1e300, std::numeric_limits<double>::infinity(), std::nan("")}) {
    CAPTURE(turns);
    refused({.kind = metric, .cones = {{0, turns}, {1, 2 - turns}}});
    refused({.kind = ConnectionKind::trivial, .cones = {{0, turns}, {1, 2 - turns}}, .n = 1});
    const auto all = [&](Eigen::Index count) {
      return VectorX<double>::Constant(count, 2 * pi<double> * turns).eval();
    };
    refused({.kind = metric, .target = {.rotation = all(surface.mesh().halfedges())}});
    refused({.kind = metric, .target = {.adjustment = all(surface.mesh().halfedges())}});
    refused({.kind = metric, .target = {.vertex_curvature = all(surface.mesh().vertices())}});
    refused({.kind = metric, .target = {.face_curvature = all(surface.mesh().faces())}});
  }
  CHECK(connect(surface, {.kind = metric, .cones = {{0, 1e5}, {1, 2 - 1e5}}}).connection().flat);
}
