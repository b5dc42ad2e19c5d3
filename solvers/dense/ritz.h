// SPDX-License-Identifier: MIT
//
// ritz.h: the small dense problems of Rayleigh-Ritz. Internal to solvers/.
#pragma once

#include "alcap/conventions.h"

namespace alcap::detail {

/// Lowest Ritz pairs of a basis: values ascending, coefficients m x count.
struct Ritz {
  VectorX<double> values;
  MatrixX<std::complex<double>> coefficients;
};

/// Rayleigh-Ritz in a basis whose Gram matrices are S and M (m x m, Hermitian). Directions of the unit-length basis
/// that carry less than `dependent` of its whole are dropped: rounding made them. At most `count` pairs; none where no
/// vector has a positive length.
[[nodiscard]] Ritz rayleigh_ritz(const MatrixX<std::complex<double>>& S, const MatrixX<std::complex<double>>& M,
                                 Eigen::Index count, double dependent);

}  // namespace alcap::detail
