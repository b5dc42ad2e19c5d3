// SPDX-License-Identifier: MIT
//
// solve.h: sparse solvers behind one small interface. Matrices are Hermitian (complex) or symmetric (real) with both
// triangles stored, positive definite unless said otherwise. Backends live in solvers/, or are registered by the user
// (backends.h), and are chosen by name.
//
//   auto solver = alcap::make_linear_solver<std::complex<double>>({.name = "cholmod"});
//   solver->analyse(A);                 // pattern only: reuse for any values
//   solver->factorise(A);               // values
//   SolveReport r = solver->solve(B, X);  // any number of right-hand sides
#pragma once

#include <Eigen/SparseCore>
#include <complex>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "alcap/conventions.h"
#include "alcap/names.h"

namespace alcap {

/// The sparse matrices of this library: column-compressed, with the library's indices.
template <class Scalar>
using SparseMatrix = Eigen::SparseMatrix<Scalar, Eigen::ColMajor, Index>;

/// What a linear solve did. Times in seconds.
struct SolveReport {
  std::string solver;                ///< the backend and its choices, e.g. "cholmod (metis)"
  bool converged = false;            ///< whether the tolerance was reached
  int iterations = 0;                ///< 0 for direct solvers
  double residual = 0;               ///< max over columns of |A x - b| / |b|, recomputed
  double analyse_seconds = 0;        ///< ordering and symbolic analysis
  double factorise_seconds = 0;      ///< numeric factorisation
  double solve_seconds = 0;          ///< all right-hand sides
  std::int64_t factor_nonzeros = 0;  ///< of the factor or the hierarchy
};

/// Which linear backend is used, and how.
struct SolverOptions {
  /// "auto" picks the fastest compiled-in backend when it sees the matrix; see linear_solvers() for the names.
  std::string name = "auto";
  /// For "auto": how many right-hand sides one factorisation will be used for; 0: not known, many. A factorisation
  /// costs as much as a dozen multigrid solves.
  int right_hand_sides = 0;
  double tolerance = 1e-10;   // iterative backends: relative residual
  int max_iterations = 1000;  // iterative backends
  /// Asked before every analysis, factorisation and solve, and by iterative backends in every iteration; true ends the
  /// call with Cancelled, and the solver can be used again. So does a RunControl around the call (control.h). An
  /// ordering or factorisation that has begun is not interrupted, and is the only part that can take long: ask for
  /// "multigrid" where that matters. May be called on several threads at once;
  /// what it throws reaches the caller. Example: a std::stop_token's stop_requested().
  std::function<bool()> cancel = {};
};

/// Half of a solve with a direct backend: H = L^-1 P B where A = P' L L' P. H' H = B' A^-1 B costs much less than
/// solving where B is concentrated: H has few rows that are not zero.
template <class Scalar>
struct HalfSolution {
  std::vector<Index> rows;  ///< rows of H that may differ from zero, ascending, in the order of the factor
  MatrixX<Scalar> values;   ///< those rows

