// SPDX-License-Identifier: MIT
//
// MatLoad() reads what write_matrix() writes: a product with the matrix is the same.
#include <doctest/doctest.h>

#include "alcap/generators.h"
#include "alcap/matrix_file.h"
#include "solvers/petsc/session.h"
#include "tests/solvers/solver_fixture.h"
#include "tests/support/folder.h"

using namespace alcap;
using namespace alcap::detail::petsc;

TEST_CASE("PETSc loads an exported matrix") {
  const test::Problem p = test::problem_of(bumpy_sphere(2, 0.3, 5), 2);
  const test::Folder folder;
  write_matrix(folder.path / "S.petsc", p.S, MatrixFormat::petsc);
  const Session session;
  OwnedMat S;
  PetscViewer viewer = nullptr;
  check(PetscViewerBinaryOpen(PETSC_COMM_SELF, (folder.path / "S.petsc").c_str(), FILE_MODE_READ, &viewer));
  check(MatCreate(PETSC_COMM_SELF, S.out()));
  check(MatSetType(S.get(), MATSEQAIJ));
  check(MatLoad(S.get(), viewer));
  check(PetscViewerDestroy(&viewer));
  const Vector x = test::random_dense(p.S.rows(), 1, 1).col(0);
  Vector y(x.size());
  const OwnedVec from = wrapped(x.data(), x.size()), to = wrapped(y.data(), y.size());
  check(MatMult(S.get(), from.get(), to.get()));
  const Vector expected = p.S * x;
  CHECK((y - expected).norm() <= 1e-14 * expected.norm());
  PetscBool hermitian = PETSC_FALSE;
  check(MatIsHermitian(S.get(), 1e-12, &hermitian));
  CHECK(hermitian == PETSC_TRUE);
}
