// SPDX-License-Identifier: MIT
#include "src/design/eigen/guidance.h"

#include <cmath>

namespace alcap::detail {
namespace {

using C = Complex<double>;

/// M_g.
SparseMatrix<C> weighted(const SparseMatrix<C>& M, const VectorX<double>& weights) {
  SparseMatrix<C> mass;  // assigned: Eigen's constructors leak where memory runs out in the middle of them
  mass = M;
  if (weights.size() == 0) return mass;
  const VectorX<double> roots = weights.cwiseSqrt();
  for (Index j = 0; j < mass.outerSize(); ++j)
    for (SparseMatrix<C>::InnerIterator it(mass, j); it; ++it) it.valueRef() *= roots[it.row()] * roots[j];
  return mass;
}

/// g of root mean square length 1; empty where it is 0.
ComplexVectorX<double> of_unit_length(const SparseMatrix<C>& M, const ComplexVectorX<double>& field, double area) {
  const double largest = field.size() > 0 ? field.cwiseAbs().maxCoeff() : 0;
  if (!(largest > 0)) return {};
  ComplexVectorX<double> g = field / largest, Mg(g.size());
  hermitian_product(M, g.data(), Mg.data());
  g *= std::sqrt(area / g.dot(Mg).real());
  return g;
}

}  // namespace

GuidedPencil guided(const SparseMatrix<C>& S, const SparseMatrix<C>& M, const DesignRows& rows,
                    const std::vector<GuidanceTie>& ties, double size, double area, const EigenGuidance& guidance) {
  GuidedPencil out{.S = {}, .rows = rows, .size = size / (1 + guidance.pull * area)};
  const SparseMatrix<C> mass = weighted(M, guidance.weights);
  out.S = S + guidance.pull * mass;
  const ComplexVectorX<double> g = of_unit_length(M, guidance.field, area);
  if (g.size() == 0) return out;
  ComplexVectorX<double> b(g.size());
  hermitian_product(mass, g.data(), b.data());
  double c = guidance.pull * g.dot(b).real();
  b *= guidance.pull;
  for (const GuidanceTie& tie : ties) {
    out.rows.across.push_back(tie.row);
    for (std::size_t k = 0; k < tie.row.vertex.size(); ++k) b[tie.row.vertex[k]] += tie.value * tie.row.coefficient[k];
    c += tie.value * tie.value;
  }
  if (c > 0) out.rows.follow = b / std::sqrt(c);
  return out;
}

}  // namespace alcap::detail
