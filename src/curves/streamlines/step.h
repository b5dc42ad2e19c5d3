// SPDX-License-Identifier: MIT
//
// step.h: one step of the Runge-Kutta pair of Dormand and Prince (1980), orders 5 and 4, for dx/ds = v(x).
// Internal to streamlines.
#pragma once

#include "src/curves/streamlines/chart.h"

namespace alcap::detail {

struct RungeKuttaStep {
  Cplx w;             ///< the way
  Cplx v;             ///< direction at the end
  double error = 0;   ///< estimate, a length
  bool safe = false;  ///< no stage met a zero or turned too far to know its branch
};

/// From b in direction v over the length h. Stages may lie outside the face, where the basis goes on analytically.
[[nodiscard]] inline RungeKuttaStep runge_kutta_step(const FaceChart& chart, int n, const Barycentric& b, const Cplx& v,
                                                     double h) {
  static constexpr double a[6][6] = {{1.0 / 5, 0, 0, 0, 0, 0},
                                     {3.0 / 40, 9.0 / 40, 0, 0, 0, 0},
                                     {44.0 / 45, -56.0 / 15, 32.0 / 9, 0, 0, 0},
                                     {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729, 0, 0},
                                     {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656, 0},
                                     {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
  static constexpr double e[7] = {71.0 / 57600,      0,          -71.0 / 16695, 71.0 / 1920,
                                  -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
  const RootNear roots(v, n);
  RungeKuttaStep out;
  Cplx k[7] = {v};
  for (int stage = 0; stage < 6; ++stage) {
    Cplx w{0, 0};
    for (int j = 0; j <= stage; ++j) w = w + a[stage][j] * k[j];
    out.w = h * w;
    if (!roots.find(chart.at(chart.moved(b, out.w)), k[stage + 1])) return out;
  }
  Cplx error{0, 0};
  for (int j = 0; j < 7; ++j) error = error + e[j] * k[j];
  out.v = k[6];
  out.error = h * modulus(error);
  out.safe = true;
  return out;
}

}  // namespace alcap::detail
