// SPDX-License-Identifier: MIT
//
// The loop over triangles gives the same bits with every instruction set of this machine, however the range is split.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <random>
#include <string>
#include <vector>

#include "alcap/errors.h"
#include "kernels/stiffness_mass.h"
#include "src/simd/triangle_entries.h"

using namespace alcap::detail;

namespace {

constexpr std::int64_t faces = 1037;  // a multiple of no pack

template <class T>
struct Data {
  std::vector<T> cot, area, curvature;
  T n = 4;

  explicit Data(unsigned seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> u(0.05, 3.0), exponent(-12, 1.1);
    for (std::int64_t f = 0; f < faces; ++f) {
      // Angles a, b from cotangents, the third from cot a cot b + cot b cot c + cot c cot a = 1.
      const double a = u(random), b = u(random);
      for (const double c : {a, b, (1 - a * b) / (a + b)}) cot.push_back(static_cast<T>(c));
      area.push_back(static_cast<T>(u(random)));
      curvature.push_back(static_cast<T>((f % 2 ? 1 : -1) * std::pow(10.0, exponent(random))));
    }
  }
  TriangleInputs<T> inputs() const { return {cot.data(), area.data(), curvature.data(), n}; }
};

template <class T>
struct Result {
  std::vector<T> diagonal;
  std::vector<std::complex<T>> off, mass;
  explicit Result(T fill)
      : diagonal(3 * faces, fill),
        off(3 * faces, std::complex<T>(fill, fill)),
        mass(faces, std::complex<T>(fill, fill)) {}
  TriangleOutputs<T> outputs() { return {diagonal.data(), off.data(), mass.data()}; }
  bool operator==(const Result&) const = default;
};

template <class T>
void check_against_scalar(Isa isa) {
  const Data<T> data(11);
  Result<T> expected(0), got(0);
  triangle_entries<T>(0, faces, data.inputs(), expected.outputs(), Isa::scalar);
  triangle_entries<T>(0, faces, data.inputs(), got.outputs(), isa);
  CHECK(got == expected);
}

/// Any split gives the same bits, and nothing outside the range is written.
template <class T>
void check_splits(Isa isa) {
  const Data<T> data(12);
  Result<T> whole(0);
  triangle_entries<T>(0, faces, data.inputs(), whole.outputs(), isa);
  std::mt19937_64 random(13);
  std::uniform_int_distribution<std::int64_t> step(1, 40);
  Result<T> pieces(0);
  for (std::int64_t begin = 0; begin < faces;) {
    const std::int64_t end = std::min(faces, begin + step(random));
    triangle_entries<T>(begin, end, data.inputs(), pieces.outputs(), isa);
    begin = end;
  }
  CHECK(pieces == whole);

  const std::int64_t begin = 5, end = 26;
  Result<T> untouched(T(-7)), part(T(-7));
  triangle_entries<T>(begin, begin, data.inputs(), part.outputs(), isa);
  CHECK(part == untouched);
  triangle_entries<T>(begin, end, data.inputs(), part.outputs(), isa);
  for (std::int64_t f = 0; f < faces; ++f) {
    const Result<T>& expected = f >= begin && f < end ? whole : untouched;
    const auto i = static_cast<std::size_t>(f);
    for (std::size_t c = 3 * i; c < 3 * i + 3; ++c) {
      CHECK(part.diagonal[c] == expected.diagonal[c]);
      CHECK(part.off[c] == expected.off[c]);
    }
    CHECK(part.mass[i] == expected.mass[i]);
  }
}

}  // namespace

TEST_CASE("the scalar loop writes what the kernel says, where the header says") {
  const Data<double> data(14);
  Result<double> result(0);
  triangle_entries<double>(0, faces, data.inputs(), result.outputs(), Isa::scalar);
  for (std::size_t f = 0; f < faces; ++f) {
    const double cot[3] = {data.cot[3 * f], data.cot[3 * f + 1], data.cot[3 * f + 2]};
    const auto e = alcap::kernels::stiffness_mass(cot, data.area[f], data.n * data.curvature[f]);
    const double size = e.stiffness_diagonal[0] + e.stiffness_diagonal[1] + e.stiffness_diagonal[2];
    for (std::size_t c = 0; c < 3; ++c) {
      CHECK(std::abs(result.diagonal[3 * f + c] - e.stiffness_diagonal[c]) <= 1e-14 * size);
      CHECK(std::abs(result.off[3 * f + c] - std::complex<double>(e.stiffness_off[c].re, e.stiffness_off[c].im)) <=
            1e-14 * size);
    }
    CHECK(std::abs(result.mass[f] - std::complex<double>(e.mass_off.re, e.mass_off.im)) <= 1e-15 * data.area[f]);
  }
}

TEST_CASE("every instruction set of this machine gives the bits of the scalar loop") {
  REQUIRE(available_isas().front() == Isa::scalar);
  CHECK(best_isa() == available_isas().back());
  for (const Isa isa : available_isas()) {
    CAPTURE(std::string(name(isa)));
    check_against_scalar<double>(isa);
    check_against_scalar<float>(isa);
  }
}

TEST_CASE("results do not depend on how the range is split") {
  for (const Isa isa : available_isas()) {
    CAPTURE(std::string(name(isa)));
    check_splits<double>(isa);
    check_splits<float>(isa);
  }
}

TEST_CASE("an instruction set this machine lacks is refused") {
  const Data<double> data(15);
  Result<double> result(0);
  CHECK_THROWS_AS(triangle_entries<double>(0, 1, data.inputs(), result.outputs(), static_cast<Isa>(99)),
                  alcap::OptionError);
}
