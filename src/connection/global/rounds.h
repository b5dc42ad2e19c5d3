// SPDX-License-Identifier: MIT
//
// rounds.h: iterative refinement of the globally optimal connection, on one machine and over several ranks: how many
// rounds, and what each is asked for. Internal to src/connection/global and src/distributed.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "alcap/connection.h"

namespace alcap::detail {

/// How far the refinement has come. Norms are those of the preconditioner; float is enough for them.
struct RefinementState {
  int iterations = 0;
  double residual = 0;  // the gradient's norm relative to its first one
  bool converged = false;
};

/// What rounding leaves of a force, over the root of the sum of the energies: angles are up to a turn or so, and a
/// force is a sum of some of them.
inline constexpr double force_digits = 32 * std::numeric_limits<double>::epsilon();

/// The least reduction that one solve with held rotations is asked for: its directions drift by then.
inline constexpr double least_held_reduction = 1e-8;

/// Decides over rounds of refinement from the squared norms of their gradients.
class Rounds {
 public:
  Rounds(const GlobalOptions& options, double rounding, RefinementState& state)
      : state_(state),
        tolerance_(std::max(options.tolerance, 4 * std::numeric_limits<double>::epsilon())),
        rounding_(rounding),
        most_(options.max_iterations) {}

  /// Whether another correction is needed, for the gradient that the last one has left.
  bool another(double square) {
    const double norm = std::sqrt(std::max(0.0, square));
    // A round that gains less than a digit has met its own rounding.
    constexpr double useful_reduction = 0.1;
    stalled_ = started_ && norm > useful_reduction * last_;
    // Where the start is the optimum already, or close to it (a flat piece, a regular solid), the gradient is rounding
    // and nothing is left to do.
    if (!started_) scale_ = std::max(norm, rounding_ / tolerance_);
    started_ = true;
    last_ = norm;
    state_.residual = norm / scale_;
    state_.converged = state_.residual <= tolerance_;
    return !state_.converged && left() > 0;
  }
  [[nodiscard]] bool stalled() const { return stalled_; }

  /// The relative residual that the next solve should reach, a little below what is needed, and its iterations at most.
  [[nodiscard]] double wanted() const { return 0.5 * tolerance_ / state_.residual; }
  [[nodiscard]] int left() const { return most_ - state_.iterations; }
  void add(int iterations) { state_.iterations += iterations; }

 private:
  RefinementState& state_;
  double tolerance_, rounding_, scale_ = 0, last_ = 0;
  int most_;
  bool started_ = false, stalled_ = false;
};

}  // namespace alcap::detail
