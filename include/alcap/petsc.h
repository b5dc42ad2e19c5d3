// SPDX-License-Identifier: MIT
//
// petsc.h: PETSc's linear solvers and SLEPc's eigensolvers as backends, in one process. Only where alcap was built with
// -DALCAP_WITH_PETSC=ON (complex builds of PETSc and SLEPc 3.18 or later); link alcap::petsc besides alcap::alcap.
//
//   const auto petsc = alcap::register_petsc_backends();  // in main(): they are known as long as this lives
//   const alcap::FieldRun a = alcap::run_field(V, F, {.n = 4, .eigen = {.method = "slepc-lobpcg"}});
//   const alcap::FieldRun b = alcap::run_field(V, F, {.n = 4, .eigen = {.solver = "petsc-mumps"}});
//
// Linear backends (SolverOptions::name):
// - petsc-cg-gamg: conjugate gradients, preconditioned by PETSc's aggregation multigrid with its defaults.
// - petsc-mumps: a sparse L U factorisation by MUMPS. Not L L^H: MUMPS has none for complex Hermitian matrices. So it
//   takes twice the memory, and an indefinite matrix is only noticed when a solution x has x^H b < 0.
// - petsc: whatever PETSc's options say; conjugate gradients with an incomplete factorisation unless they do.
//
// Eigensolvers (EigenOptions::method), each with what EigenOptions::solver names:
// - slepc-krylovschur: shift-invert; the solver solves its systems ("auto": petsc-mumps).
// - slepc-lobpcg, slepc-gd, slepc-jd: preconditioned; one iteration of the solver is the preconditioner ("auto": the
//   library's own "multigrid").
// "petsc-mumps" and "petsc-cg-gamg" are then PETSc's own objects, every other name becomes a PCSHELL. Up to 48 rows
// the library's dense solver does the work.
//
// PETSc measures residuals in its own ways. Here each solve goes on with a tighter tolerance until the true residual,
// recomputed by the library, is what was asked for, or nothing is gained any more.
//
// What happens to PETSc and MPI: nothing before the first solver is made. Then, unless the program did it before, PETSc
// and SLEPc are initialised, without signal handlers and configuration files, and finalised when the program ends. MPI
// is initialised by PETSc unless the program did (then for at least MPI_THREAD_SERIALIZED if several threads solve).
// Everything runs on PETSC_COMM_SELF. Errors of PETSc become SolveError and print nothing; a handler of the program's
// own is back in its place after every call. PETSc is not safe for threads: the calls of all these backends take
// turns, and a program that uses PETSc itself must not do so on another thread meanwhile.
#pragma once

#include <string>
#include <vector>

#include "alcap/backends.h"

namespace alcap {

/// Registers the backends above. `options` are PETSc's for "petsc", such as "-ksp_type cg -pc_type sor"; when empty,
/// those of PETSc's own database that begin with "alcap_" (PETSC_OPTIONS="-alcap_pc_type sor"). Throws OptionError when
/// a name is taken already.
[[nodiscard]] std::vector<BackendRegistration> register_petsc_backends(const std::string& options = "");

/// One more linear backend by PETSc, under a name and with PETSc options of your own. Throws OptionError as
/// register_linear_solver(); bad options are a SolveError of the first factorisation.
BackendRegistration register_petsc_solver(const std::string& name, const std::string& options);

}  // namespace alcap
