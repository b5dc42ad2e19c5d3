// SPDX-License-Identifier: MIT
//
// conjugate_gradients.h: preconditioned conjugate gradients in the form of Chronopoulos and Gear (1989), which needs
// one pass over the faces and one over the edges in every step. Internal to src/connection/global and src/distributed.
//
// A System starts with r, z = P r and x = 0. apply() forms A z and returns z' A z; step(alpha, beta) forms p = z + beta
// p and A p likewise, moves x by alpha p and r by -alpha A p, and returns the new r' P r.
#pragma once

#include <algorithm>

#include "src/base/cancel.h"

namespace alcap::detail {

/// Preconditioned conjugate gradients from x = 0 until r' P r has fallen by `reduction` squared or `max_iterations` are
/// done. They also end where rounding has left r a part in the kernel that is no longer small beside the rest: from
/// there on search directions grow along the kernel, and so would r. Returns the iterations.
template <class System>
int conjugate_gradients(System& system, double square, double reduction, int max_iterations) {
  using S = typename System::Scalar;
  constexpr double growth = 100;  // of r' P r above its least value: it oscillates by far less than that
  const double target = square * reduction * reduction;
  double beta = 0, alpha = 0, least = square;
  int iteration = 0;
  while (square > target && square <= growth * least && iteration < max_iterations) {
    check_cancelled();
    double curvature = system.apply();
    if (iteration > 0) curvature -= beta * square / alpha;
    if (!(curvature > 0)) break;  // rounding has used up the search directions
    alpha = square / curvature;
    const double next = system.step(static_cast<S>(alpha), static_cast<S>(beta));
    beta = next / square;
    square = next;
    least = std::min(least, square);
    ++iteration;
  }
  return iteration;
}

}  // namespace alcap::detail
