// SPDX-License-Identifier: MIT
//
// inverse_iteration.cpp: smallest eigenpair by inverse iteration with a block of vectors and Rayleigh-Ritz (subspace
// iteration, Bathe and Wilson 1973), over any linear backend. A step removes a factor (lambda - sigma) / (mu - sigma)
// of the error, mu the first eigenvalue beyond the block: where that is slow, in clusters, the block grows. The plain
// reference that the other methods are held against; it needs 4 to 7 times as many solves as Lanczos.
#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/dense/ritz.h"
#include "solvers/eigenpair/problem.h"
#include "solvers/linear/backends.h"
#include "src/base/parallel.h"
#include "src/base/random.h"

namespace alcap::detail {
namespace {

using Dense = MatrixX<std::complex<double>>;

/// Four vectors find the second eigenvalue as well, also a double one; the 2n + 1 equal ones of a round sphere fit in
/// the widest block.
constexpr Eigen::Index narrowest = 4;
constexpr Eigen::Index widest = 16;
/// A step that leaves more of the residual than this is slow.
constexpr double slow = 0.3;
/// The second eigenvalue is information: good when it changes by no more than this, waited for so many steps.
constexpr double settled = 1e-4;
constexpr int steps_for_next = 10;
/// Rounding is what is left when steps gain nothing more.
constexpr double no_gain = 0.9;
constexpr int patience = 3;
/// Directions that carry less than this of the block are rounding of double precision.
constexpr double dependent = 1e-14;

class InverseIteration {
 public:
  InverseIteration(const EigenProblem& problem, const EigenOptions& options)
      : problem_(problem), options_(options), rows_(problem.S.rows()), inverse_(shift_invert(problem, options)) {}

  EigenResult run() {
    EigenResult result;
    Dense Y;
    widen(Y, std::min(narrowest, rows_));
    ComplexVector Su, Mu;
    double best = std::numeric_limits<double>::infinity();
    double second = 0;
    int idle = 0;
    int steps_left = steps_for_next;
    for (int solves = 0;;) {
      check_cancelled(options_.cancel);
      const VectorX<double> values = step(Y);
      solves += static_cast<int>(Y.cols());
      ComplexVector u = Y.col(0);
      const PairCheck now = check_pair(problem_, u, Su, Mu);
      const bool is_slow = now.residual > slow * best;
      idle = now.residual > no_gain * best ? idle + 1 : 0;
      if (now.residual < best) {
        best = now.residual;
        result.u = u;
      }
      const bool found = best <= options_.residual_tolerance();
      const bool next_known = values.size() < 2 || std::abs(values[1] - second) <= settled * std::abs(values[1]);
      if (values.size() > 1) second = values[1];
      result.report.iterations = solves;
      if (found && (next_known || --steps_left < 0)) break;
      if (solves >= options_.max_iterations) break;
      if (idle >= patience && best <= rounding_floor(problem_, u, now.lambda).residual) break;
      const Eigen::Index room = std::min(widest, rows_) - Y.cols();
      if (!found && is_slow && room > 0) widen(Y, std::min(Y.cols(), room));
    }
    if (second > 0) result.report.next = second;
    result.report.solver = "inverse iteration, " + inverse_.solver->name();
    conclude(problem_, options_, result);
    return result;
  }

 private:
  /// Appends random vectors.
  void widen(Dense& Y, Eigen::Index count) {
    Y.conservativeResize(rows_, Y.cols() + count);
    for (Eigen::Index c = Y.cols() - count; c < Y.cols(); ++c) Y.col(c) = start_vector(rows_, options_.seed + seeds_++);
  }

  /// Y <- X = (S - sigma M)^-1 M Y, then its Ritz vectors X C, with X^H S X C = X^H M X C diag(values); the Ritz
  /// values, as many as the block has dimensions.
  VectorX<double> step(Dense& Y) {
    Dense X(rows_, Y.cols());
    static_cast<void>(inverse_.solver->solve(times(problem_.M, Y), X));
    // Without the scale of the matrices, so that Gram matrices do not underflow.
    for (Eigen::Index c = 0; c < X.cols(); ++c) X.col(c).normalize();
    const Dense M = X.adjoint() * times(problem_.M, X);
    const Dense S = X.adjoint() * times(problem_.S, X);
    const Ritz ritz = rayleigh_ritz(S, M, X.cols(), dependent);
    if (ritz.values.size() == 0 && X.allFinite()) throw_mass(problem_.M);
    if (!(ritz.values.size() > 0) || !ritz.coefficients.allFinite())
      throw SolveError("inverse iteration broke down; EigenOptions::method 'lanczos' is more robust");
    Y = X * ritz.coefficients;
    return ritz.values;
  }

  [[nodiscard]] Dense times(const HermitianMatrix& A, const Dense& X) const {
    Dense product(rows_, X.cols());
    for (Eigen::Index c = 0; c < X.cols(); ++c) hermitian_product(A, X.col(c).data(), product.col(c).data());
    return product;
  }

  const EigenProblem& problem_;
  const EigenOptions& options_;
  Eigen::Index rows_;
  ShiftInverted inverse_;
  std::uint64_t seeds_ = 0;
};

}  // namespace

EigenResult smallest_inverse_iteration(const EigenProblem& problem, const EigenOptions& options) {
  if (problem.S.rows() <= no_room) return smallest_dense(problem, options);
  return InverseIteration(problem, options).run();
}

}  // namespace alcap::detail
