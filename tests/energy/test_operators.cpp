// SPDX-License-Identifier: MIT
//
// First-order operators: closed forms against quadrature of the interpolated field, Stokes, and invariances.
#include "tests/energy/operators_fixture.h"

#include <doctest/doctest.h>

#include <cstring>

#include "src/base/parallel.h"

using namespace alcap;
using namespace alcap::test;

TEST_CASE(
    "triangle-based P and Q are the integrals of the interpolated field's derivatives, any connection, n = 1..6") {
  detail::Random random(1);
  const Case c(jittered_sphere(0, 0.2, 3));
  for (const double size : {1e-3, 0.3, 1.5}) {
    const auto connection = scrambled(c.mesh, polar(c.mesh, c.geometry), size, random);
    const Vec u = random_field(c.mesh, random);
    for (int n = 1; n <= 6; ++n) {
      CAPTURE(n);
      CAPTURE(size);
      const auto ops = first_order_operators(c.mesh, c.geometry, connection, {n, OperatorKind::triangle});
      Vec p(c.mesh.faces()), q(c.mesh.faces());
      for (Index t = 0; t < c.mesh.faces(); ++t) {
        const auto field = face_field(c.mesh, c.geometry, connection, n, u, t);
        p[t] = over_triangle(c.geometry.area(t), [&](const auto& b) { return field.at(b).div_curl(); });
        q[t] = over_triangle(c.geometry.area(t), [&](const auto& b) { return field.at(b).reflected(); });
      }
      CHECK(relative(apply(c.mesh, ops.p, u), p) < 1e-12);
      CHECK(relative(apply(c.mesh, ops.q, u), q) < 1e-12);
    }
  }
}

TEST_CASE(
    "edge-based P and Q are boundary integrals of the field interpolated along the edges, with and without alpha") {
  detail::Random random(2);
  const Case c(jittered_sphere(0, 0.2, 4));
  const auto rule = gauss(20);
  for (const bool adjusted : {false, true}) {
    auto connection = scrambled(c.mesh, polar(c.mesh, c.geometry), 0.5, random);
    if (adjusted) {
      connection.alpha.resize(c.mesh.halfedges());
      for (double& a : connection.alpha) a = random.uniform(-1, 1);
    }
    const Vec u = random_field(c.mesh, random);
    for (int n = 1; n <= 6; ++n) {
      CAPTURE(n);
      CAPTURE(adjusted);
      Vec p = Vec::Zero(c.mesh.faces()), q = p;
      for (Index h = 0; h < c.mesh.halfedges(); ++h) {
        const double start = connection.rho_start(c.mesh, h), end = connection.rho_end(c.mesh, h);
        const double eps = connection.eps_along(c.mesh, h);
        const C dl = c.geometry.length(c.mesh.edge(h)) * std::exp(I * c.geometry.direction(h));
        const C normal = -I * dl;  // outward, the face lies to the left
        for (const auto& [x, w] : rule) {
          const C along = (1 - x) * std::exp(-I * double(n) * (start + eps * x)) * u[c.mesh.tail(h)] +
                          x * std::exp(-I * double(n) * (end - eps * (1 - x))) * u[c.mesh.tip(h)];
          const C inside = along * std::exp(-I * double(n) * connection.edge_to_face(c.geometry, h));
          p[Mesh::face(h)] += w * std::conj(normal) * inside;
          q[Mesh::face(h)] += w * normal * inside;
        }
      }
      const auto ops = first_order_operators(c.mesh, c.geometry, connection, {n, OperatorKind::edge});
      CHECK(relative(apply(c.mesh, ops.p, u), p) < 1e-12);
      CHECK(relative(apply(c.mesh, ops.q, u), q) < 1e-12);
    }
  }
}

