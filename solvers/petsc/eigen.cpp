// SPDX-License-Identifier: MIT
//
// eigen.cpp: the smallest eigenpair by SLEPc's EPS, on tightened tolerances until the residual that the library
// recomputes is met.
#include "solvers/petsc/eigen.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "solvers/eigenpair/problem.h"
#include "solvers/linear/backends.h"
#include "solvers/petsc/session.h"

namespace alcap::detail::petsc {
namespace {

/// S - sigma M is positive definite even where S is singular or indefinite by rounding; sigma is far below the first
/// eigenvalue's scale.
constexpr double relative_shift = 1e-3;
/// Inner systems are solved so much better than the eigenvector is asked for.
constexpr double inner_tolerance = 0.01;
constexpr double least_tolerance = 1e-13;
/// So many rounds at most, each at least this much tighter; one that gains nothing is the last.
constexpr int most_rounds = 8;
constexpr double tighter = 0.1, least_tightening = 1e-4;
constexpr double no_gain = 0.9;
/// LOBPCG computes a few neighbours as well: within a cluster one vector alone hardly moves.
constexpr PetscInt lobpcg_block = 6;

const char* type_of(Method method) {
  switch (method) {
    case Method::lobpcg:
      return EPSLOBPCG;
    case Method::gd:
      return EPSGD;
    case Method::jd:
      return EPSJD;
    default:
      return EPSKRYLOVSCHUR;
  }
}

class Run {
 public:
  Run(Method method, const EigenProblem& problem, const EigenOptions& options)
      : method_(method),
        problem_(problem),
        options_(options),
        inner_(options.solver != "auto" ? options.solver
               : inverts()              ? "petsc-mumps"
                                        : "multigrid"),
        sigma_(-relative_shift / problem.area),
        typical_(std::sqrt(problem.M.diagonal().real().mean())) {}

  EigenResult operator()() {
    const Session session;
    EigenResult result;
    result.u = start_vector(problem_.S.rows(), options_.seed);
    S_ = matrix(problem_.S);
    M_ = matrix(problem_.M);
    create();
    rounds(result);
    result.report.solver = std::string("SLEPc ") + type_of(method_) + ", " + inner_;
    return result;
  }

 private:
  [[nodiscard]] bool inverts() const { return method_ == Method::krylovschur; }

  void rounds(EigenResult& result) {
    double tolerance = options_.residual_tolerance();
    double best = HUGE_VAL;
    Vector Su, Mu;
    for (int round = 0; round < most_rounds; ++round) {
      Vector u = result.u;
      const bool finished = solve(u, tolerance, result.report);
      if (!u.allFinite() || !(u.squaredNorm() > 0)) break;
      const PairCheck now = check_pair(problem_, u, Su, Mu);
      const double residual = std::max(now.residual, now.energy);  // both are asked for
      const bool gained = residual < no_gain * best;
      if (residual < best) {
        best = residual;
        result.u = u;
      }
      if (best <= options_.residual_tolerance() || !gained || !finished || used_ >= options_.max_iterations) break;
      tolerance *= std::clamp(tighter * options_.residual_tolerance() / best, least_tightening, tighter);
    }
  }

  void create() {
    check(EPSCreate(PETSC_COMM_SELF, eps_.out()));
    EPS eps = eps_.get();
    check(EPSSetOperators(eps, S_.get(), M_.get()));
    check(EPSSetProblemType(eps, EPS_GHEP));
    check(EPSSetType(eps, type_of(method_)));
    check(EPSSetDimensions(eps, 1, PETSC_DEFAULT, PETSC_DEFAULT));
    if (inverts()) {
      check(EPSSetWhichEigenpairs(eps, EPS_TARGET_MAGNITUDE));
      check(EPSSetTarget(eps, sigma_));
    } else {
      check(EPSSetWhichEigenpairs(eps, EPS_SMALLEST_REAL));
    }
    if (method_ == Method::lobpcg)
      check(EPSLOBPCGSetBlockSize(eps, std::min(lobpcg_block, static_cast<PetscInt>(problem_.S.rows() / 5))));
    check(EPSSetConvergenceTestFunction(eps, measure, this, nullptr));
    check(EPSSetStoppingTestFunction(eps, ask_and_stop, this, nullptr));
    precondition();
  }

