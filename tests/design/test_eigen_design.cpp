// SPDX-License-Identifier: MIT
#include "alcap/eigen_design.h"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <functional>

#include "alcap/designer.h"
#include "alcap/energies.h"
#include "alcap/generators.h"
#include "alcap/operators.h"
#include "src/base/random.h"
#include "src/design/eigen/guidance.h"
#include "src/design/eigen/pencil.h"
#include "src/design/eigen/pins.h"
#include "tests/support/mesh_case.h"
#include "tests/support/mesh_helpers.h"

using namespace alcap;

namespace {

using C = Complex<double>;
using Row = Eigen::RowVector3d;

struct Case : test::ConnectedCase {
  using ConnectedCase::ConnectedCase;
  [[nodiscard]] SurfacePolyline stroke(const std::function<Row(double)>& curve, int pieces, double scale = 1) const {
    Positions<double> points(pieces + 1, 3);
    for (int k = 0; k <= pieces; ++k) points.row(k) = scale * curve(double(k) / pieces);
    return stroke_from_space(connected(), points);
  }
  [[nodiscard]] EigenDesignResult design(const std::vector<EigenStroke>& strokes,
                                         const EigenDesignOptions& options) const {
    return eigen_design(connected(), {.strokes = strokes}, options);
  }
};

Row great_circle(double t) {
  const double a = 1.5 * t + 0.3;
  return {std::cos(a), 0.6 * std::sin(a), 0.8 * std::sin(a)};
}
Row small_circle(double t) {
  const double a = 3 * t + 0.3;
  return {0.7 * std::cos(a), 0.7 * std::sin(a), 0.71};
}
Row flat_circle(double t) {
  const double a = t == 1 ? 0 : 2 * pi<double> * t;
  return {0.6 * std::cos(a), 0.6 * std::sin(a), 0};
}

// Turns every vertex frame by an angle, so that rho_v-> grow by it.
VectorX<double> turn_frames(Case& s) {
  detail::Random random(3);
  VectorX<double> angle(s.mesh.vertices());
  for (double& x : angle) x = random.uniform(-1, 1);
  Connection& c = s.connection;
  for (Index h = 0; h < s.mesh.halfedges(); ++h) c.rho_t[h] += angle[s.mesh.tail(h)];
  for (Index e = 0; e < s.mesh.edges(); ++e) {
    const Index i = s.mesh.tail(s.mesh.halfedge(e)), j = s.mesh.tip(s.mesh.halfedge(e));
    c.rho_e[2 * e] += angle[i];
    c.rho_e[2 * e + 1] += angle[j];
    c.rho[e] += angle[i] - angle[j];
  }
  return angle;
}

ComplexVectorX<double> random_values(Index count, std::uint64_t seed) {
  detail::Random random(seed);
  ComplexVectorX<double> u(count);
  for (C& z : u) {
    const double re = random.uniform(-1, 1);
    z = {re, random.uniform(-1, 1)};
  }
  return u;
}

// A field without noise that is none of the smoothest ones.
ComplexVectorX<double> smooth_field(const Case& s, int n) {
  ComplexVectorX<double> mixed(5);
  mixed << C(0.6, 0.1), C(-0.2, 0.5), C(0.4, 0.4), C(0.1, -0.7), C(0.9, 0.2);
  return smoothest_modes(s.connected(), 5, {.n = n, .eigen = {.tolerance = 1e-9}}).U * mixed;
}

// How far u is from a multiple of v of modulus 1, relatively.
double apart(const ComplexVectorX<double>& u, const ComplexVectorX<double>& v) {
  const C product = v.dot(u);
  return (u - product / std::abs(product) * v).norm() / v.norm();
}

}  // namespace

TEST_CASE("without strokes all paths give the smoothest field, on any connection and per component") {
  const Case one(bumpy_sphere(3, 0.3, 2.3));
  const Case apart_pieces(test::together(bumpy_sphere(2, 0.3, 2.3), jittered_sphere(2, 0.2, 3)));
  Case flat(icosphere(3));
  flat.connection = trivial(flat.mesh, flat.geometry, {{0, 1.0}, {5, 0.5}, {100, 0.5}}, {.n = 2});
  for (const Case* s : std::initializer_list<const Case*>{&one, &apart_pieces, &flat})
    for (const int n : {1, 2, 4}) {
      const SmoothestResult plain =
          smoothest_field(s->mesh, s->geometry, s->connection, nullptr, {.n = n, .eigen = {.tolerance = 1e-8}});
      for (const EigenPath path : {EigenPath::automatic, EigenPath::real_view, EigenPath::low_rank}) {
        const EigenDesignResult result = s->design({}, {.n = n, .eigen = {.tolerance = 1e-8}, .path = path});
        REQUIRE(result.components.size() == plain.components.size());
        for (std::size_t c = 0; c < plain.components.size(); ++c) {
          const EigenReport& a = result.components[c];
          const EigenReport& b = plain.components[c];
          CHECK(a.converged);
          CHECK(std::abs(a.lambda - b.lambda) <= 1e-8 * (b.lambda + 1 / s->geometry.total_area()));
          if (plain.components.size() == 1 && b.next.value_or(0) > 1.02 * b.lambda + 1e-3) {
            CAPTURE(n);
            CHECK(apart(result.field.u, plain.field.u) < 1e-6);
          }
        }
      }
    }
}

TEST_CASE("the real matrix and the update of the complex one agree to 1e-8 with strokes") {
  for (const MeshData& surface : {jittered_sphere(3, 0.2, 4), bumpy_sphere(3, 0.2, 3)}) {
    const Case s(surface);
    const std::vector<EigenStroke> strokes{{s.stroke(great_circle, 12), 0.5}, {s.stroke(small_circle, 30), 2}};
    for (const int n : {1, 2, 4}) {
      const auto a = s.design(strokes, {.n = n, .path = EigenPath::real_view});
      const auto b = s.design(strokes, {.n = n, .path = EigenPath::low_rank});
      CHECK(a.components[0].converged);
      CHECK(b.components[0].converged);
      CHECK(std::abs(a.components[0].lambda / b.components[0].lambda - 1) < 1e-8);
      CHECK((a.field.u - b.field.u).norm() < 1e-8 * a.field.u.norm());
      CHECK(a.components[0].solver != b.components[0].solver);
    }
  }
}

