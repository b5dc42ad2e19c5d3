// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>

#include "alcap/connection.h"
#include "alcap/generators.h"
#include "alcap/topology.h"
#include "src/base/parallel.h"
#include "src/connection/construction.h"

using namespace alcap;

namespace {

struct Case {
  Mesh mesh;
  Geometry geometry;
  explicit Case(const MeshData& s) : mesh(s.F, s.V.rows()), geometry(mesh, s.V) {}
};

double total_curvature(const Connection& c) { return std::accumulate(c.K.begin(), c.K.end(), 0.0); }

// eps and tau as their definitions, modulo 2 pi (LTGD 2016, eq. 8).
void check_definitions(const Case& s, const Connection& c) {
  double worst = 0;
  for (Index h = 0; h < s.mesh.halfedges(); ++h) {
    const double eps = -c.rho_start(s.mesh, h) + c.rho_along(s.mesh, h) + c.rho_end(s.mesh, h);
    const double tau = -c.rho_t[h] + c.rho_along(s.mesh, h) + c.rho_t[Mesh::next(h)];
    worst = std::max({worst, std::abs(wrap(eps - c.eps_along(s.mesh, h))), std::abs(wrap(tau - c.tau[h]))});
  }
  CHECK(worst < 1e-12);
  for (Index t = 0; t < s.mesh.faces(); ++t)
    CHECK(c.K[t] == doctest::Approx(-(c.tau[3 * t] + c.tau[3 * t + 1] + c.tau[3 * t + 2])).epsilon(1e-14));
}

std::pair<double, double> curvature_range(const Case& s, const Connection& c) {
  double low = 1e300, high = -1e300;
  for (Index t = 0; t < s.mesh.faces(); ++t) {
    low = std::min(low, c.K[t] / s.geometry.area(t));
    high = std::max(high, c.K[t] / s.geometry.area(t));
  }
  return {low, high};
}

}  // namespace

// The numbers of the next two tests are those of an independent prototype in another language, whose integrals are
// 20-point Gauss quadrature instead of closed forms; test_global_oracle.cpp solves the same problem a third way.
TEST_CASE("reference numbers on the icosphere of 642 vertices") {
  const Case s(icosphere(3));
  const auto local = locally_optimal(s.mesh, s.geometry);
  CHECK(local.report.D_T == doctest::Approx(0.006020479337).epsilon(1e-9));
  CHECK(curvature_range(s, local).first == doctest::Approx(0.9172228055).epsilon(1e-9));
  CHECK(curvature_range(s, local).second == doctest::Approx(1.0824831533).epsilon(1e-9));

  const auto mean = globally_optimal(s.mesh, s.geometry);
  CHECK(mean.report.converged);
  CHECK(mean.report.D_T == doctest::Approx(0.006127049193).epsilon(1e-9));
  CHECK(mean.report.D_E == doctest::Approx(0.005996247209).epsilon(1e-9));
  CHECK(curvature_range(s, mean).first == doctest::Approx(0.83520369).epsilon(1e-7));
  CHECK(curvature_range(s, mean).second == doctest::Approx(1.14769776).epsilon(1e-7));

  const auto metric = globally_optimal(s.mesh, s.geometry, {.length_factor = LengthFactor::metric});
  CHECK(metric.report.D_T == doctest::Approx(0.006020087564).epsilon(1e-9));
  CHECK(metric.report.D_E == doctest::Approx(0.0009393253754).epsilon(1e-9));

  const auto per_edge = globally_optimal(s.mesh, s.geometry, {.length_factor = LengthFactor::per_edge});
  CHECK(per_edge.report.D_T == doctest::Approx(0.006094258938).epsilon(1e-9));
  CHECK(per_edge.report.D_E == doctest::Approx(0.005996805941).epsilon(1e-9));
}

TEST_CASE("reference numbers on the torus") {
  const Case s(torus(40, 20, 1.0, 0.4));
  const auto mean = globally_optimal(s.mesh, s.geometry);
  CHECK(mean.report.D_T == doctest::Approx(0.03530682245).epsilon(1e-9));
  CHECK(mean.report.D_E == doctest::Approx(0.02245084237).epsilon(1e-9));
  const auto metric = globally_optimal(s.mesh, s.geometry, {.length_factor = LengthFactor::metric});
  CHECK(metric.report.D_T == doctest::Approx(0.02678642735).epsilon(1e-9));
  CHECK(metric.report.D_E == doctest::Approx(0.007572780644).epsilon(1e-9));
}

