// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "alcap/energies.h"
#include "alcap/generators.h"
#include "alcap/operators.h"
#include "alcap/singularities.h"
#include "alcap/smoothest.h"
#include "src/base/parallel.h"
#include "tests/support/mesh_case.h"

using namespace alcap;

namespace {

struct Case : test::FramedCase {
  using FramedCase::FramedCase;
  Topology topology = find_topology(mesh);
  [[nodiscard]] SmoothestResult smoothest(int n, double s = 0) const {
    return smoothest_field(mesh, geometry, connection, frames, {.n = n, .s = s, .eigen = {.tolerance = 1e-8}});
  }
};

// Angle between two n-fields at a vertex, modulo the n branches, from vectors in space.
double worst_angle(const Field& a, const Field& b, const Eigen::Matrix3d& rotation) {
  double worst = 0;
  for (Index v = 0; v < a.u.size(); ++v) {
    const Eigen::RowVector3d x = a.frames->vector(v, a.branch(v)) * rotation.transpose();
    const Complex<double> z = b.frames->component(v, x);
    // z^n against u_b, up to a global phase that is fixed at vertex 0 by the caller's normalisation
    worst = std::max(worst, std::abs(wrap(a.n * std::arg(z) - std::arg(b.u[v]))) / a.n);
  }
  return worst;
}

}  // namespace

TEST_CASE("sphere spectrum: lambda = l(l+1) - n^2, so n for the smallest, with second order, n = 1 to 6") {
  for (int n = 1; n <= 6; ++n) {
    double error[2];
    for (int level = 3; level <= 4; ++level) {
      const Case s(icosphere(level));
      const auto result = s.smoothest(n);
      CHECK(result.components[0].converged);
      CHECK(result.components[0].residual < 1e-7);
      error[level - 3] = std::abs(result.components[0].lambda - n);
    }
    CHECK(error[1] < 0.05 * n);
    CHECK(error[0] / error[1] > 3.3);
  }
}

TEST_CASE("reference eigenvalues") {
  const double sphere[3] = {1.0072299318, 2.0231796202, 4.0791350873};
  const double doughnut[3] = {0.4995891256, 1.8692307066, 4.1011688469};
  const int n[3] = {1, 2, 4};
  Case s(icosphere(3)), t(torus(40, 20, 1, 0.4));
  for (Case* c : {&s, &t}) c->connection = globally_optimal(c->mesh, c->geometry, {.tolerance = 1e-10});
  for (int k = 0; k < 3; ++k) {
    CHECK(s.smoothest(n[k]).components[0].lambda == doctest::Approx(sphere[k]).epsilon(1e-9));
    CHECK(t.smoothest(n[k]).components[0].lambda == doctest::Approx(doughnut[k]).epsilon(1e-9));
  }
}

TEST_CASE("flat torus: lambda = 0 and a parallel field") {
  const FlatTorus flat = flat_torus(12, 10);
  const Mesh mesh(flat.F, flat.vertices);
  Eigen::VectorXd lengths(mesh.edges());
  for (Index h = 0; h < mesh.halfedges(); ++h) lengths[mesh.edge(h)] = flat.lengths(h / 3, h % 3);
  const auto geometry = Geometry::from_lengths(mesh, lengths);
  const auto connection = globally_optimal(mesh, geometry);
  for (const int n : {1, 2, 4}) {
    const auto result = smoothest_field(mesh, geometry, connection, nullptr, {.n = n});
    CHECK(result.components[0].converged);
    CHECK(std::abs(result.components[0].lambda) < 1e-9);
    CHECK(result.field.u.cwiseAbs().maxCoeff() == doctest::Approx(result.field.u.cwiseAbs().minCoeff()).epsilon(1e-6));
    CHECK(find_singularities(mesh, geometry, connection, result.field).empty());
  }
}

TEST_CASE("Poincare-Hopf: indices sum to n chi on closed surfaces and to the boundary's count on open ones") {
  for (const MeshData& surface : {icosphere(2), jittered_sphere(3, 0.2, 6), torus_random_diagonals(20, 12, 1, 0.4, 5),
                                  genus_surface(2, 2), genus_surface(3, 2), cylinder(16, 8), disk(6),
                                  noisy_scan(3, 0.1, 3), cad_like(24, 2), tetrahedron(), cube(), single_triangle()}) {
    const Case s(surface);
    for (const int n : {1, 2, 3, 4, 6}) {
      const auto result = s.smoothest(n);
      CHECK(result.components[0].converged);
      const auto indices = face_indices(s.mesh, s.connection, result.field);
      for (const IndexSum& sum : index_sums(s.mesh, s.geometry, s.connection, result.field, indices, s.topology))
        CHECK(sum.sum == sum.expected);
    }
  }
}