TEST_CASE("with strokes the eigenvalue is proven to be the smallest, on both paths, and every residual is given") {
  for (const bool closed : {true, false}) {
    const Case s(closed ? bumpy_sphere(4, 0.3, 2.3) : disk(16));
    const auto line = closed ? s.stroke(great_circle, 40) : s.stroke(flat_circle, 40);
    for (const int n : {1, 4})
      for (const EigenPath path : {EigenPath::real_view, EigenPath::low_rank}) {
        CAPTURE(closed);
        CAPTURE(n);
        EigenDesignOptions options{.n = n, .path = path};
        const EigenReport r = s.design({{.line = line}}, options).components[0];
        CHECK(r.converged);
        CHECK(r.smallest == Smallest::proven);
        CHECK(r.lower_bound.value() < r.lambda);
        CHECK(r.lower_bound.value() >= r.lambda - 1e-4 * std::max(r.lambda, 1.0));
        CHECK(r.energy_residual > 0);
        CHECK(r.energy_residual <= options.eigen.residual_tolerance());
        CHECK(r.distance > 0);
        options.eigen.prove_smallest = Prove::never;
        const EigenReport unproven = s.design({{.line = line}}, options).components[0];
        CHECK(unproven.smallest == Smallest::not_checked);
        CHECK(!unproven.smallest_note.empty());
        CHECK(unproven.lambda == doctest::Approx(r.lambda).epsilon(1e-8));
      }
  }
}

TEST_CASE("the mass of strokes, integrated densely with FaceField, bounds the smoothness by the eigenvalue") {
  const Case s(jittered_sphere(2, 0.15, 6));
  const int n = 2;
  const double weight = 0.3;
  const SurfacePolyline line = s.stroke(small_circle, 20);
  const auto result = s.design({{line, weight}}, {.n = n});
  const HermitianPattern pattern(s.mesh);
  const auto matrices = stiffness_and_mass(s.mesh, pattern, s.geometry, s.connection, n);
  const auto &S = matrices.S, &M = matrices.M;
  const double w = 10 * weight * std::sqrt(s.geometry.total_area());
  // The mass is checked in full; a denser rule must give the same integral.
  const auto mass = [&](const ComplexVectorX<double>& u) {
    double sum = u.dot(M * u).real(), mean = 0;
    for (const SurfaceSegment& segment : line.segments) {
      const auto field = face_field(s.mesh, s.geometry, s.connection, n, u, segment.face);
      const C turn = std::polar(1.0, -n * std::arg(segment.tangent));
      for (int k = 0; k < 40; ++k) {
        const double q = (turn * field.at(segment.at((k + 0.5) / 40)).u).real();
        sum += w * q * q * segment.length / 40;
        mean += q * segment.length / 40;
      }
    }
    return sum + 10 * w * mean * mean / line.length();
  };
  const double lambda = result.components[0].lambda, m = mass(result.field.u);
  // lambda mass = u S u + stroke part >= u S u.
  CHECK(result.field.u.dot(S * result.field.u).real() <= lambda * m * (1 + 1e-6));
  CHECK(lambda > 0);
  CHECK(result.field.u.dot(M * result.field.u).real() == doctest::Approx(1));
  // i u is as smooth as u, but goes across the stroke: its mass is smaller, the problem is not complex-linear.
  CHECK(mass(C(0, 1) * result.field.u) < 0.5 * m);
}

TEST_CASE("the heavier a stroke, the better it is followed, with finite lambda and without shrinking the field") {
  struct Try {
    Case s;
    SurfacePolyline line;
    double steady;  // from this weight on the same kind of field is the smoothest
  };
  std::vector<Try> tries;
  {
    Case sphere(jittered_sphere(3, 0.2, 4));
    auto line = sphere.stroke(small_circle, 30);
    tries.push_back({sphere, line, 0.01});
    Case flat(disk(12));
    line = flat.stroke([](double t) -> Row { return flat_circle(0.3 * t); }, 20);
    tries.push_back({flat, line, 1});
  }
  for (const Try& t : tries)
    for (const int n : {1, 2, 4}) {
      double last = 90, first = -1;
      EigenStrokeReport report;
      for (const double weight : {0.01, 0.1, 1.0, 10.0, 100.0}) {
        const auto result = t.s.design({{t.line, weight}}, {.n = n});
        report = result.strokes[0];
        CAPTURE(n);
        CAPTURE(weight);
        CHECK(result.components[0].converged);
        CHECK(std::isfinite(result.components[0].lambda));
        CHECK(result.components[0].lambda > 0);
        // Corners of the polyline leave a degree or so.
        if (weight > t.steady) CHECK(report.mean_degrees < last + 0.8);
        if (weight >= 1) CHECK(report.magnitude > 0.4);
        last = report.mean_degrees;
        if (first < 0) first = report.mean_degrees;
      }
      CHECK(report.mean_degrees < 2);
      CHECK(report.mean_degrees < first);
      CHECK(report.met);
      CHECK(report.magnitude > 1);
    }
}