TEST_CASE("every construction satisfies the definitions and Gauss-Bonnet") {
  for (const MeshData& surface : {icosphere(2), jittered_sphere(3, 0.2, 7), torus_random_diagonals(20, 12, 1, 0.4, 3),
                                  genus_surface(2, 2), genus_surface(3, 1), cad_like(24, 3)}) {
    const Case s(surface);
    const double expected = 2 * pi<double> * find_topology(s.mesh).euler();
    for (const auto& c : {polar(s.mesh, s.geometry), polar(s.mesh, s.geometry, {.center = PolarCenter::barycenter}),
                          locally_optimal(s.mesh, s.geometry), globally_optimal(s.mesh, s.geometry)}) {
      check_definitions(s, c);
      CHECK(std::abs(total_curvature(c) - expected) < 1e-10 * (s.mesh.faces() + std::abs(expected)));
    }
  }
}

TEST_CASE("with boundary the curvature is 2 pi chi less the turning of the boundary") {
  for (const MeshData& surface : {cylinder(16, 8), disk(6), grid(5, 4), noisy_scan(3, 0.1, 5), single_triangle()}) {
    const Case s(surface);
    double expected = 2 * pi<double> * find_topology(s.mesh).euler();
    for (Index v = 0; v < s.mesh.vertices(); ++v)
      if (s.mesh.boundary_vertex(v)) expected -= s.geometry.defect(s.mesh, v);
    for (const auto& c : {polar(s.mesh, s.geometry), locally_optimal(s.mesh, s.geometry)}) {
      check_definitions(s, c);
      CHECK(std::abs(total_curvature(c) - expected) < 1e-11 * (s.mesh.faces() + 1));
    }
    check_definitions(s, globally_optimal(s.mesh, s.geometry));
  }
}

TEST_CASE("a flat piece needs no correction") {
  const Case s(disk(5));
  const auto c = globally_optimal(s.mesh, s.geometry);
  CHECK(c.report.D_T < 1e-24);
  CHECK(c.report.D_E < 1e-24);
  CHECK(c.K.cwiseAbs().maxCoeff() < 1e-12);
}

TEST_CASE("the locally optimal connection spreads a face's curvature evenly over its halfedges") {
  const Case s(jittered_sphere(3, 0.2, 1));
  const auto c = locally_optimal(s.mesh, s.geometry);
  for (Index h = 0; h < s.mesh.halfedges(); ++h) CHECK(c.tau[h] == doctest::Approx(-c.K[h / 3] / 3).epsilon(1e-10));
}

TEST_CASE("tau vanishes under refinement with the incenter and does not with the barycenter") {
  double incenter = 1, barycenter = 0;
  for (int level = 2; level <= 5; ++level) {
    const Case s(icosphere(level));
    const double now = polar(s.mesh, s.geometry).tau.cwiseAbs().maxCoeff();
    CHECK(now < 0.3 * incenter);
    incenter = now;
    barycenter = polar(s.mesh, s.geometry, {.center = PolarCenter::barycenter}).tau.cwiseAbs().maxCoeff();
    CHECK(barycenter > 0.05);
  }
}

TEST_CASE("the global optimum cannot be improved by any change of its angles") {
  const Case s(jittered_sphere(2, 0.2, 3));
  const GlobalOptions options{.detail = 0.7, .tolerance = 1e-12};
  const auto best = globally_optimal(s.mesh, s.geometry, options);
  const double energy = best.report.D_T + options.detail * best.report.D_E;
  const auto perturbed = [&](auto&& change) {
    auto c = best;
    change(c);
    for (Index h = 0; h < s.mesh.halfedges(); ++h)  // small changes keep the lift
      c.tau[h] += wrap(-c.rho_t[h] + c.rho_along(s.mesh, h) + c.rho_t[Mesh::next(h)] - c.tau[h]);
    measure_deviation(s.mesh, s.geometry, options, c);
    return c.report.D_T + options.detail * c.report.D_E;
  };
  const double d = 1e-3;
  for (Index k = 0; k < s.mesh.edges(); k += 7) {
    // A quadratic minimum: both directions rise, and by the same amount.
    for (int which = 0; which < 3; ++which) {
      const auto move = [&](double by) {
        return perturbed([&](Connection& c) {
          if (which == 0) c.rho[k] += by;
          if (which == 1) c.rho_e[k] += by;
          if (which == 2) c.rho_t[k] += by;
        });
      };
      const double up = move(d) - energy, down = move(-d) - energy;
      CHECK(up > 0);
      CHECK(up == doctest::Approx(down).epsilon(1e-5));
    }
  }
}

