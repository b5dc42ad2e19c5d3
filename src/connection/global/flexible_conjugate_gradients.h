// SPDX-License-Identifier: MIT
//
// flexible_conjugate_gradients.h: conjugate gradients whose preconditioner need not be exactly linear (Notay 2000),
// such as an iteration of its own. Internal to src/connection/global and src/distributed.
//
// A Space has precondition(r, z), which sets z = P r and returns r' z; product(p, q), which sets q = A p; dot(a, b);
// and combine(x, s, d, y), which sets y = x + s d, where y may be x or d. A Vector is made by its size.
#pragma once

#include <cmath>
#include <utility>

#include "src/base/cancel.h"

namespace alcap::detail {

/// x += the solution for the residual r, until r' P r has fallen by `wanted` squared or `most` iterations are done;
/// those done. r is used up.
template <class Space, class Vector>
int flexible_conjugate_gradients(const Space& space, double wanted, int most, Vector& r, Vector& x) {
  Vector p(r.size()), q(r.size()), z(r.size()), before(r.size());
  double square = space.precondition(r, p);
  const double first = square;
  int done = 0;
  while (done < most && square > wanted * wanted * first) {
    check_cancelled();
    ++done;
    space.product(p, q);
    const double alpha = square / space.dot(p, q);
    if (!std::isfinite(alpha)) break;
    space.combine(x, alpha, p, x);
    space.combine(r, -alpha, q, before);
    std::swap(before, r);
    const double next = space.precondition(r, z);
    const double beta = (next - space.dot(before, z)) / square;
    square = next;
    space.combine(z, beta, p, p);
  }
  return done;
}

}  // namespace alcap::detail
