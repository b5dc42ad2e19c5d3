// SPDX-License-Identifier: MIT
//
// hierarchy.h: gauge-covariant smoothed aggregation (Vanek, Mandel, Brezina 1996, with parallel transports where they
// have the constant vector) and its W-cycle. Internal to solvers/.
//
// The near-null vectors of a connection Laplacian are not constant but covariantly constant over short distances. So
// the tentative prolongation carries a value from the root of an aggregate to its vertices by parallel transport, which
// is the phase of -A_ij. A change of gauge changes no modulus anywhere.
#pragma once

#include <functional>
#include <vector>

#include "alcap/solve.h"
#include "solvers/multigrid/level.h"

namespace alcap::detail {

/// Which vertices form one coarse vertex. `aggregate[i]` is none for vertices that the smoother alone takes care of.
struct Aggregates {
  Buffer<Index> aggregate;
  Buffer<ComplexF> transport;  ///< from the root of the aggregate to the vertex, modulus 1
  Index count = 0;
};

/// Greedy aggregation of strongly coupled vertices, in their order.
[[nodiscard]] Aggregates aggregate(const Level& level);

/// Fills level.prolongation and level.restriction, up to the scaling of the coarse level.
void smooth_prolongation(Level& level, const Aggregates& aggregates);

/// P^H A P scaled to unit diagonal, without its prolongation; scales the prolongation of `fine` to match. Returns a
/// level without rows when a diagonal entry is not positive.
[[nodiscard]] Level galerkin(Level& fine);

/// True for entries that aggregation and prolongation treat as coupled.
[[nodiscard]] inline bool strong(ComplexF a) {
  // Weak couplings (theta = 0.08 of the diagonal) would tie directions together that the smoother does not.
  constexpr float theta = 0.08F;
  return a.real() * a.real() + a.imag() * a.imag() > theta * theta;
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
  /// transports (the mass matrix is one): couplings of A that work against them (obtuse angles, mass terms) stay in the
  /// operator, but aggregates and prolongation are those of A with such couplings lumped. Bitwise independent of
  /// threads. Throws SolveError when A has a diagonal entry that is not positive, Cancelled.
  void build(const Operand& A, const SparseMatrix<std::complex<double>>* transport,
             const std::function<bool()>& cancel = {});

  /// From now on cycles on the finest level are approximate inverses of A - sigma M on smooth vectors: the coarser
  /// levels become those of A - sigma M, whose smallest eigenvalue there must be positive; the smoother above does not
  /// feel sigma. `masses` are lumped masses of every level in its scaled unknowns and are kept so. Levels too coarse
  /// for vectors with an eigenvalue of sigma stay as they are.
  void shift(std::vector<Buffer<float>>& masses, float sigma);

  /// Workspace of W-cycles with K vectors (1, 4, 8 or 16) that start on level `first` or coarser.
  struct Workspace {
    std::vector<Buffer<float>> x, b, r;
  };
  template <int K>
  [[nodiscard]] Workspace workspace(std::size_t first = 0) const;

  /// x ~ A^-1 b by one W-cycle on a level, from zero or from x. Hermitian positive definite from zero, so fit for
  /// preconditioning. The vectors are w.b[level] and w.x[level], scaled: with N = levels()[level].near, N^-1 b and N x
  /// of the level's own matrix (times a constant).
  template <int K>
  void cycle(Workspace& w, std::size_t level = 0, bool from_zero = true) const;

  [[nodiscard]] const std::vector<Level>& levels() const { return levels_; }
  /// The finest level is N^-1 A N^-1 / unit().
  [[nodiscard]] double unit() const { return unit_; }
  [[nodiscard]] std::int64_t nonzeros() const;

 private:
  void invert_coarsest();

  std::vector<Level> levels_;
  double unit_ = 1;
  Buffer<ComplexF> coarsest_inverse_;  // dense; empty when the coarsest level is too large for that
};

}  // namespace alcap::detail
