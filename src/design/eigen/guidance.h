// SPDX-License-Identifier: MIT
//
// guidance.h: closeness to a field of any length in an eigenproblem. Internal to eigen_design.
#pragma once

#include <vector>

#include "src/design/eigen/rows.h"

namespace alcap::detail {

/// A control that has a sign, next to guidance: (row u - value r)^2, with the square root of its weight in both.
struct GuidanceTie {
  RealRow row;
  double value = 0;
};

/// What draws one component's field, vertices numbered as in the component.
struct EigenGuidance {
  double pull = 0;                    ///< w, which multiplies the mass
  ComplexVectorX<double> field = {};  ///< g, of any length; empty or 0: drawn towards zero
  VectorX<double> weights = {};       ///< at vertices; empty: 1
};

/// A pencil of which guidance is a part: S with w M_g added, and the row over all vertices.
struct GuidedPencil {
  SparseMatrix<Complex<double>> S;
  DesignRows rows;
  double size = 0;  ///< the mass of a unit field over 1 + w area: eigenvalues are as large as 1 / size
};

/// Adds the smallest value over real r of
///   w |u - r g|^2 + sum over ties of (row u - value r)^2,
/// with |.| the norm of the weighted mass M_g and g of root mean square length 1, to the stiffness. It is taken at r =
/// b u / c, with c = w |g|^2 + sum of value^2 and b = w g* M_g + sum of value row:
///   w |u|^2 + sum of (row u)^2 - (b u)^2 / c.
/// That is the guidance of a variational design with a length that is free, as that of an eigenvector is, and what has
/// a sign takes that of the guidance. Without other rows u is a multiple of (S - (lambda - w) M)^-1 M g: the field of
/// Knoeppel et al. 2013 with lambda_t = lambda - w, below the smallest eigenvalue of S for every w. Without a field:
/// w |u|^2 alone. `size`: the mass of a unit field, with rows.
[[nodiscard]] GuidedPencil guided(const SparseMatrix<Complex<double>>& S, const SparseMatrix<Complex<double>>& M,
                                  const DesignRows& rows, const std::vector<GuidanceTie>& ties, double size,
                                  double area, const EigenGuidance& guidance);

}  // namespace alcap::detail