TEST_CASE("a circle on a flat disk makes the field turn with it, and a straight stroke gives the parallel field") {
  const Case s(disk(14));
  for (const int n : {1, 2}) {
    const auto round = s.design({{s.stroke(flat_circle, 60), 10}}, {.n = n});
    CHECK(round.strokes[0].mean_degrees < 3);
    const SurfacePolyline straight = s.stroke([](double t) { return Row(t - 0.5, 0.3 * t, 0); }, 5);
    const auto parallel = s.design({{straight, 0.1}}, {.n = n});
    CHECK(parallel.strokes[0].largest_degrees < 1e-3);
    CHECK(std::abs(parallel.components[0].lambda) < 1e-10);
    CHECK(parallel.strokes[0].magnitude == doctest::Approx(1));
    // Multigrid learns only when it solves that the plain problem is singular.
    const auto iterative =
        s.design({{straight, 0.1}}, {.n = n, .eigen = {.solver = "multigrid"}, .path = EigenPath::low_rank});
    CHECK(std::abs(iterative.components[0].lambda) < 1e-10);
    CHECK(iterative.strokes[0].largest_degrees < 1e-3);
    // Without the offset term the two terms of the paper leave every constant field alone: which one comes out depends
    // on the start vector.
    const auto seeded = [&](double offset, std::uint64_t seed) {
      return s.design({{straight, 0.1}}, {.n = n, .offset = offset, .eigen = {.seed = seed}}).field.u;
    };
    CHECK((seeded(1, 1) - seeded(1, 2)).norm() < 1e-5 * parallel.field.u.norm());
    CHECK((seeded(0, 1) - seeded(0, 2)).norm() > 1e-2 * parallel.field.u.norm());
  }
}

TEST_CASE("a stroke drawn backwards gives the same field, turned by half a turn for odd n") {
  const Case s(bumpy_sphere(3, 0.2, 3));
  const SurfacePolyline line = s.stroke(small_circle, 25);
  for (const int n : {1, 2, 3}) {
    const auto a = s.design({{line, 1}}, {.n = n});
    const auto b = s.design({{line.reversed(), 1}}, {.n = n});
    CHECK(a.components[0].lambda == doctest::Approx(b.components[0].lambda).epsilon(1e-9));
    CHECK((a.field.u - (n % 2 ? -1.0 : 1.0) * b.field.u).norm() < 1e-6 * a.field.u.norm());
  }
}

TEST_CASE("the gauge and the unit of length do not matter") {
  const Case s(bumpy_sphere(3, 0.2, 3));
  const SurfacePolyline line = s.stroke(small_circle, 25);
  for (const int n : {1, 4}) {
    const auto a = s.design({{line, 1}}, {.n = n});
    Case turned = s;
    const VectorX<double> angle = turn_frames(turned);
    const auto b = turned.design({{line, 1}}, {.n = n});
    CHECK(a.components[0].lambda == doctest::Approx(b.components[0].lambda).epsilon(1e-8));
    ComplexVectorX<double> back = b.field.u;
    for (Index v = 0; v < s.mesh.vertices(); ++v) back[v] *= std::polar(1.0, -n * angle[v]);
    CHECK((back - a.field.u).norm() < 1e-5 * a.field.u.norm());

    MeshData larger = s.surface;
    larger.V *= 1000;
    const Case big(larger);
    const auto d = big.design({{big.stroke(small_circle, 25, 1000), 1}}, {.n = n});
    CHECK(d.components[0].lambda * 1e6 == doctest::Approx(a.components[0].lambda).epsilon(1e-6));
    CHECK(d.strokes[0].mean_degrees == doctest::Approx(a.strokes[0].mean_degrees).epsilon(1e-3));
    CHECK(d.strokes[0].magnitude == doctest::Approx(a.strokes[0].magnitude).epsilon(1e-4));
  }
}

TEST_CASE("strokes act on their own component only") {
  const Case s(test::together(jittered_sphere(2, 0.2, 4), bumpy_sphere(2, 0.3, 2.3)));
  const Case alone(jittered_sphere(2, 0.2, 4));
  const SurfacePolyline line = alone.stroke(small_circle, 20);
  const auto a = s.design({{line, 1}}, {.n = 2});
  const auto b = alone.design({{line, 1}}, {.n = 2});
  CHECK(a.components[0].lambda == doctest::Approx(b.components[0].lambda).epsilon(1e-8));
  CHECK((a.field.u.head(alone.mesh.vertices()) - b.field.u).norm() < 1e-5 * b.field.u.norm());
  const auto plain = smoothest_field(s.mesh, s.geometry, s.connection, nullptr, {.n = 2});
  CHECK(a.components[1].lambda == doctest::Approx(plain.components[1].lambda).epsilon(1e-9));
}

TEST_CASE("bad options and strokes are refused by name") {
  const Case s(icosphere(1));
  const SurfacePolyline line = s.stroke(great_circle, 4);
  const auto refused = [&](const std::vector<EigenStroke>& strokes, const EigenDesignOptions& options,
                           const char* field) {
    try {
      (void)s.design(strokes, options);
    } catch (const OptionError& e) {
      return e.field() == field;
    }
    return false;
  };
  CHECK(refused({}, {.n = 0}, "n"));
  CHECK(refused({}, {.offset = -1}, "offset"));
  CHECK(refused({}, {.largest_rank = -1}, "largest_rank"));
  CHECK(refused({{line, 0}}, {}, "strokes[0].weight"));
  CHECK(refused({{line, 1}, {line, std::nan("")}}, {}, "strokes[1].weight"));
  CHECK(refused({{{}, 1}}, {}, "strokes[0].line"));
  CHECK(refused({{.line = line, .radius = -1}}, {}, "strokes[0].radius"));
  CHECK(refused({{.line = line, .radius = 1e-9}}, {}, "radius"));
  SurfacePolyline broken = line;
  broken.segments[0].face = 1000;
  CHECK(refused({{broken, 1}}, {}, "strokes[0].line"));
}