TEST_CASE("a disk's boundary count by hand: the constant field turns -n times against the tangent") {
  const Case s(disk(6));
  Field field{1, ComplexVectorX<double>(s.mesh.vertices()), s.frames};
  const Positions<double> east =
      Positions<double>::Constant(s.mesh.vertices(), 3, 0).rowwise() + Eigen::RowVector3d(1, 0, 0);
  for (const int n : {1, 2, 4}) {
    field = from_vectors(n, east, s.frames);
    const auto sums =
        index_sums(s.mesh, s.geometry, s.connection, field, face_indices(s.mesh, s.connection, field), s.topology);
    CHECK(sums[0].sum == 0);
    CHECK(sums[0].expected == 0);
  }
  const auto radial = from_vectors(1, s.surface.V, s.frames);
  const auto indices = face_indices(s.mesh, s.connection, radial);
  const auto sums = index_sums(s.mesh, s.geometry, s.connection, radial, indices, s.topology);
  CHECK(sums[0].sum == 1);
  CHECK(sums[0].expected == 1);
}

TEST_CASE("zeros and orientations of known fields in the plane") {
  MeshData flat = grid(9, 9, 2, 2);
  flat.V.rowwise() -= Eigen::RowVector3d(1, 1, 0);
  const Case s(flat);
  const Eigen::RowVector3d zero(0.04, 0.09, 0);
  for (int n = 1; n <= 6; ++n)
    for (const double turn : {0.0, 0.3, 1.1}) {
      const double beta = turn * pi<double> / n;
      // Index +1/n and -1/n: u = e^{i a} w and u = e^{i a} conj(w), w the position from the zero.
      for (const int sign : {1, -1}) {
        const double a = sign > 0 ? (n == 1 ? beta : (n - 1) * beta) : (n + 1) * beta;
        Positions<double> d(s.mesh.vertices(), 3);
        for (Index v = 0; v < s.mesh.vertices(); ++v) {
          const Eigen::RowVector3d w = flat.V.row(v) - zero;
          const Complex<double> u = std::polar(1.0, a) * Complex<double>(w.x(), sign * w.y());
          const double r = std::pow(std::abs(u), 1.0 / n), angle = std::arg(u) / n;
          d.row(v) << r * std::cos(angle), r * std::sin(angle), 0;
        }
        const auto field = from_vectors(n, d, s.frames);
        const auto found = find_singularities(s.mesh, s.geometry, s.connection, field);
        REQUIRE(found.size() == 1);
        CHECK(found[0].index == sign);
        CHECK(found[0].located);
        Eigen::RowVector3d at = Eigen::RowVector3d::Zero();
        for (int c = 0; c < 3; ++c)
          at += found[0].barycentric[static_cast<std::size_t>(c)] * flat.V.row(s.mesh.F()(found[0].face, c));
        CHECK((at - zero).norm() < 1e-12);
        // The angle is relative to the face's first halfedge.
        const Index t = found[0].face;
        const Eigen::RowVector3d axis = flat.V.row(s.mesh.F()(t, 1)) - flat.V.row(s.mesh.F()(t, 0));
        const double period = 2 * pi<double> / (sign > 0 ? (n == 1 ? 1 : n - 1) : n + 1);
        const double world = found[0].orientation + (sign > 0 && n == 1 ? 0 : std::atan2(axis.y(), axis.x()));
        CHECK(std::abs(std::remainder(world - beta, period)) < 1e-9);
      }
    }
}

TEST_CASE("the smoothest field turns with the mesh and does not see its scale") {
  const MeshData surface = bumpy_sphere(3, 0.3, 3);
  const Case s(surface);
  const auto a = s.smoothest(4);
  REQUIRE(a.components[0].next.value() > 1.0001 * a.components[0].lambda);  // else the field is not unique
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (const double scale : {1e-6, 1.0, 1e6}) {
    MeshData moved = surface;
    moved.V = scale * surface.V * rotation.transpose();
    const Case m(moved);
    auto b = m.smoothest(4);
    CHECK(b.components[0].lambda * scale * scale == doctest::Approx(a.components[0].lambda).epsilon(1e-8));
    // Fix the free global phase at one vertex.
    Index v = 0;
    b.field.u.cwiseAbs().maxCoeff(&v);
    const Complex<double> z =
        m.frames->component(v, a.field.frames->vector(v, a.field.branch(v)) * rotation.transpose());
    b.field.u *= std::polar(1.0, 4 * std::arg(z) - std::arg(b.field.u[v]));
    CHECK(worst_angle(a.field, b.field, rotation) < 1e-4);
  }
}

TEST_CASE("the energy family: E_s of its own smoothest field is least for its own s") {
  const Case s(cylinder(20, 10));
  const HermitianPattern pattern(s.mesh);
  for (const double e : {-1.0, -0.5, 0.5, 1.0}) {
    auto S = stiffness_and_mass(s.mesh, pattern, s.geometry, s.connection, 4).S;
    apply_energy_family(s.mesh, pattern, s.geometry, s.connection, 4, e, S);
    const auto own = s.smoothest(4, e).field.u, plain = s.smoothest(4).field.u;
    CHECK(own.dot(S * own).real() <= plain.dot(S * plain).real() * (1 + 1e-9) + 1e-9);
  }
}

