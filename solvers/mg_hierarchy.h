// SPDX-License-Identifier: MIT
//
// mg_hierarchy.h: gauge-covariant smoothed aggregation (Vanek, Mandel, Brezina 1996, with transports in place of the
// constant vector) and its W-cycle. Internal to solvers/.
//
// The near-null vectors of a connection Laplacian are not constant but covariantly constant over short distances. So
// the tentative prolongation carries a value from the root of an aggregate to its vertices by parallel transport, which
// is the phase of -A_ij. A change of gauge changes no modulus anywhere.
#pragma once

#include <vector>

#include "alcap/solve.h"
#include "solvers/mg_level.h"

namespace alcap::detail {

/// Which vertices form one coarse vertex. `aggregate[i]` is none for vertices that the smoother alone takes care of.
struct Aggregates {
  std::vector<Index> aggregate;
  std::vector<ComplexF> transport;  ///< from the root of the aggregate to the vertex, modulus 1
  Index count = 0;
};

/// Greedy aggregation of strongly coupled vertices, in their order.
[[nodiscard]] Aggregates aggregate(const Level& level);

/// Fills level.prolongation and level.restriction.
void smooth_prolongation(Level& level, const Aggregates& aggregates);

/// P^H A P, without its prolongation.
[[nodiscard]] Level galerkin(const Level& fine);

/// True for entries that aggregation and prolongation treat as coupled.
[[nodiscard]] inline bool strong(const Level& level, std::int64_t i, std::int64_t e) {
  // Weak couplings (theta = 0.08 of the diagonal) would tie directions together that the smoother does not.
  constexpr float theta = 0.08F;
  const auto j = static_cast<std::size_t>(level.off.column[static_cast<std::size_t>(e)]);
  return std::norm(level.off.value[static_cast<std::size_t>(e)]) >
         theta * theta * level.diagonal[static_cast<std::size_t>(i)] * level.diagonal[j];
}

/// S - sigma M without forming it. M, when not null, has the pattern of S; both are compressed.
struct Operand {
  const SparseMatrix<std::complex<double>>& S;
  const SparseMatrix<std::complex<double>>* M = nullptr;
  double sigma = 0;
  [[nodiscard]] std::complex<double> value(std::int64_t e) const {
    return M == nullptr ? S.valuePtr()[e] : S.valuePtr()[e] - sigma * M->valuePtr()[e];
  }
};

class Hierarchy {
 public:
  /// Builds all levels from A. `transport`, when not null, is a matrix of A's pattern whose off-diagonal phases are the
  /// transports (the mass matrix is one): couplings of A that work against them (obtuse angles, mass terms) are lumped.
  /// Bitwise independent of threads. Throws SolveError when A has a diagonal entry that is not positive.
  void build(const Operand& A, const SparseMatrix<std::complex<double>>* transport);

  /// Workspace of W-cycles with K vectors (1, 4, 8 or 16) that start on level `first` or coarser.
  struct Workspace {
    std::vector<std::vector<float>> x, b, d;
  };
  template <int K>
  [[nodiscard]] Workspace workspace(std::size_t first = 0) const;

  /// x ~ A^-1 b by one W-cycle from zero on a level. Hermitian positive definite, so fit for preconditioning. The
  /// vectors are w.b[level] and w.x[level].
  template <int K>
  void cycle(Workspace& w, std::size_t level = 0) const {
    visit<K>(level, w, true);
  }

  [[nodiscard]] const std::vector<Level>& levels() const { return levels_; }
  [[nodiscard]] std::int64_t nonzeros() const;

 private:
  template <int K>
  void visit(std::size_t level, Workspace& w, bool from_zero) const;
  void invert_coarsest();

  std::vector<Level> levels_;
  std::vector<ComplexF> coarsest_inverse_;  // dense; empty when the coarsest level is too large for that
};

}  // namespace alcap::detail
