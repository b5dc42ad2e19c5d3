// SPDX-License-Identifier: MIT
//
// assembly.h: the sparsity of vertex-by-vertex Hermitian matrices, built once per mesh, and where each edge's and
// vertex's entry lives in it. Numeric fills then write disjoint slots without sorting, allocation or atomics.
#pragma once

#include <vector>

#include "alcap/mesh.h"
#include "alcap/solve.h"

namespace alcap {

/// Pattern of a #V x #V matrix with an entry per vertex and two per edge, column-compressed, rows sorted, both
/// triangles. Vertices that no face uses keep a diagonal entry.
class HermitianPattern {
 public:
  HermitianPattern() = default;
  /// O(V), parallel.
  explicit HermitianPattern(const Mesh& mesh);

  /// #V.
  [[nodiscard]] Index rows() const { return static_cast<Index>(outer_.size()) - 1; }
  /// #V + 2 #E.
  [[nodiscard]] Index nonzeros() const { return outer_[outer_.size() - 1]; }
  /// Slot of entry (v, v).
  [[nodiscard]] Index diagonal(Index v) const { return diagonal_[v]; }
  /// Slot of entry (i, j), row i and column j, for the canonical halfedge i -> j of edge e.
  [[nodiscard]] Index upper(Index e) const { return upper_[e]; }
  /// Slot of its mirror (j, i).
  [[nodiscard]] Index lower(Index e) const { return lower_[e]; }

  /// A matrix of this pattern with unset values.
  [[nodiscard]] SparseMatrix<Complex<double>> matrix() const;

 private:
  VectorX<Index> outer_, inner_, diagonal_, upper_, lower_;  // not zeroed when they are made, as std::vector is
};

/// The real symmetric 2V x 2V view of a Hermitian matrix, (re, im) interleaved: entry a + ib becomes [a -b; b a].
[[nodiscard]] SparseMatrix<double> real_view(const SparseMatrix<Complex<double>>& A);

/// The diagonal block of a block-diagonal A that belongs to `vertices`; local[v] is the place of v in its block. Costs
/// the block's own entries.
[[nodiscard]] SparseMatrix<Complex<double>> diagonal_block(const SparseMatrix<Complex<double>>& A,
                                                           const std::vector<Index>& vertices,
                                                           const std::vector<Index>& local);

}  // namespace alcap