TEST_CASE("a bumpy sphere has fewer singularities at detail 0.1 than at 10") {
  const MeshData surface = bumpy_sphere(5, 0.15, 14);
  const Mesh mesh(surface.F, surface.V.rows());
  const Geometry geometry(mesh, surface.V);
  std::size_t count[2];
  for (int k = 0; k < 2; ++k) {
    const auto connection = globally_optimal(mesh, geometry, {.detail = k == 0 ? 0.1 : 10.0});
    const auto result = smoothest_field(mesh, geometry, connection, nullptr, {.n = 4});
    count[k] = find_singularities(mesh, geometry, connection, result.field).size();
  }
  CHECK(count[0] < count[1]);
}

TEST_CASE("pieces are solved each on its own, unreferenced vertices stay zero") {
  const MeshData a = bumpy_sphere(2, 0.3, 3), b = cylinder(8, 4);
  MeshData both{Positions<double>(a.V.rows() + b.V.rows() + 1, 3), Faces(a.F.rows() + b.F.rows(), 3)};
  both.V << a.V, Eigen::RowVector3d(7, 7, 7), b.V * 1000.0;
  both.F << a.F, (b.F.array() + static_cast<Index>(a.V.rows()) + 1).matrix();
  const Case s(both), first(a);
  const auto result = s.smoothest(4);
  REQUIRE(result.components.size() == 2);
  CHECK(result.components[0].lambda == doctest::Approx(first.smoothest(4).components[0].lambda).epsilon(1e-7));
  CHECK(result.components[1].converged);
  CHECK(result.field.u[a.V.rows()] == Complex<double>(0));
  CHECK(result.field.u.tail(b.V.rows()).norm() > 0);
  CHECK(result.field.vectors(0).row(a.V.rows()).norm() == 0);
}

TEST_CASE("vectors and components undo each other; branches are n-fold") {
  const Case s(jittered_sphere(2, 0.2, 1));
  for (const int n : {1, 2, 5}) {
    const auto field = s.smoothest(n).field;
    for (int k = 0; k < n; ++k)
      CHECK((from_vectors(n, field.vectors(k), s.frames).u - field.u).cwiseAbs().maxCoeff() < 1e-13);
    CHECK(field.raw().cols() == 3 * n);
    CHECK_THROWS_AS((void)field.vectors(n), OptionError);
    CHECK(normalised(field).u.cwiseAbs().minCoeff() == doctest::Approx(1));
  }
  for (Index v = 0; v < s.mesh.vertices(); ++v) {
    CHECK(std::abs(s.frames->X.row(v).dot(s.frames->N.row(v))) < 1e-14);
    CHECK(s.frames->X.row(v).norm() == doctest::Approx(1));
  }
}

TEST_CASE("frames make edge directions fit: on a sphere to second order of the edge length") {
  const Case s(icosphere(5));
  double worst = 0;
  for (Index h = 0; h < s.mesh.halfedges(); ++h) {
    const Index v = s.mesh.tail(h);
    const auto z = s.frames->component(v, s.surface.V.row(s.mesh.tip(h)) - s.surface.V.row(v));
    worst = std::max(worst, std::abs(wrap(std::arg(z) - s.connection.rho_start(s.mesh, h))));
  }
  CHECK(worst < 2e-3);
}

TEST_CASE("thread count changes no bit of the field through a serial backend, nothing beyond 1e-10 through BLAS") {
  const MeshData surface = bumpy_sphere(4, 0.3, 3);
  const auto field = [&](int threads, const char* solver) {
    ComplexVectorX<double> u;
    run_with_threads(threads, [&] {
      const Case s(surface);
      u = smoothest_field(s.mesh, s.geometry, s.connection, s.frames, {.n = 4, .eigen = {.solver = solver}}).field.u;
    });
    return u;
  };
  const auto serial = field(1, "eigen-ldlt"), direct = field(1, "auto");
  for (const int threads : {2, 4}) {
    CHECK(field(threads, "eigen-ldlt") == serial);
    CHECK((field(threads, "auto") - direct).cwiseAbs().maxCoeff() < 1e-10 * direct.cwiseAbs().maxCoeff());
  }
}

TEST_CASE("two threads may run two designs at once, with the results of one") {
  const Case a(bumpy_sphere(3, 0.3, 3)), b(torus(20, 10, 1, 0.4));
  const auto alone_a = a.smoothest(4), alone_b = b.smoothest(2);
  SmoothestResult together[2];
  parallel_for(
      2, [&](std::int64_t k) { together[k] = k == 0 ? a.smoothest(4) : b.smoothest(2); }, 1);
  CHECK((together[0].field.u - alone_a.field.u).cwiseAbs().maxCoeff() < 1e-10 * alone_a.field.u.cwiseAbs().maxCoeff());
  CHECK(std::abs(together[1].components[0].lambda - alone_b.components[0].lambda) < 1e-10);
}

TEST_CASE("bad options are refused") {
  const Case s(tetrahedron());
  CHECK_THROWS_AS((void)s.smoothest(0), OptionError);
  CHECK_THROWS_AS((void)s.smoothest(1, 2.0), OptionError);
  CHECK_THROWS_AS(
      (void)smoothest_field(s.mesh, s.geometry, s.connection, s.frames, {.n = 1, .eigen = {.solver = "nope"}}),
      OptionError);
}