TEST_CASE("singularities as terms of the mass: index and orientation in the asked faces, several at once") {
  for (const MeshData& surface : {bumpy_sphere(3, 0.1, 2.3), torus(30, 16, 1, 0.4), genus_surface(2, 3)}) {
    const Case s(surface);
    for (const int n : {1, 2, 4}) {
      const Index step = s.mesh.faces() / 5;
      const std::vector<SingularityTarget> targets = {{.face = step, .sign = -1, .orientation = 0.4},
                                                      {.face = 3 * step, .sign = 1, .orientation = 1.1}};
      std::vector<EigenDesignResult> results;
      for (const EigenPath path : {EigenPath::low_rank, EigenPath::real_view})
        results.push_back(eigen_design(s.connected(), {.singularities = targets}, {.n = n, .path = path}));
      CAPTURE(n);
      CAPTURE(surface.F.rows());
      for (const EigenDesignResult& result : results) {
        CHECK(result.components[0].converged);
        REQUIRE(result.singularities.size() == 2);
        for (const ControlReport& report : result.singularities) {
          CHECK(report.met);
          CHECK(report.error_degrees < 0.5);
        }
      }
      CHECK((results[0].field.u - results[1].field.u).norm() < 1e-6 * results[0].field.u.norm());
      CHECK(results[0].components[0].lambda == doctest::Approx(results[1].components[0].lambda).epsilon(1e-8));
    }
  }
  const Case s(icosphere(2));
  const auto refused = [&](const SingularityTarget& target) {
    CHECK_THROWS_AS((void)eigen_design(s.connected(), {.singularities = {target}}, {.n = 1}), OptionError);
  };
  refused({.face = -1});
  refused({.face = 1, .sign = 0});
  refused({.face = 1, .strength = -1});
  refused({.face = 1, .pin = std::array<double, 3>{0.2, 0.3, 0.6}});
}

TEST_CASE("strokes and singularities together, on the connection of the surface and on a trivial one") {
  Case s(bumpy_sphere(3, 0.1, 2.3));
  const Connection surface_connection = s.connection;
  for (const bool flat : {false, true}) {
    s.connection = flat ? trivial(s.mesh, s.geometry, {{0, 1.0}, {11, 1.0}}, {.n = 1}) : surface_connection;
    const SurfacePolyline line = s.stroke(great_circle, 40, 1.1);
    const auto result = eigen_design(
        s.connected(), {.strokes = {{.line = line}}, .singularities = {{.face = 900, .sign = -1}}}, {.n = 1});
    CHECK(result.components[0].converged);
    CHECK(result.singularities[0].index == -1);
    CHECK(result.singularities[0].met);
  }
}

TEST_CASE("fixed directions in the eigenproblem: met, by both ways of solving, with one sign") {
  for (const MeshData& surface : {bumpy_sphere(3, 0.1, 2.3), torus(30, 16, 1, 0.4)}) {
    const Case s(surface);
    const Index last = s.mesh.vertices();
    for (const int n : {1, 2, 4}) {
      CAPTURE(n);
      const std::vector<VertexConstraint> fixed = {{.vertex = 5, .value = std::polar(3.0, 0.4)},
                                                   {.vertex = last / 2, .value = std::polar(1.0, -1.3)},
                                                   {.vertex = last - 7, .value = std::polar(0.1, 2.9)}};
      const auto low = eigen_design(s.connected(), {.fixed = fixed}, {.n = n, .path = EigenPath::low_rank});
      const auto real = eigen_design(s.connected(), {.fixed = fixed}, {.n = n, .path = EigenPath::real_view});
      CHECK(low.components[0].converged);
      REQUIRE(low.fixed.size() == 3);
      for (std::size_t k = 0; k < 3; ++k) {
        CHECK(low.fixed[k].met);
        const Complex<double> u = low.field.u[fixed[k].vertex];
        CHECK(std::abs(std::arg(u * std::conj(fixed[k].value))) < 0.02);
      }
      CHECK((low.field.u - real.field.u).norm() < 1e-6 * real.field.u.norm());
      // Lengths of the values do not matter.
      auto longer = fixed;
      for (VertexConstraint& f : longer) f.value *= 7.0;
      const auto same = eigen_design(s.connected(), {.fixed = longer}, {.n = n, .path = EigenPath::low_rank});
      CHECK((low.field.u - same.field.u).norm() < 1e-6 * low.field.u.norm());
    }
    CHECK_THROWS_AS((void)eigen_design(s.connected(), {.fixed = {{.vertex = -1}}}, {.n = 1}), OptionError);
    CHECK_THROWS_AS((void)eigen_design(s.connected(), {.fixed = {{.vertex = 1, .value = 0}}}, {.n = 1}), OptionError);
  }
}

TEST_CASE("across a stroke is along it after a quarter turn") {
  const Case s(torus(30, 16, 1, 0.4));
  const SurfacePolyline line = s.stroke(great_circle, 30, 1.1);
  for (const int n : {1, 2}) {
    const auto across = eigen_design(s.connected(), {.strokes = {{.line = line, .across = true}}}, {.n = n});
    const auto along = eigen_design(s.connected(), {.strokes = {{.line = line}}}, {.n = n});
    CHECK(across.strokes[0].met);
    // The quarter turn changes nothing else: the same energy, the field turned by n quarters.
    CHECK(across.components[0].lambda == doctest::Approx(along.components[0].lambda).epsilon(1e-7));
    const Complex<double> turn = n == 1 ? Complex<double>(0, 1) : Complex<double>(-1, 0);
    CHECK((across.field.u - turn * along.field.u).norm() < 1e-4 * along.field.u.norm());
  }
}

TEST_CASE("guidance alone is the linear field of Knoeppel et al. 2013 for the lambda_t that belongs to its weight") {
  for (const MeshData& surface : {bumpy_sphere(3, 0.3, 2.3), disk(12)}) {
    const Case s(surface);
    for (const int n : {1, 2, 4}) {
      const ComplexVectorX<double> g = smooth_field(s, n);
      const double unit = 4 * pi<double> * n / s.geometry.total_area();
      for (const double weight : {0.01, 1.0, 100.0})
        for (const EigenPath path : {EigenPath::low_rank, EigenPath::real_view}) {
          CAPTURE(n);
          CAPTURE(weight);
          EigenDesignOptions options{.n = n, .eigen = {.tolerance = 1e-10}, .path = path};
          const auto eigen = eigen_design(s.connected(), {.guidance = g, .guidance_weight = weight}, options);
          const EigenReport& r = eigen.components[0];
          CHECK(r.converged);
          CHECK(r.smallest == Smallest::proven);
          CHECK(r.lower_bound.value() <= r.lambda);
          CHECK(r.lower_bound.value() > r.lambda - 1e-5 * (r.lambda + weight * unit));
          Designer linear(s.connected(), {.n = n, .t = r.lambda / unit - weight});
          linear.set_guidance(g);
          ComplexVectorX<double> u = linear.solve().field.u;
          u *= eigen.field.u.norm() / u.norm();
          CHECK((eigen.field.u - u).norm() < 1e-6 * u.norm());
        }
    }
  }
}

