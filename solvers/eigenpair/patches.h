// SPDX-License-Identifier: MIT
//
// patches.h: small Dirichlet eigenproblems on overlapping patches of the mesh. A vector that is zero outside a patch is
// a vector like any other, so every eigenvalue of a patch bounds the smallest one from above; and where eigenvectors
// are localised (noise, bumps, chains of necks), those of patches nearly are the eigenvectors. What coarse levels lose
// is found here, in time proportional to the mesh. Internal to solvers/.
#pragma once

#include <vector>

#include "solvers/eigenpair/problem.h"

namespace alcap::detail {

/// The smallest eigenpair of a patch.
struct LocalVector {
  double lambda = 0;
  std::vector<Index> rows;  ///< where it is not zero
  ComplexVector u;          ///< there, of M-length 1
};

/// A at these rows, ascending, and the same columns.
[[nodiscard]] HermitianMatrix block_of(const HermitianMatrix& A, const std::vector<Index>& rows);

/// Patches of up to `core` rows that cover the graph of A, each with `rings` rings of neighbours around: rows,
/// ascending.
[[nodiscard]] std::vector<std::vector<Index>> patches_of(const HermitianMatrix& A, Index core, int rings);

/// Smallest eigenpairs of patches, of those below `sigma`: the lowest `most` of them. Patches are counted by inertia
/// first; only where something lies below the lowest value so far is an eigenproblem solved. Where the whole mesh is
/// one patch: the `most` smallest ones below sigma, and none where no more are there than the `known` ones.
[[nodiscard]] std::vector<LocalVector> search_patches(const EigenProblem& problem, const EigenOptions& options,
                                                      double sigma, std::size_t most, std::int64_t known = 0);

/// The mean number of states of a flat surface without a field below lambda (Weyl 1911). Where it is larger than this,
/// more eigenvectors than a block has compete for the first place, and coarse levels may order them wrongly.
inline constexpr double dense_states = 24;
[[nodiscard]] inline double states_below(double lambda, double area) { return lambda * area / (4 * pi<double>); }

}  // namespace alcap::detail
