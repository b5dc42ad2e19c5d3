// SPDX-License-Identifier: MIT
//
// session.h: PETSc for the time of a call: initialised, locked, silent. And its objects as values that clean up.
// Internal to solvers/petsc/.
#pragma once

#include <petscksp.h>
#include <slepceps.h>

#include <complex>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "alcap/solve.h"

#ifndef PETSC_USE_COMPLEX
#error "alcap needs a complex build of PETSc"
#endif

namespace alcap::detail::petsc {

using C = std::complex<double>;
using Hermitian = SparseMatrix<C>;
using Vector = ComplexVectorX<double>;
static_assert(sizeof(PetscInt) == sizeof(Index) && sizeof(PetscScalar) == sizeof(C));

/// Every call to PETSc is made while one of these is alive. Calls take turns; a thread may hold several (a PCSHELL that
/// solves by PETSc). Meanwhile errors are kept, not printed.
class Session {
 public:
  /// Initialises PETSc and SLEPc where nobody did. Throws SolveError where that fails, or they are finalised already.
  Session();
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

 private:
  std::unique_lock<std::recursive_mutex> lock_;
};

/// Throws SolveError with PETSc's message when `code` is an error.
void check(PetscErrorCode code);
/// After a code that is not checked because something else is tried: the next error has its own message.
void forget_error();

/// An object of PETSc. Destroyed under a session, and left alone once PETSc is finalised.
template <class Handle, PetscErrorCode (*destroy)(Handle*)>
class Owned {
 public:
  Owned() = default;
  Owned(Owned&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
  Owned& operator=(Owned&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~Owned() { reset(); }
  void reset() {
    PetscBool over = PETSC_FALSE;
    if (handle_ == nullptr || PetscFinalized(&over) != 0 || over == PETSC_TRUE) return;
    const Session session;
    (void)destroy(&handle_);
    handle_ = nullptr;
  }
  [[nodiscard]] Handle get() const { return handle_; }
  [[nodiscard]] Handle* out() { return &handle_; }
  [[nodiscard]] explicit operator bool() const { return handle_ != nullptr; }

 private:
  Handle handle_ = nullptr;
};
using OwnedMat = Owned<Mat, MatDestroy>;
using OwnedVec = Owned<Vec, VecDestroy>;
using OwnedKsp = Owned<KSP, KSPDestroy>;
using OwnedEps = Owned<EPS, EPSDestroy>;
using OwnedOptions = Owned<::PetscOptions, PetscOptionsDestroy>;

/// A copy of A as a sequential AIJ matrix, marked Hermitian.
[[nodiscard]] OwnedMat matrix(const Hermitian& A);
/// A vector over somebody's array, which must outlive it.
[[nodiscard]] OwnedVec wrapped(const C* data, Eigen::Index size);

/// Exceptions must not pass through PETSc: kept here, thrown again afterwards.
class Escape {
 public:
  /// body(), and what PETSc is told.
  template <class Body>
  PetscErrorCode run(Body&& body) noexcept {
    try {
      body();
      return 0;
    } catch (...) {
      if (!caught_) caught_ = std::current_exception();
      return PETSC_ERR_USER;
    }
  }
  /// Throws what was caught; what PETSc says of it is a consequence.
  void rethrow() {
    if (caught_) std::rethrow_exception(std::exchange(caught_, nullptr));
  }
  [[nodiscard]] bool caught() const { return caught_ != nullptr; }

 private:
  std::exception_ptr caught_;
};

/// L U by MUMPS, or plain aggregation multigrid.
void use_mumps(KSP ksp);
void use_gamg(KSP ksp);

/// Makes KSP ask `cancel` in every iteration. Both must outlive `ksp`.
void ask_in_iterations(KSP ksp, const std::function<bool()>& cancel, Escape& escape);

/// The linear backends. `options`: for "petsc".
enum class Kind { cg_gamg, mumps, options };
[[nodiscard]] std::unique_ptr<LinearSolver<C>> make_solver(Kind kind, std::string name, std::string options,
                                                           const SolverOptions& solver_options);

}  // namespace alcap::detail::petsc