  /// H' K, of two half solutions by the same factor.
  [[nodiscard]] MatrixX<Scalar> product(const HalfSolution& K) const;
};

/// One factorisation: analyse once per pattern, factorise once per set of values, solve as often as wanted.
/// solve() is const and may run on several threads at once.
template <class Scalar>
class LinearSolver {
 public:
  virtual ~LinearSolver() = default;
  /// Optional, before factorise(): a matrix of A's pattern whose off-diagonal phases are the parallel transports; the
  /// mass matrix is one. Multigrid uses it where the phase of -A_ij is not the transport (obtuse angles); others ignore
  /// it.
  virtual void set_transport(const SparseMatrix<Scalar>&) {}
  /// Ordering and symbolic analysis of A's pattern. Throws SolveError when memory runs out.
  virtual void analyse(const SparseMatrix<Scalar>& A) = 0;
  /// Numeric factorisation; A must have the analysed pattern. Throws SolveError when A is not positive definite.
  virtual void factorise(const SparseMatrix<Scalar>& A) = 0;
  /// Solves A X = B for the columns of B. The residual in the report is left at 0 by direct backends: recompute it
  /// where it matters, with residual().
  virtual SolveReport solve(const Eigen::Ref<const MatrixX<Scalar>>& B, Eigen::Ref<MatrixX<Scalar>> X) const = 0;
  /// Half of the solve for a sparse B, or nothing when this backend cannot.
  [[nodiscard]] virtual std::optional<HalfSolution<Scalar>> half_solve(const SparseMatrix<Scalar>&) const {
    return std::nullopt;
  }
  /// What it is, for reports.
  [[nodiscard]] virtual std::string name() const = 0;
};

/// Throws OptionError for an unknown name (and lists the known ones). Scalars: double, std::complex<double>.
template <class Scalar>
[[nodiscard]] std::unique_ptr<LinearSolver<Scalar>> make_linear_solver(const SolverOptions& options = {});

/// Names of the linear backends: those compiled in, then those registered (backends.h).
[[nodiscard]] std::vector<std::string> linear_solvers();

/// max over columns of |A x - b| / |b|.
template <class Scalar>
[[nodiscard]] double residual(const SparseMatrix<Scalar>& A, const Eigen::Ref<const MatrixX<Scalar>>& X,
                              const Eigen::Ref<const MatrixX<Scalar>>& B);

/// y = A x for a Hermitian matrix with both triangles stored; parallel over columns, bitwise independent of threads.
void hermitian_product(const SparseMatrix<std::complex<double>>& A, const std::complex<double>* x,
                       std::complex<double>* y);

/// When it is proven that an eigenpair is the smallest one.
enum class Prove {
  automatic,  ///< where the proof costs less than the solve: up to 200,000 rows
  always,     ///< wherever memory allows; beyond, an independent search takes its place
  never,      ///< not at all
};
template <>
struct NamesOf<Prove> {
  static constexpr auto table =
      detail::name_table<Prove>({{Prove::automatic, "auto"}, {Prove::always, "always"}, {Prove::never, "never"}});
};

/// What is known about whether an eigenpair is the smallest one.
enum class Smallest {
  not_checked,  ///< nothing: a small residual says that it is an eigenpair, not which
  searched,     ///< no proof; a search from an independent random start found nothing lower
  proven,       ///< no eigenvalue lies below EigenReport::lower_bound
  refuted,      ///< a smaller one exists, and was not found
};
template <>
struct NamesOf<Smallest> {
  static constexpr auto table = detail::name_table<Smallest>({{Smallest::not_checked, "not checked"},
                                                              {Smallest::searched, "searched"},
                                                              {Smallest::proven, "proven"},
                                                              {Smallest::refuted, "refuted"}});
};

/// What is known about the angle between an eigenvector and the true one.
enum class AngleCheck {
  unknown,    ///< nothing: the residual is too large for a bound
  of_many,    ///< others may be as smooth: the angle is that to the nearest of them, bounded whatever is proven
  estimated,  ///< the second eigenvalue is not proven, only approximated: it may lie closer
  bounded,    ///< no eigenvalue but the smallest lies below the one that the bound is made with
};
template <>
struct NamesOf<AngleCheck> {
  static constexpr auto table = detail::name_table<AngleCheck>({{AngleCheck::unknown, "none"},
                                                                {AngleCheck::of_many, "of many"},
                                                                {AngleCheck::estimated, "estimated"},
                                                                {AngleCheck::bounded, "bounded"}});
};

/// How the smallest eigenpair is computed.
struct EigenOptions {
  /// Relative residual |S u - lambda M u| / (max(lambda, 1/area) |M u|) that is asked for and checked; the same bound
  /// holds for EigenReport::energy_residual. Not given: angle_tolerance.
  std::optional<double> tolerance = {};
  /// Degrees, at least 0 (off). Without a `tolerance` the solve may end where EigenReport::angle is below this and, if
  /// it is only estimated, both residuals are below 1e-6. 0.01: nobody sees or measures more of a field.
  double angle_tolerance = 0.01;
  /// n where u stands for the n-th power of directions: angles are those of the directions, an n-th of those of u's
  /// phase. smoothest_field(), smoothest_modes() and eigen_design() set it to their n.
  int degree = 1;
  std::string solver = "auto";  // linear backend inside shift-invert; see linear_solvers()
  std::string method = "auto";  // eigensolver; see eigen_solvers(). Tiny problems are solved densely
  int max_iterations = 1000;    // operator applications before giving up
  std::uint64_t seed = 1;       // of the start vector
  /// A pair that turns out not to be the smallest is replaced by the smallest, which is then proven.
  Prove prove_smallest = Prove::automatic;
  /// As SolverOptions::cancel; asked before every step of a method, in the linear solves inside and in the proof.
  std::function<bool()> cancel = {};

