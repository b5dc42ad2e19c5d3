// SPDX-License-Identifier: MIT
//
// lanczos_loop.h: shift-invert Lanczos with implicit restarts (Sorensen 1992), as far as complex and real problems
// share it: when to stop, when to restart, and what is done where rounding in the solves limits the vector.
//
// The basis grows one vector, one solve, at a time, and after each the residual of the first Ritz pair is computed:
// with Op V = V H + f e^T, a Ritz pair (theta, y = V s) has S y - lambda M y = -(s_last / theta) (S - sigma M) f. When
// that says it is done, the vector is formed and its true residual decides. Internal to solvers/.
#pragma once

#include <algorithm>
#include <cmath>

#include "solvers/dense/hermitian.h"
#include "solvers/eigenpair/lanczos_recurrence.h"
#include "solvers/linear/backends.h"

namespace alcap::detail {

/// Ritz pairs of the basis; the largest value, which comes last, belongs to the smallest eigenvalue.
using RitzPairs = Eigenpairs<double>;

/// The Ritz value after the first and the copies of it that rounding brings in, counted from the end.
inline Eigen::Index second_place(const RitzPairs& ritz) {
  constexpr double copy = 1e-6;  // Ritz values this close, relatively, to the first may be copies of it
  const VectorX<double>& theta = ritz.values;
  const Eigen::Index k = theta.size();
  Eigen::Index place = 2;
  while (place < k && theta[k - place] > (1 - copy) * theta[k - 1]) ++place;
  return place;
}

/// What is iterated. `Problem` has
///   u                       the vector; assignable
///   form(basis, ritz)       u = the first Ritz vector
///   check()                 scales u to mass 1 and returns its residual
///   polish(solves)          a step of inverse iteration on u, adding to the number of solves
///   estimate(basis, ritz)   the residual of the first Ritz pair, up to a factor that is learned here
template <class Problem, class Recurrence>
class LanczosLoop {
 public:
  using Index = Eigen::Index;
  LanczosLoop(Problem& problem, Recurrence& basis, const EigenOptions& options)
      : problem_(problem), basis_(basis), options_(options) {}

  /// From `start` to one that is as good as asked, or as it gets, with at most `size` basis vectors;
  /// the last Ritz pairs.
  RitzPairs run(Eigen::Map<const VectorX<double>> start, Index size) {
    basis_.init(start, solves_);
    Index stop_next = options_.max_iterations;  // when to stop waiting for the second Ritz value
    bool found = false;
    for (Index k = 1;; ++k) {
      check_cancelled(options_.cancel);
      const RitzPairs ritz = hermitian_eigenpairs<double>(basis_.matrix_H().topLeftCorner(k, k));
      if (!found && correction_ * problem_.estimate(basis_, ritz) <= options_.tolerance) {
        found = accept(ritz);
        if (found) stop_next = std::min<Index>(stop_next, solves_ + solves_for_next);
      }
      const bool give_up = solves_ >= options_.max_iterations;
      if ((found && (second_is_good(ritz) || solves_ >= stop_next)) || give_up) {
        if (!found) static_cast<void>(accept(ritz));
        return ritz;
      }
      if (k == size) {
        basis_.restart(std::min(kept, size / 2), ritz.values);
        k = basis_.subspace_dim();
      }
      basis_.factorize_from(k, k + 1, solves_);
    }
  }
  [[nodiscard]] int solves() const { return static_cast<int>(solves_); }

 private:
  // The second eigenvalue is an information, not the result: its Ritz vector this good gives it to about 1e-3.
  static constexpr double next_tolerance = 1e-3;
  static constexpr Index solves_for_next = 12;
  // When the recurrence promises this fraction of the true residual, the rest is rounding.
  static constexpr double limited = 1e-2;

  /// Forms the first Ritz vector and says whether to stop: its true residual is good enough, or rounding does not let
  /// it get better.
  bool accept(const RitzPairs& ritz) {
    problem_.form(basis_, ritz);
    double residual = problem_.check();
    const double promised = problem_.estimate(basis_, ritz);
    for (int round = 0; residual > options_.tolerance && promised < limited * residual; ++round) {
      // The recurrence has converged further than the vector: what is left is rounding in the solves.
      const auto before = problem_.u;
      problem_.polish(solves_);
      const double after = problem_.check();
      if (after > residual) problem_.u = before;
      if (round == 3 || after > 0.5 * residual) return true;
      residual = after;
    }
    if (residual <= options_.tolerance) return true;
    correction_ *= 2 * residual / options_.tolerance;
    return false;
  }

  [[nodiscard]] bool second_is_good(const RitzPairs& ritz) const {
    const Index k = ritz.values.size();
    if (k < 2) return false;
    const Index at = k - second_place(ritz);
    return std::abs(ritz.vectors(k - 1, at)) * basis_.f_norm() <= next_tolerance * ritz.values[at];
  }

  Problem& problem_;
  Recurrence& basis_;
  const EigenOptions& options_;
  Index solves_ = 0;
  double correction_ = 1;  // what the last true residual taught
};

}  // namespace alcap::detail
