// SPDX-License-Identifier: MIT
//
// held_rotations.h: conjugate gradients for the globally optimal connection with rho_ij held (trivial connections).
// That problem is not local: turning all frames around slowly varying vertices costs next to nothing, the Dirichlet
// energy of the turn. So the edges' blocks are joined by a Poisson solve for such turns g of vertices, which move
// rho_{v->e} by g at both ends of an edge and rho_{v->t} by g in the faces.
#pragma once

#include <functional>
#include <memory>

#include "alcap/geometry.h"
#include "alcap/mesh.h"
#include "alcap/solve.h"
#include "src/base/array.h"
#include "src/connection/global/edge_correction.h"
#include "src/connection/global/system.h"

namespace alcap::detail {

class HeldRotations {
 public:
  using Edges = Array<EdgeCorrection>;  // #E, with rotation zero

  HeldRotations(const Mesh& mesh, const Geometry& geometry);

  /// edges += the solution for the forces `residual`, to a relative residual of `wanted` or `most` iterations; those
  /// done. blocks: the inverse of the edges' blocks, Rotations::held. product(p, q) sets q = A p. Flexible: the float
  /// blocks and the Poisson solver are not exactly linear. `residual` is used up.
  int solve(CorrectionSystem<float>& blocks, Edges& residual, double wanted, int most,
            const std::function<void(Edges& p, Edges& q)>& product, Edges& edges) const;

 private:
  double precondition(CorrectionSystem<float>& blocks, const Edges& r, Edges& z) const;

  const Mesh& mesh_;
  std::unique_ptr<LinearSolver<double>> poisson_;
};

}  // namespace alcap::detail
