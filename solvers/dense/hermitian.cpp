// SPDX-License-Identifier: MIT
#include "solvers/dense/hermitian.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace alcap::detail {
namespace {

using Complex = std::complex<double>;
using Dense = MatrixX<Complex>;

}  // namespace

template <class Scalar>
Eigenpairs<Scalar> hermitian_eigenpairs(const MatrixX<Scalar>& A) {
  const Eigen::SelfAdjointEigenSolver<MatrixX<Scalar>> solver(A);
  return {solver.eigenvalues(), solver.eigenvectors()};
}
template Eigenpairs<double> hermitian_eigenpairs<double>(const MatrixX<double>&);
template Eigenpairs<Complex> hermitian_eigenpairs<Complex>(const MatrixX<Complex>&);

VectorX<double> hermitian_eigenvalues(const Dense& A) {
  return Eigen::SelfAdjointEigenSolver<Dense>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

template <class Scalar>
std::optional<Eigenpairs<Scalar>> generalised_eigenpairs(const MatrixX<Scalar>& S, const MatrixX<Scalar>& M) {
  // With M = L L^H: the eigenpairs of C = L^-1 S L^-H, and L^-H times their vectors.
  const Eigen::LLT<MatrixX<Scalar>> L(M);
  if (L.info() != Eigen::Success) return std::nullopt;
  MatrixX<Scalar> C = S.template selfadjointView<Eigen::Lower>();
  L.matrixL().template solveInPlace<Eigen::OnTheLeft>(C);
  L.matrixU().template solveInPlace<Eigen::OnTheRight>(C);
  Eigenpairs<Scalar> pairs = hermitian_eigenpairs<Scalar>(C);
  L.matrixU().solveInPlace(pairs.vectors);
  return pairs;
}
template std::optional<Eigenpairs<double>> generalised_eigenpairs<double>(const MatrixX<double>&,
                                                                          const MatrixX<double>&);
template std::optional<Eigenpairs<Complex>> generalised_eigenpairs<Complex>(const MatrixX<Complex>&,
                                                                            const MatrixX<Complex>&);

VectorX<double> symmetric_solve(const MatrixX<double>& A, const VectorX<double>& b) {
  return Eigen::LDLT<MatrixX<double>>(A).solve(b);
}

std::optional<MatrixX<double>> cholesky_factor(const MatrixX<double>& A) {
  const Eigen::LLT<MatrixX<double>> llt(A);
  if (llt.info() != Eigen::Success) return std::nullopt;
  return MatrixX<double>(llt.matrixLLT());
}

VectorX<double> cholesky_solve(const MatrixX<double>& L, const VectorX<double>& b) {
  VectorX<double> x = b;
  L.triangularView<Eigen::Lower>().solveInPlace(x);
  L.triangularView<Eigen::Lower>().adjoint().solveInPlace(x);
  return x;
}

std::optional<Dense> hermitian_inverse(const Dense& A) {
  const Eigen::LLT<Dense> llt(A);
  if (llt.info() != Eigen::Success) return std::nullopt;
  return Dense(llt.solve(Dense::Identity(A.rows(), A.cols())));
}

std::optional<Dense> inverse_cholesky_factor(const Dense& M, double rcond) {
  const Eigen::LLT<Dense> llt(M);
  if (llt.info() != Eigen::Success || !(llt.rcond() > rcond)) return std::nullopt;
  return Dense(llt.matrixU().solve(Dense::Identity(M.rows(), M.cols())));
}

Dense orthonormal_basis(const Dense& M, double dependent) {
  const Eigenpairs<Complex> basis = hermitian_eigenpairs<Complex>(M);
  const double largest = basis.values[M.rows() - 1];
  // Counted so that what is not a number stays, for the caller to see.
  const Eigen::Index dropped = (basis.values.array() <= dependent * largest).cast<Eigen::Index>().sum();
  const Eigen::Index rank = M.rows() - dropped;
  return basis.vectors.rightCols(rank) * basis.values.tail(rank).cwiseSqrt().cwiseInverse().asDiagonal();
}

}  // namespace alcap::detail
