// SPDX-License-Identifier: MIT
#include "src/distributed/matrices.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "alcap/energies.h"
#include "src/base/array.h"
#include "src/connection/grounded_laplacian.h"

namespace alcap::detail::distributed {
namespace {

petsc::OwnedMat from_patch(const Patch& patch, const SparseMatrix<C>& A) {
  std::vector<PetscInt> start{0}, column;
  std::vector<PetscScalar> value;
  std::vector<std::pair<PetscInt, C>> row;
  for (Index v = 0; v < patch.owned; ++v) {
    row.clear();
    if (A.rows() == 0) {  // no face here
      row.emplace_back(patch.row[at(v)], 0);
    } else {
      for (Index e = A.outerIndexPtr()[v]; e < A.outerIndexPtr()[v + 1]; ++e)
        row.emplace_back(patch.row[at(A.innerIndexPtr()[e])], std::conj(A.valuePtr()[e]));
    }
    std::ranges::sort(row, {}, &std::pair<PetscInt, C>::first);
    for (const auto& [j, a] : row) {
      column.push_back(j);
      value.push_back(a);
    }
    start.push_back(static_cast<PetscInt>(column.size()));
  }
  petsc::OwnedMat result;
  check(MatCreateMPIAIJWithArrays(PETSC_COMM_WORLD, patch.owned, patch.owned, PETSC_DETERMINE, PETSC_DETERMINE,
                                  start.data(), column.data(), value.data(), result.out()));
  check(MatSetOption(result.get(), MAT_HERMITIAN, PETSC_TRUE));
  return result;
}

}  // namespace

Matrices assemble(const Patch& patch, const Connection& connection, int n, double s) {
  StiffnessMass local;
  agreed([&] {
    if (patch.empty()) return;
    local = energy_matrices(patch.mesh, patch.geometry, connection, n, s);
  });
  Matrices out;
  out.S = from_patch(patch, local.S);
  out.M = from_patch(patch, local.M);
  return out;
}

petsc::OwnedMat assemble_laplacian(const Patch& patch, const Components& components, const std::vector<char>& held) {
  const Mesh& mesh = patch.mesh;
  const auto component = [&](Index v) { return at(components.of_vertex[at(v)]); };
  const std::size_t size = components.list.size();
  std::vector<double> most(2 * size, -HUGE_VAL);  // whether any is held, and minus the first vertex, of each component
  for (Index v = 0; v < patch.owned; ++v) {
    if (components.of_vertex[at(v)] == none) continue;
    double &any_held = most[component(v)], &first = most[size + component(v)];
    any_held = std::max(any_held, held[at(v)] != 0 ? 1.0 : 0.0);
    first = std::max(first, -static_cast<double>(patch.vertex[at(v)]));
  }
  largest_all(most);
  std::vector<Eigen::Triplet<C, Index>> entries;
  const auto fixed = [&](Index v) { return v >= patch.inner || held[at(v)] != 0; };
  for (Index e = 0; e < mesh.edges(); ++e) {
    const Index h = mesh.halfedge(e), i = mesh.tail(h), j = mesh.tip(h);
    const double w = raised_weight(mesh, patch.geometry, e);
    if (!fixed(i)) entries.emplace_back(i, i, w);
    if (!fixed(j)) entries.emplace_back(j, j, w);
    if (fixed(i) || fixed(j)) continue;
    entries.emplace_back(i, j, -w);
    entries.emplace_back(j, i, -w);
  }
  for (Index v = 0; v < patch.owned; ++v) {
    const bool used = components.of_vertex[at(v)] != none;
    const bool tied = used && most[component(v)] == 0 && most[size + component(v)] == -double(patch.vertex[at(v)]);
    if (!used || held[at(v)] != 0 || tied) entries.emplace_back(v, v, 1);
  }
  const auto rows = count_of(patch.vertex);
  SparseMatrix<C> L(rows, rows);
  L.setFromTriplets(entries.begin(), entries.end());
  return from_patch(patch, L);
}

petsc::OwnedMat principal_part(const petsc::OwnedMat& A, const std::vector<PetscInt>& rows) {
  petsc::Owned<IS, ISDestroy> which;
  petsc::OwnedMat part;
  check(ISCreateGeneral(PETSC_COMM_WORLD, static_cast<PetscInt>(rows.size()), rows.data(), PETSC_COPY_VALUES,
                        which.out()));
  check(MatCreateSubMatrix(A.get(), which.get(), which.get(), MAT_INITIAL_MATRIX, part.out()));
  check(MatSetOption(part.get(), MAT_HERMITIAN, PETSC_TRUE));
  return part;
}

std::vector<Node> nodes_of_rows(Mat A, const std::vector<PetscInt>& rows) {
  const PetscInt* range = nullptr;
  check(MatGetOwnershipRanges(A, &range));
  std::vector<Node> nodes;
  nodes.reserve(rows.size());
  const int all = ranks();
  for (const PetscInt row : rows) {
    const auto owner = static_cast<int>(std::upper_bound(range, range + all + 1, row) - range) - 1;
    nodes.push_back({owner, row - range[owner]});
  }
  return nodes;
}

LocalRows::LocalRows(Mat A) {
  Mat diagonal = nullptr, off = nullptr;
  PetscBool done = PETSC_FALSE;
  check(MatMPIAIJGetSeqAIJ(A, &diagonal, &off, &other_column));
  check(MatGetOwnershipRange(A, &first, nullptr));
  PetscInt n = 0;
  check(MatGetLocalSize(off, &n, &others));
  const auto read = [&](Mat part, Part& out) {
    check(MatGetRowIJ(part, 0, PETSC_FALSE, PETSC_FALSE, &rows, &out.start, &out.column, &done));
    check(MatSeqAIJGetArrayRead(part, &out.value));
    // Pointers to the matrix's own arrays, which stay.
    const PetscScalar* value = out.value;
    check(MatSeqAIJRestoreArrayRead(part, &value));
  };
  read(diagonal, own);
  read(off, other);
}

}  // namespace alcap::detail::distributed
