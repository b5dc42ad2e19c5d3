// SPDX-License-Identifier: MIT
//
// lanczos_recurrence.h: Spectra's Lanczos factorisation with the implicit restart (Sorensen 1992) that its solver
// classes keep private. Internal to solvers/.
#pragma once

#include <Spectra/LinAlg/Lanczos.h>
#include <Spectra/LinAlg/UpperHessenbergQR.h>
#include <Spectra/MatOp/internal/ArnoldiOp.h>

#include "alcap/conventions.h"

namespace alcap::detail {

/// `Operators` is a Spectra::ArnoldiOp: a symmetric positive operator in an inner product.
template <class Operators>
class LanczosRecurrence : public Spectra::Lanczos<double, Operators> {
 public:
  using Base = Spectra::Lanczos<double, Operators>;
  using Base::Base;
  using Index = Eigen::Index;  // Spectra's is private

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
  }
};

}  // namespace alcap::detail
