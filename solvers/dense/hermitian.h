// SPDX-License-Identifier: MIT
//
// hermitian.h: dense eigenproblems and factorisations of Hermitian (real: symmetric) matrices, by the Eigen library.
// hermitian.cpp is the only file that instantiates these decompositions, which take long to compile. Internal to the
// library.
//
// Of every matrix only the lower triangle is read. Scalar: double or std::complex<double>.
#pragma once

#include <complex>
#include <optional>

#include "alcap/conventions.h"

namespace alcap::detail {

/// Eigenvalues, ascending, and one eigenvector per column.
template <class Scalar>
struct Eigenpairs {
  VectorX<double> values;
  MatrixX<Scalar> vectors;
};

/// All eigenpairs of A by the symmetric QR algorithm (Golub and Van Loan 2013, section 8.3); orthonormal vectors.
template <class Scalar>
[[nodiscard]] Eigenpairs<Scalar> hermitian_eigenpairs(const MatrixX<Scalar>& A);

/// The eigenvalues of A alone, ascending.
[[nodiscard]] VectorX<double> hermitian_eigenvalues(const MatrixX<std::complex<double>>& A);

/// All eigenpairs of S u = lambda M u with u^H M u = 1; nothing when M is not positive definite.
template <class Scalar>
[[nodiscard]] std::optional<Eigenpairs<Scalar>> generalised_eigenpairs(const MatrixX<Scalar>& S,
                                                                       const MatrixX<Scalar>& M);

/// x with A x = b for a symmetric A, by L D L' with pivots (Golub and Van Loan 2013, section 4.4).
[[nodiscard]] VectorX<double> symmetric_solve(const MatrixX<double>& A, const VectorX<double>& b);

/// L with A = L L'; nothing when A is not positive definite.
[[nodiscard]] std::optional<MatrixX<double>> cholesky_factor(const MatrixX<double>& A);

/// x with L L' x = b.
[[nodiscard]] VectorX<double> cholesky_solve(const MatrixX<double>& L, const VectorX<double>& b);

/// A^-1; nothing when A is not positive definite.
[[nodiscard]] std::optional<MatrixX<std::complex<double>>> hermitian_inverse(const MatrixX<std::complex<double>>& A);

/// U^-1 with M = U^H U, U upper triangular; nothing when M is not positive definite or when the reciprocal of its
/// condition number (in the 1-norm, estimated) is not above `rcond`.
[[nodiscard]] std::optional<MatrixX<std::complex<double>>> inverse_cholesky_factor(
    const MatrixX<std::complex<double>>& M, double rcond);

/// T with T^H M T = 1 from the eigenpairs of M, without the directions whose eigenvalues are at most `dependent` times
/// the largest: T has as many columns as there are others.
[[nodiscard]] MatrixX<std::complex<double>> orthonormal_basis(const MatrixX<std::complex<double>>& M, double dependent);

}  // namespace alcap::detail
