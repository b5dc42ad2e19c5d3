// SPDX-License-Identifier: MIT
//
// First-order operators against known values: flat pieces, the sphere, the Euler characteristic; adjoint, scale, float.
#include "tests/energy/operators_fixture.h"

#include <doctest/doctest.h>
#include <Eigen/Geometry>

#include "alcap/energies.h"

using namespace alcap;
using namespace alcap::test;

TEST_CASE("lengths times s give P times s, energies are scale-free") {
  detail::Random random(7);
  const Case c(jittered_sphere(2, 0.2, 9));
  for (const double s : {1e-6, 3.7, 1e6}) {
    const Case d(MeshData{s * c.surface.V, c.surface.F});
    const Vec u = random_field(c.mesh, random);
    for (const auto kind : {OperatorKind::edge, OperatorKind::triangle}) {
      const auto a = first_order_operators(c.mesh, c.geometry, locally_optimal(c.mesh, c.geometry), {2, kind});
      const auto b = first_order_operators(d.mesh, d.geometry, locally_optimal(d.mesh, d.geometry), {2, kind});
      CHECK(relative(b.p, s * a.p) < 1e-11);
      CHECK(relative(b.q, s * a.q) < 1e-11);
      const auto x = operator_energies(c.mesh, c.geometry, a, u), y = operator_energies(d.mesh, d.geometry, b, u);
      CHECK(y.antiholomorphic == doctest::Approx(x.antiholomorphic).epsilon(1e-11));
      CHECK(y.holomorphic == doctest::Approx(x.holomorphic).epsilon(1e-11));
    }
  }
}

TEST_CASE(
    "linear fields on flat pieces: divergence, curl and the reflected pair are exact, any n, up to the boundary") {
  detail::Random random(8);
  for (const MeshData& surface : {grid(7, 5, 2, 1), disk(5)}) {
    const Case c(surface);
    for (const auto& connection :
         {polar(c.mesh, c.geometry), locally_optimal(c.mesh, c.geometry), globally_optimal(c.mesh, c.geometry)}) {
      const auto frames = vertex_frames(c.mesh, c.surface.V, connection);
      const C a(0.3, -0.8), gx(random.uniform(), 0.7), gy(-0.4, random.uniform());  // w = a + gx x + gy y
      for (int n = 1; n <= 6; ++n) {
        Vec u(c.mesh.vertices());
        for (Index v = 0; v < u.size(); ++v) {
          const C axis(frames.X(v, 0), frames.X(v, 1));
          u[v] = (a + gx * c.surface.V(v, 0) + gy * c.surface.V(v, 1)) * std::pow(std::conj(axis), n);
        }
        Vec p(c.mesh.faces()), q(c.mesh.faces());
        for (Index t = 0; t < c.mesh.faces(); ++t) {
          const Row side = c.surface.V.row(c.mesh.F()(t, 1)) - c.surface.V.row(c.mesh.F()(t, 0));
          const C axis = C(side.x(), side.y()) / side.norm();
          p[t] = c.geometry.area(t) * (gx - I * gy) * std::pow(axis, 1 - n);
          q[t] = c.geometry.area(t) * (gx + I * gy) * std::pow(axis, -1 - n);
        }
        for (const auto kind : {OperatorKind::edge, OperatorKind::triangle}) {
          const auto ops = first_order_operators(c.mesh, c.geometry, connection, {n, kind});
          CHECK(relative(apply(c.mesh, ops.p, u), p) < 1e-11);
          CHECK(relative(apply(c.mesh, ops.q, u), q) < 1e-11);
        }
        if (n == 1) {
          const auto ops = first_order_operators(c.mesh, c.geometry, connection);
          const Vec f = apply(c.mesh, ops.p, u);
          CHECK(f[3].real() == doctest::Approx(c.geometry.area(3) * (gx.real() + gy.imag())));  // div
          CHECK(f[3].imag() == doctest::Approx(c.geometry.area(3) * (gx.imag() - gy.real())));  // curl
        }
      }
    }
  }
}

