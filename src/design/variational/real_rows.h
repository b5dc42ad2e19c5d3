// SPDX-License-Identifier: MIT
//
// real_rows.h: rows as real functionals, so that those which fix a direction only can stand among the others, and their
// multipliers: of (R Y + C) mu = R A^-1 b - t with Y = A^-1 R' (solve.cpp). Internal to design and to its distributed
// form.
#pragma once

#include <vector>

#include "src/design/variational/rows.h"

namespace alcap::detail {

/// A row as one of its real functionals Re(factor row.at(u)) = target.
struct RowFunctional {
  Eigen::Index number = 0;  ///< of the row among all
  Complex<double> factor;
  double target = 0;
  double weight = 0;  ///< 0: exact
};

/// Appends the one or two functionals of row `number`. `kernel_weight`: what exact rows are in the matrix with as well,
/// 0 where they are not.
void append_real_rows(const ControlRow& row, Eigen::Index number, double kernel_weight,
                      std::vector<RowFunctional>& out);

/// mu of every functional, from R A^-1 R' and R A^-1 b of all rows.
[[nodiscard]] VectorX<double> multipliers(const std::vector<RowFunctional>& rows,
                                          const MatrixX<Complex<double>>& response,
                                          const ComplexVectorX<double>& values);

/// The same as one complex number for each of `count` rows: R' mu is the sum of row' times it.
[[nodiscard]] ComplexVectorX<double> complex_multipliers(const std::vector<RowFunctional>& rows,
                                                         const VectorX<double>& mu, Eigen::Index count);

}  // namespace alcap::detail
