// SPDX-License-Identifier: MIT
//
// A second proof that an eigenvalue is the smallest, by code that is not the library's: SLEPc's spectrum slicing, whose
// inertias come from PETSc's Cholesky factorisation, against inertia() and smallest_eigenpair(). PETSc does not
// factorise complex Hermitian matrices so, and of MUMPS there are no inertias of complex ones; so it sees the real
// form, in which every eigenvalue is there twice.
#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "alcap/generators.h"
#include "solvers/petsc/session.h"
#include "tests/solvers/solver_fixture.h"

using namespace alcap;
using namespace alcap::detail::petsc;

namespace {

/// [Re -Im; Im Re].
Hermitian real_form(const Hermitian& A) {
  const Index n = static_cast<Index>(A.rows());
  std::vector<Eigen::Triplet<C, Index>> entries;
  for (Index j = 0; j < n; ++j)
    for (Hermitian::InnerIterator it(A, j); it; ++it) {
      const auto i = static_cast<Index>(it.row());
      entries.emplace_back(i, j, it.value().real());
      entries.emplace_back(n + i, n + j, it.value().real());
      entries.emplace_back(i, n + j, -it.value().imag());
      entries.emplace_back(n + i, j, it.value().imag());
    }
  Hermitian out(2 * n, 2 * n);
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

struct Slice {
  std::vector<double> eigenvalues, shifts;
  std::vector<std::int64_t> below;  // each shift
};

/// All eigenvalues between two numbers.
Slice slice(const test::Problem& p, double from, double to) {
  const OwnedMat S = matrix(real_form(p.S)), M = matrix(real_form(p.M));
  for (Mat A : {S.get(), M.get()}) check(MatSetOption(A, MAT_SYMMETRIC, PETSC_TRUE));
  OwnedEps eps;
  ST transformation = nullptr;
  KSP ksp = nullptr;
  PC pc = nullptr;
  check(EPSCreate(PETSC_COMM_SELF, eps.out()));
  check(EPSSetOperators(eps.get(), S.get(), M.get()));
  check(EPSSetProblemType(eps.get(), EPS_GHEP));
  check(EPSSetType(eps.get(), EPSKRYLOVSCHUR));
  check(EPSSetWhichEigenpairs(eps.get(), EPS_ALL));
  check(EPSSetInterval(eps.get(), from, to));
  check(EPSGetST(eps.get(), &transformation));
  check(STSetType(transformation, STSINVERT));
  check(STGetKSP(transformation, &ksp));
  check(KSPSetType(ksp, KSPPREONLY));
  check(KSPGetPC(ksp, &pc));
  check(PCSetType(pc, PCCHOLESKY));
  check(PCFactorSetMatSolverType(pc, MATSOLVERPETSC));
  check(EPSSolve(eps.get()));
  Slice out;
  PetscInt count = 0;
  check(EPSGetConverged(eps.get(), &count));
  for (PetscInt k = 0; k < count; ++k) {
    PetscScalar lambda = 0;
    check(EPSGetEigenvalue(eps.get(), k, &lambda, nullptr));
    out.eigenvalues.push_back(PetscRealPart(lambda));
  }
  PetscReal* shifts = nullptr;
  PetscInt* inertias = nullptr;
  check(EPSKrylovSchurGetInertias(eps.get(), &count, &shifts, &inertias));
  out.shifts.assign(shifts, shifts + count);
  out.below.assign(inertias, inertias + count);
  check(PetscFree(shifts));
  check(PetscFree(inertias));
  std::sort(out.eigenvalues.begin(), out.eigenvalues.end());
  return out;
}

}  // namespace

TEST_CASE("spectrum slicing finds the eigenvalue that is proven to be the smallest, and nothing below") {
  for (const MeshData& data :
       {noisy_scan(3, 0.2, 5), bumpy_sphere(2, 0.3, 4), torus_random_diagonals(20, 12, 1, 0.4, 2)})
    for (const int n : {1, 4}) {
      CAPTURE(n);
      const test::Problem p = test::problem_of(data, n);
      const EigenModes modes = eigenpairs(p.S, p.M, p.area, 6);
      const EigenResult smallest = smallest_eigenpair(p.S, p.M, p.area);
      REQUIRE(smallest.report.smallest == Smallest::proven);
      REQUIRE(modes.lambda.size() == 6);
      // Below everything, to between two that are apart.
      Eigen::Index last = 4;
      while (last > 0 && modes.lambda[last + 1] - modes.lambda[last] < 1e-4 * modes.lambda[last + 1]) --last;
      const double unit = 1 / p.area, to = (modes.lambda[last] + modes.lambda[last + 1]) / 2;
      const Session session;
      const Slice found = slice(p, -unit, to);
      REQUIRE(found.eigenvalues.size() == static_cast<std::size_t>(2 * (last + 1)));
      for (Eigen::Index k = 0; k <= last; ++k)
        for (const std::size_t twin : {0, 1})
          CHECK(std::abs(found.eigenvalues[static_cast<std::size_t>(2 * k) + twin] - modes.lambda[k]) <=
                1e-6 * std::max(unit, modes.lambda[k]));
      CHECK(std::abs(found.eigenvalues[0] - smallest.report.lambda) <= 1e-6 * std::max(unit, smallest.report.lambda));
      REQUIRE(found.shifts.size() >= 2);
      for (std::size_t k = 0; k < found.shifts.size(); ++k) {
        CAPTURE(found.shifts[k]);
        CHECK(found.below[k] == 2 * inertia(p.S, p.M, found.shifts[k]).below);
      }
    }
}
