// SPDX-License-Identifier: MIT
//
// lobpcg_refine.h: the last digits of one eigenpair: LOBPCG in double for a single vector, in a basis enlarged by the
// neighbouring Ritz vectors of the block phase, which remove what clusters would leave. Internal to solvers/.
#pragma once

#include <functional>

#include "solvers/lobpcg_block.h"
#include "solvers/mg_hierarchy.h"
#include "solvers/pencil.h"

namespace alcap::detail {

struct RefineOptions {
  double tolerance = 1e-8;  ///< |S u - lambda M u| / (max(lambda, floor) |M u|)
  double floor = 0;         ///< of eigenvalues, in the pencil's scale
  double negative = 0;      ///< below minus this S counts as indefinite
  int max_iterations = 100;
  std::function<bool()> cancel = {};  ///< see EigenOptions
};

struct Refined {
  ComplexVector u;
  double next = 0;  ///< second Ritz value, in the pencil's scale
  int iterations = 0;
  double residual = 1;
  /// `narrow`: the block was smaller than the cluster, nothing was refined.
  enum class End { converged, limit, stalled, indefinite, narrow } end = End::stalled;
};

/// What the refinement works on; the mass is the lumped one of the finest level in its scaled unknowns.
struct RefineProblem {
  const FinePencil& pencil;
  const Hierarchy& hierarchy;
  const Buffer<float>& mass;
};

/// `Y` holds K Ritz vectors of M-length 1, the first of them the start, `theta` their Ritz values. K: 4, 8, 16.
template <int K>
[[nodiscard]] Refined refine(const RefineProblem& problem, const Buffer<float>& Y, const VectorX<double>& theta,
                             const RefineOptions& options);

}  // namespace alcap::detail
