// SPDX-License-Identifier: MIT
//
// Everything a triangle contributes, against quadrature of the basis itself: S, M, P, Q, Whitney mass, energies.
#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <algorithm>

#include "kernels/basis.h"
#include "kernels/connection_energy.h"
#include "kernels/edge_operators.h"
#include "kernels/stiffness_mass.h"
#include "kernels/triangle_operators.h"
#include "tests/kernels/kernels_reference.h"

using namespace alcap::kernels;
using reference::C;
using reference::I;
using reference::Real;
using reference::to_c;
using reference::Triangle;

namespace {

const reference::Rule rule = reference::gauss(56);

/// Triangles of many shapes, degrees and curvatures, slivers among them.
std::vector<Triangle> triangles() {
  std::mt19937_64 random(3);
  std::vector<Triangle> list;
  const std::array<double, 4> flatness{1, 1, 1e-3, 1e-8};
  const std::array<int, 4> degrees{1, 4, -2, 7};
  for (const Real nK : reference::curvatures()) {
    for (std::size_t v = 0; v < 4; ++v) {
      list.push_back(
          reference::random_triangle(random, nK, std::min<Real>(10, 0.5L + nK * nK), flatness[v], degrees[v]));
    }
  }
  return list;
}

template <class T>
TriangleEntries<T> entries(const Triangle& t) {
  const std::array<T, 3> c = t.cots<T>();
  const T cot[3] = {c[0], c[1], c[2]};
  return stiffness_mass<T>(cot, static_cast<T>(t.area()), static_cast<T>(t.K()));
}

/// The 3 x 3 matrices with the phases put in.
struct Matrices {
  Eigen::Matrix3cd S, M;
};
Matrices matrices(const Triangle& t) {
  const TriangleEntries e = entries<double>(t);
  Matrices m;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = reference::next(i);
    const auto row = static_cast<Eigen::Index>(i), column = static_cast<Eigen::Index>(j);
    const std::complex<double> phase = std::polar(1.0, static_cast<double>(t.R(i, j)));
    m.S(row, row) = e.stiffness_diagonal[i];
    m.M(row, row) = e.mass_diagonal;
    m.S(row, column) = phase * std::complex<double>(e.stiffness_off[i].re, e.stiffness_off[i].im);
    m.M(row, column) = phase * std::complex<double>(e.mass_off.re, e.mass_off.im);
    m.S(column, row) = std::conj(m.S(row, column));
    m.M(column, row) = std::conj(m.M(row, column));
  }
  return m;
}

struct Exact {
  std::array<C, 3> S_off{}, M_off{}, P{}, Q{};
  std::array<Real, 3> S_diagonal{};
  Exact& operator+=(const Exact& o) {
    for (std::size_t i = 0; i < 3; ++i) {
      S_off[i] += o.S_off[i], M_off[i] += o.M_off[i], P[i] += o.P[i], Q[i] += o.Q[i];
      S_diagonal[i] += o.S_diagonal[i];
    }
    return *this;
  }
  friend Exact operator*(Real s, Exact e) {
    for (std::size_t i = 0; i < 3; ++i) {
      e.S_off[i] *= s, e.M_off[i] *= s, e.P[i] *= s, e.Q[i] *= s;
      e.S_diagonal[i] *= s;
    }
    return e;
  }
};

Exact integrate(const Triangle& t) {
  return t.area() * reference::mean_over_triangle(rule, [&](const std::array<Real, 3>& b) {
           Exact e;
           const std::array<Triangle::Point, 3> p{t.psi(0, b), t.psi(1, b), t.psi(2, b)};
           for (std::size_t i = 0; i < 3; ++i) {
             const std::size_t j = reference::next(i);
             e.S_diagonal[i] = std::norm(p[i].d1) + std::norm(p[i].d2);
             e.S_off[i] = std::conj(p[i].d1) * p[j].d1 + std::conj(p[i].d2) * p[j].d2;
             e.M_off[i] = std::conj(p[i].value) * p[j].value;
             e.P[i] = p[i].d1 - I * p[i].d2;
             e.Q[i] = p[i].d1 + I * p[i].d2;
           }
           return e;
         });
}

