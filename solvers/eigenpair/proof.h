// SPDX-License-Identifier: MIT
//
// proof.h: eigenvalues of S u = lambda M u counted below a number, by the signs of the pivots of S - sigma M
// (Sylvester's law of inertia; Parlett 1998, section 3.3). Internal to solvers/.
#pragma once

#include <limits>
#include <optional>

#include "solvers/eigenpair/problem.h"
#include "solvers/linear/multifrontal.h"

namespace alcap::detail {

class EigenvalueCounter {
 public:
  /// Analyses the pattern of S - sigma M.
  explicit EigenvalueCounter(const EigenProblem& problem)
      : problem_(problem),
        fronts_(shifted(problem, 1)),
        S_(problem.S.diagonal().real().cwiseAbs()),
        M_(problem.M.diagonal().real().cwiseAbs()) {}

  struct Count {
    std::int64_t below = 0;
    bool complete = true;   ///< false: more than asked for, counting ended
    bool reliable = false;  ///< rounding did not decide
    double sigma = 0;       ///< moved a little where a pivot vanished
    double growth = 1;
  };
  /// Eigenvalues below sigma, up to `most` + 1 of them. Asks open ControlScopes.
  [[nodiscard]] Count below(double sigma, std::int64_t most = std::numeric_limits<std::int64_t>::max() - 1) const;

  /// How far rounding in a factorisation may have moved an eigenvalue whose vector is u, |u|_M = 1.
  [[nodiscard]] double uncertainty(const ComplexVector& u, double sigma) const;

  [[nodiscard]] const Multifrontal& fronts() const { return fronts_; }

 private:
  [[nodiscard]] VectorX<double> weights(double sigma) const { return S_ + std::abs(sigma) * M_; }

  const EigenProblem& problem_;
  Multifrontal fronts_;
  VectorX<double> S_, M_;  // moduli of the diagonals
};

}  // namespace alcap::detail
