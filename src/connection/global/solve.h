// SPDX-License-Identifier: MIT
//
// solve.h: the corrections that minimise D_T + lambda D_E (LTGD 2016, Sec. 5.3), by iterative refinement: the gradient
// is taken in double, the correction it asks for is solved to a few digits, and both again until the gradient is gone.
#pragma once

#include "alcap/connection.h"
#include "src/base/array.h"
#include "src/connection/global/edge_correction.h"
#include "src/connection/global/pairs.h"
#include "src/connection/global/relaxation.h"
#include "src/connection/global/rounds.h"

namespace alcap::detail {

/// What is to be added to a connection.
struct Corrections {
  FacePairs faces;
  Array<EdgeCorrection> edges;  // #E, by their number in `faces`; `rotation` is what matters, the rest follows
  Array<double> corners;        // 3 #F: of rho_{v->t}
  RefinementState refinement;
};

/// Over all of rho. The corrections are solved by conjugate gradients in float, which halves the memory traffic that
/// bounds them; where float makes no headway (extreme slivers) the next ones are solved in double.
[[nodiscard]] Corrections solve_free(const FaceEnergy& energy, const LiftedState& state, const GlobalOptions& options);

/// With rho_ij held: every rotation is zero. By HeldRotations in double.
[[nodiscard]] Corrections solve_held(const FaceEnergy& energy, const LiftedState& state, const GlobalOptions& options);

}  // namespace alcap::detail