/// Error allowed for S: of the size of its largest diagonal entry (slivers: all entries are of cotangent size).
Real stiffness_scale(const Exact& e) { return *std::max_element(e.S_diagonal.begin(), e.S_diagonal.end()); }

}  // namespace

TEST_CASE("S, M, P, Q of a triangle equal quadrature of the basis") {
  for (const Triangle& t : triangles()) {
    const Exact exact = integrate(t);
    const TriangleEntries e = entries<double>(t);
    const TriangleOperator<double> op =
        triangle_operator(t.frame<double>(), static_cast<double>(t.area()), static_cast<double>(t.n));
    const Real K = t.K(), n = t.n, area = t.area(), S_scale = stiffness_scale(exact);
    CAPTURE(K);
    CAPTURE(n);
    CAPTURE(area);
    Real gradient = 0, turn = 1 + std::abs(K);
    for (std::size_t i = 0; i < 3; ++i) {
      gradient = std::max(gradient, std::abs(t.grad(i)));
      turn = std::max({turn, std::abs(n * t.tau[i]), std::abs(n * t.rho[i])});
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const C phase = std::polar(Real(1), t.R(i, reference::next(i)));
      CHECK(std::abs(Real(e.stiffness_diagonal[i]) - exact.S_diagonal[i]) <= 1e-14L * S_scale);
      CHECK(std::abs(phase * to_c(e.stiffness_off[i]) - exact.S_off[i]) <= 1e-14L * S_scale);
      CHECK(std::abs(phase * to_c(e.mass_off) - exact.M_off[i]) <= 1e-14L * std::abs(exact.M_off[i]));
      const Real scale = area * gradient * turn;
      CHECK(std::abs(to_c(op.p[i]) - exact.P[i]) <= 2e-15L * scale);
      CHECK(std::abs(to_c(op.q[i]) - exact.Q[i]) <= 2e-15L * scale);
    }
    CHECK(Real(e.mass_diagonal) == doctest::Approx(double(area / 6)).epsilon(1e-15));
  }
}

TEST_CASE("float kernels follow the double ones") {
  for (const Triangle& t : triangles()) {
    const TriangleEntries d = entries<double>(t);
    const TriangleEntries<float> f = entries<float>(t);
    const double scale = std::max({d.stiffness_diagonal[0], d.stiffness_diagonal[1], d.stiffness_diagonal[2]});
    // cot and K are rounded to float: K (1 + 6e-8) turns e^{iK} by up to 6e-8 K.
    const double tolerance = 1e-6 * (1 + 0.1 * std::abs(static_cast<double>(t.K())));
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(std::abs(double(f.stiffness_diagonal[i]) - d.stiffness_diagonal[i]) <= tolerance * scale);
      CHECK(std::abs(to_c(f.stiffness_off[i]) - to_c(d.stiffness_off[i])) <= tolerance * scale);
    }
    CHECK(std::abs(to_c(f.mass_off) - to_c(d.mass_off)) <= tolerance * std::abs(to_c(d.mass_off)));
    const auto op = triangle_operator(t.frame<double>(), static_cast<double>(t.area()), static_cast<double>(t.n));
    const auto of = triangle_operator(t.frame<float>(), static_cast<float>(t.area()), static_cast<float>(t.n));
    Real gradient = 0;
    for (std::size_t i = 0; i < 3; ++i) gradient = std::max(gradient, std::abs(t.grad(i)));
    for (std::size_t i = 0; i < 3; ++i) {
      const Real allowed = 2e-6L * t.area() * gradient * (10 + std::abs(t.K()));
      CHECK(std::abs(to_c(of.p[i]) - to_c(op.p[i])) <= allowed);
      CHECK(std::abs(to_c(of.q[i]) - to_c(op.q[i])) <= allowed);
    }
  }
}

