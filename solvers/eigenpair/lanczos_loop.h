// SPDX-License-Identifier: MIT
//
// lanczos_loop.h: shift-invert Lanczos with implicit restarts (Sorensen 1992), as far as complex and real problems
// share it: when to stop, when to restart, and what is done where rounding in the solves limits the vector. Internal to
// solvers/.
#pragma once

#include <memory>

#include "alcap/solve.h"
#include "solvers/dense/hermitian.h"

namespace alcap::detail {

/// S u = lambda M u as the loop sees it, and the vector that it iterates: real vectors, or the interleaved real view of
/// complex ones.
class LanczosProblem {
 public:
  /// `rows`: real entries of a vector. `size`: 1 / size is the scale of eigenvalues; u = 1 has about this mass.
  LanczosProblem(Eigen::Index rows, double size) : rows_(rows), size_(size) {}
  LanczosProblem(const LanczosProblem&) = delete;
  LanczosProblem& operator=(const LanczosProblem&) = delete;
  virtual ~LanczosProblem() = default;

  [[nodiscard]] Eigen::Index rows() const { return rows_; }
  [[nodiscard]] double size() const { return size_; }

  /// y = Op x = (S - sigma M)^-1 M x / size, sigma below the smallest eigenvalue; given is M x in units of the mean row
  /// sum, M x rows / (2 size). Eigenvalues of Op are theta = 1 / (size (lambda - sigma)): numbers near 1 for Spectra's
  /// absolute thresholds.
  virtual void solve(const double* Mx, double* y) const = 0;
  /// y = M x.
  virtual void mass(const double* x, double* y) const = 0;
  /// |(S - sigma M) x|.
  [[nodiscard]] virtual double shifted_norm(const double* x) const = 0;

  /// The vector u that is iterated.
  [[nodiscard]] virtual Eigen::Map<VectorX<double>> vector() = 0;
  /// Scales u to mass 1; its residual |S u - lambda M u| / (max(lambda, 1 / size) |M u|).
  virtual double check() = 0;
  /// A step of inverse iteration on the u just checked; how many solves it took.
  virtual int polish() = 0;

 private:
  Eigen::Index rows_;
  double size_;
};

/// Ritz pairs of Op in the basis; the largest value, which comes last, belongs to the smallest eigenvalue of the
/// pencil.
using RitzPairs = Eigenpairs<double>;

class LanczosLoop {
 public:
  LanczosLoop(LanczosProblem& problem, const EigenOptions& options);
  ~LanczosLoop();

  /// From `start` (not all zero) to a problem.vector() that is as good as asked, or as it gets, and checked.
  void run(const double* start);

  [[nodiscard]] int solves() const;
  /// Ritz pairs of the last basis.
  [[nodiscard]] const RitzPairs& ritz() const;
  /// Where the Ritz value of the second eigenvalue stands, counted from the end: after the first and the copies of it
  /// that rounding brings in. 1 when there is but one.
  [[nodiscard]] Eigen::Index second_place() const;
  /// The `count` last Ritz vectors, into rows() x count entries.
  void ritz_vectors(Eigen::Index count, double* out) const;

 private:
  class Process;
  std::unique_ptr<Process> process_;
};

}  // namespace alcap::detail
