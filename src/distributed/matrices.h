// SPDX-License-Identifier: MIT
//
// matrices.h: S and M over all ranks. Internal to src/distributed.
#pragma once

#include <complex>
#include <vector>

#include "src/distributed/components.h"

namespace alcap::detail::distributed {

using C = std::complex<double>;

struct Matrices {
  petsc::OwnedMat S, M;
};

/// S of E_s and M of the patch's owned vertices, one row each (MPIAIJ).
[[nodiscard]] Matrices assemble(const Patch& patch, const Connection& connection, int n, double s);

/// The Laplacian of grounded_laplacian.h over the patch's owned vertices: the vertices with held[v] != 0 (per inner
/// vertex), and those that no face uses, have rows of the identity; where a component has none held, its first is tied
/// to the ground.
[[nodiscard]] petsc::OwnedMat assemble_laplacian(const Patch& patch, const Components& components,
                                                 const std::vector<char>& held);

/// The rows that `wanted` names, and the columns of the same numbers.
[[nodiscard]] petsc::OwnedMat principal_part(const petsc::OwnedMat& A, const std::vector<PetscInt>& rows);

/// Where rows of a matrix, or columns of a square one, are owned.
[[nodiscard]] std::vector<Node> nodes_of_rows(Mat A, const std::vector<PetscInt>& rows);

/// This rank's rows as arrays of PETSc's: entries whose columns are its own, the rest, and the columns of those.
struct LocalRows {
  explicit LocalRows(Mat A);
  struct Part {
    const PetscInt* start = nullptr;
    const PetscInt* column = nullptr;
    const PetscScalar* value = nullptr;
  };
  Part own, other;
  const PetscInt* other_column = nullptr;  ///< column of the whole matrix for each column of `other`
  PetscInt rows = 0, first = 0, others = 0;
};

}  // namespace alcap::detail::distributed