TEST_CASE("element matrices are Hermitian positive semidefinite, M definite, on slivers too") {
  for (const Triangle& t : triangles()) {
    const Matrices m = matrices(t);
    const Eigen::Vector3d s = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3cd>(m.S).eigenvalues();
    const Eigen::Vector3d mass = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3cd>(m.M).eigenvalues();
    CHECK(s[0] >= -1e-14 * s[2]);
    CHECK(mass[0] >= 1e-3 * mass[2]);
  }
}

TEST_CASE("without curvature the parallel field is in the kernel of S, and M integrates 1") {
  std::mt19937_64 random(4);
  for (int trial = 0; trial < 50; ++trial) {
    Triangle t = reference::random_triangle(random, 0, 0, trial % 2 ? 1 : 1e-6, 1 + trial % 5);
    Eigen::Vector3cd parallel;  // the constant field 1 of the face, in the vertex frames
    for (int i = 0; i < 3; ++i) parallel[i] = std::polar(1.0, double(t.n * t.rho[static_cast<std::size_t>(i)]));
    const Matrices m = matrices(t);
    CHECK((m.S * parallel).norm() <= 1e-14 * m.S.norm());
    CHECK(std::abs(parallel.dot(m.M * parallel) - double(t.area())) <= 1e-14 * double(t.area()));
    const auto op = triangle_operator(t.frame<double>(), double(t.area()), double(t.n));
    C p = 0, q = 0;
    Real size = 0;
    for (int i = 0; i < 3; ++i) {
      p += to_c(op.p[i]) * C(parallel[i].real(), parallel[i].imag());
      q += to_c(op.q[i]) * C(parallel[i].real(), parallel[i].imag());
      size = std::max(size, std::abs(to_c(op.p[i])));
    }
    CHECK(std::abs(p) <= 1e-14L * size);
    CHECK(std::abs(q) <= 1e-14L * size);
  }
}

TEST_CASE("the basis is its definition, and its covariant derivative is d + i n omega with the Whitney form omega") {
  std::mt19937_64 random(5);
  for (const Real nK : {0.0L, 0.3L, -2.0L, 12.0L}) {
    const Triangle t = reference::random_triangle(random, nK, 2, 1, 3);
    const double b[3] = {0.25, 0.125, 0.625};
    const std::array<Real, 3> at{0.25L, 0.125L, 0.625L};
    const BasisAt<double> basis = basis_at(t.frame<double>(), b, 3.0);
    for (std::size_t i = 0; i < 3; ++i) {
      const Triangle::Point p = t.psi(i, at);
      CHECK(std::abs(to_c(basis.value[i]) - p.value) <= 1e-14L);
      CHECK(std::abs(to_c(basis.d1[i]) - p.d1) <= 1e-13L * (1 + std::abs(nK)));
      CHECK(std::abs(to_c(basis.d2[i]) - p.d2) <= 1e-13L * (1 + std::abs(nK)));
      // Along each of two directions: central difference plus i n omega Psi, omega = sum tau_ij (phi_i dphi_j - phi_j
      // dphi_i).
      for (const C direction : {C(1, 0), C(0, 1)}) {
        const auto slope = [&](std::size_t c) { return std::real(std::conj(t.grad(c)) * direction); };
        const Real h = 1e-6L;
        std::array<Real, 3> forward = at, back = at;
        Real omega = 0;
        for (std::size_t c = 0; c < 3; ++c) {
          const std::size_t d = reference::next(c);
          forward[c] += h * slope(c), back[c] -= h * slope(c);
          omega += t.n_tau(c, d) * (at[c] * slope(d) - at[d] * slope(c));
        }
        const C derivative = (t.psi(i, forward).value - t.psi(i, back).value) / (2 * h) + I * omega * p.value;
        const C expected = direction.real() * to_c(basis.d1[i]) + direction.imag() * to_c(basis.d2[i]);
        CHECK(std::abs(derivative - expected) <= 1e-8L);
      }
    }
  }
}

