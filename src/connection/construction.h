// SPDX-License-Identifier: MIT
//
// construction.h: the steps that all connections are made of. Internal to src/connection.
#pragma once

#include "alcap/connection.h"

namespace alcap::detail {

/// The lifted state that every construction starts from and the optimisations correct. Per halfedge h = i -> j of face
/// t: start = rho_{vi->t} - rho_{vi->e} - rho_{e->t}, end = rho_{vj->t} - rho_{vj->e} - rho_{e->t}, the deviation of
/// LTGD 2016, eq. 9, from eq. 10 at both ends. Then tau = eps - start + end, without any modulus.
struct LiftedResiduals {
  VectorX<double> start, end;
};

/// Assembles a connection from the curvature each interior vertex shall have: the corner angles seen are
/// angle + alpha_h - alpha_prev(h), each takes the share curvature(v) * angle / angle_sum of its vertex's curvature.
/// With curvature = angle defect and no alpha this is the polar map (LTGD 2016, eqs. 11 and 12). `residuals` receives
/// the lifted state.
[[nodiscard]] Connection build_connection(const Mesh& mesh, const Geometry& geometry,
                                          const VectorX<double>& vertex_curvature, const VectorX<double>& alpha,
                                          PolarCenter center, LiftedResiduals& residuals);

/// build_connection() with the curvature of the surface itself.
[[nodiscard]] Connection polar_start(const Mesh& mesh, const Geometry& geometry, PolarCenter center,
                                     LiftedResiduals& residuals);

/// tau = eps - start + end (from LTGD 2016, eq. 8) and K = -(sum of tau) of each face.
void close_faces(const Mesh& mesh, const LiftedResiduals& residuals, Connection& connection);

/// Moves rho_{v->t} so that tau = -K/3 (LTGD 2016, Sec. 5.2).
void optimise_locally(const Mesh& mesh, Connection& connection, LiftedResiduals& residuals);

/// Minimises D_T + detail D_E over all of rho from here (LTGD 2016, Sec. 5.3).
void optimise_globally(const Mesh& mesh, const Geometry& geometry, const GlobalOptions& options, Connection& connection,
                       LiftedResiduals& residuals);

/// The same over rho_{v->t} and rho_{v->e} alone: the vertex-to-vertex rotations, hence every K, stay.
void optimise_with_held_rotations(const Mesh& mesh, const Geometry& geometry, const GlobalOptions& options,
                                  Connection& connection, LiftedResiduals& residuals);

}  // namespace alcap::detail