TEST_CASE("guidance: heavy weights give the field itself, light ones the smoothest, and its length does not matter") {
  const Case s(bumpy_sphere(3, 0.3, 2.3));
  for (const int n : {1, 4}) {
    CAPTURE(n);
    const ComplexVectorX<double> g = smooth_field(s, n);
    const auto design = [&](const ComplexVectorX<double>& field, double weight) {
      const auto result = eigen_design(s.connected(), {.guidance = field, .guidance_weight = weight},
                                       {.n = n, .eigen = {.tolerance = 1e-10}});
      CHECK(result.components[0].converged);
      return result.field.u;
    };
    CHECK(apart(design(g, 1e10), design(g, 1e10).norm() / g.norm() * g) < 1e-6);
    const auto smooth = smoothest_field(s.connected(), {.n = n, .eigen = {.tolerance = 1e-10}});
    CHECK(smooth.components[0].next.value_or(0) - smooth.components[0].lambda > 1e-4);
    CHECK(apart(design(g, 1e-9), smooth.field.u) < 1e-3);
    const ComplexVectorX<double> u = design(g, 1);
    for (const C factor : {C(1e150), C(-3e-150), std::polar(2.0, 1.0)})
      CHECK((design(factor * g, 1) - factor / std::abs(factor) * u).norm() < 1e-6 * u.norm());
    // Towards zero nothing is said of directions.
    const auto zero = eigen_design(s.connected(), {.guidance_weight = 3}, {.n = n});
    CHECK(apart(zero.field.u, smooth.field.u) < 1e-3);
  }
}

TEST_CASE("guidance works per component, and weights at vertices say where") {
  const Case s(test::together(jittered_sphere(2, 0.2, 4), bumpy_sphere(2, 0.3, 2.3)));
  const Case alone(jittered_sphere(2, 0.2, 4));
  const Index first = alone.mesh.vertices();
  ComplexVectorX<double> g = ComplexVectorX<double>::Zero(s.mesh.vertices());
  g.head(first) = random_values(first, 11);
  const auto both = eigen_design(s.connected(), {.guidance = g, .guidance_weight = 1e9}, {.n = 2});
  const ComplexVectorX<double> u = both.field.u.head(first);
  CHECK((u / u.norm() - g.head(first) / g.norm()).norm() < 1e-5);
  const auto plain = smoothest_field(s.connected(), {.n = 2, .eigen = {.tolerance = 1e-9}});
  CHECK(apart(both.field.u.tail(s.mesh.vertices() - first), plain.field.u.tail(s.mesh.vertices() - first)) < 1e-3);
  // Only one half of the sphere is asked to be near to g.
  VectorX<double> weights(first);
  for (Index v = 0; v < first; ++v) weights[v] = alone.surface.V(v, 2) > 0 ? 1 : 0;
  const auto half = eigen_design(
      alone.connected(), {.guidance = g.head(first), .guidance_weight = 1e6, .guidance_weights = weights}, {.n = 2});
  CHECK(half.components[0].converged);
  double above = 0, below = 0;
  for (Index v = 0; v < first; ++v) {
    const double off = std::abs(std::arg(half.field.u[v] * std::conj(g[v])));
    double& most = weights[v] > 0 ? above : below;
    most = std::max(most, off);
  }
  CHECK(above < 1e-2);
  CHECK(below > 0.1);
}

