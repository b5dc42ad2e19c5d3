// SPDX-License-Identifier: MIT
//
// test_angles.cpp: angles and unit numbers by polynomials are those of the C library to an ulp or two, whatever the
// instruction set and the neighbours.
#include <doctest/doctest.h>

#include <cmath>
#include <complex>
#include <cstring>
#include <limits>
#include <vector>

#include "alcap/errors.h"
#include "src/base/random.h"
#include "src/simd/angles.h"

namespace {

using namespace alcap::detail;

template <class T>
struct Vectors {
  std::vector<T> y, x;
};

// Directions all over the upper half plane, close to both ends and to every place where the formula changes.
template <class T>
Vectors<T> vectors() {
  Vectors<T> v;
  const auto add = [&](double y, double x) {
    v.y.push_back(static_cast<T>(y));
    v.x.push_back(static_cast<T>(x));
  };
  Random random(3);
  const double pi = 3.14159265358979323846;
  for (int i = 0; i < 2000; ++i) {
    const double angle = random.uniform(1e-6, pi - 1e-6), length = std::exp(random.uniform(-20, 20));
    add(length * std::sin(angle), length * std::cos(angle));
    add(1, std::exp(random.uniform(-30, 30)) * (i % 2 == 0 ? 1 : -1));
  }
  for (int eighth = 1; eighth < 8; ++eighth)
    for (const double shift : {-1e-15, -1e-16, 0.0, 1e-16, 1e-15})
      add(std::sin(eighth * pi / 8 + shift), std::cos(eighth * pi / 8 + shift));
  add(1, 0);
  add(1, -0.0);
  add(1e-30, 1);
  add(1e-30, -1);
  return v;
}

template <class T>
void check_upper_angles() {
  constexpr T eps = std::numeric_limits<T>::epsilon();
  const Vectors<T> v = vectors<T>();
  std::vector<T> expected(v.y.size()), angles(v.y.size());
  for (const Isa isa : available_isas()) {
    CAPTURE(std::string(name(isa)));
    upper_angles(static_cast<std::int64_t>(v.y.size()), v.y.data(), v.x.data(), angles.data(), isa);
    for (std::size_t i = 0; i < angles.size(); ++i) {
      const double exact = std::atan2(static_cast<double>(v.y[i]), static_cast<double>(v.x[i]));
      CAPTURE(v.y[i]);
      CAPTURE(v.x[i]);
      CHECK(std::abs(static_cast<double>(angles[i]) - exact) <= 2 * static_cast<double>(eps) * exact);
    }
    if (isa == Isa::scalar) expected = angles;
    CHECK(std::memcmp(angles.data(), expected.data(), angles.size() * sizeof(T)) == 0);
  }
}

template <class T>
void check_unit_numbers(T largest) {
  constexpr auto eps = static_cast<double>(std::numeric_limits<T>::epsilon());
  std::vector<T> angles;
  Random random(5);
  for (int i = 0; i < 3000; ++i) {
    angles.push_back(static_cast<T>(random.uniform(-7, 7)));
    angles.push_back(static_cast<T>(random.uniform(-1, 1)) * largest);
  }
  for (int quarter = -40; quarter <= 40; ++quarter)
    for (const double shift : {-1e-9, 0.0, 1e-9})
      angles.push_back(static_cast<T>(quarter * 0.78539816339744830962 * (1 + shift)));
  for (const T factor : {T(1), T(-1), T(0.25)}) {
    std::vector<std::complex<T>> expected(angles.size()), units(angles.size());
    for (const Isa isa : available_isas()) {
      CAPTURE(std::string(name(isa)));
      unit_numbers(static_cast<std::int64_t>(angles.size()), angles.data(), factor, units.data(), isa);
      for (std::size_t i = 0; i < units.size(); ++i) {
        const auto angle = static_cast<double>(factor * angles[i]);
        const std::complex<double> unit(units[i]);
        CAPTURE(angle);
        CHECK(std::abs(unit - std::complex<double>(std::cos(angle), std::sin(angle))) <= 1.5 * eps);
      }
      if (isa == Isa::scalar) expected = units;
      CHECK(std::memcmp(units.data(), expected.data(), units.size() * sizeof(units[0])) == 0);
    }
  }
}

}  // namespace

TEST_CASE("angles in the upper half plane are those of atan2, with every instruction set the same bits") {
  check_upper_angles<double>();
  check_upper_angles<float>();
}

TEST_CASE("unit numbers are cosine and sine, also of large angles, with every instruction set the same bits") {
  check_unit_numbers<double>(1e5);
  check_unit_numbers<float>(1e4F);
}

TEST_CASE("a number does not depend on its neighbours") {
  const Vectors<double> v = vectors<double>();
  for (const Isa isa : available_isas()) {
    std::vector<double> whole(23), part(23);
    std::vector<std::complex<double>> units(23), one(1);
    upper_angles(23, v.y.data(), v.x.data(), whole.data(), isa);
    unit_numbers(23, v.x.data(), 1e-9, units.data(), isa);
    for (std::size_t i = 0; i < 23; ++i) {
      upper_angles(1, v.y.data() + i, v.x.data() + i, part.data() + i, isa);
      unit_numbers(1, v.x.data() + i, 1e-9, one.data(), isa);
      CHECK(one[0] == units[i]);
    }
    CHECK(whole == part);
  }
}

TEST_CASE("an instruction set this machine lacks is refused") {
  double x = 1;
  CHECK_THROWS_AS(upper_angles(1, &x, &x, &x, static_cast<Isa>(99)), alcap::OptionError);
}