TEST_CASE("iterations do not grow under refinement, at any detail") {
  // The system is local: its condition depends on detail, about as 1 / detail, and on the shape of the faces alone.
  // Curvature spreads over some detail^-1/2 edges; the meshes are several times larger than that.
  for (const double detail : {1.0, 0.01, 1e-3}) {
    int before = 0;
    for (const int size : {3, 6}) {
      const Case s(torus_random_diagonals(40 * size, 16 * size, 1, 0.4, 3));
      const auto c = globally_optimal(s.mesh, s.geometry, {.detail = detail, .tolerance = 1e-10});
      CHECK(c.report.converged);
      CHECK(c.report.residual <= 1e-10);
      CHECK(c.report.iterations <= 30 / std::sqrt(detail));
      if (before > 0) CHECK(c.report.iterations <= 1.35 * before);
      before = c.report.iterations;
    }
  }
}

TEST_CASE("the start does not matter: the optimum from the polar and from the local connection is the same") {
  const Case s(jittered_sphere(3, 0.2, 4));
  const GlobalOptions options{.tolerance = 1e-12};
  VectorX<double> defects(s.mesh.vertices());
  for (Index v = 0; v < s.mesh.vertices(); ++v) defects[v] = s.geometry.defect(s.mesh, v);
  detail::LiftedResiduals residuals;
  auto c = detail::build_connection(s.mesh, s.geometry, defects, {}, PolarCenter::barycenter, residuals);
  detail::optimise_locally(s.mesh, c, residuals);
  detail::optimise_globally(s.mesh, s.geometry, options, c, residuals);
  const auto d = globally_optimal(s.mesh, s.geometry, options);
  CHECK((c.K - d.K).cwiseAbs().maxCoeff() < 1e-11);
  CHECK((c.tau - d.tau).cwiseAbs().maxCoeff() < 1e-11);
  check_definitions(s, c);
}

TEST_CASE("faces around a vertex keep their direction on average, however edges are numbered") {
  for (const MeshData& surface : {jittered_sphere(3, 0.2, 4), noisy_scan(3, 0.1, 2), disk(8)}) {
    const Case s(surface);
    const auto start = polar(s.mesh, s.geometry);
    const auto c = globally_optimal(s.mesh, s.geometry, {.tolerance = 1e-12});
    double largest = 0;
    for (Index v = 0; v < s.mesh.vertices(); ++v) {
      double sum = 0;
      s.mesh.for_each_outgoing(v, [&](Index h) {
        const double turn = wrap(c.rho_t[h] - start.rho_t[h]);
        largest = std::max(largest, std::abs(turn));
        sum += s.geometry.angle(h) * turn;
      });
      CHECK(std::abs(sum) < 1e-12);
    }
    if (s.mesh.vertices() == s.mesh.faces() / 2 + 2) CHECK(largest > 1e-3);  // closed and curved: it did turn some
  }
}

TEST_CASE("the deviations reported by the optimisation are those of its result") {
  for (const MeshData& surface : {jittered_sphere(3, 0.2, 6), noisy_scan(3, 0.1, 5), cylinder(16, 8)}) {
    const Case s(surface);
    const auto c = globally_optimal(s.mesh, s.geometry);
    auto again = c;
    measure_deviation(s.mesh, s.geometry, {}, again);
    CHECK(again.report.D_T == doctest::Approx(c.report.D_T).epsilon(1e-10));
    CHECK(again.report.D_E == doctest::Approx(c.report.D_E).epsilon(1e-10));
  }
}

TEST_CASE("detail trades D_T against D_E monotonically") {
  const Case s(bumpy_sphere(4, 0.2, 9));
  double last_T = 0, last_E = 1e300;
  for (const double detail : {0.03, 0.1, 0.3, 1.0, 3.0, 10.0}) {
    const auto c = globally_optimal(s.mesh, s.geometry, {.detail = detail});
    CHECK(c.report.converged);
    CHECK(c.report.D_T > last_T);
    CHECK(c.report.D_E < last_E);
    last_T = c.report.D_T;
    last_E = c.report.D_E;
  }
}

TEST_CASE("scaling a mesh changes nothing, except for the metric length factor") {
  MeshData surface = jittered_sphere(3, 0.2, 11);
  const Case reference(surface);
  const auto c = globally_optimal(reference.mesh, reference.geometry);
  for (const double scale : {1e-6, 1e6}) {
    MeshData scaled = surface;
    scaled.V *= scale;
    const Case s(scaled);
    const auto d = globally_optimal(s.mesh, s.geometry);
    CHECK((d.K - c.K).cwiseAbs().maxCoeff() < 1e-8);
    CHECK(d.report.D_E == doctest::Approx(c.report.D_E).epsilon(1e-9));
    const auto m = globally_optimal(s.mesh, s.geometry, {.length_factor = LengthFactor::metric});
    CHECK(std::abs(m.report.D_T /
                       globally_optimal(reference.mesh, reference.geometry, {.length_factor = LengthFactor::metric})
                           .report.D_T -
                   1) > 1e-4);
  }
}

