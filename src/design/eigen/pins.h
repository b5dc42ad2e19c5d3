// SPDX-License-Identifier: MIT
//
// pins.h: fields that vanish at given points. An eigenproblem is linear and homogeneous, and so is a pin,
// sum_c coefficient_c u_c = 0 over the corners of its face: it is solved for the corner with the largest coefficient,
// u = T v, which leaves T' S T v = lambda T' M T v, Hermitian and sparse as before, and exact. Internal to
// eigen_design.
#pragma once

#include <map>
#include <set>
#include <utility>
#include <vector>

#include "alcap/solve.h"
#include "src/design/eigen/rows.h"

namespace alcap::detail {

/// The same over the real numbers, two unknowns to a vertex, serves directions that are held.
template <class Scalar>
class ZeroSpace {
 public:
  using Term = std::pair<Index, Scalar>;  // unknown, coefficient
  explicit ZeroSpace(Index unknowns) : unknowns_(unknowns) {}

  /// sum of coefficient x[unknown] = 0. Nothing where the conditions before say so already.
  void demand(const std::vector<Term>& terms);
  [[nodiscard]] bool empty() const { return solved_.empty(); }

  /// T: as many rows as unknowns, a column for each one that is left.
  [[nodiscard]] SparseMatrix<Scalar> basis() const;

 private:
  using Sum = std::map<Index, Scalar>;  // of values that are left
  Index unknowns_;
  std::map<Index, Sum> solved_;
  std::set<Index> used_;  // left, and in some sum
};

extern template class ZeroSpace<double>;
extern template class ZeroSpace<Complex<double>>;

/// Rows of u as rows of v.
[[nodiscard]] DesignRows pinned_rows(const DesignRows& rows, const SparseMatrix<Complex<double>>& basis);

}  // namespace alcap::detail