TEST_CASE("the rotation field of the sphere: no divergence, curl 2 w.n, and errors fall faster than lengths") {
  const Row axis = Row(0.3, -0.5, 0.81).normalized();
  for (const auto kind : {OperatorKind::edge, OperatorKind::triangle}) {
    double before = 0;
    for (const int level : {2, 3, 4}) {
      const Case c(icosphere(level));
      const auto connection = globally_optimal(c.mesh, c.geometry);
      Frames frames = vertex_frames(c.mesh, c.surface.V, connection);
      const Vec u = components(frames, [&](Index v) -> Row { return axis.cross(Row(c.surface.V.row(v))); });
      const auto ops = first_order_operators(c.mesh, c.geometry, connection, {1, kind});
      const Vec f = apply(c.mesh, ops.p, u);
      double error = 0, curl = 0;
      for (Index t = 0; t < c.mesh.faces(); ++t) {
        Row center = Row::Zero();
        for (int k = 0; k < 3; ++k) center += c.surface.V.row(c.mesh.F()(t, k)) / 3;
        const double expected = 2 * axis.dot(center) * c.geometry.area(t);
        error += std::norm(f[t] - I * expected);
        curl += expected * expected;
      }
      error = std::sqrt(error / curl);
      CAPTURE(level);
      CHECK(error < 0.2 * std::pow(0.5, level));
      if (before > 0) CHECK(std::log2(before / error) > 1.3);
      before = error;
    }
  }
}

TEST_CASE("E_A - E_H of unit fields is 2 pi chi with the edge-based operators") {
  detail::Random random(9);
  struct Expected {
    MeshData surface;
    double chi, tolerance;
  };
  for (const auto& [surface, chi, tolerance] : {Expected{icosphere(2), 2, 1e-3},
                                                {icosphere(3), 2, 1e-4},
                                                {icosphere(4), 2, 1e-5},
                                                {torus(60, 30, 1, 0.4), 0, 1e-3},
                                                {genus_surface(2, 4), -2, 0.02},
                                                {genus_surface(3, 4), -4, 0.02}}) {
    const Case c(surface);
    const auto connection = globally_optimal(c.mesh, c.geometry);
    const auto frames = vertex_frames(c.mesh, c.surface.V, connection);
    const auto ops = first_order_operators(c.mesh, c.geometry, connection);
    for (int trial = 0; trial < 5; ++trial) {
      const Smooth field(random);
      Vec u = components(frames, [&](Index v) { return field(c.surface.V.row(v)); });
      for (C& z : u) z /= std::abs(z);
      const auto energies = operator_energies(c.mesh, c.geometry, ops, u);
      const double euler = chi;
      CAPTURE(euler);
      CHECK(std::abs((energies.antiholomorphic - energies.holomorphic) / pi<double> - 2 * chi) < tolerance);
    }
  }
}

TEST_CASE("energies from triangle-based means never exceed the exact ones and tend to them") {
  detail::Random random(10);
  const Smooth field(random);
  double before = 1;
  for (const int level : {2, 3, 4}) {
    const Case c(jittered_sphere(level, 0.2, 11));
    const auto connection = globally_optimal(c.mesh, c.geometry);
    const auto frames = vertex_frames(c.mesh, c.surface.V, connection);
    const HermitianPattern pattern(c.mesh);
    for (const int n : {1, 2, 4}) {
      const Vec u = components(
          frames, [&](Index v) { return field(c.surface.V.row(v)); }, n);
      const auto ops = first_order_operators(c.mesh, c.geometry, connection, {n, OperatorKind::triangle});
      const auto mean = operator_energies(c.mesh, c.geometry, ops, u);
      const auto [S, M] = stiffness_and_mass(c.mesh, pattern, c.geometry, connection, n);
      const auto K = curvature_and_boundary(c.mesh, pattern, c.geometry, connection, n);
      const double sum = u.dot(S * u).real(), difference = u.dot(K * u).real();
      CHECK(mean.antiholomorphic <= (sum + difference) / 2 * (1 + 1e-12));
      CHECK(mean.holomorphic <= (sum - difference) / 2 * (1 + 1e-12));
      const double missing = 1 - 2 * mean.dirichlet() / sum;
      if (n == 1) {
        CHECK(missing < 0.5 * before);
        before = missing;
      }
    }
  }
}

TEST_CASE("the sparse matrix, the product and the adjoint are one operator") {
  detail::Random random(11);
  const Case c(noisy_scan(3, 0.1, 12));
  const auto ops = first_order_operators(c.mesh, c.geometry, polar(c.mesh, c.geometry), {4, OperatorKind::edge});
  const Vec u = random_field(c.mesh, random);
  Vec w(c.mesh.faces());
  for (C& z : w) z = C(random.uniform(-1, 1), random.uniform(-1, 1));
  for (const Vec& a : {ops.p, ops.q}) {
    const auto matrix = face_vertex_matrix(c.mesh, a);
    CHECK(matrix.rows() == c.mesh.faces());
    CHECK(matrix.cols() == c.mesh.vertices());
    CHECK(matrix.nonZeros() == 3 * c.mesh.faces());
    CHECK(relative(apply(c.mesh, a, u), matrix * u) < 1e-14);
    CHECK(relative(apply_adjoint(c.mesh, a, w), matrix.adjoint() * w) < 1e-14);
  }
}
