// SPDX-License-Identifier: MIT
//
// multigrid.h: the library's gauge-covariant aggregation, rank by rank, as prolongations of PETSc's PCMG. Levels that
// are small for all ranks are shared by fewer. Internal to src/distributed.
#pragma once

#include <petscksp.h>

#include <vector>

#include "src/distributed/matrices.h"

namespace alcap::detail::distributed {

class Multigrid {
 public:
  /// Of A, Hermitian positive definite; the phases of `transport`, a matrix of the same pattern, are the transports.
  Multigrid(petsc::OwnedMat A, Mat transport);
  /// Makes `pc` a W-cycle with a Chebyshev smoother of degree 2. This must outlive it.
  void configure(PC pc) const;

  /// Of a level, 0 the finest.
  [[nodiscard]] Mat matrix(std::size_t level = 0) const { return levels_[level].A.get(); }
  [[nodiscard]] std::size_t levels() const { return levels_.size(); }

 private:
  struct Level {
    petsc::OwnedMat A;
    petsc::OwnedMat P;       ///< from the next coarser level
    petsc::OwnedMat P_conj;  ///< its entries conjugate: restricts, since PETSc transposes without conjugation
  };
  std::vector<Level> levels_;  ///< the finest first
};

}  // namespace alcap::detail::distributed