TEST_CASE("point evaluation: hat values at corners, derivatives equal finite differences plus the connection form") {
  detail::Random random(3);
  const Case c(jittered_sphere(1, 0.2, 5));
  const auto connection = scrambled(c.mesh, polar(c.mesh, c.geometry), 0.5, random);
  const Vec u = random_field(c.mesh, random);
  for (int n = 1; n <= 6; ++n) {
    for (Index t = 0; t < c.mesh.faces(); t += 7) {
      const auto field = face_field(c.mesh, c.geometry, connection, n, u, t);
      for (std::size_t k = 0; k < 3; ++k) {
        std::array<double, 3> corner{};
        corner[k] = 1;
        const Index h = 3 * t + static_cast<Index>(k);
        const C expected = u[c.mesh.tail(h)] * std::exp(-I * double(n) * connection.rho_t[h]);
        CHECK(std::abs(field.at(corner).u - expected) < 1e-13);
      }
      const double x = random.uniform(0.1, 0.4), y = random.uniform(0.1, 0.4);
      const std::array<double, 3> b{x, y, 1 - x - y};
      const auto value = field.at(b);
      const double step = 1e-4 * std::sqrt(c.geometry.area(t));
      for (const C w : {C(1), I}) {  // directions along the frame's axes
        const auto slope = [&](std::size_t k) { return (std::conj(w) * field.grad[k]).real(); };
        const auto moved = [&](double s) {
          return field.at({b[0] + s * slope(0), b[1] + s * slope(1), b[2] + s * slope(2)}).u;
        };
        const C difference = (8.0 * (moved(step) - moved(-step)) - (moved(2 * step) - moved(-2 * step))) / (12 * step);
        double omega = 0;  // the Whitney form of tau: grad u = du + i n omega u
        for (std::size_t k = 0; k < 3; ++k) {
          const std::size_t m = (k + 1) % 3;
          omega += field.tau[k] * (b[k] * slope(m) - b[m] * slope(k));
        }
        const C expected = difference + I * double(n) * omega * value.u;
        CHECK(std::abs(value.derivative(w) - expected) * std::sqrt(c.geometry.area(t)) < 1e-9);
      }
      CHECK(std::abs(value.div_curl() - (value.d1 - I * value.d2)) < 1e-12 * std::abs(value.d1));
      CHECK(C(value.div(), value.curl()) == value.div_curl());
      CHECK(std::abs(2.0 * value.cauchy_riemann() - (value.d1 + I * value.d2)) < 1e-12 * std::abs(value.d1));
    }
  }
}

TEST_CASE("Stokes: edge-based divergence and curl of any patch are the flux and circulation of its boundary") {
  detail::Random random(4);
  for (const MeshData& surface : {jittered_sphere(3, 0.2, 6), torus(20, 10, 1, 0.4), genus_surface(2, 2), disk(8)}) {
    const Case c(surface);
    const auto connection = globally_optimal(c.mesh, c.geometry);
    const Vec u = random_field(c.mesh, random);
    const auto ops = first_order_operators(c.mesh, c.geometry, connection);
    const Vec f = apply(c.mesh, ops.p, u);
    for (int trial = 0; trial < 20; ++trial) {
      // Trial 0 is the whole surface, the others random halves of it.
      std::vector<bool> inside(static_cast<std::size_t>(c.mesh.faces()), true);
      if (trial > 0)
        for (std::size_t t = 0; t < inside.size(); ++t) inside[t] = random.uniform() < 0.5;
      C sum = 0, boundary = 0;
      double scale = 0;
      for (Index h = 0; h < c.mesh.halfedges(); ++h) {
        if (!inside[static_cast<std::size_t>(h / 3)]) continue;
        if (h % 3 == 0) sum += f[h / 3];
        const Index g = c.mesh.twin(h);
        const C along = flux_and_circulation(c.mesh, c.geometry, connection, u, h);
        scale += std::abs(along);
        if (g != none)
          CHECK(std::abs(along + flux_and_circulation(c.mesh, c.geometry, connection, u, g)) <
                1e-13 * c.geometry.length(c.mesh.edge(h)) * 4);
        if (g == none || !inside[static_cast<std::size_t>(g / 3)]) boundary += along;
      }
      CHECK(std::abs(sum - boundary) < 1e-12 * scale);
      if (trial == 0 && c.mesh.boundary_edges() == 0) CHECK(std::abs(sum) < 1e-12 * scale);
    }
  }
}

TEST_CASE("turning the vertex frames changes no face value") {
  detail::Random random(5);
  const Case c(noisy_scan(3, 0.1, 7));
  const auto before = globally_optimal(c.mesh, c.geometry);
  auto after = before;
  VectorX<double> turn(c.mesh.vertices());
  for (double& a : turn) a = random.uniform(-3, 3);
  for (Index h = 0; h < c.mesh.halfedges(); ++h) after.rho_t[h] -= turn[c.mesh.tail(h)];
  for (Index e = 0; e < c.mesh.edges(); ++e) {
    const Index h = c.mesh.halfedge(e), i = c.mesh.tail(h), j = c.mesh.tip(h);
    after.rho_e[2 * e] -= turn[i];
    after.rho_e[2 * e + 1] -= turn[j];
    after.rho[e] += turn[j] - turn[i];
  }
  for (const auto kind : {OperatorKind::edge, OperatorKind::triangle}) {
    for (const int n : {1, 2, 4, 6}) {
      const Vec u = random_field(c.mesh, random);
      Vec turned = u;
      for (Index v = 0; v < c.mesh.vertices(); ++v) turned[v] *= std::exp(-I * double(n) * turn[v]);
      const auto a = first_order_operators(c.mesh, c.geometry, before, {n, kind});
      const auto b = first_order_operators(c.mesh, c.geometry, after, {n, kind});
      CHECK(relative(apply(c.mesh, b.p, turned), apply(c.mesh, a.p, u)) < 1e-12);
      CHECK(relative(apply(c.mesh, b.q, turned), apply(c.mesh, a.q, u)) < 1e-12);
    }
  }
}

