// SPDX-License-Identifier: MIT
//
// Moments and divided differences of exp against quadrature, across the ranges of their series and closed forms, for
// scalars and packs.
#include <doctest/doctest.h>

#include <algorithm>
#include <limits>

#include "kernels/exp_divided_differences.h"
#include "kernels/exp_integrals.h"
#include "tests/kernels/kernels_reference.h"

using namespace alcap::kernels;
using reference::C;
using reference::Real;

namespace {

struct TestIsa;  // keeps these packs apart from those inside the library
const reference::Rule rule = reference::gauss(64);

C exact_moment(int k, Real K) {
  return reference::integrate_line(rule,
                                   [&](Real t) { return std::pow(t, Real(k)) * std::polar(Real(1), K * (1 - t)); });
}

/// int over the triangle / 2A of phi_i^a phi_j^b phi_k^c e^{i l}.
C exact_difference(int a, int b, int c, Real xi, Real xj, Real xk) {
  return reference::mean_over_triangle(rule, [&](const std::array<Real, 3>& p) {
    return std::pow(p[0], Real(a)) * std::pow(p[1], Real(b)) * std::pow(p[2], Real(c)) *
           std::polar(Real(1), xi * p[0] + xj * p[1] + xk * p[2]) / Real(2);
  });
}

/// Arguments in every range and on both sides of every limit.
template <class T>
std::vector<T> arguments(T small, T large) {
  std::vector<T> list{0,    T(1e-12), T(1e-8), T(1e-3), T(0.03), T(0.1), T(0.5),
                      T(1), T(2),     T(3),    T(5),    T(10),   T(20),  T(50)};
  const T infinity = std::numeric_limits<T>::infinity();
  for (const T limit : {small, large}) {
    list.insert(list.end(), {std::nextafter(limit, T(0)), limit, std::nextafter(limit, infinity)});
  }
  for (int i = 1; i < 60; ++i) list.push_back(T(i) * T(0.137));
  const std::size_t count = list.size();
  for (std::size_t i = 0; i < count; ++i) list.push_back(-list[i]);
  return list;
}

template <class T>
void check_moments(Real tolerance) {
  using Tables = MomentTables<T>;
  for (const T K : arguments<T>(Tables::small, Tables::large)) {
    const Moments<T> m = moments<0, 5>(K);
    CAPTURE(K);
    for (int k = 0; k <= 5; ++k) {
      const C exact = exact_moment(k, Real(K));
      const Real scale = k == 0 ? std::max(std::abs(exact), 1 / (1 + std::abs(Real(K)))) : std::abs(exact);
      CAPTURE(k);
      CHECK(std::abs(reference::to_c(m.j[k]) - exact) <= tolerance * scale);
    }
    const C psi = reference::integrate_line(rule, [&](Real x) { return (1 - x) * std::polar(Real(1), -Real(K) * x); });
    CHECK(std::abs(reference::to_c(edge_weight_integral(K)) - psi) <= tolerance * std::abs(psi));
  }
}

/// Nodes as triples: all within `range`, some coinciding, some close.
template <class T>
std::vector<std::array<T, 3>> node_triples(T range, std::mt19937_64& random) {
  std::uniform_real_distribution<double> u(-1, 1);
  const auto draw = [&] { return T(u(random)) * range; };
  const T a = draw(), b = draw(), c = draw();
  return {{a, b, c},
          {a, b, b},
          {a, a, b},
          {b, a, b},
          {a, a, a},
          {a, a + T(1e-5) * range, b},
          {T(0), a, -a},
          {range, -range, -range},
          {-range, range, -range}};
}

template <class T>
void check_differences(T range, Real tolerance, std::mt19937_64& random) {
  for (const auto& x : node_triples<T>(range, random)) {
    const CornerDifferences<T> d = corner_differences(x[0], x[1], x[2]);
    const Real xi = x[0], xj = x[1], xk = x[2];
    CAPTURE(xi);
    CAPTURE(xj);
    CAPTURE(xk);
    CHECK(std::abs(reference::to_c(d.ijk) - exact_difference(0, 0, 0, xi, xj, xk)) <= tolerance / 2);
    CHECK(std::abs(reference::to_c(d.iijjk) - exact_difference(1, 1, 0, xi, xj, xk)) <= tolerance / 24);
    CHECK(std::abs(reference::to_c(d.iijkk) - exact_difference(1, 0, 1, xi, xj, xk)) <= tolerance / 24);
  }
}

/// Bits, so that NaN and the sign of zero count.
template <class T>
bool same_bits(const T& a, const T& b) {
  return std::equal(reinterpret_cast<const unsigned char*>(&a), reinterpret_cast<const unsigned char*>(&a + 1),
                    reinterpret_cast<const unsigned char*>(&b));
}

template <class T, int N>
void check_packs(Real tolerance) {
  using P = Pack<T, N, TestIsa>;
  const std::vector<T> all = arguments<T>(MomentTables<T>::small, MomentTables<T>::large);
  std::mt19937_64 random(7);
  std::uniform_int_distribution<std::size_t> any_index(0, all.size() - 1);
  std::uniform_real_distribution<double> near(0, 0.06);
  for (int trial = 0; trial < 300; ++trial) {
    T lanes[3][N];
    for (int l = 0; l < N; ++l) {
      for (auto& row : lanes) row[l] = all[any_index(random)];
      if (random() % 2) {  // nodes close together, so that lanes use the short series beside lanes that do not
        lanes[1][l] = lanes[0][l] + T(near(random)), lanes[2][l] = lanes[0][l] - T(near(random));
      }
    }
    const P K = P::load(lanes[0]), xj = P::load(lanes[1]), xk = P::load(lanes[2]);
    const Moments<P> m = moments<0, 5>(K);
    const CornerDifferences<P> d = corner_differences(K, xj, xk);
    for (int l = 0; l < N; ++l) {
      const Moments<T> one = moments<0, 5>(lanes[0][l]);
      const Moments<P> alone = moments<0, 5>(P(lanes[0][l]));
      CAPTURE(lanes[0][l]);
      for (int k = 0; k <= 5; ++k) {
        CHECK(std::abs(C(m.j[k].re[l], m.j[k].im[l]) - reference::to_c(one.j[k])) <= tolerance);
        CHECK(same_bits(T(m.j[k].re[l]), T(alone.j[k].re[l])));
        CHECK(same_bits(T(m.j[k].im[l]), T(alone.j[k].im[l])));
      }
      const CornerDifferences<T> single = corner_differences(lanes[0][l], lanes[1][l], lanes[2][l]);
      const CornerDifferences<P> same = corner_differences(P(lanes[0][l]), P(lanes[1][l]), P(lanes[2][l]));
      const Real scale =
          1 + 2 * std::abs(Real(lanes[0][l])) + std::abs(Real(lanes[1][l])) + std::abs(Real(lanes[2][l]));
      CHECK(std::abs(C(d.ijk.re[l], d.ijk.im[l]) - reference::to_c(single.ijk)) <= tolerance * scale);
      CHECK(std::abs(C(d.iijjk.re[l], d.iijjk.im[l]) - reference::to_c(single.iijjk)) <= tolerance * scale);
      CHECK(std::abs(C(d.iijkk.re[l], d.iijkk.im[l]) - reference::to_c(single.iijkk)) <= tolerance * scale);
      for (const auto part : {&CornerDifferences<P>::ijk, &CornerDifferences<P>::iijjk, &CornerDifferences<P>::iijkk}) {
        CHECK(same_bits(T((d.*part).re[l]), T((same.*part).re[l])));
        CHECK(same_bits(T((d.*part).im[l]), T((same.*part).im[l])));
      }
    }
  }
}

}  // namespace

