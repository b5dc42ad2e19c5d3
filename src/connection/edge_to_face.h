// SPDX-License-Identifier: MIT
//
// edge_to_face.h: how the connection takes vectors from an edge into a face. Internal.
#pragma once

#include "alcap/connection.h"

namespace alcap::detail {

/// rho_{e->t} at the fraction s of halfedge h, from the frame along h to the face of h: linear from rho_{vi->t} -
/// rho_{vi->e} at its tail to rho_{vj->t} - rho_{vj->e} at its tip, because the frames of edge and face turn by eps and
/// tau on the way (LTGD 2016, eqs. 8 and 9).
[[nodiscard]] inline double edge_to_face_at(const Mesh& mesh, const Connection& connection, Index h, double s) {
  return connection.rho_t[h] - connection.rho_start(mesh, h) + s * (connection.tau[h] - connection.eps_along(mesh, h));
}

}  // namespace alcap::detail