TEST_CASE("pieces do not feel each other") {
  const MeshData a = jittered_sphere(2, 0.2, 1);
  MeshData b = torus(12, 8, 100, 30);
  MeshData both;
  both.V.resize(a.V.rows() + b.V.rows(), 3);
  both.V << a.V, b.V;
  both.F.resize(a.F.rows() + b.F.rows(), 3);
  both.F << a.F, (b.F.array() + static_cast<Index>(a.V.rows())).matrix();
  const Case together(both), first(a), second(b);
  const auto c = globally_optimal(together.mesh, together.geometry, {.tolerance = 1e-12});
  const auto d = globally_optimal(first.mesh, first.geometry, {.tolerance = 1e-12});
  const auto e = globally_optimal(second.mesh, second.geometry, {.tolerance = 1e-12});
  CHECK((c.K.head(a.F.rows()) - d.K).cwiseAbs().maxCoeff() < 1e-9);
  CHECK((c.K.tail(b.F.rows()) - e.K).cwiseAbs().maxCoeff() < 1e-9);
}

TEST_CASE("relabelling vertices, turning faces' corners and shuffling faces relabels the curvature only") {
  const MeshData surface = torus_random_diagonals(16, 10, 1, 0.4, 9);
  const Case s(surface);
  const auto c = globally_optimal(s.mesh, s.geometry, {.tolerance = 1e-12});
  // vertex v -> (a v + b) mod #V, face t -> reversed order, corners turned by t mod 3
  const Index n = s.mesh.vertices();
  const auto rename = [n](Index v) { return static_cast<Index>((std::int64_t{v} * 37 + 11) % n); };
  REQUIRE(n % 37 != 0);
  MeshData other{Positions<double>(n, 3), Faces(surface.F.rows(), 3)};
  for (Index v = 0; v < n; ++v) other.V.row(rename(v)) = surface.V.row(v);
  const Index faces = s.mesh.faces();
  for (Index t = 0; t < faces; ++t)
    for (Index k = 0; k < 3; ++k) other.F(faces - 1 - t, (k + t) % 3) = rename(surface.F(t, k));
  const Case o(other);
  const auto d = globally_optimal(o.mesh, o.geometry, {.tolerance = 1e-12});
  CHECK(d.report.D_T == doctest::Approx(c.report.D_T).epsilon(1e-10));
  for (Index t = 0; t < faces; ++t) CHECK(std::abs(d.K[faces - 1 - t] - c.K[t]) < 1e-9);
}

TEST_CASE("thread count changes no bit") {
  const Case s(jittered_sphere(5, 0.2, 2));
  Connection c[3];
  const int threads[3] = {1, 2, 4};
  for (int k = 0; k < 3; ++k) run_with_threads(threads[k], [&] { c[k] = globally_optimal(s.mesh, s.geometry); });
  for (int k = 1; k < 3; ++k) {
    CHECK(c[k].rho == c[0].rho);
    CHECK(c[k].rho_e == c[0].rho_e);
    CHECK(c[k].rho_t == c[0].rho_t);
    CHECK(c[k].K == c[0].K);
    CHECK(c[k].report.D_E == c[0].report.D_E);
  }
}

TEST_CASE("slivers of relative area 1e-8 work") {
  // A square whose diagonal is doubled by a vertex 1e-8 off it: two slivers.
  MeshData s{Positions<double>(5, 3), Faces(4, 3)};
  s.V << 0, 0, 0, 1, 0, 0, 1, 1, 0.3, 0, 1, 0, 0.5 + 1e-8, 0.5 - 1e-8, 0.15;
  s.F << 0, 1, 4, 1, 2, 4, 0, 4, 2, 0, 2, 3;
  const Case c(s);
  const auto g = globally_optimal(c.mesh, c.geometry);
  CHECK(g.report.converged);
  CHECK(g.K.allFinite());
  check_definitions(c, g);
}

TEST_CASE("bad options are refused by name") {
  const Case s(tetrahedron());
  const auto field = [&](const GlobalOptions& o) -> std::string {
    try {
      (void)globally_optimal(s.mesh, s.geometry, o);
    } catch (const OptionError& e) {
      return e.field();
    }
    return "";
  };
  CHECK(field({.detail = 0}) == "detail");
  CHECK(field({.detail = std::nan("")}) == "detail");
  CHECK(field({.tan_cap = -1}) == "tan_cap");
  CHECK(field({.tolerance = 0}) == "tolerance");
  CHECK(field({.max_iterations = 0}) == "max_iterations");
  CHECK(field({}).empty());
}