TEST_CASE("field_at sums the basis; div + i curl of the position field is 2, its reflected pair 0") {
  std::mt19937_64 random(6);
  const Triangle t = reference::random_triangle(random, 0, 0);
  Cplx<double> position[3], turned[3];
  for (std::size_t i = 0; i < 3; ++i) {
    const C in_vertex_frame = t.p[i] * std::polar(Real(1), t.rho[i]);
    position[i] = {double(in_vertex_frame.real()), double(in_vertex_frame.imag())};
    turned[i] = times_i(position[i]);
  }
  const double b[3] = {0.2, 0.3, 0.5};
  const auto f = field_at(t.frame<double>(), position, b, 1.0), rotation = field_at(t.frame<double>(), turned, b, 1.0);
  const C middle = 0.2L * t.p[0] + 0.3L * t.p[1] + 0.5L * t.p[2];
  CHECK(std::abs(to_c(f.value) - middle) <= 1e-15L);
  CHECK(std::abs(to_c(f.div_curl()) - Real(2)) <= 1e-13L);
  CHECK(std::abs(to_c(f.reflected())) <= 1e-13L);
  CHECK(std::abs(to_c(rotation.div_curl()) - C(0, 2)) <= 1e-13L);  // counter-clockwise rotation has positive curl
}

TEST_CASE("edge operators equal the boundary integral, and on flat triangles the area integral") {
  std::mt19937_64 random(8);
  for (const Real range : {0.0L, 1e-8L, 1e-3L, 0.06L, 1.0L, 4.0L, 12.0L}) {
    for (const int n : {1, 2, 4, -1, 0}) {
      const Triangle t = reference::random_triangle(random, 0, 0, 1, 1);
      std::uniform_real_distribution<double> u(-1, 1);
      C p_sum[3] = {}, q_sum[3] = {};
      for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t d = reference::next(c);
        const double length = double(std::abs(t.edge(c))), phi = double(std::arg(t.edge(c)));
        // Any angles: the coefficient is the integral of the edge's basis function against the normal.
        const double rho_start = 3 * u(random), rho_end = 3 * u(random), eps = double(range) * u(random);
        const EdgeOperator<double> e = edge_operator(length, rho_start, rho_end, eps, phi, double(n));
        const auto along = [&](bool start, Real reflect) {
          return Real(length) * reference::integrate_line(rule, [&](Real x) {
                   const C value = start ? (1 - x) * std::polar(Real(1), -n * (Real(rho_start) + Real(eps) * x))
                                         : x * std::polar(Real(1), -n * (Real(rho_end) - Real(eps) * (1 - x)));
                   return reflect * I * value * std::polar(Real(1), (n - reflect) * Real(phi));
                 });
        };
        const Real allowed = 2e-14L * Real(length);
        CHECK(std::abs(to_c(e.p_start) - along(true, 1)) <= allowed);
        CHECK(std::abs(to_c(e.p_end) - along(false, 1)) <= allowed);
        CHECK(std::abs(to_c(e.q_start) - along(true, -1)) <= allowed);
        CHECK(std::abs(to_c(e.q_end) - along(false, -1)) <= allowed);
        // The flat connection: frames differ by constant angles, tau = eps = 0.
        const EdgeOperator<double> flat =
            edge_operator(length, double(t.rho[c]) + phi, double(t.rho[d]) + phi, 0.0, phi, double(n));
        p_sum[c] += to_c(flat.p_start), p_sum[d] += to_c(flat.p_end);
        q_sum[c] += to_c(flat.q_start), q_sum[d] += to_c(flat.q_end);
      }
      const auto op = triangle_operator(t.frame<double>(), double(t.area()), double(n));
      for (std::size_t c = 0; c < 3; ++c) {
        CHECK(std::abs(to_c(op.p[c]) - p_sum[c]) <= 1e-14L);
        CHECK(std::abs(to_c(op.q[c]) - q_sum[c]) <= 1e-14L);
      }
    }
  }
}

