// SPDX-License-Identifier: MIT
//
// First-order operators: closed forms against quadrature of the interpolated field, Stokes, invariances, exactness on
// flat pieces, and the Euler characteristic from E_A - E_H.
#include "alcap/operators.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "alcap/detail/random.h"
#include "alcap/energies.h"
#include "alcap/frames.h"
#include "alcap/generators.h"
#include "alcap/parallel.h"

using namespace alcap;

namespace {

using C = std::complex<double>;
using Vec = ComplexVectorX<double>;
using Row = Eigen::RowVector3d;
constexpr C I(0, 1);

struct Case {
  Surface surface;
  Mesh mesh;
  Geometry<double> geometry;
  explicit Case(Surface s) : surface(std::move(s)), mesh(surface.F, surface.V.rows()), geometry(mesh, surface.V) {}
};

Vec random_field(const Mesh& mesh, detail::Random& random) {
  Vec u(mesh.vertices());
  for (C& z : u) z = C(random.uniform(-1, 1), random.uniform(-1, 1));
  return u;
}

/// Any connection at all: every angle moved by up to `size`, lifts kept consistent.
Connection<double> scrambled(const Mesh& mesh, Connection<double> c, double size, detail::Random& random) {
  const auto any = [&] { return random.uniform(-size, size); };
  for (Index e = 0; e < mesh.edges(); ++e) {
    const double at_tail = any(), at_tip = any(), along = any();
    c.rho_e[2 * e] += at_tail;
    c.rho_e[2 * e + 1] += at_tip;
    c.rho[e] += along;
    c.eps[e] += along - at_tail + at_tip;
    const Index h = mesh.halfedge(e), g = mesh.twin(h);
    c.tau[h] += along;
    if (g != none) c.tau[g] -= along;
  }
  for (Index h = 0; h < mesh.halfedges(); ++h) {
    const double turn = any();
    c.rho_t[h] += turn;
    c.tau[h] -= turn;
    c.tau[Mesh::prev(h)] += turn;
  }
  for (Index t = 0; t < mesh.faces(); ++t) c.K[t] = -(c.tau[3 * t] + c.tau[3 * t + 1] + c.tau[3 * t + 2]);
  return c;
}

/// Gauss-Legendre nodes and weights on [0, 1], by Newton's method.
std::vector<std::pair<double, double>> gauss(int count) {
  std::vector<std::pair<double, double>> rule;
  for (int i = 0; i < count; ++i) {
    double x = std::cos(pi<double> * (i + 0.75) / (count + 0.5)), slope = 1;
    for (int step = 0; step < 8; ++step) {
      double before = 1, now = x;
      for (int k = 2; k <= count; ++k) {
        const double next = ((2 * k - 1) * x * now - (k - 1) * before) / k;
        before = now;
        now = next;
      }
      slope = count * (x * now - before) / (x * x - 1);
      x -= now / slope;
    }
    rule.emplace_back((1 + x) / 2, 1 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

/// Integral over a triangle of the given area of f(barycentric).
C over_triangle(double area, const std::function<C(const std::array<double, 3>&)>& f) {
  static const auto rule = gauss(20);
  C sum = 0;
  for (const auto& [x, wx] : rule)
    for (const auto& [y, wy] : rule) sum += wx * wy * (1 - x) * f({x, y * (1 - x), (1 - x) * (1 - y)});
  return 2 * area * sum;
}

/// The largest deviation over the largest value.
double relative(const Vec& a, const Vec& b) { return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff(); }

/// Components of tangential vectors in space as an n-field: (component)^n.
Vec components(const Frames<double>& frames, const std::function<Row(Index)>& vector, int n = 1) {
  Vec u(frames.X.rows());
  for (Index v = 0; v < u.size(); ++v) u[v] = std::pow(frames.component(v, vector(v)), n);
  return u;
}

/// A smooth random field in space: polynomials of degree two.
struct Smooth {
  Eigen::Matrix<double, 3, 9> A;
  explicit Smooth(detail::Random& random) {
    for (double& a : A.reshaped()) a = random.uniform(-1, 1);
  }
  Row operator()(const Row& p) const {
    Eigen::Matrix<double, 9, 1> m;
    m << 0, p.x(), p.y(), p.z(), p.x() * p.y(), p.y() * p.z(), p.z() * p.x(), p.x() * p.x(), p.y() * p.y();
    m[0] = 1;
    return (A * m).transpose();
  }
};

}  // namespace

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
      CHECK(std::abs(2.0 * value.cauchy_riemann() - (value.d1 + I * value.d2)) < 1e-12 * std::abs(value.d1));
    }
  }
}

TEST_CASE("Stokes: edge-based divergence and curl of any patch are the flux and circulation of its boundary") {
  detail::Random random(4);
  for (const Surface& surface : {jittered_sphere(3, 0.2, 6), torus(20, 10, 1, 0.4), genus_surface(2, 2), disk(8)}) {
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
  Surface other = c.surface;
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

TEST_CASE("lengths times s give P times s, energies are scale-free") {
  detail::Random random(7);
  const Case c(jittered_sphere(2, 0.2, 9));
  for (const double s : {1e-6, 3.7, 1e6}) {
    const Case d(Surface{s * c.surface.V, c.surface.F});
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
  for (const Surface& surface : {grid(7, 5, 2, 1), disk(5)}) {
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
      Frames<double> frames = vertex_frames(c.mesh, c.surface.V, connection);
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
    Surface surface;
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
      CAPTURE(chi);
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

TEST_CASE("float agrees with double to rounding") {
  detail::Random random(12);
  const Case c(jittered_sphere(2, 0.2, 13));
  const Geometry<float> geometry(c.mesh, Positions<float>(c.surface.V.cast<float>()));
  const auto in_double = polar(c.mesh, c.geometry);
  const auto in_float = polar(c.mesh, geometry);
  for (const auto kind : {OperatorKind::edge, OperatorKind::triangle}) {
    for (const int n : {1, 4}) {
      const auto a = first_order_operators(c.mesh, c.geometry, in_double, {n, kind});
      const auto b = first_order_operators(c.mesh, geometry, in_float, {n, kind});
      CHECK(relative(b.p.cast<C>(), a.p) < 2e-4);
      CHECK(relative(b.q.cast<C>(), a.q) < 2e-4);
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
