// SPDX-License-Identifier: MIT
//
// backends.h: linear solvers and eigensolvers of your own, under names of your own. A registered name works wherever a
// built-in one does: SolverOptions::name, EigenOptions::solver and method, the lists of linear_solvers() and
// eigen_solvers(), and the options --solver and --method of a program that parses its command line afterwards.
//
//   using C = std::complex<double>;
//   using Dense = alcap::MatrixX<C>;
//   struct Mine final : alcap::LinearSolver<C> {
//     void analyse(const alcap::SparseMatrix<C>& A) override { ldlt.analyzePattern(A); }
//     void factorise(const alcap::SparseMatrix<C>& A) override {
//       ldlt.factorize(A);
//       if (ldlt.info() != Eigen::Success) throw alcap::SolveError("mine: the matrix is singular");
//     }
//     alcap::SolveReport solve(const Eigen::Ref<const Dense>& B, Eigen::Ref<Dense> X) const override {
//       X = ldlt.solve(B);
//       return {.solver = name(), .converged = true};
//     }
//     std::string name() const override { return "mine"; }
//     Eigen::SimplicialLDLT<alcap::SparseMatrix<C>> ldlt;
//   };
//   const auto mine = alcap::register_linear_solver("mine", [](const auto&) { return std::make_unique<Mine>(); });
//   const alcap::FieldRun run = alcap::run_field(V, F, {.n = 4, .eigen = {.solver = "mine"}});
//
// What a linear backend promises:
// - analyse() then factorise() then solve(); each may be called again, with another pattern after analyse(). solve() is
//   const and may run on several threads at once. Solvers made by one factory do not disturb each other.
// - Matrices are Hermitian (real: symmetric) positive definite, both triangles stored. factorise(), or at the latest
//   solve(), throws SolveError for one that is not: eigensolvers then try a larger shift. A backend that also solves
//   indefinite systems works too, but gives up that safeguard.
// - An iterative backend stops at SolverOptions::tolerance or max_iterations and says in its report which; a direct one
//   reports `converged` and leaves `residual` at 0. Callers recompute residuals where they matter.
// - It asks SolverOptions::cancel as that field says, and throws Cancelled. One that never asks cannot be stopped.
// - Memory that runs out is a SolveError; std::bad_alloc is understood as well.
// - set_transport() and half_solve() may be left as they are.
//
// What an eigensolver promises: a vector, and what it says about the way there. Whether it converged is not its to say:
// the library scales and turns the vector, recomputes eigenvalue and residual, and compares with the tolerance.
//
// The tables of names are the library's only mutable global state. They may be read and changed on any thread at any
// time; no lock is held while a factory or a solver runs.
#pragma once

#include <complex>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "alcap/solve.h"

namespace alcap {

/// Keeps a name registered; the end of its life takes the name out again. Solvers made before live on. Keep it in
/// main() or in a static variable of the program.
class [[nodiscard]] BackendRegistration {
 public:
  /// Made by the functions below.
  explicit BackendRegistration(std::function<void()> remove) : remove_(std::move(remove)) {}
  BackendRegistration(BackendRegistration&& other) noexcept : remove_(std::exchange(other.remove_, nullptr)) {}
  /// Exchanges the two registrations.
  BackendRegistration& operator=(BackendRegistration&& other) noexcept {
    std::swap(remove_, other.remove_);
    return *this;
  }
  BackendRegistration(const BackendRegistration&) = delete;
  BackendRegistration& operator=(const BackendRegistration&) = delete;
  ~BackendRegistration() {
    if (remove_) remove_();
  }

 private:
  std::function<void()> remove_;
};

/// Makes a solver for given options, whose name is the registered one. Called on any thread, several at once; what it
/// throws reaches the caller of make_linear_solver(). Nothing (a null pointer) becomes a SolveError there.
template <class Scalar>
using LinearSolverFactory = std::function<std::unique_ptr<LinearSolver<Scalar>>(const SolverOptions&)>;

/// Registers a linear backend. `complex` makes its solvers of Hermitian systems (fields and designs); `real` those of
/// real symmetric ones (cones, trivial and global connections). Without `real` these are solved as complex systems, in
/// twice the memory. Throws OptionError for a name that is empty, has blanks, is "auto" or is taken, and
/// when `complex` is empty.
BackendRegistration register_linear_solver(std::string name, LinearSolverFactory<std::complex<double>> complex,
                                           LinearSolverFactory<double> real = {});

/// The smallest eigenpair of S u = lambda M u is asked for: S Hermitian positive semidefinite, possibly indefinite by
/// rounding; M Hermitian positive definite; V x V, both triangles stored. Lives as long as the call.
struct EigenProblem {
  const SparseMatrix<std::complex<double>>& S;  ///< stiffness
  const SparseMatrix<std::complex<double>>& M;  ///< mass
  double area = 1;                              ///< of the surface: 1 / area is the scale of eigenvalues
  /// M, when S and M are compressed and have the same pattern, else null: for LinearSolver::set_transport().
  const SparseMatrix<std::complex<double>>* transport = nullptr;
};

/// Solves `problem`. Of the result `u` is needed, of any length and phase. Of its report, `solver` (the registered name
/// when empty), `iterations`, `next` (an upper bound of the second eigenvalue, which is kept where it is confirmed) and
/// `message` are taken over; all else the library fills in. Called on any thread, several at once. Exceptions reach the
/// caller of smallest_eigenpair().
using EigenSolver = std::function<EigenResult(const EigenProblem& problem, const EigenOptions& options)>;

/// Registers an eigensolver as EigenOptions::method. It should honour options.tolerance, solver, max_iterations, seed
/// and cancel as far as they mean anything to it. A vector of another size than the problem, of zeros or of values that
/// are not finite is a SolveError of the solve. Throws OptionError as register_linear_solver().
BackendRegistration register_eigen_solver(std::string name, EigenSolver solver);

}  // namespace alcap
