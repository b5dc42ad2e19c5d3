// SPDX-License-Identifier: MIT
//
// problem.h: what all eigensolvers share: the true residual, the start vector, the phase, the dense solver for
// tiny problems. Internal to solvers/.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "alcap/backends.h"
#include "alcap/errors.h"
#include "alcap/solve.h"

namespace alcap::detail {

using HermitianMatrix = SparseMatrix<std::complex<double>>;
using ComplexVector = ComplexVectorX<double>;

class EigenvalueCounter;

/// What a vector is worth as an eigenvector.
struct PairCheck {
  double lambda = 0;    ///< Rayleigh quotient
  double residual = 0;  ///< |S u - lambda M u| / (max(lambda, 1/area) |M u|)
  double energy = 0;    ///< EigenReport::energy_residual
  double distance = 0;  ///< EigenReport::distance; of check_distance() only
  [[nodiscard]] bool within(double tolerance) const { return residual <= tolerance && energy <= tolerance; }
};

/// Scales u to |u|_M = 1 and computes its Rayleigh quotient and residual. `Su`, `Mu` are workspace and hold the
/// products afterwards.
[[nodiscard]] PairCheck check_pair(const EigenProblem& problem, ComplexVector& u, ComplexVector& Su, ComplexVector& Mu);

/// The same with the distance, for as much as five more products with M.
[[nodiscard]] PairCheck check_distance(const EigenProblem& problem, ComplexVector& u, ComplexVector& Su,
                                       ComplexVector& Mu);

/// Energy and distance of the residual r = S u - lambda M u, |u|_M = 1, of a problem that has more in it than these
/// matrices, M as a part of its mass: the distance is then an upper bound.
[[nodiscard]] PairCheck check_residual(const EigenProblem& problem, double lambda, const ComplexVector& r);

/// An angle that rests on an estimate of the second eigenvalue is believed where residuals are below this.
inline constexpr double residual_with_estimate = 1e-6;
/// Fields whose eigenvalues differ by less than this part of max(lambda, 1/area) count as equally smooth: neither shape
/// nor mesh are known so well.
inline constexpr double equally_smooth = 1e-3;
/// The sine of the angle that options ask for.
[[nodiscard]] double sine_tolerance(const EigenOptions& options);

/// Fills in what a report says of angles: to the space of the eigenvectors whose eigenvalues lie below `above`, which
/// is that of the smallest alone where `above` is the second eigenvalue, known or estimated.
void judge_angle(const EigenProblem& problem, const EigenOptions& options, double above, AngleCheck check,
                 EigenResult& result);

/// The residuals below which rounding in S u and M u alone drowns everything: no solver can be asked for less.
[[nodiscard]] PairCheck rounding_floor(const EigenProblem& problem, const ComplexVector& u, double lambda);

/// EigenReport::message where the tolerance was not reached.
inline constexpr const char* not_reached =
    "the residual asked for was not reached: try another EigenOptions::solver or EigenOptions::method, or a larger "
    "EigenOptions::tolerance or EigenOptions::max_iterations";

/// Throws SolveError: M is not positive definite, with an entry of the diagonal that shows it, if there is one.
template <class Scalar>
[[noreturn]] void throw_mass(const SparseMatrix<Scalar>& M) {
  for (Eigen::Index j = 0; j < M.rows(); ++j) {
    const double entry = std::real(M.coeff(j, j));
    if (!(entry > 0))
      throw SolveError("the mass matrix M is not positive definite: entry " + std::to_string(j) +
                       " of its diagonal is " + number_text(entry));
  }
  throw SolveError("the mass matrix M is not positive definite, although its diagonal is positive");
}

/// Fills `converged`, `lambda`, `residual`, `distance` and `message` from a last check against the tolerance, fixes the
/// phase. Where an angle is enough it is that which `next` allows.
void conclude(const EigenProblem& problem, const EigenOptions& options, EigenResult& result);

/// Makes the entry of largest modulus real and positive: the first among those within 1e-6 of the largest, so that the
/// choice does not hang on last bits.
void fix_phase(ComplexVector& u);

/// Independent uniform entries in the square [-1, 1)^2, the same on every machine.
[[nodiscard]] ComplexVector start_vector(Eigen::Index rows, std::uint64_t seed);

/// Rayleigh-Ritz in the complex span of the columns of Y: ascending Ritz values. Columns that depend on others (u and
/// iu in the real view) count once.
[[nodiscard]] std::vector<double> ritz_values(const EigenProblem& problem, const MatrixX<std::complex<double>>& Y);

/// S - sigma M.
[[nodiscard]] HermitianMatrix shifted(const EigenProblem& problem, double sigma);

/// A = S - sigma M, positive definite also when S is singular or a little indefinite, and its factorisation.
struct ShiftInverted {
  HermitianMatrix A;
  double sigma = 0;
  std::unique_ptr<LinearSolver<std::complex<double>>> solver;
};
/// By the linear backend that the options name. Throws SolveError when S is clearly indefinite. `above`: an upper bound
/// of the smallest eigenvalue, for a shift near it: many fewer solves where eigenvalues lie close.
[[nodiscard]] ShiftInverted shift_invert(const EigenProblem& problem, const EigenOptions& options,
                                         std::optional<double> above = {});

/// Up to here a dense solve is faster than one factorisation, and it has no special cases.
inline constexpr Eigen::Index dense_eigen_rows = 48;
/// Up to so many rows the Krylov methods leave the problem to the dense solver: a basis needs room.
inline constexpr Eigen::Index no_room = 2;

// The eigensolvers, each in its own file. Results are concluded.
[[nodiscard]] EigenResult smallest_dense(const EigenProblem& problem, const EigenOptions& options);
[[nodiscard]] EigenResult smallest_lobpcg(const EigenProblem& problem, const EigenOptions& options);
[[nodiscard]] EigenResult smallest_lanczos(const EigenProblem& problem, const EigenOptions& options);
[[nodiscard]] EigenResult smallest_lanczos_below(const EigenProblem& problem, const EigenOptions& options,
                                                 std::optional<double> above);
[[nodiscard]] EigenResult smallest_inverse_iteration(const EigenProblem& problem, const EigenOptions& options);

/// eigenpairs() by one of the methods above.
[[nodiscard]] EigenModes find_modes(const EigenProblem& problem, const EigenOptions& options, const std::string& method,
                                    int count);

/// EigenReport::lower_bound lies this part of max(lambda, 1/area) below lambda, or more.
inline constexpr double bound_margin = 1e-6;
/// `next` is good to this part of max(next, 1/area).
inline constexpr double next_accuracy = 1e-3;
/// Whether the options ask for a proof of a problem of so many rows, and thus for a `next` worth proving.
[[nodiscard]] bool asks_for_proof(const EigenOptions& options, Eigen::Index rows);
/// Fills in `smallest`, `lower_bound` and `smallest_note`, and keeps `next` only where it is established. A pair that
/// is refuted is replaced by the smallest one. `own`: `next` comes from a method of the library, which makes it an
/// upper bound of the second eigenvalue. `memory`: bytes that the factorisation may take, by default half of what the
/// system could still give; where that is too little an independent search takes its place. `counter`: of this problem,
/// from plan_proof().
void prove_smallest(const EigenProblem& problem, const EigenOptions& options, bool own, EigenResult& result,
                    std::optional<double> memory = {}, std::shared_ptr<const EigenvalueCounter> counter = {});

/// The same for a problem that has more in it than these matrices, and S - sigma M is positive definite wherever it is:
/// `rest` tells whether it is at sigma, where these matrices are, or nothing where rounding does not allow an answer.
/// `next` is not established, and a pair that is refuted stays.
void prove_smallest_with(const EigenProblem& problem, const EigenOptions& options,
                         const std::function<std::optional<bool>(double sigma)>& rest, EigenResult& result);

/// Before a solve by LOBPCG that may be followed by a proof: what the proof needs, where it takes no longer than such a
/// solve usually does. Where it would, `options` then ask for none: the solve has to rest on itself, and does not end
/// where only a proof would have made its end right. Null where no proof is to be made in any case.
[[nodiscard]] std::shared_ptr<const EigenvalueCounter> plan_proof(const EigenProblem& problem, EigenOptions& options);
/// After a solve that took so many iterations: whether the proof takes no longer than it did, as it may after hard
/// ones.
[[nodiscard]] bool worth_proving(const EigenvalueCounter& counter, Eigen::Index rows, int iterations);
/// EigenReport::smallest_note of what plan_proof() decided.
inline constexpr const char* proof_takes_longer =
    "a proof would take longer than the solve did: EigenOptions::prove_smallest asks for it";

}  // namespace alcap::detail
