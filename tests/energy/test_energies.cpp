// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>

#include "alcap/energies.h"
#include "alcap/generators.h"
#include "alcap/operators.h"
#include "src/base/parallel.h"
#include "src/base/random.h"

using namespace alcap;

namespace {

using C = std::complex<double>;

struct Case {
  Mesh mesh;
  Geometry geometry;
  Connection connection;
  HermitianPattern pattern;
  explicit Case(const MeshData& s)
      : mesh(s.F, s.V.rows()), geometry(mesh, s.V), connection(globally_optimal(mesh, geometry)), pattern(mesh) {}
};

ComplexVectorX<double> random_field(Index size, std::uint64_t seed) {
  detail::Random random(seed);
  ComplexVectorX<double> u(size);
  for (C& z : u) z = {random.uniform(-1, 1), random.uniform(-1, 1)};
  return u;
}

double form(const SparseMatrix<C>& A, const ComplexVectorX<double>& u) { return u.dot(A * u).real(); }

// Integrals of |u|^2, |grad u|^2 and the halves |D1 - i D2|^2 / 2, |D1 + i D2|^2 / 2 by 8 x 8 collapsed Gauss points.
struct Integrals {
  double mass = 0, dirichlet = 0, antiholomorphic = 0, holomorphic = 0;
};
Integrals quadrature(const Case& s, int n, const ComplexVectorX<double>& u) {
  static const double x[8] = {0.0198550717512319, 0.101666761293187, 0.237233795041836, 0.408282678752175,
                              0.591717321247825,  0.762766204958164, 0.898333238706813, 0.980144928248768};
  static const double w[8] = {0.0506142681451881, 0.111190517226687, 0.156853322938944, 0.181341891689181,
                              0.181341891689181,  0.156853322938944, 0.111190517226687, 0.0506142681451881};
  Integrals sum;
  for (Index t = 0; t < s.mesh.faces(); ++t) {
    const FaceField field = face_field(s.mesh, s.geometry, s.connection, n, u, t);
    for (int i = 0; i < 8; ++i)
      for (int j = 0; j < 8; ++j) {
        const double a = x[i], b = (1 - x[i]) * x[j];
        const double weight = 2 * s.geometry.area(t) * w[i] * w[j] * (1 - x[i]);
        const FieldValue at = field.at({a, b, 1 - a - b});
        sum.mass += weight * std::norm(at.u);
        sum.dirichlet += weight * at.squared_gradient();
        sum.antiholomorphic += weight / 2 * std::norm(at.div_curl());
        sum.holomorphic += weight / 2 * std::norm(at.reflected());
      }
  }
  return sum;
}

}  // namespace

TEST_CASE("S, M and the curvature and boundary term are the integrals they stand for, closed and open, n = 1 to 6") {
  for (const MeshData& surface : {jittered_sphere(1, 0.2, 3), cylinder(8, 3), noisy_scan(3, 0.1, 2)}) {
    const Case s(surface);
    for (int n = 1; n <= 6; n += surface.F.rows() > 500 ? 3 : 1) {
      const auto u = random_field(s.mesh.vertices(), static_cast<std::uint64_t>(n));
      const Integrals exact = quadrature(s, n, u);
      const auto [S, M] = stiffness_and_mass(s.mesh, s.pattern, s.geometry, s.connection, n);
      const auto D = curvature_and_boundary(s.mesh, s.pattern, s.geometry, s.connection, n);
      CHECK(form(M, u) == doctest::Approx(exact.mass).epsilon(1e-9));
      CHECK(form(S, u) == doctest::Approx(exact.dirichlet).epsilon(1e-9));
      const double scale = exact.antiholomorphic + exact.holomorphic;
      CHECK(std::abs(form(D, u) - (exact.antiholomorphic - exact.holomorphic)) < 1e-9 * scale);
      const FieldEnergies e = field_energies(s.mesh, s.geometry, s.connection, n, u);
      CHECK(e.dirichlet == doctest::Approx(exact.dirichlet / 2).epsilon(1e-9));
      CHECK(e.antiholomorphic == doctest::Approx(exact.antiholomorphic).epsilon(1e-9));
      CHECK(e.holomorphic == doctest::Approx(exact.holomorphic).epsilon(1e-9));
    }
  }
}

TEST_CASE("S and M are Hermitian and positive (semi)definite on slivers, and so is every member of the energy family") {
  for (const MeshData& surface : {cad_like(12, 2), disk(3), tetrahedron(), single_triangle()}) {
    const Case s(surface);
    for (const int n : {1, 4, 30}) {
      auto [S, M] = stiffness_and_mass(s.mesh, s.pattern, s.geometry, s.connection, n);
      const Eigen::MatrixXcd dense_M(M);
      CHECK((dense_M - dense_M.adjoint()).norm() == 0.0);
      CHECK(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXcd>(dense_M, Eigen::EigenvaluesOnly).eigenvalues()[0] > 0);
      for (const double e : {0.0, -1.0, -0.5, 0.5, 1.0}) {
        SparseMatrix<C> A = S;
        apply_energy_family(s.mesh, s.pattern, s.geometry, s.connection, n, e, A);
        const Eigen::MatrixXcd dense(A);
        CHECK((dense - dense.adjoint()).norm() == 0.0);
        const auto values =
            Eigen::SelfAdjointEigenSolver<Eigen::MatrixXcd>(dense, Eigen::EigenvaluesOnly).eigenvalues();
        CHECK(values[0] > -1e-12 * values[values.size() - 1]);
      }
    }
  }
}