TEST_CASE("P is an (n-1)-vector and Q an (n+1)-vector of the face frame: another first corner turns them so") {
  detail::Random random(6);
  const Case c(jittered_sphere(2, 0.2, 8));
  MeshData other = c.surface;
  for (Index t = 0; t < c.mesh.faces(); ++t)
    for (int k = 0; k < 3; ++k) other.F(t, k) = c.surface.F(t, (k + t) % 3);
  const Case d(other);
  const auto before = globally_optimal(c.mesh, c.geometry), after = globally_optimal(d.mesh, d.geometry);
  const auto frames = vertex_frames(c.mesh, c.surface.V, before), turned = vertex_frames(d.mesh, d.surface.V, after);
  const Smooth field(random);
  for (const auto kind : {OperatorKind::edge, OperatorKind::triangle}) {
    for (int n = 1; n <= 6; ++n) {
      const auto at = [&](Index v) -> Row { return field(c.surface.V.row(v)); };
      const Vec u = components(frames, at, n), w = components(turned, at, n);
      const auto a = first_order_operators(c.mesh, c.geometry, before, {n, kind});
      const auto b = first_order_operators(d.mesh, d.geometry, after, {n, kind});
      Vec p = apply(c.mesh, a.p, u), q = apply(c.mesh, a.q, u);
      for (Index t = 0; t < c.mesh.faces(); ++t) {
        const double turn = c.geometry.direction(3 * t + t % 3);  // old frame to new frame
        p[t] *= std::exp(-I * double(n - 1) * turn);
        q[t] *= std::exp(-I * double(n + 1) * turn);
      }
      CHECK(relative(apply(d.mesh, b.p, w), p) < 1e-7);  // two conjugate gradient solves to 1e-10
      CHECK(relative(apply(d.mesh, b.q, w), q) < 1e-7);
    }
  }
}

TEST_CASE("any number of threads gives the same bits") {
  detail::Random random(13);
  const Case c(jittered_sphere(5, 0.2, 14));
  const auto connection = locally_optimal(c.mesh, c.geometry);
  const Vec u = random_field(c.mesh, random);
  const auto everything = [&](int threads, OperatorKind kind) {
    std::vector<Vec> out;
    run_with_threads(threads, [&] {
      const auto ops = first_order_operators(c.mesh, c.geometry, connection, {4, kind});
      const auto energies = operator_energies(c.mesh, c.geometry, ops, u);
      const Vec f = apply(c.mesh, ops.p, u);
      const Vec pair = Vec::Constant(1, C(energies.antiholomorphic, energies.holomorphic));
      out = {ops.p, ops.q, f, apply_adjoint(c.mesh, ops.q, f), pair};
    });
    return out;
  };
  for (const auto kind : {OperatorKind::edge, OperatorKind::triangle}) {
    const auto one = everything(1, kind), four = everything(4, kind);
    for (std::size_t k = 0; k < one.size(); ++k) {
      REQUIRE(one[k].size() == four[k].size());
      CHECK(std::memcmp(one[k].data(), four[k].data(), sizeof(C) * static_cast<std::size_t>(one[k].size())) == 0);
    }
  }
}

TEST_CASE("misuse is refused by name") {
  const Case c(icosphere(0));
  const auto connection = polar(c.mesh, c.geometry);
  const auto ops = first_order_operators(c.mesh, c.geometry, connection);
  const Vec u = Vec::Ones(c.mesh.vertices());
  CHECK_THROWS_AS((void)apply(c.mesh, ops.p, Vec(Vec::Ones(5))), OptionError);
  CHECK_THROWS_AS((void)apply(c.mesh, u, u), OptionError);
  CHECK_THROWS_AS((void)apply_adjoint(c.mesh, ops.p, u), OptionError);
  CHECK_THROWS_AS((void)face_field(c.mesh, c.geometry, connection, 1, u, c.mesh.faces()), OptionError);
}
