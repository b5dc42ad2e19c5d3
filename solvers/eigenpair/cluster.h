// SPDX-License-Identifier: MIT
//
// cluster.h: the last digits of the smallest eigenpair when it is one of a cluster, whose members single
// precision does not tell apart. Internal to solvers/.
#pragma once

#include "solvers/eigenpair/single_vector.h"

namespace alcap::detail {

/// Refines the first of the K Ritz vectors in `Y`, of M-length 1, with Ritz values `theta`; see refine(). Where it
/// makes no progress because of mates in a cluster these are refined as well, one after another, and Rayleigh-Ritz
/// among all members tells them apart.
template <int K>
[[nodiscard]] Refined refine_first(const RefineProblem& problem, Buffer<float> Y, VectorX<double> theta,
                                   const RefineOptions& options);

}  // namespace alcap::detail
