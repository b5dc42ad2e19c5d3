// SPDX-License-Identifier: MIT
//
// pencil.h: a Hermitian pencil with real-linear rows added, and its smallest eigenpair. Internal to
// eigen_design.
#pragma once

#include <vector>

#include "alcap/eigen_design.h"
#include "src/design/eigen/rows.h"

namespace alcap::detail {

/// (S + sum over `across` of row' row - follow' follow) u = lambda (M + sum over `along` of row' row) u, u complex,
/// rows over the reals. `size`: the mass of a field of unit length, rows included, which gives the scale of
/// eigenvalues. u is scaled to u* M u = 1 without the rows; its sign is any.
[[nodiscard]] EigenResult smallest_with_rows(const SparseMatrix<Complex<double>>& S,
                                             const SparseMatrix<Complex<double>>& M, const DesignRows& rows,
                                             double size, const EigenDesignOptions& options);

/// The same among fields u = T y, y real, with real and imaginary parts of u interleaved.
[[nodiscard]] EigenResult smallest_with_rows_in(const SparseMatrix<double>& T, const SparseMatrix<Complex<double>>& S,
                                                const SparseMatrix<Complex<double>>& M, const DesignRows& rows,
                                                double size, const EigenDesignOptions& options);

}  // namespace alcap::detail
