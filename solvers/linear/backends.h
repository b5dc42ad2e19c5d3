// SPDX-License-Identifier: MIT
//
// backends.h: what a solver backend gives the factory: one maker per scalar. Internal to solvers/.
//
// A new linear backend is one file that defines its makers, their declaration here, and one line of the table in
// registry.cpp. What it promises stands in alcap/backends.h.
#pragma once

#include <algorithm>
#include <complex>
#include <functional>
#include <limits>
#include <memory>
#include <new>
#include <string>

#include "alcap/solve.h"
#include "src/base/cancel.h"
#include "src/base/clock.h"

namespace alcap::detail {

template <class Scalar>
using SolverPtr = std::unique_ptr<LinearSolver<Scalar>>;

/// Fill-reducing ordering of CHOLMOD. `automatic` decides by the number of rows when the pattern is analysed.
enum class Ordering { automatic, amd, metis };

template <class Scalar>
[[nodiscard]] SolverPtr<Scalar> make_cholmod(Ordering ordering, const SolverOptions& options);
template <class Scalar>
[[nodiscard]] SolverPtr<Scalar> make_eigen_ldlt(const SolverOptions& options);
template <class Scalar>
[[nodiscard]] SolverPtr<Scalar> make_eigen_cg(const SolverOptions& options);

/// Of complex systems only: real ones go through RealSystems.
[[nodiscard]] SolverPtr<std::complex<double>> make_multigrid(const SolverOptions& options);

/// What to do where memory runs out: factors take most, multigrid and gradients little more than the matrix.
inline constexpr const char* less_than_a_factor = "; the solver 'multigrid' needs a small part of it";
inline constexpr const char* more_memory = "; use a smaller mesh or a machine with more memory";

/// Runs a step of a backend; running out of memory becomes a SolveError that names the step and gives the advice.
template <class Step>
void guarded(const std::string& name, const char* advice, Step&& step) {
  try {
    step();
  } catch (const std::bad_alloc&) {
    throw SolveError(name + ": out of memory" + advice);
  }
}

/// A factor of more rows than this takes minutes and more than 5 GB: it is not made unasked.
inline constexpr Eigen::Index factorisable_rows = 3'000'000;

/// A positive pivot this many rounding units below its diagonal entry carries no digit: the matrix is singular to
/// working precision. A margin of 64 covers the rounding errors summed up in one pivot.
inline constexpr double singular_pivot = 64 * std::numeric_limits<double>::epsilon();

/// Throws SolveError unless A is square and has at least one row.
template <class Scalar>
void require_square(const SparseMatrix<Scalar>& A) {
  if (A.rows() != A.cols() || A.rows() == 0) {
    throw SolveError("the matrix is " + std::to_string(A.rows()) + " x " + std::to_string(A.cols()) +
                     ": it must be square and not empty");
  }
}

/// Throws SolveError unless B and X have `rows` rows and as many columns as each other.
template <class B, class X>
void require_sizes(const B& b, const X& x, Eigen::Index rows) {
  if (b.rows() != rows || x.rows() != rows || b.cols() != x.cols()) {
    throw SolveError("right-hand side " + std::to_string(b.rows()) + " x " + std::to_string(b.cols()) + ", solution " +
                     std::to_string(x.rows()) + " x " + std::to_string(x.cols()) + " do not fit a matrix of " +
                     std::to_string(rows) + " rows");
  }
}

/// Throws OptionError unless `name` is "auto" or a known linear backend; the message lists them.
void require_linear_solver(const char* field, const std::string& name);

/// The built-in factorisation that "auto" takes, and that methods fall back to.
[[nodiscard]] std::string preferred_factorisation();

/// Whether A and B are compressed and have their entries at the same places, so that entry k of one belongs to entry k
/// of the other.
template <class Scalar>
[[nodiscard]] bool same_pattern(const SparseMatrix<Scalar>& A, const SparseMatrix<Scalar>& B) {
  return A.isCompressed() && B.isCompressed() && A.rows() == B.rows() && A.cols() == B.cols() &&
         A.nonZeros() == B.nonZeros() &&
         std::equal(A.outerIndexPtr(), A.outerIndexPtr() + A.outerSize() + 1, B.outerIndexPtr()) &&
         std::equal(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros(), B.innerIndexPtr());
}

}  // namespace alcap::detail