  void precondition() {
    ST st = nullptr;
    KSP ksp = nullptr;
    check(EPSGetST(eps_.get(), &st));
    const bool gamg = inner_ == "petsc-cg-gamg";
    if (inverts()) {
      check(STSetType(st, STSINVERT));
      check(STSetMatStructure(st, problem_.transport ? SAME_NONZERO_PATTERN : UNKNOWN_NONZERO_PATTERN));
    } else {
      check(STSetType(st, STPRECOND));
      A_ = shifted(problem_, sigma_);
      preconditioned_ = matrix(A_);
      check(STSetPreconditionerMat(st, preconditioned_.get()));
    }
    check(STGetKSP(st, &ksp));
    if (inverts()) {
      check(KSPSetType(ksp, gamg ? KSPCG : KSPPREONLY));
      check(KSPSetTolerances(ksp, inner(), PETSC_DEFAULT, PETSC_DEFAULT, options_.max_iterations));
      ask_in_iterations(ksp, options_.cancel, escape_);
      check(KSPSetPreSolve(ksp, ask_before_solve, this));
    }
    if (gamg) {
      use_gamg(ksp);
    } else if (inner_ == "petsc-mumps") {
      if (inverts() || method_ != Method::jd) {
        use_mumps(ksp);
      } else {
        PC pc = nullptr;  // JD keeps its own Krylov method
        check(KSPGetPC(ksp, &pc));
        check(PCSetType(pc, PCLU));
        check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
      }
    } else {
      use_shell(ksp);
    }
  }

  [[nodiscard]] double inner() const {
    return std::max(inner_tolerance * options_.residual_tolerance(), least_tolerance);
  }

  /// A linear backend of the library as PETSc's preconditioner: a whole solve to invert, else one iteration.
  void use_shell(KSP ksp) {
    if (A_.rows() == 0) A_ = shifted(problem_, sigma_);
    shell_ = make_linear_solver<C>({.name = inner_,
                                    .tolerance = inner(),
                                    .max_iterations = inverts() ? options_.max_iterations : 1,
                                    .cancel = options_.cancel});
    if (problem_.transport != nullptr) shell_->set_transport(*problem_.transport);
    shell_->analyse(A_);
    shell_->factorise(A_);
    PC pc = nullptr;
    check(KSPGetPC(ksp, &pc));
    check(PCSetType(pc, PCSHELL));
    check(PCShellSetContext(pc, this));
    check(PCShellSetApply(pc, apply_shell));
  }

  /// A method is interrupted between two solves as well: it may not stop before a few dozen.
  static PetscErrorCode ask_before_solve(KSP, Vec, Vec, void* context) {
    auto& run = *static_cast<Run*>(context);
    return run.escape_.run([&] { check_cancelled(run.options_.cancel); });
  }

  static PetscErrorCode apply_shell(PC pc, Vec from, Vec to) {
    void* context = nullptr;
    const PetscScalar* r = nullptr;
    PetscScalar* z = nullptr;
    PetscErrorCode code = PCShellGetContext(pc, &context);
    if (code == 0) code = VecGetArrayRead(from, &r);
    if (code == 0) code = VecGetArray(to, &z);
    if (code != 0) return code;
    auto& run = *static_cast<Run*>(context);
    const PetscErrorCode solved = run.escape_.run([&] {
      const Eigen::Index n = run.A_.rows();
      MatrixX<C> x(n, 1);
      (void)run.shell_->solve(Eigen::Map<const MatrixX<C>>(r, n, 1), x);
      Eigen::Map<MatrixX<C>>(z, n, 1) = x;
    });
    code = VecRestoreArrayRead(from, &r);
    if (code == 0) code = VecRestoreArray(to, &z);
    return solved != 0 ? solved : code;
  }