TEST_CASE("hat gradients are the derivatives of the hat functions") {
  std::mt19937_64 random(9);
  const Triangle t = reference::random_triangle(random, 0, 0);
  Cplx<double> edge[3], grad[3];
  for (std::size_t c = 0; c < 3; ++c) edge[c] = {double(t.edge(c).real()), double(t.edge(c).imag())};
  hat_gradients(edge, double(t.area()), grad);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {  // phi_i changes by -1, +1, 0 along the halfedges from, to and opposite i
      const Real change = std::real(std::conj(to_c(grad[i])) * t.edge(c));
      CHECK(std::abs(change - (c == i ? -1 : reference::next(c) == i ? 1 : 0)) <= 1e-14L);
    }
  }
}

TEST_CASE("the Whitney mass matrix equals quadrature of the forms") {
  std::mt19937_64 random(10);
  for (const double flatness : {1.0, 1.0, 1.0, 1e-4}) {
    const Triangle t = reference::random_triangle(random, 0.7L, 1, flatness);
    const auto c = t.cots<double>();
    const double cot[3] = {c[0], c[1], c[2]};
    const Symmetric3<double> w = whitney_mass(cot);
    const Real scale = std::max({std::abs(t.cot(0)), std::abs(t.cot(1)), std::abs(t.cot(2))});
    const reference::Rule few = reference::gauss(4);
    const auto form = [&](std::size_t i, const std::array<Real, 3>& b) {
      const std::size_t j = reference::next(i);
      return b[i] * t.grad(j) - b[j] * t.grad(i);
    };
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = reference::next(i);
      const Real diagonal =
          t.area() * reference::mean_over_triangle(few, [&](const auto& b) { return std::norm(form(i, b)); });
      const Real off = t.area() * reference::mean_over_triangle(few, [&](const auto& b) {
                         return std::real(std::conj(form(i, b)) * form(j, b));
                       });
      CHECK(std::abs(Real(w.diagonal[i]) - diagonal) <= 1e-15L * scale);
      CHECK(std::abs(Real(w.off[i]) - off) <= 1e-15L * scale);
    }
    // Equal angles: K^2 (sum cot) / 36.
    const double K = 0.3, even[3] = {-K / 3, -K / 3, -K / 3};
    CHECK(triangle_energy(cot, even) == doctest::Approx(K * K * (cot[0] + cot[1] + cot[2]) / 36).epsilon(1e-9));
    // A quadratic form's central difference is exact.
    const double tau[3] = {0.1, -0.25, 0.4};
    double gradient[3];
    triangle_energy_gradient(cot, tau, gradient);
    for (std::size_t i = 0; i < 3; ++i) {
      double up[3] = {0.1, -0.25, 0.4}, down[3] = {0.1, -0.25, 0.4};
      up[i] += 0.5, down[i] -= 0.5;
      CHECK(std::abs(triangle_energy(cot, up) - triangle_energy(cot, down) - gradient[i]) <= 1e-14 * double(scale));
    }
  }
}

TEST_CASE("the halfedge energy integrates the square of a linear residual; its weight is capped") {
  const double w = 1.7, a = 0.3, b = -0.8;
  const Real exact = Real(w) * reference::integrate_line(reference::gauss(3), [&](Real x) {
                       const Real r = (1 - x) * Real(a) + x * Real(b);
                       return r * r;
                     });
  CHECK(std::abs(Real(halfedge_energy(w, a, b)) - exact) <= 1e-16L);
  double da, db;
  halfedge_energy_gradient(w, a, b, da, db);
  CHECK(std::abs(halfedge_energy(w, a + 0.5, b) - halfedge_energy(w, a - 0.5, b) - da) <= 1e-15);
  CHECK(std::abs(halfedge_energy(w, a, b + 0.5) - halfedge_energy(w, a, b - 0.5) - db) <= 1e-15);
  CHECK(capped_tangent(1 / std::sqrt(3.0), 10.0) == doctest::Approx(std::sqrt(3.0)).epsilon(1e-15));
  CHECK(capped_tangent(0.05, 10.0) == 10.0);
  CHECK(capped_tangent(0.0, 10.0) == 10.0);
  CHECK(capped_tangent(-2.0, 10.0) == 10.0);
}
