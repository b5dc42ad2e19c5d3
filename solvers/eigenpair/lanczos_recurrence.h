// SPDX-License-Identifier: MIT
//
// lanczos_recurrence.h: Spectra's Lanczos factorisation with the implicit restart (Sorensen 1992) that its solver
// classes keep private, and with a step that multiplies less. Internal to solvers/.
#pragma once

#include <cmath>

#include <Spectra/LinAlg/Arnoldi.h>
#include <Spectra/LinAlg/UpperHessenbergQR.h>
#include <Spectra/MatOp/internal/ArnoldiOp.h>

#include "alcap/conventions.h"

namespace alcap::detail {

/// `Operators` is a Spectra::ArnoldiOp: a symmetric positive operator in an inner product.
template <class Operators>
class LanczosRecurrence : public Spectra::Arnoldi<double, Operators> {
 public:
  using Base = Spectra::Arnoldi<double, Operators>;
  using Base::Base;
  using Index = Eigen::Index;  // Spectra's is private

  /// One more basis vector, by one solve and three products with M. `product(x, y)` is y = M x in the inner product of
  /// `Operators`, `solve(Mx, y)` is y = Op x. As Spectra::Lanczos::factorize_from(), but M v follows from M f, and each
  /// vector is projected twice, which is enough (Giraud, Langou, Rozloznik 2005). Spectra projects until nothing is
  /// left but rounding, and takes about six products.
  template <class Product, class Solve>
  void extend(const Product& product, const Solve& solve, Index& solves) {
    const Index k = this->m_k;
    double& beta = this->m_beta;
    VectorX<double>& f = this->m_fac_f;
    double coupling = beta;
    if (!(beta > this->m_eps * std::sqrt(static_cast<double>(f.size())))) {
      // The basis spans an invariant space (eigenvalues of Op are near 1): on with a random vector.
      Eigen::Map<const MatrixX<double>> V(this->m_fac_V.data(), f.size(), k);
      this->expand_basis(V, 2 * k, f, beta, solves);
      coupling = 0;
      fresh_ = false;
    }
    if (!fresh_) {
      Mf_.resize(f.size());
      product(f.data(), Mf_.data());
    }
    this->m_fac_V.col(k) = f / beta;
    Mf_ /= beta;  // M v
    solve(Mf_.data(), f.data());
    ++solves;
    f -= coupling * this->m_fac_V.col(k - 1);
    const auto V = this->m_fac_V.leftCols(k + 1);
    double diagonal = 0;
    VectorX<double> projections(k + 1);  // no member: Eigen frees a vector twice where it cannot be made longer
    for (int pass = 0; pass < 2; ++pass) {
      product(f.data(), Mf_.data());
      projections.noalias() = V.transpose() * Mf_;
      f.noalias() -= V * projections;
      coupling += projections[k - 1];
      diagonal += projections[k];
    }
    product(f.data(), Mf_.data());
    beta = std::sqrt(f.dot(Mf_));
    fresh_ = true;
    MatrixX<double>& H = this->m_fac_H;
    H.row(k).setZero();
    H.col(k).setZero();
    H(k, k - 1) = H(k - 1, k) = coupling;
    H(k, k) = diagonal;
    this->m_k = k + 1;
  }

  /// Shrinks a full basis to the `keep` Ritz vectors of largest Ritz values; `theta` ascending.
  void restart(Index keep, const VectorX<double>& theta) {
    const Index full = theta.size();
    Spectra::TridiagQR<double> qr(full);
    MatrixX<double> Q = MatrixX<double>::Identity(full, full);
    for (Index i = 0; i < full - keep; ++i) {
      // Shifts of larger modulus first, as in Spectra: theta is positive and ascending here.
      qr.compute(this->matrix_H(), theta[full - keep - 1 - i]);
      qr.apply_YQ(Q);
      this->compress_H(qr);
    }
    this->compress_V(Q);
    fresh_ = false;
  }

 private:
  VectorX<double> Mf_;
  bool fresh_ = false;  // Mf_ is M f
};

}  // namespace alcap::detail