TEST_CASE("rows, guidance and pins in one pencil: a dense eigensolver finds the same smallest pair") {
  const Case s(jittered_sphere(2, 0.2, 4));
  const int n = 2;
  const auto [S, M] = energy_matrices(s.connected(), n);
  const Index vertices = s.mesh.vertices();
  const double area = s.geometry.total_area();
  detail::DesignRows rows;
  std::vector<detail::GuidanceTie> ties(12);
  const ComplexVectorX<double> coefficients = random_values(200, 5);
  for (Index k = 0; k < 12; ++k) {
    rows.across.emplace_back().add(7 * k, 3.0 * coefficients[k]);
    rows.across.back().add(7 * k + 1, coefficients[k + 20]);
    rows.along.emplace_back().add(11 * k, coefficients[k + 40]);
    ties[static_cast<std::size_t>(k)].row.add(13 * k, coefficients[k + 60]);
    ties[static_cast<std::size_t>(k)].value = coefficients[k + 110].real();
  }
  const double w = 20;
  const ComplexVectorX<double> g = random_values(vertices, 8);
  detail::ZeroSpace<C> pins(vertices);
  detail::ZeroSpace<double> real_pins(2 * vertices);
  const std::vector<std::array<Index, 3>> at = {{7, 8, 9}, {9, 10, 8}, {8, 9, 7}, {100, 101, 102}};
  std::vector<std::array<C, 3>> zero;
  for (Index k = 0; k < 4; ++k) zero.push_back({coefficients[80 + k], coefficients[90 + k], coefficients[100 + k]});
  for (std::size_t k = 0; k < at.size(); ++k) {
    const auto term = [&](std::size_t c, C z) { return std::pair(at[k][c], z * zero[k][c]); };
    pins.demand({term(0, 1), term(1, 1), term(2, 1)});
    for (const C turn : {C(1), C(0, -1)}) {  // real and imaginary part
      std::vector<detail::ZeroSpace<double>::Term> terms;
      for (std::size_t c = 0; c < 3; ++c) {
        const C z = term(c, turn).second;
        terms.insert(terms.end(), {{2 * at[k][c], z.real()}, {2 * at[k][c] + 1, -z.imag()}});
      }
      real_pins.demand(terms);
    }
  }
  const SparseMatrix<C> T = pins.basis();
  CHECK(T.cols() == vertices - 4);

  // Independently: dense matrices of the real view, and the null space of the pins.
  const auto real = [&](const detail::RealRow& row) {
    VectorX<double> r = VectorX<double>::Zero(2 * vertices);
    for (std::size_t k = 0; k < row.vertex.size(); ++k) {
      r[2 * row.vertex[k]] += row.coefficient[k].real();
      r[2 * row.vertex[k] + 1] += row.coefficient[k].imag();
    }
    return r;
  };
  MatrixX<double> A = MatrixX<double>(real_view(S)), B = MatrixX<double>(real_view(M));
  const MatrixX<double> mass = B;
  for (const auto& row : rows.across) A += real(row) * real(row).transpose();
  for (const auto& row : rows.along) B += real(row) * real(row).transpose();
  const VectorX<double> gr = Eigen::Map<const VectorX<double>>(reinterpret_cast<const double*>(g.data()), 2 * vertices);
  // The matrix over (u, r), from which r is eliminated.
  const VectorX<double> g1 = gr * std::sqrt(area / gr.dot(mass * gr));
  VectorX<double> cross = -w * mass * g1;
  double corner = w * g1.dot(mass * g1);
  A += w * mass;
  for (const auto& tie : ties) {
    A += real(tie.row) * real(tie.row).transpose();
    cross -= tie.value * real(tie.row);
    corner += tie.value * tie.value;
  }
  A -= cross * cross.transpose() / corner;
  MatrixX<double> constraint = MatrixX<double>::Zero(8, 2 * vertices);
  for (Index k = 0; k < 4; ++k)
    for (std::size_t c = 0; c < 3; ++c) {
      const C z = zero[static_cast<std::size_t>(k)][c];
      const Index v = at[static_cast<std::size_t>(k)][c];
      constraint(2 * k, 2 * v) = constraint(2 * k + 1, 2 * v + 1) = z.real();
      constraint(2 * k, 2 * v + 1) = -z.imag();
      constraint(2 * k + 1, 2 * v) = z.imag();
    }
  const MatrixX<double> kernel = Eigen::FullPivLU<MatrixX<double>>(constraint).kernel();
  REQUIRE(kernel.cols() == 2 * vertices - 8);
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixX<double>> dense(kernel.transpose() * A * kernel,
                                                                        kernel.transpose() * B * kernel);
  const double smallest = dense.eigenvalues()[0];
  REQUIRE(dense.eigenvalues()[1] > 1.001 * smallest);
  const VectorX<double> expected = kernel * dense.eigenvectors().col(0);

  const detail::GuidedPencil pencil =
      detail::guided(S, M, rows, ties, 3 * area, area, {.pull = w, .field = 1e3 * g, .weights = {}});
  const SparseMatrix<C> TS = T.adjoint() * pencil.S * T, TM = T.adjoint() * M * T;
  const SparseMatrix<double> real_T = real_pins.basis();
  CHECK(real_T.cols() == 2 * (vertices - 4));
  for (const bool over_reals : {false, true})
    for (const EigenPath path : {EigenPath::low_rank, EigenPath::real_view}) {
      const EigenDesignOptions options{.n = n, .eigen = {.tolerance = 1e-11}, .path = path};
      const EigenResult found =
          over_reals ? detail::smallest_with_rows_in(real_T, pencil.S, M, pencil.rows, pencil.size, options)
                     : detail::smallest_with_rows(TS, TM, detail::pinned_rows(pencil.rows, T), pencil.size, options);
      CHECK(found.report.converged);
      CHECK(found.report.smallest == Smallest::proven);
      CHECK(found.report.lambda == doctest::Approx(smallest).epsilon(1e-9));
      CHECK(found.report.lower_bound.value() <= smallest * (1 + 1e-12));
      CHECK(found.report.lower_bound.value() > smallest * (1 - 1e-4));
      CHECK(std::abs(dense.eigenvalues()[0] - found.report.lambda) <= found.report.distance);
      const ComplexVectorX<double> u = over_reals ? found.u : ComplexVectorX<double>(T * found.u);
      for (std::size_t k = 0; k < at.size(); ++k) {
        C value = 0;
        for (std::size_t c = 0; c < 3; ++c) value += zero[k][c] * u[at[k][c]];
        CHECK(std::abs(value) < 1e-12 * u.cwiseAbs().maxCoeff());
      }
      const VectorX<double> ur =
          Eigen::Map<const VectorX<double>>(reinterpret_cast<const double*>(u.data()), 2 * vertices);
      CHECK(std::abs(std::abs(ur.dot(expected)) / (ur.norm() * expected.norm()) - 1) < 1e-9);
    }
}

