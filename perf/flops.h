// SPDX-License-Identifier: MIT
//
// flops.h: a scalar that counts what is done with it, so that the operations of a kernel are counted by running it.
// Additions, multiplications and divisions count 1; sine and cosine count 1 each, though they cost more; comparisons,
// selections and signs count nothing.
#pragma once

#include <cmath>
#include <cstdint>

#include "kernels/stiffness_mass.h"

namespace alcap::perf {

inline std::int64_t& flops_counted() {
  static std::int64_t count = 0;
  return count;
}

/// A double whose arithmetic is counted.
struct CountedValue {
  double x = 0;
  friend CountedValue operator+(CountedValue a, CountedValue b) { return ++flops_counted(), CountedValue{a.x + b.x}; }
  friend CountedValue operator-(CountedValue a, CountedValue b) { return ++flops_counted(), CountedValue{a.x - b.x}; }
  friend CountedValue operator*(CountedValue a, CountedValue b) { return ++flops_counted(), CountedValue{a.x * b.x}; }
  friend CountedValue operator/(CountedValue a, CountedValue b) { return ++flops_counted(), CountedValue{a.x / b.x}; }
};

/// The same with the vocabulary of kernels/pack.h.
struct Counted {
  CountedValue v;
  Counted() = default;
  Counted(double x) : v{x} {}  // NOLINT(google-explicit-constructor): literals mix with it, as with packs
  static Counted from(CountedValue value) {
    Counted c;
    c.v = value;
    return c;
  }
  friend Counted operator+(Counted a, Counted b) { return from(a.v + b.v); }
  friend Counted operator-(Counted a, Counted b) { return from(a.v - b.v); }
  friend Counted operator*(Counted a, Counted b) { return from(a.v * b.v); }
  friend Counted operator/(Counted a, Counted b) { return from(a.v / b.v); }
  friend Counted operator-(Counted a) { return {-a.v.x}; }
  friend bool operator<=(Counted a, Counted b) { return a.v.x <= b.v.x; }
  friend bool operator>(Counted a, Counted b) { return a.v.x > b.v.x; }
};
inline Counted abs(Counted a) { return {std::abs(a.v.x)}; }
inline Counted select(bool condition, Counted yes, Counted no) { return condition ? yes : no; }
inline void sincos(Counted a, Counted& sine, Counted& cosine) {
  flops_counted() += 2;
  sine = std::sin(a.v.x);
  cosine = std::cos(a.v.x);
}

}  // namespace alcap::perf

template <>
struct alcap::kernels::detail::ValueOf<alcap::perf::Counted> {
  using type = double;
};

namespace alcap::perf {

/// Operations of the entries of one triangle whose field sees the curvature nK.
inline double flops_of_entries(double curvature) {
  const std::int64_t before = flops_counted();
  const Counted cot[3] = {0.5, 0.6, 0.63};
  (void)kernels::stiffness_mass<Counted>(cot, 1.0, curvature);
  return static_cast<double>(flops_counted() - before);
}

}  // namespace alcap::perf
