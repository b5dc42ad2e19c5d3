// SPDX-License-Identifier: MIT
//
// front_loops.h: the loops of a multifrontal factorisation L D L^H (part of loops.h). Only pointers and numbers.
//
// A front is a dense Hermitian matrix of which the lower triangle counts: a plane of real and one of imaginary parts,
// row by row, with room for front_panel numbers behind each row.
#pragma once

namespace alcap::detail::simd {

/// Columns that are eliminated together.
inline constexpr int front_panel = 16;

struct RawFront {
  double* re;
  double* im;
  long long stride;
};

/// The panel's columns first ... first + depth - 1, at most front_panel of them.
struct RawPanel {
  long long first;
  int depth;
  const double* inverse_pivots;  ///< depth of them
  /// W[p][q] = L_qp d_p of the panel's own rows, front_panel numbers a row, zero unless p < q < depth.
  const double* own_re;
  const double* own_im;
  /// Y[p][i] = L_ip d_p for all rows i below, rows of the front's stride.
  double* below_re;
  double* below_im;
};

struct FrontLoops {
  /// Rows begin ... end - 1 below the panel: the panel's columns become those of L; fills Y.
  void (*panel)(const RawFront& F, const RawPanel& P, long long begin, long long end);
  /// Rows begin ... end - 1 from column `column` to the diagonal: F_ij -= sum_p L_ip conj(Y_pj). A few numbers behind
  /// the diagonal are changed too.
  void (*update)(const RawFront& F, const RawPanel& P, long long column, long long begin, long long end);
};

}  // namespace alcap::detail::simd
