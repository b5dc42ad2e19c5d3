// SPDX-License-Identifier: MIT
//
// kernels_reference.h: the slow truth for the kernels. Everything pointwise is written down from its definition in
// long double, and integrated by Gauss-Legendre rules with enough points for any phase in the tests.
#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <vector>

#include "kernels/basis.h"

namespace reference {

using Real = long double;
using C = std::complex<Real>;
inline constexpr Real pi = std::numbers::pi_v<Real>;
inline constexpr C I{0, 1};

struct Rule {
  std::vector<Real> x, w;
};

/// Gauss-Legendre on [0, 1], exact to degree 2n - 1.
inline Rule gauss(int n) {
  Rule r{std::vector<Real>(static_cast<std::size_t>(n)), std::vector<Real>(static_cast<std::size_t>(n))};
  for (int i = 0; i < n; ++i) {
    Real x = std::cos(pi * (Real(i) + 0.75L) / (Real(n) + 0.5L)), slope = 1;
    for (int step = 0; step < 50; ++step) {
      Real before = 1, value = x;
      for (int k = 2; k <= n; ++k) {
        const Real next = ((2 * k - 1) * x * value - (k - 1) * before) / k;
        before = value;
        value = next;
      }
      slope = n * (x * value - before) / (x * x - 1);
      const Real dx = value / slope;
      x -= dx;
      if (std::abs(dx) < 1e-19L) break;
    }
    r.x[static_cast<std::size_t>(i)] = (1 + x) / 2;
    r.w[static_cast<std::size_t>(i)] = 1 / ((1 - x * x) * slope * slope);
  }
  return r;
}

/// int_0^1 f.
template <class F>
auto integrate_line(const Rule& rule, F f) {
  decltype(f(Real(0))) sum{};
  for (std::size_t i = 0; i < rule.x.size(); ++i) sum += rule.w[i] * f(rule.x[i]);
  return sum;
}

/// The mean over a triangle of a function of barycentric coordinates (collapsed rule).
template <class F>
auto mean_over_triangle(const Rule& rule, F f) {
  decltype(f(std::array<Real, 3>{})) sum{};
  for (std::size_t i = 0; i < rule.x.size(); ++i) {
    for (std::size_t j = 0; j < rule.x.size(); ++j) {
      const Real x = rule.x[i], y = rule.x[j];
      sum += 2 * x * rule.w[i] * rule.w[j] * f(std::array<Real, 3>{1 - x, x * (1 - y), x * y});
    }
  }
  return sum;
}

inline std::size_t next(std::size_t c) { return (c + 1) % 3; }

/// One triangle with a connection and an n-field on it.
struct Triangle {
  std::array<C, 3> p;       // corners in the face frame
  std::array<Real, 3> rho;  // vertex frame to face frame
  std::array<Real, 3> tau;  // halfedges 0-1, 1-2, 2-0
  Real n = 1;

  C edge(std::size_t c) const { return p[next(c)] - p[c]; }
  Real area() const { return std::imag(std::conj(edge(0)) * edge(1)) / 2; }
  Real K() const { return -n * (tau[0] + tau[1] + tau[2]); }
  C grad(std::size_t i) const { return I * edge(next(i)) / (2 * area()); }
  Real cot(std::size_t i) const {
    const C d = std::conj(edge(i)) * -edge(next(next(i)));
    return d.real() / d.imag();
  }
  /// n times the lifted tau of i -> j, either direction.
  Real n_tau(std::size_t i, std::size_t j) const { return j == next(i) ? n * tau[i] : -n * tau[j]; }
  /// n rho_ij = n (tau_ij + rho_i - rho_j).
  Real R(std::size_t i, std::size_t j) const { return n_tau(i, j) + n * (rho[i] - rho[j]); }

  struct Point {
    C value, d1, d2;
  };
  Point psi(std::size_t i, const std::array<Real, 3>& b) const {
    const std::size_t j = next(i), k = next(j);
    const C phase = std::polar(Real(1), -(n * rho[i] + n_tau(i, j) * b[j] + n_tau(i, k) * b[k]));
    const C gi = grad(i), phi_jk = b[j] * grad(k) - b[k] * grad(j);
    return {b[i] * phase, phase * (gi.real() - I * K() * b[i] * phi_jk.real()),
            phase * (gi.imag() - I * K() * b[i] * phi_jk.imag())};
  }

  template <class T>
  std::array<T, 3> cots() const {
    return {static_cast<T>(cot(0)), static_cast<T>(cot(1)), static_cast<T>(cot(2))};
  }
  template <class T>
  alcap::kernels::TriangleFrame<T> frame() const {
    alcap::kernels::TriangleFrame<T> f;
    for (std::size_t c = 0; c < 3; ++c) {
      f.rho[c] = static_cast<T>(rho[c]);
      f.tau[c] = static_cast<T>(tau[c]);
      f.grad[c] = {static_cast<T>(grad(c).real()), static_cast<T>(grad(c).imag())};
    }
    return f;
  }
};

/// A triangle whose field sees the curvature nK. `flatness` 1 gives any shape, smaller values slivers of that relative
/// height. All numbers are exact in float, so that kernels of any precision see the same triangle; `twist` is the size
/// of the part of n tau that sums to 0.
inline Triangle random_triangle(std::mt19937_64& random, Real nK, Real twist, double flatness = 1, int n = 1) {
  std::uniform_real_distribution<double> u(-1, 1);
  const auto exact = [](Real x) { return Real(static_cast<float>(x)); };
  Triangle t;
  do {
    for (C& p : t.p) p = {exact(u(random)), exact(u(random) * flatness)};
    if (t.area() < 0) std::swap(t.p[1], t.p[2]);
  } while (t.area() < 0.05L * flatness);
  for (Real& r : t.rho) r = exact(3 * u(random));
  const Real a = twist * u(random), b = twist * u(random);
  t.n = n;
  t.tau = {exact((a - nK / 3) / n), exact((b - nK / 3) / n), 0};
  t.tau[2] = exact(-nK / n - t.tau[0] - t.tau[1]);
  return t;
}

template <class T>
C to_c(const alcap::kernels::Cplx<T>& z) {
  return {Real(z.re), Real(z.im)};
}

/// The curvatures at which integrals are checked.
inline std::vector<Real> curvatures() {
  std::vector<Real> list;
  for (const Real k :
       {0.0L, 1e-12L, 1e-8L, 1e-3L, 0.0625L, 0.1L, 0.5L, 1.0L, 2.0L, 3.0L, 4.0L, 5.0L, 6.28L, 10.0L, 20.0L, 50.0L}) {
    list.push_back(k);
    list.push_back(-k);
  }
  return list;
}

}  // namespace reference