TEST_CASE("moments equal quadrature in every range, double") { check_moments<double>(1e-14L); }
TEST_CASE("moments equal quadrature in every range, float") { check_moments<float>(1e-6L); }

TEST_CASE("series, economised series and closed form agree where they meet") {
  using Tables = MomentTables<double>;
  // Both polynomials at the end of the Taylor range.
  const double y = Tables::small * Tables::small;
  CHECK(horner(Tables::taylor_even, y) == doctest::Approx(horner(Tables::chebyshev_even, y)).epsilon(1e-15));
  CHECK(horner(Tables::taylor_odd, y) == doctest::Approx(horner(Tables::chebyshev_odd, y)).epsilon(1e-15));
  // Going down from the polynomial and going up from the closed form at the other end.
  Moments<double> down, up;
  const double K = Tables::large;
  detail::moments_down<0>(K, {horner(Tables::chebyshev_even, K * K), K * horner(Tables::chebyshev_odd, K * K)}, down);
  detail::moments_up<5>(K, up);
  for (int k = 0; k <= 5; ++k) {
    CHECK(std::abs(reference::to_c(down.j[k]) - reference::to_c(up.j[k])) <=
          1e-14L * std::abs(reference::to_c(up.j[k])));
  }
}

TEST_CASE("moments obey their recurrence: iK J_k = k J_{k-1} - 1") {
  for (const double K : arguments<double>(MomentTables<double>::small, MomentTables<double>::large)) {
    const Moments<double> m = moments<0, 5>(K);
    for (int k = 1; k <= 5; ++k) {
      const C left = C(0, K) * reference::to_c(m.j[k]), right = Real(k) * reference::to_c(m.j[k - 1]) - Real(1);
      CHECK(std::abs(left - right) <= 1e-14L * (1 + std::abs(left)));
    }
  }
}

