// SPDX-License-Identifier: MIT
//
// multifrontal.h: the signs of the pivots of A = L D L^H, for sparse Hermitian A that may be indefinite (multifrontal
// method: Duff and Reid 1983, Liu 1992). By Sylvester's law of inertia they are those of the eigenvalues. L is not
// kept: memory is that of the fronts in progress, a fraction of a factor's. Internal to solvers/.
//
// There is no pivoting. Where A is definite none is needed. Otherwise a pivot can come out small by chance and entries
// grow; the growth is measured, and bounds what rounding did: |computed L D L^H - A|_ij <= c eps sqrt(g_i g_j) with
// g = diag(|L| |D| |L|^H).
#pragma once

#include <complex>
#include <cstdint>
#include <vector>

#include "alcap/solve.h"

namespace alcap::detail {

/// What a factorisation found.
struct PivotCount {
  std::int64_t negative = 0;  ///< pivots below zero
  bool complete = true;       ///< false: it ended early, with more of them than asked for
  double growth = 0;          ///< max_i g_i / w_i for given weights w; at most 1 for definite A and w = |diag(A)|
  bool broken = false;        ///< a pivot was zero or not a number
};

class Multifrontal {
 public:
  using Matrix = SparseMatrix<std::complex<double>>;

  /// Order, elimination tree and fronts of A's pattern. Throws SolveError when memory runs out.
  explicit Multifrontal(const Matrix& A);

  /// Floating-point operations of a factorisation.
  [[nodiscard]] double flops() const { return flops_; }
  /// Memory of a factorisation on one thread; a further thread needs a part of it once more.
  [[nodiscard]] double bytes() const { return bytes_; }

  /// Factorises A, which must have the pattern analysed, both triangles stored, until more than `most` pivots are
  /// negative. `weights`: w above. On all threads, with the same result on any number of them. Asks open
  /// ControlScopes in every front.
  [[nodiscard]] PivotCount count(const Matrix& A, const VectorX<double>& weights, std::int64_t most) const;

 private:
  class Task;
  struct Tree;

  [[nodiscard]] std::int64_t front_rows(Index s) const { return rows_begin_[at(s) + 1] - rows_begin_[at(s)]; }
  [[nodiscard]] Index columns(Index s) const { return first_[at(s) + 1] - first_[at(s)]; }
  [[nodiscard]] Index supernodes() const { return static_cast<Index>(parent_.size()); }
  static std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

  void order(const Matrix& A);
  void find_supernodes(const Matrix& A);
  void find_rows(const Matrix& A);
  void predict();
  void cut_subtrees();

  // Columns are numbered in the order of elimination; supernode s has those from first_[s] to first_[s + 1].
  std::vector<Index> column_;    // of A, by position in that order
  std::vector<Index> position_;  // the inverse
  std::vector<Index> first_;
  std::vector<Index> parent_;  // of supernodes, none at roots
  // Rows of the front of s, ascending, its own columns first.
  std::vector<std::int64_t> rows_begin_;
  std::vector<Index> rows_;
  std::vector<Index> top_;       // supernodes above all subtrees, ascending
  std::vector<Index> subtrees_;  // their roots, the most work first
  std::vector<Index> leftmost_;  // first supernode of the subtree of s
  double flops_ = 0, bytes_ = 0;
};

/// The rows of A in an order that fills little: order[k] is eliminated k-th.
[[nodiscard]] std::vector<Index> fill_reducing_order(const SparseMatrix<std::complex<double>>& A);
/// By nested dissection and minimum degree, in dissection.cpp.
[[nodiscard]] std::vector<Index> dissection_order(const SparseMatrix<std::complex<double>>& A);

/// Above this many rows METIS pays for itself where it is compiled in (with CHOLMOD): it fills less, by a tenth on even
/// meshes and by two fifths on scans, and takes eight times as long to order as dissection_order().
inline constexpr Eigen::Index metis_above_rows = 1'000'000;

#ifdef ALCAP_WITH_CHOLMOD
/// By METIS, in cholmod.cpp.
[[nodiscard]] std::vector<Index> metis_order(const SparseMatrix<std::complex<double>>& A);
#endif

}  // namespace alcap::detail
