// SPDX-License-Identifier: MIT
//
// write_back.h: what the solve found, added to a connection and to its lifted residuals. turn: of the frame of each
// vertex, from gauge.h.
#pragma once

#include "src/connection/construction.h"
#include "src/connection/global/energy.h"
#include "src/connection/global/solve.h"

namespace alcap::detail {

/// rho_{v->t}, which both residuals at a corner contain.
void move_corners(const Mesh& mesh, const Array<double>& corners, const VectorX<double>& turn, Connection& connection,
                  LiftedResiduals& residuals);

/// rho_ij, and eps with it (LTGD 2016, eq. 8).
void move_rotations(const Mesh& mesh, const Corrections& found, const VectorX<double>& turn, Connection& connection);

/// rho_{v->e}: for given corners D_E is least where the residual at each end of an edge is zero on average over its two
/// faces, with their weights. Next to a boundary the one face has none left.
void follow_with_edges(const Mesh& mesh, const HalfedgeWeights& weights, const VectorX<double>& turn,
                       Connection& connection, LiftedResiduals& residuals);

}  // namespace alcap::detail
