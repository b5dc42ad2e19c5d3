// SPDX-License-Identifier: MIT
//
// products.cpp: matrix-vector products with Hermitian matrices whose both triangles are stored, and residuals.
#include <cmath>

#include "solvers/linear/backends.h"
#include "src/base/parallel.h"

namespace alcap {

void hermitian_product(const SparseMatrix<std::complex<double>>& A, const std::complex<double>* x,
                       std::complex<double>* y) {
  const Index* start = A.outerIndexPtr();
  const Index* count = A.innerNonZeroPtr();  // null when compressed
  const Index* row = A.innerIndexPtr();
  const std::complex<double>* value = A.valuePtr();
  parallel_for(A.cols(), [=](std::int64_t j) {
    // Row j is the conjugate of column j, so that y is written in order and no two threads meet. Written out in reals:
    // the C++ product of complex numbers checks for infinities.
    double re = 0;
    double im = 0;
    const Index end = count == nullptr ? start[j + 1] : start[j] + count[j];
    for (Index k = start[j]; k < end; ++k) {
      const double ar = value[k].real();
      const double ai = value[k].imag();
      const std::complex<double> z = x[row[k]];
      re += ar * z.real() + ai * z.imag();
      im += ar * z.imag() - ai * z.real();
    }
    y[j] = {re, im};
  });
}

template <class Scalar>
MatrixX<Scalar> HalfSolution<Scalar>::product(const HalfSolution& K) const {
  if (rows == K.rows) return values.adjoint() * K.values;
  std::vector<Eigen::Index> here, there;
  for (std::size_t i = 0, j = 0; i < rows.size() && j < K.rows.size();) {
    if (rows[i] == K.rows[j]) {
      here.push_back(static_cast<Eigen::Index>(i++));
      there.push_back(static_cast<Eigen::Index>(j++));
    } else {
      ++(rows[i] < K.rows[j] ? i : j);
    }
  }
  return MatrixX<Scalar>(values(here, Eigen::all)).adjoint() * MatrixX<Scalar>(K.values(there, Eigen::all));
}
template struct HalfSolution<double>;
template struct HalfSolution<std::complex<double>>;

template <class Scalar>
double residual(const SparseMatrix<Scalar>& A, const Eigen::Ref<const MatrixX<Scalar>>& X,
                const Eigen::Ref<const MatrixX<Scalar>>& B) {
  detail::require_sizes(B, X, A.rows());
  double worst = 0;
  Eigen::Matrix<Scalar, Eigen::Dynamic, 1> r(A.rows());
  for (Eigen::Index c = 0; c < B.cols(); ++c) {
    if constexpr (std::is_same_v<Scalar, double>) {
      r.noalias() = A * X.col(c);
    } else {
      hermitian_product(A, X.col(c).data(), r.data());
    }
    r -= B.col(c);
    const double b = B.col(c).norm();
    const double relative = b > 0 ? r.norm() / b : r.norm();
    if (!(relative <= worst)) worst = relative;  // a NaN must not pass as 0
  }
  return worst;
}
template double residual<double>(const SparseMatrix<double>&, const Eigen::Ref<const MatrixX<double>>&,
                                 const Eigen::Ref<const MatrixX<double>>&);
template double residual<std::complex<double>>(const SparseMatrix<std::complex<double>>&,
                                               const Eigen::Ref<const MatrixX<std::complex<double>>>&,
                                               const Eigen::Ref<const MatrixX<std::complex<double>>>&);

}  // namespace alcap