  /// The relative residual that is enough in any case: `tolerance`, or 1e-8.
  [[nodiscard]] double residual_tolerance() const { return tolerance.value_or(1e-8); }
  /// Whether a small angle is enough as well.
  [[nodiscard]] bool by_angle() const { return !tolerance && angle_tolerance > 0; }
};

/// What an eigensolve did.
struct EigenReport {
  std::string solver;      ///< e.g. "shift-invert Lanczos, cholmod (amd)"
  bool converged = false;  ///< whether the tolerance was reached: by both residuals, or by the angle
  int iterations = 0;      ///< operator applications (linear solves)
  double lambda = 0;       ///< the eigenvalue; the smallest one as far as `smallest` says
  /// The second smallest eigenvalue, counted with multiplicity, to 1e-3 of max(next, 1/area): nothing where that is not
  /// established. It is wherever the smallest is proven and the second vector converged.
  std::optional<double> next;
  double residual = 0;  ///< |S u - lambda M u| / (max(lambda, 1/area) |M u|), recomputed
  /// r^H diag(S)^-1 r / max(lambda, 1e-6/area) with r = S u - lambda M u and |u|_M = 1, recomputed: to first order the
  /// part of lambda that is an error of single vertices. It knows no areas and no unit: every vertex is weighed by its
  /// own stiffness, where |r| sees little of vertices with small areas. With `lower_bound`, lambda itself is the other
  /// bound of the smallest eigenvalue, whatever the residuals.
  double energy_residual = 0;
  /// |S u - lambda M u| in the norm of the inverse of M, with |u|_M = 1, recomputed: some eigenvalue lies no further
  /// from lambda than this. At most a tenth too large, where M is within a factor of 100 of its diagonal (linear
  /// elements: within 2).
  double distance = 0;
  /// Degrees: how far u's phase may be from that of the true eigenvector, after both are turned to agree best, divided
  /// by EigenOptions::degree. The sine of the whole angle is distance / (next - lambda), which is no less than the root
  /// mean square of the sines of all angles, over the surface and weighted by |u|^2 (Davis and Kahan 1970). Where no
  /// `next` is known, or it lies within 1e-3 of max(lambda, 1/area) above lambda: the same to the nearest vector in the
  /// space of all eigenvectors whose eigenvalues lie so near to lambda, AngleCheck::of_many. Nothing where the bound is
  /// no bound.
  std::optional<double> angle;
  AngleCheck angle_check = AngleCheck::unknown;  ///< what the angle rests on
  /// Degrees, an estimate: the largest of these angles among the vertices where |u| is at least a tenth of its root
  /// mean square (nearer to zeros directions mean little): what `angle` allows everywhere, and what single vertices
  /// would still move by.
  std::optional<double> angle_at_vertices;
  Smallest smallest = Smallest::not_checked;  ///< what is known about lambda being the smallest
  /// Proven: no eigenvalue lies below this. At most 1e-6 of max(lambda, 1/area) below lambda, more where the tolerance
  /// or rounding ask for it.
  std::optional<double> lower_bound;
  std::string smallest_note;  ///< why it was not checked, or what the check led to; empty when all is said
  double seconds = 0;         ///< wall clock, the proof included
  double proof_seconds = 0;   ///< of these, for `smallest`
  std::string message;        ///< empty when all is well; says why when the tolerance was not reached
};

/// Whether the numbers of a report are what was asked for: both residuals within residual_tolerance(), or, where that
/// is enough, the angle within angle_tolerance. False for NaN.
[[nodiscard]] bool within_tolerance(const EigenReport& report, const EigenOptions& options);

/// An eigenvector and how it was found.
struct EigenResult {
  ComplexVectorX<double> u;  ///< |u|_M = 1, phase fixed: the entry of largest modulus region is positive real
  EigenReport report;        ///< how it was found
};

/// Names of the eigensolvers: those of the library, then those registered (backends.h).
[[nodiscard]] std::vector<std::string> eigen_solvers();

/// Smallest eigenpair of S u = lambda M u, S Hermitian positive semidefinite, M Hermitian positive definite.
/// `area` (the surface's) gives the scale of eigenvalues, so that lambda = 0 is judged sensibly. Within a multiple or
/// nearly multiple eigenvalue any vector is right. Non-convergence is reported; throws SolveError when memory runs out,
/// M is not positive definite or S is clearly indefinite, OptionError for bad options, Cancelled when asked to stop.
[[nodiscard]] EigenResult smallest_eigenpair(const SparseMatrix<std::complex<double>>& S,
                                             const SparseMatrix<std::complex<double>>& M, double area,
                                             const EigenOptions& options = {});

/// The k smallest eigenpairs, in ascending order.
struct EigenModes {
  MatrixX<std::complex<double>> U;  ///< #V x k, U^H M U = 1, phases as of EigenResult::u
  VectorX<double> lambda;           ///< eigenvalues, counted with multiplicity
  VectorX<double> residual;         ///< of each, as EigenReport::residual
  /// Eigenvalues that follow each other within 1e-6 of max(lambda, 1/area) have the same number, from 0: any vectors
  /// that span the space of a cluster are right.
  std::vector<int> cluster;
  std::string solver;      ///< as EigenReport::solver
  bool converged = false;  ///< every residual is within the tolerance
  int iterations = 0;      ///< linear solves; 0 for dense ones
  /// `proven`: as many eigenvalues as given lie below the last one, none is missing. `refuted`: some are.
  Smallest smallest = Smallest::not_checked;
  std::string message;  ///< empty when all is well
  double seconds = 0;   ///< wall clock
};

/// The `count` smallest eigenpairs, 1 <= count <= rows, with every method but those registered from outside: "dense",
/// "inverse-iteration" (subspace iteration), "lanczos", and "lobpcg", which stands for Lanczos with multigrid solves
/// here. Completeness is proven as EigenOptions::prove_smallest says, by counting; eigenvalues found missing are
/// searched for again. Errors as of smallest_eigenpair(); OptionError for a count out of range.
[[nodiscard]] EigenModes eigenpairs(const SparseMatrix<std::complex<double>>& S,
                                    const SparseMatrix<std::complex<double>>& M, double area, int count,
                                    const EigenOptions& options = {});

/// What inertia() counted.
struct Inertia {
  std::int64_t below = 0;  ///< eigenvalues below sigma, with multiplicity
  double sigma = 0;        ///< as asked for, or next to it: where a pivot vanished it was moved by 1e-12 of it at most
  /// 1 where S - sigma M is positive definite, more where entries grew. The count is that of a matrix whose entries
  /// differ by a few rounding units times this, relative to the roots of the diagonal entries of S + |sigma| M.
  double growth = 1;
  double flops = 0;    ///< of the factorisation
  double seconds = 0;  ///< wall clock
};

/// How many eigenvalues of S u = lambda M u lie below sigma, S Hermitian, M Hermitian positive definite: the negative
/// pivots of S - sigma M = L D L^H (Sylvester's law of inertia). The factor is not kept: memory is a small part of what
/// a direct solve takes. No pivoting: see Inertia::growth. Throws SolveError for matrices that do not fit each other or
/// when memory runs out, OptionError for a sigma that is not finite, Cancelled by a RunControl around it.
[[nodiscard]] Inertia inertia(const SparseMatrix<std::complex<double>>& S, const SparseMatrix<std::complex<double>>& M,
                              double sigma);

}  // namespace alcap
