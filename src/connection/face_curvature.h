// SPDX-License-Identifier: MIT
//
// face_curvature.h: vertex-to-vertex rotations with which every face has the curvature asked for. Internal.
#pragma once

#include <string>

#include "src/connection/construction.h"

namespace alcap::detail {

/// Adds to rho_ij the rotations delta of least sum delta^2 / w with which face t has K_t = curvature[t], w the inverse
/// of the cotangent weight: delta = w (phi_t - phi_s) across the faces t and s of an edge, one Poisson solve for phi,
/// which is 0 beyond the boundary. rho_{v->e} and rho_{v->t} stay. Closed components must have the sum they had.
void set_face_curvature(const Mesh& mesh, const Geometry& geometry, const Topology& topology,
                        const VectorX<double>& curvature, const std::string& solver, const LiftedResiduals& residuals,
                        Connection& connection);

}  // namespace alcap::detail
