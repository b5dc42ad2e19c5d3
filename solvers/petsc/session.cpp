// SPDX-License-Identifier: MIT
//
// session.cpp: PETSc initialised once and silent, matrices and vectors across.
#include "solvers/petsc/session.h"

#include <memory>
#include <vector>

#include "solvers/linear/backends.h"
#include "src/base/cancel.h"

namespace alcap::detail::petsc {
namespace {

/// All calls take turns: PETSc keeps its state in globals.
std::recursive_mutex& turn() {
  static std::recursive_mutex mutex;
  return mutex;
}

/// What the error handler heard first; guarded by turn().
std::string& first_message() {
  static std::string message;
  return message;
}

PetscErrorCode keep_message(MPI_Comm, int, const char*, const char*, PetscErrorCode code, PetscErrorType,
                            const char* message, void*) {
  if (first_message().empty() && message != nullptr) first_message() = message;
  return code;
}

/// Made by the first session, so that it ends with the program.
class Runtime {
 public:
  Runtime() {
    PetscBool there = PETSC_FALSE;
    if (SlepcInitialized(&there) == 0 && there == PETSC_TRUE) return;
    PetscBool petsc = PETSC_FALSE;
    if (PetscInitialized(&petsc) != 0) petsc = PETSC_FALSE;
    if (petsc == PETSC_FALSE) {
      PETSC_MPI_THREAD_REQUIRED = MPI_THREAD_SERIALIZED;
      for (const char* option : {"-no_signal_handler", "-skip_petscrc"})
        if (PetscOptionsSetValue(nullptr, option, nullptr) != 0) throw SolveError("PETSc cannot be initialised");
    }
    if (SlepcInitialize(nullptr, nullptr, nullptr, nullptr) != 0) throw SolveError("SLEPc cannot be initialised");
    mine_ = true;
  }
  Runtime(const Runtime&) = delete;
  Runtime& operator=(const Runtime&) = delete;
  /// Finalises PETSc as well where SLEPc initialised it.
  ~Runtime() {
    PetscBool over = PETSC_FALSE;
    if (mine_ && PetscFinalized(&over) == 0 && over == PETSC_FALSE) (void)SlepcFinalize();
  }

 private:
  bool mine_ = false;
};

}  // namespace

Session::Session() : lock_(turn()) {
  PetscBool over = PETSC_FALSE;
  if (PetscFinalized(&over) == 0 && over == PETSC_TRUE) throw SolveError("PETSc is finalised already");
  static const Runtime runtime;
  if (PetscPushErrorHandler(keep_message, nullptr) != 0) throw SolveError("PETSc takes no error handler");
}

Session::~Session() { (void)PetscPopErrorHandler(); }

void check(PetscErrorCode code) {
  if (code == 0) return;
  std::string message = std::exchange(first_message(), "");
  if (message.empty()) {
    const char* text = nullptr;
    if (PetscErrorMessage(code, &text, nullptr) == 0 && text != nullptr) message = text;
  }
  throw SolveError(code == PETSC_ERR_MEM ? std::string("PETSc: out of memory") + more_memory : "PETSc: " + message);
}

void forget_error() { first_message().clear(); }

OwnedMat matrix(const Hermitian& A) {
  if (!A.isCompressed()) {
    Hermitian compressed = A;
    compressed.makeCompressed();
    return matrix(compressed);
  }
  OwnedMat result;
  const auto rows = static_cast<PetscInt>(A.rows());
  // By rows: the columns of a Hermitian matrix, conjugate.
  std::vector<PetscInt> counts(static_cast<std::size_t>(rows));
  for (PetscInt i = 0; i < rows; ++i)
    counts[static_cast<std::size_t>(i)] = A.outerIndexPtr()[i + 1] - A.outerIndexPtr()[i];
  check(MatCreateSeqAIJ(PETSC_COMM_SELF, rows, rows, 0, counts.data(), result.out()));
  std::vector<PetscScalar> values;
  for (PetscInt i = 0; i < rows; ++i) {
    const Index begin = A.outerIndexPtr()[i];
    const PetscInt count = counts[static_cast<std::size_t>(i)];
    values.resize(static_cast<std::size_t>(count));
    for (PetscInt k = 0; k < count; ++k) values[static_cast<std::size_t>(k)] = std::conj(A.valuePtr()[begin + k]);
    check(MatSetValues(result.get(), 1, &i, count, A.innerIndexPtr() + begin, values.data(), INSERT_VALUES));
  }
  check(MatAssemblyBegin(result.get(), MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(result.get(), MAT_FINAL_ASSEMBLY));
  check(MatSetOption(result.get(), MAT_HERMITIAN, PETSC_TRUE));
  return result;
}

OwnedVec wrapped(const C* data, Eigen::Index size) {
  OwnedVec result;
  check(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, static_cast<PetscInt>(size), data, result.out()));
  return result;
}

void use_mumps(KSP ksp) {
  PC pc = nullptr;
  check(KSPSetType(ksp, KSPPREONLY));
  check(KSPGetPC(ksp, &pc));
  check(PCSetType(pc, PCLU));
  check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
}

void use_gamg(KSP ksp) {
  PC pc = nullptr;
  check(KSPGetPC(ksp, &pc));
  check(PCSetType(pc, PCGAMG));
  // Plain aggregation. Smoothed prolongations P are complex, and PETSc's coarse matrices are P^T A P, not P^H A P: no
  // longer Hermitian, and conjugate gradients stand still.
  check(PCGAMGSetNSmooths(pc, 0));
}

namespace {

struct Asked {
  const std::function<bool()>& cancel;
  Escape& escape;
  void* standard = nullptr;
};

PetscErrorCode ask_and_test(KSP ksp, PetscInt iteration, PetscReal norm, KSPConvergedReason* reason, void* context) {
  auto& asked = *static_cast<Asked*>(context);
  if (asked.escape.run([&] { check_cancelled(asked.cancel); }) != 0) {
    *reason = KSP_DIVERGED_BREAKDOWN;  // ends the loop in good order; the exception is thrown again outside
    return 0;
  }
  return KSPConvergedDefault(ksp, iteration, norm, reason, asked.standard);
}

PetscErrorCode forget(void* context) {
  const std::unique_ptr<Asked> asked(static_cast<Asked*>(context));
  return KSPConvergedDefaultDestroy(asked->standard);
}

}  // namespace

void ask_in_iterations(KSP ksp, const std::function<bool()>& cancel, Escape& escape) {
  auto asked = std::make_unique<Asked>(Asked{cancel, escape});
  check(KSPConvergedDefaultCreate(&asked->standard));
  check(KSPSetConvergenceTest(ksp, ask_and_test, asked.release(), forget));
}

}  // namespace alcap::detail::petsc
