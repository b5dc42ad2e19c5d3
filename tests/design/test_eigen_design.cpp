// SPDX-License-Identifier: MIT
#include "alcap/eigen_design.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>

#include "alcap/energies.h"
#include "alcap/generators.h"
#include "alcap/operators.h"
#include "src/base/random.h"
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
    // Turn every vertex frame: rho_v-> grow by the angle.
    Case turned = s;
    detail::Random random(3);
    VectorX<double> angle(s.mesh.vertices());
    for (double& x : angle) x = random.uniform(-1, 1);
    Connection& c = turned.connection;
    for (Index h = 0; h < s.mesh.halfedges(); ++h) c.rho_t[h] += angle[s.mesh.tail(h)];
    for (Index e = 0; e < s.mesh.edges(); ++e) {
      const Index i = s.mesh.tail(s.mesh.halfedge(e)), j = s.mesh.tip(s.mesh.halfedge(e));
      c.rho_e[2 * e] += angle[i];
      c.rho_e[2 * e + 1] += angle[j];
      c.rho[e] += angle[i] - angle[j];
    }
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
  refused({.face = 1, .pin = std::array<double, 3>{0.2, 0.3, 0.5}});
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