TEST_CASE("pins in the eigenproblem: the zero lies where it was put, with its index and direction") {
  for (const MeshData& surface : {bumpy_sphere(3, 0.1, 2.3), torus(30, 16, 1, 0.4)}) {
    const Case s(surface);
    const Index step = s.mesh.faces() / 5;
    for (const int n : {1, 2, 4})
      for (const EigenPath path : {EigenPath::low_rank, EigenPath::real_view}) {
        CAPTURE(n);
        const std::vector<SingularityTarget> targets = {
            {.face = step, .sign = -1, .orientation = 0.4, .pin = std::array<double, 3>{0.2, 0.7, 0.1}},
            {.face = 3 * step, .sign = 1, .orientation = 1.1, .pin = std::array<double, 3>{0.6, 0.2, 0.2}}};
        const auto result = eigen_design(s.connected(), {.singularities = targets}, {.n = n, .path = path});
        CHECK(result.components[0].converged);
        CHECK(result.components[0].smallest == Smallest::proven);
        for (std::size_t k = 0; k < targets.size(); ++k) {
          const Index t = targets[k].face;
          const C there = face_field(s.mesh, s.geometry, s.connection, n, result.field.u, t).at(*targets[k].pin).u;
          double size = 0;
          for (Index c = 0; c < 3; ++c) size = std::max(size, std::abs(result.field.u[s.mesh.F()(t, c)]));
          CHECK(std::abs(there) < 1e-12 * size);
          CHECK(result.singularities[k].index == targets[k].sign);
          CHECK(result.singularities[k].met);
        }
      }
  }
  // A pin in a corner takes the vertex away; several zeros of one control have one each.
  const Case s(bumpy_sphere(3, 0.1, 2.3));
  const auto corner = eigen_design(
      s.connected(), {.singularities = {{.face = 100, .sign = -1, .pin = std::array<double, 3>{0, 1, 0}}}}, {.n = 2});
  CHECK(corner.field.u[s.mesh.F()(100, 1)] == C(0));
  const auto pair = eigen_design(
      s.connected(),
      {.singularities = {{.face = 300, .sign = -1, .count = 2, .pin = std::array<double, 3>{0.3, 0.3, 0.4}}}},
      {.n = 2});
  CHECK(pair.singularities[0].index == -2);
  CHECK(pair.singularities[0].met);
}

TEST_CASE("a stroke with a radius: the line's terms over a band") {
  const Case s(jittered_sphere(4, 0.1, 4));
  const SurfacePolyline line = s.stroke(small_circle, 60);
  for (const double radius : {0.4, 0.2, 0.1}) {
    const auto band = s.design({{.line = line, .radius = radius}}, {.n = 2});
    CHECK(band.components[0].converged);
    CHECK(band.strokes[0].met);
    CHECK(band.strokes[0].mean_degrees < 2);
  }

  // A straight one on a flat surface leaves the parallel field what it is, and turns it along, or across.
  const Case flat(disk(14));
  const SurfacePolyline straight = flat.stroke([](double t) { return Row(t - 0.5, 0.3 * t, 0); }, 5);
  for (const int n : {1, 2})
    for (const bool across : {false, true}) {
      const auto parallel = flat.design({{.line = straight, .across = across, .radius = 0.3}}, {.n = n});
      CHECK(parallel.strokes[0].largest_degrees < 1e-3);
      CHECK(std::abs(parallel.components[0].lambda) < 1e-10);
      CHECK(parallel.strokes[0].magnitude == doctest::Approx(1));
    }
  // Without the offset the derivative along the line alone is at work: it turns a field with a circle.
  for (const int n : {1, 2}) {
    const auto round =
        flat.design({{.line = flat.stroke(flat_circle, 60), .weight = 10, .radius = 0.2}}, {.n = n, .offset = 0});
    CHECK(round.strokes[0].met);
  }
}

TEST_CASE("rows of a band integrate the squares of a field and of its slope along the line") {
  const Case s(disk(60));
  const ConnectedSurface surface = s.connected();
  const SurfacePolyline line = s.stroke([](double t) { return Row(t - 0.5, 0, 0); }, 5);
  for (const int n : {1, 4})
    for (const bool across : {false, true}) {
      CAPTURE(n);
      CAPTURE(across);
      SurfacePolyline turned = line;
      for (SurfaceSegment& segment : turned.segments) segment.tangent *= across ? C(0, 1) : C(1);
      const auto band = detail::stroke_band(s.mesh, s.geometry, s.connection, turned, 0.3);
      const C quarter = across ? std::polar(1.0, n * pi<double> / 2) : C(1);
      // Sums of squares of the rows, of the field of which f is the part along the line and its turned copy.
      const auto sums = [&](const std::function<C(double, double)>& f, double offset) {
        ComplexVectorX<double> u(s.mesh.vertices());
        for (Index v = 0; v < s.mesh.vertices(); ++v)
          u[v] = quarter * f(s.surface.V(v, 0), s.surface.V(v, 1)) *
                 std::pow(surface.frames()->component(v, Row(1, 0, 0)), n);
        const auto rows = detail::band_rows(surface, n, band, offset, across);
        const auto square = [&](const std::vector<detail::RealRow>& list) {
          double sum = 0;
          for (const detail::RealRow& row : list) {
            double value = 0;
            for (std::size_t k = 0; k < row.vertex.size(); ++k)
              value += (std::conj(row.coefficient[k]) * u[row.vertex[k]]).real();
            sum += value * value;
          }
          return sum;
        };
        return std::pair(square(rows.along), square(rows.across));
      };
      const auto [along, none] = sums([](double, double) { return C(1); }, 5);
      CHECK(along > 0.9 * line.length());  // distances are those along edges: the band is a little narrower
      CHECK(along < 1.3 * line.length());  // and goes around its ends
      CHECK(none < 1e-18);
      CHECK(sums([](double, double) { return C(0, 1); }, 0).first < 1e-18);
      CHECK(sums([](double, double) { return C(0, 1); }, 7).second == doctest::Approx(7 * along).epsilon(1e-9));
      CHECK(sums([](double x, double) { return C(3, 2 * x); }, 0).second == doctest::Approx(4 * along).epsilon(0.02));
      CHECK(sums([](double, double y) { return C(3, 2 * y); }, 0).second < 1e-3 * along);
    }
}