TEST_CASE("divided differences equal quadrature over the triangle, double") {
  std::mt19937_64 random(1);
  for (const double range :
       {0.0, 1e-12, 1e-8, 1e-3, 0.06, 0.0625, 0.07, 0.5, 0.99, 1.0, 1.01, 2.0, 5.0, 10.0, 20.0, 50.0}) {
    check_differences<double>(range, 5e-15L, random);
  }
}

TEST_CASE("divided differences equal quadrature over the triangle, float") {
  std::mt19937_64 random(2);
  for (const float range : {0.0f, 1e-3f, 0.06f, 0.0625f, 0.5f, 1.0f, 2.0f, 10.0f, 50.0f}) {
    check_differences<float>(range, 3e-5L, random);
  }
}

TEST_CASE("differences are symmetric in their nodes and conjugate when the nodes change sign") {
  for (const double r : {0.01, 0.7, 6.0, 45.0}) {
    const double a = 0.3 * r, b = -0.8 * r, c = r;
    const CornerDifferences<double> d = corner_differences(a, b, c), swapped = corner_differences(a, c, b),
                                    negative = corner_differences(-a, -b, -c);
    CHECK(std::abs(reference::to_c(d.iijjk) - reference::to_c(swapped.iijkk)) <= 1e-14L);
    CHECK(std::abs(reference::to_c(d.ijk) - reference::to_c(corner_differences(c, a, b).ijk)) <= 1e-14L);
    CHECK(std::abs(reference::to_c(d.iijjk) - std::conj(reference::to_c(negative.iijjk))) <= 1e-14L);
  }
}

TEST_CASE("a pack gives each lane what a scalar gives, whatever the other lanes hold") {
  check_packs<double, 2>(1e-14L);
  check_packs<double, 4>(1e-14L);
  check_packs<float, 4>(2e-6L);
  check_packs<float, 16>(2e-6L);
}

TEST_CASE("non-finite arguments end and stay in their lane") {
  using P = Pack<double, 2, TestIsa>;
  const double bad[2] = {std::numeric_limits<double>::infinity(), 0.25};
  const CornerDifferences<P> d = corner_differences(P::load(bad), P(0.5), P(3.0));
  const CornerDifferences<P> good = corner_differences(P(0.25), P(0.5), P(3.0));
  CHECK_FALSE(std::isfinite(d.ijk.re[0]));
  CHECK(d.ijk.re[1] == good.ijk.re[1]);
  CHECK(std::isnan(moments<1, 1>(std::numeric_limits<double>::quiet_NaN()).j[1].re));
}
