// SPDX-License-Identifier: MIT
//
// smoothest.h: fields from energies (LTGD 2016, Sec. 7): the smallest eigenvector of the connection Laplacian, one
// component at a time.
//
//   auto result = alcap::smoothest_field(connected, {.n = 4});
//   result.field.u, result.components[0].lambda ...
#pragma once

#include <memory>
#include <vector>

#include "alcap/field.h"
#include "alcap/solve.h"
#include "alcap/topology.h"

namespace alcap {

class ConnectedSurface;

/// Which field is the smoothest.
struct SmoothestOptions {
  int n = 1;  // 1 vector field, 2 line field, 4 cross field
  /// Knoeppel et al. 2013, energy family E_s = (1+s) E_H + (1-s) E_A, s in [-1, 1]. 0 is the Dirichlet energy.
  double s = 0.0;
  EigenOptions eigen = {};  // tolerance, backend; its cancel is honoured in the assembly as well
};

/// The smoothest field and how it was found.
struct SmoothestResult {
  Field field;  ///< the field
  /// One per connected component of the mesh, in the order of topology.h.
  std::vector<EigenReport> components;
  double assembly_seconds = 0;  ///< wall clock
  double eigen_seconds = 0;     ///< wall clock
};

/// The smoothest n-vector field: per component the smallest eigenpair of E_s against the mass matrix, with |u|_M = 1.
/// Throws OptionError for n < 1 or s outside [-1, 1]. Non-convergence is reported, not thrown. The field has the frames
/// of the surface, made after the solve, which takes the most memory; none where the surface lies in no space.
[[nodiscard]] SmoothestResult smoothest_field(const ConnectedSurface& surface, const SmoothestOptions& options = {});

/// The same for those who own the parts. The frames may be empty and set afterwards.
[[nodiscard]] SmoothestResult smoothest_field(const Mesh& mesh, const Geometry& geometry, const Connection& connection,
                                              std::shared_ptr<const Frames> frames,
                                              const SmoothestOptions& options = {});

/// The `count` smoothest fields: the smallest eigenpairs of the whole surface, components taken together, as columns of
/// #V rows, zero at vertices that no face uses. Field{.n = options.n, .u = modes.U.col(k), .frames = surface.frames()}
/// is the k-th. Throws as smoothest_field() and eigenpairs().
[[nodiscard]] EigenModes smoothest_modes(const ConnectedSurface& surface, int count,
                                         const SmoothestOptions& options = {});

}  // namespace alcap