TEST_CASE("the sphere's spectrum has multiplicities 2l + 1 around l(l+1) - n^2, l = n, n+1, and converges to it") {
  for (const int n : {1, 2, 3}) {
    double error[2] = {0, 0};
    for (int level = 1; level <= 2; ++level) {
      const Case s(icosphere(level));
      const auto [S, M] = stiffness_and_mass(s.mesh, s.pattern, s.geometry, s.connection, n);
      const Eigen::VectorXd values = Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXcd>(
                                         Eigen::MatrixXcd(S), Eigen::MatrixXcd(M), Eigen::EigenvaluesOnly)
                                         .eigenvalues();
      Eigen::Index k = 0;
      for (int l = n; l <= n + 1; ++l)
        for (int m = 0; m < 2 * l + 1; ++m, ++k)
          error[level - 1] = std::max(error[level - 1], std::abs(values[k] / (l * (l + 1) - n * n) - 1));
      // A clear gap to the next cluster closes the count.
      CHECK(values[k] - values[k - 1] > 0.5 * 2 * (n + 2));
    }
    CHECK(error[1] < 0.2);
    CHECK(error[1] < error[0] / 3);
  }
}

TEST_CASE("the real view acts like the complex matrix") {
  const Case s(icosphere(1));
  const auto S = stiffness_and_mass(s.mesh, s.pattern, s.geometry, s.connection, 3).S;
  const auto u = random_field(s.mesh.vertices(), 5);
  const ComplexVectorX<double> Su = S * u;
  const Eigen::Map<const Eigen::VectorXd> flat(reinterpret_cast<const double*>(u.data()), 2 * u.size());
  const Eigen::VectorXd product = real_view(S) * flat;
  for (Index v = 0; v < s.mesh.vertices(); ++v) CHECK(std::abs(C(product[2 * v], product[2 * v + 1]) - Su[v]) < 1e-13);
}

TEST_CASE("turning the vertex frames conjugates the matrices") {
  Case s(jittered_sphere(2, 0.2, 8));
  const int n = 3;
  const auto before = stiffness_and_mass(s.mesh, s.pattern, s.geometry, s.connection, n);
  const auto u = random_field(s.mesh.vertices(), 9);
  // Turning the frame of v by g adds -g to rho_{v -> e} and rho_{v -> t}; rho_ij = rho_{vi->e} - rho_{vj->e} + eps
  // follows.
  detail::Random random(4);
  Eigen::VectorXd turn(s.mesh.vertices());
  for (double& g : turn) g = random.uniform(-3, 3);
  for (Index e = 0; e < s.mesh.edges(); ++e) {
    const Index h = s.mesh.halfedge(e);
    s.connection.rho[e] += turn[s.mesh.tip(h)] - turn[s.mesh.tail(h)];
  }
  ComplexVectorX<double> turned = u;
  for (Index v = 0; v < s.mesh.vertices(); ++v) turned[v] *= std::polar(1.0, -n * turn[v]);
  const auto after = stiffness_and_mass(s.mesh, s.pattern, s.geometry, s.connection, n);
  CHECK(form(after.S, turned) == doctest::Approx(form(before.S, u)).epsilon(1e-12));
  CHECK(form(after.M, turned) == doctest::Approx(form(before.M, u)).epsilon(1e-12));
}

TEST_CASE("S does not change with scale and M changes with area") {
  MeshData surface = jittered_sphere(2, 0.2, 8);
  const Case s(surface);
  surface.V *= 1e-6;
  const Geometry small(s.mesh, surface.V);
  const auto a = stiffness_and_mass(s.mesh, s.pattern, s.geometry, s.connection, 4);
  const auto b = stiffness_and_mass(s.mesh, s.pattern, small, s.connection, 4);
  const auto u = random_field(s.mesh.vertices(), 1);
  CHECK(form(b.S, u) == doctest::Approx(form(a.S, u)).epsilon(1e-9));
  CHECK(form(b.M, u) == doctest::Approx(1e-12 * form(a.M, u)).epsilon(1e-9));
}

TEST_CASE("thread count changes no bit") {
  const MeshData surface = jittered_sphere(4, 0.2, 5);
  const Case s(surface);
  StiffnessMass a, b;
  run_with_threads(1, [&] { a = stiffness_and_mass(s.mesh, HermitianPattern(s.mesh), s.geometry, s.connection, 4); });
  run_with_threads(4, [&] { b = stiffness_and_mass(s.mesh, HermitianPattern(s.mesh), s.geometry, s.connection, 4); });
  for (Index k = 0; k < a.S.nonZeros(); ++k) {
    REQUIRE(a.S.valuePtr()[k] == b.S.valuePtr()[k]);
    REQUIRE(a.M.valuePtr()[k] == b.M.valuePtr()[k]);
  }
}

TEST_CASE("unreferenced vertices have empty rows and a pattern of another mesh is refused") {
  MeshData s = icosphere(1);
  s.V.conservativeResize(s.V.rows() + 2, 3);
  s.V.bottomRows(2).setZero();
  const Case c(s);
  const auto M = stiffness_and_mass(c.mesh, c.pattern, c.geometry, c.connection, 2).M;
  CHECK(M.coeff(c.mesh.vertices() - 1, c.mesh.vertices() - 1) == C(0));
  const Mesh other(icosphere(0).F, 12);
  CHECK_THROWS_AS((void)stiffness_and_mass(c.mesh, HermitianPattern(other), c.geometry, c.connection, 1), OptionError);
  SparseMatrix<C> S = M;
  CHECK_THROWS_AS(apply_energy_family(c.mesh, c.pattern, c.geometry, c.connection, 1, 1.5, S), OptionError);
}
