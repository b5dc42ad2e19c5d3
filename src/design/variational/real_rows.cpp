// SPDX-License-Identifier: MIT
#include "src/design/variational/real_rows.h"

#include <cmath>

#include "solvers/dense/hermitian.h"

namespace alcap::detail {
namespace {

// Exact rows get this compliance, relative to the others': rows that say the same twice stay solvable.
constexpr double exact_compliance = 1e-12;

}  // namespace

void append_real_rows(const ControlRow& row, Eigen::Index number, double kernel_weight,
                      std::vector<RowFunctional>& out) {
  using C = Complex<double>;
  if (row.direction_only) {
    const C along = std::conj(row.target) / std::abs(row.target);
    out.push_back({number, C(0, -1) * along, 0, 0});
    // The length is free: what the matrix weighs it with goes again.
    if (kernel_weight > 0) out.push_back({number, along, 0, -kernel_weight});
  } else {
    out.push_back({number, 1, row.target.real(), row.weight});
    out.push_back({number, C(0, -1), row.target.imag(), row.weight});
  }
}

VectorX<double> multipliers(const std::vector<RowFunctional>& rows, const MatrixX<Complex<double>>& response,
                            const ComplexVectorX<double>& values) {
  const auto count = static_cast<Eigen::Index>(rows.size());
  const auto row = [&](Eigen::Index i) -> const RowFunctional& { return rows[static_cast<std::size_t>(i)]; };
  MatrixX<double> G(count, count);
  VectorX<double> missing(count);
  for (Eigen::Index j = 0; j < count; ++j) {
    for (Eigen::Index i = 0; i < count; ++i)
      G(i, j) = (row(i).factor * response(row(i).number, row(j).number) * std::conj(row(j).factor)).real();
    missing[j] = (row(j).factor * values[row(j).number]).real() - row(j).target;
  }
  const double exact = exact_compliance * G.diagonal().cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < count; ++i) G(i, i) += row(i).weight != 0 ? 1 / row(i).weight : exact;
  return symmetric_solve(G, missing);
}

ComplexVectorX<double> complex_multipliers(const std::vector<RowFunctional>& rows, const VectorX<double>& mu,
                                           Eigen::Index count) {
  ComplexVectorX<double> sum = ComplexVectorX<double>::Zero(count);
  for (std::size_t i = 0; i < rows.size(); ++i)
    sum[rows[i].number] += mu[static_cast<Eigen::Index>(i)] * std::conj(rows[i].factor);
  return sum;
}

}  // namespace alcap::detail