  /// What SLEPc compares with its tolerance: the library's residual, as far as it can be told from |S x - lambda M x|
  /// at |x|_M = 1. Shift-invert knows that of the inverse: relative to its eigenvalue, then.
  static PetscErrorCode measure(EPS, PetscScalar value, PetscScalar, PetscReal residual, PetscReal* estimate,
                                void* context) {
    const auto& run = *static_cast<const Run*>(context);
    const double lambda = value.real();
    *estimate = run.inverts() ? residual * std::abs(lambda - run.sigma_)
                              : residual / (std::max(lambda, 1 / run.problem_.area) * run.typical_);
    return 0;
  }

  static PetscErrorCode ask_and_stop(EPS eps, PetscInt iterations, PetscInt most, PetscInt converged, PetscInt wanted,
                                     EPSConvergedReason* reason, void* context) {
    auto& run = *static_cast<Run*>(context);
    if (run.escape_.run([&] { check_cancelled(run.options_.cancel); }) != 0) {
      *reason = EPS_DIVERGED_BREAKDOWN;
      return 0;
    }
    return EPSStoppingBasic(eps, iterations, most, converged, wanted, reason, nullptr);
  }

  static constexpr int most_breakdowns = 5;

  /// From u and into u; whether SLEPc says that it converged.
  bool solve(Vector& u, double tolerance, EigenReport& report) {
    EPS eps = eps_.get();
    {
      const OwnedVec start = wrapped(u.data(), u.size());
      Vec space = start.get();
      check(EPSSetTolerances(eps, std::max(tolerance, 1e-16), std::max(1, options_.max_iterations - used_)));
      // Where the directions of a block lose their rank, LOBPCG ends with an error of LAPACK. It begins again, and what
      // it adds to the start at random is different then.
      for (int breakdowns = 0;; ++breakdowns) {
        check(EPSSetInitialSpace(eps, 1, &space));
        const PetscErrorCode code = EPSSolve(eps);
        escape_.rethrow();
        if (code == PETSC_ERR_LIB && method_ == Method::lobpcg && breakdowns < most_breakdowns) {
          forget_error();
          continue;
        }
        check(code);
        break;
      }
    }
    PetscInt iterations = 0;
    PetscInt converged = 0;
    check(EPSGetIterationNumber(eps, &iterations));
    check(EPSGetConverged(eps, &converged));
    used_ += static_cast<int>(iterations);
    report.iterations = used_;
    const OwnedVec best = wrapped(u.data(), u.size());
    if (converged > 0) {
      check(EPSGetEigenvector(eps, 0, best.get(), nullptr));
    } else {
      BV basis = nullptr;
      check(EPSGetBV(eps, &basis));
      check(BVCopyVec(basis, 0, best.get()));
    }
    if (converged > 1) {
      PetscScalar next = 0;
      check(EPSGetEigenvalue(eps, 1, &next, nullptr));
      report.next = next.real();
    }
    return converged > 0;
  }

  Method method_;
  const EigenProblem& problem_;
  const EigenOptions& options_;
  std::string inner_;
  double sigma_;
  double typical_;  ///< |M x| at |x|_M = 1, about
  int used_ = 0;
  Escape escape_;
  Hermitian A_;
  std::unique_ptr<LinearSolver<C>> shell_;
  OwnedMat S_, M_, preconditioned_;
  OwnedEps eps_;
};

}  // namespace

EigenResult smallest(Method method, const EigenProblem& problem, const EigenOptions& options) {
  if (problem.S.rows() <= dense_eigen_rows) return smallest_dense(problem, options);
  return Run(method, problem, options)();
}

}  // namespace alcap::detail::petsc
