// SPDX-License-Identifier: MIT
//
// single_vector.h: the last digits of one eigenpair: LOBPCG in double for a single vector, in a basis enlarged by the
// neighbouring Ritz vectors of the block phase, which remove what clusters would leave. Internal to solvers/.
#pragma once

#include <algorithm>
#include <functional>

#include "solvers/eigenpair/block_lobpcg.h"
#include "solvers/eigenpair/pencil.h"
#include "solvers/multigrid/hierarchy.h"

namespace alcap::detail {

struct RefineOptions {
  double tolerance = 1e-8;  ///< |S u - lambda M u| / (max(lambda, floor) |M u|)
  /// Enough as well, unless 0: the sine of the angle to the true eigenvector (Refined::sine).
  double sine = 0;
  double floor = 0;     ///< of eigenvalues, in the pencil's scale
  double negative = 0;  ///< below minus this S counts as indefinite
  int max_iterations = 100;
  /// One member of a cluster: its mates are never in the basis, and a residual of `outside` apart from its parts along
  /// them is enough.
  bool member = false;
  double outside = 0;
  bool second = false;                ///< refine_first(): the second eigenvalue is wanted as well
  bool next_good = false;             ///< the second Ritz value is that of a refined vector
  std::function<bool()> cancel = {};  ///< see EigenOptions
};

struct Refined {
  ComplexVector u;
  double lambda = 0;       ///< in the pencil's scale
  double length = 0;       ///< of u, by M
  double next = 0;         ///< second Ritz value, in the pencil's scale
  bool next_good = false;  ///< whether its vector was refined, or it is one of a cluster that was parted
  int iterations = 0;
  double residual = 1;
  double distance = 0;  ///< of lambda to an eigenvalue: a bound of |S u - lambda M u| in the norm of M^-1, |u|_M = 1
  /// The sine of the angle that `distance` allows where the second eigenvalue is `next`, as far as a proof may count on
  /// it. Ritz values lie above eigenvalues: only a part of the gap counts where its vector is not refined. `floor` as
  /// of RefineOptions.
  [[nodiscard]] double sine(double floor) const {
    constexpr double gap_part = 0.7;
    const double gap = next_good ? next - next_accuracy * std::max(next, floor) - lambda : gap_part * (next - lambda);
    return gap > 0 ? distance / gap : 1;
  }
  /// Whether u is within an angle of this sine of the space of vectors that are as smooth.
  [[nodiscard]] bool among_equals(double sine, double floor) const {
    return distance <= sine * equally_smooth * std::max(lambda, floor);
  }
  /// `narrow`: the block was smaller than the cluster, nothing was refined.
  enum class End { converged, limit, stalled, indefinite, narrow } end = End::stalled;
};

/// What the refinement works on; the mass is the lumped one of the finest level in its scaled unknowns.
struct RefineProblem {
  const FinePencil& pencil;
  const Hierarchy& hierarchy;
  const Buffer<float>& mass;
};

/// Neighbours of x whose eigenvalues lie no further above its own than this part of it are its mates in a cluster. As
/// approximate as they are they take their parts out of x, but bring in as much as cycles remove: so where x makes no
/// progress with them they are let go.
inline constexpr double mates_apart = 3e-5;

/// `x`: the start. `Y` holds K Ritz vectors of M-length 1, of which the first stands for x and is not used, `theta`
/// their Ritz values. K: 4, 8, 16.
template <int K>
[[nodiscard]] Refined refine(const RefineProblem& problem, ComplexVector x, const Buffer<float>& Y,
                             const VectorX<double>& theta, const RefineOptions& options);

}  // namespace alcap::detail