TEST_CASE("guidance, pins and bands: the gauge, the unit of length and the sense of strokes do not matter") {
  const Case s(bumpy_sphere(3, 0.2, 3));
  const SurfacePolyline line = s.stroke(small_circle, 25);
  for (const int n : {1, 4}) {
    CAPTURE(n);
    EigenControls controls{
        .strokes = {{.line = line, .radius = 0.2}},
        .singularities = {{.face = 900, .sign = -1, .orientation = 0.3, .pin = std::array<double, 3>{0.3, 0.2, 0.5}}},
        .fixed = {},
        .guidance = smooth_field(s, n),
        .guidance_weight = 0.5,
        .guidance_weights = {}};
    const auto a = eigen_design(s.connected(), controls, {.n = n});
    CHECK(a.components[0].converged);
    CHECK(a.components[0].smallest == Smallest::proven);
    Case turned = s;
    const VectorX<double> angle = turn_frames(turned);
    EigenControls there = controls;
    for (Index v = 0; v < s.mesh.vertices(); ++v) there.guidance[v] *= std::polar(1.0, n * angle[v]);
    const auto b = eigen_design(turned.connected(), there, {.n = n});
    CHECK(a.components[0].lambda == doctest::Approx(b.components[0].lambda).epsilon(1e-8));
    ComplexVectorX<double> back = b.field.u;
    for (Index v = 0; v < s.mesh.vertices(); ++v) back[v] *= std::polar(1.0, -n * angle[v]);
    CHECK((back - a.field.u).norm() < 1e-5 * a.field.u.norm());

    MeshData larger = s.surface;
    larger.V *= 1000;
    const Case big(larger);
    EigenControls scaled = controls;
    scaled.strokes = {{.line = big.stroke(small_circle, 25, 1000), .radius = 200}};
    const auto c = eigen_design(big.connected(), scaled, {.n = n});
    CHECK(c.components[0].lambda * 1e6 == doctest::Approx(a.components[0].lambda).epsilon(1e-6));
    CHECK(c.strokes[0].mean_degrees == doctest::Approx(a.strokes[0].mean_degrees).epsilon(1e-3));

    EigenControls backwards = controls;
    backwards.strokes[0].line = line.reversed();
    backwards.guidance *= n % 2 ? -1 : 1;
    backwards.singularities[0].orientation += n % 2 ? pi<double> / (n + 1) : 0;
    const auto d = eigen_design(s.connected(), backwards, {.n = n});
    CHECK(d.components[0].lambda == doctest::Approx(a.components[0].lambda).epsilon(1e-6));
    CHECK((a.field.u - (n % 2 ? -1.0 : 1.0) * d.field.u).norm() < 1e-4 * a.field.u.norm());
  }
}

TEST_CASE("guidance takes the sign of everything else, and both ways of solving agree on the whole") {
  const Case s(bumpy_sphere(3, 0.1, 2.3));
  for (const int n : {1, 2, 4}) {
    CAPTURE(n);
    const ComplexVectorX<double> g = smooth_field(s, n);
    Index longest = 0;
    g.cwiseAbs().maxCoeff(&longest);
    for (const double weight : {1.0, 10.0, 100.0})
      for (const double sign : {1.0, -1.0}) {
        const EigenControls controls{.strokes = {},
                                     .singularities = {},
                                     .fixed = {{.vertex = longest, .value = sign * g[longest]}},
                                     .guidance = g,
                                     .guidance_weight = weight,
                                     .guidance_weights = {}};
        const auto low = eigen_design(s.connected(), controls, {.n = n, .path = EigenPath::low_rank});
        const auto real = eigen_design(s.connected(), controls, {.n = n, .path = EigenPath::real_view});
        CHECK(low.components[0].smallest == Smallest::proven);
        CHECK((low.field.u - real.field.u).norm() < 1e-6 * real.field.u.norm());
        CHECK(low.fixed[0].met);
        CHECK(g.dot(low.field.u).real() > (weight > 1 ? 0.9 : 0.5) * g.norm() * low.field.u.norm());
      }
  }
}

TEST_CASE("targets and strokes next to guidance are met, in its sign and against it") {
  const Case s(bumpy_sphere(3, 0.1, 2.3));
  const Index step = s.mesh.faces() / 5;
  const SurfacePolyline line = s.stroke(great_circle, 40, 1.1);
  for (const int n : {1, 2, 4}) {
    CAPTURE(n);
    const ComplexVectorX<double> g = smooth_field(s, n);
    for (const double sign : {1.0, -1.0}) {
      const EigenControls controls{.strokes = {{.line = line, .weight = 10}},
                                   .singularities = {{.face = step, .sign = -1, .orientation = 0.4},
                                                     {.face = 4 * step, .sign = 1, .orientation = 1.1}},
                                   .fixed = {},
                                   .guidance = sign * g,
                                   .guidance_weight = 1,
                                   .guidance_weights = {}};
      const auto result = eigen_design(s.connected(), controls, {.n = n});
      CHECK(result.components[0].converged);
      CHECK(result.components[0].smallest == Smallest::proven);
      for (const ControlReport& report : result.singularities) CHECK(report.met);
      CHECK(result.strokes[0].met);
      CHECK(sign * g.dot(result.field.u).real() > 0);
    }
  }
}

TEST_CASE("bad guidance is refused by name") {
  const Case s(icosphere(1));
  const auto refused = [&](const EigenControls& controls, const char* field) {
    try {
      (void)eigen_design(s.connected(), controls, {});
    } catch (const OptionError& e) {
      return e.field() == field;
    }
    return false;
  };
  const ComplexVectorX<double> g = ComplexVectorX<double>::Ones(s.mesh.vertices());
  CHECK(refused({.guidance = g}, "guidance_weight"));
  CHECK(refused({.guidance = g, .guidance_weight = -1}, "guidance_weight"));
  CHECK(refused({.guidance = g.head(5), .guidance_weight = 1}, "guidance"));
  CHECK(refused({.guidance = std::nan("") * g, .guidance_weight = 1}, "guidance"));
  CHECK(refused({.guidance_weight = 1, .guidance_weights = VectorX<double>::Ones(3)}, "guidance_weights"));
  CHECK(refused({.guidance_weight = 1, .guidance_weights = VectorX<double>::Zero(s.mesh.vertices())},
                "guidance_weights"));
  CHECK(refused({.guidance_weight = 1, .guidance_weights = -VectorX<double>::Ones(s.mesh.vertices())},
                "guidance_weights"));
}
