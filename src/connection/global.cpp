// SPDX-License-Identifier: MIT
//
// global.cpp: the connection that is as Levi-Civita as possible (LTGD 2016, Sec. 5.3), by the steps of global/: solve
// for corrections of the polar map, fix the gauge, write them back.
#include "alcap/connection.h"
#include "src/connection/construction.h"
#include "src/connection/global/energy.h"
#include "src/connection/global/gauge.h"
#include "src/connection/global/solve.h"
#include "src/connection/global/write_back.h"

namespace alcap {
namespace detail {
namespace {

void report(const RefinementState& refinement, ConnectionReport& out) {
  out.iterations = refinement.iterations;
  out.residual = refinement.residual;
  out.converged = refinement.converged;
  out.message.clear();
  if (!out.converged)
    out.message = "the global connection stopped after " + std::to_string(out.iterations) +
                  " iterations above its tolerance; raise GlobalOptions::max_iterations, GlobalOptions::tolerance or "
                  "GlobalOptions::detail";
}

}  // namespace

void optimise_globally(const Mesh& mesh, const Geometry& geometry, const GlobalOptions& options, Connection& c,
                       LiftedResiduals& r) {
  validate(options);
  const HalfedgeWeights weights(mesh, geometry, options);
  const Corrections found = solve_free({mesh, geometry, weights, options.detail}, {&c.tau, &r}, options);
  report(found.refinement, c.report);
  c.options = options;
  const VectorX<double> turn = mean_turns(mesh, geometry, found.corners);
  move_corners(mesh, found.corners, turn, c, r);
  move_rotations(mesh, found, turn, c);
  follow_with_edges(mesh, weights, turn, c, r);
  close_faces(mesh, geometry, weights, r, c);
}

void optimise_with_held_rotations(const Mesh& mesh, const Geometry& geometry, const GlobalOptions& options,
                                  Connection& c, LiftedResiduals& r) {
  validate(options);
  const HalfedgeWeights weights(mesh, geometry, options);
  const Corrections found = solve_held({mesh, geometry, weights, options.detail}, {&c.tau, &r}, options);
  report(found.refinement, c.report);
  c.options = options;
  const VectorX<double> no_turn = VectorX<double>::Zero(mesh.vertices());  // held rotations leave no gauge to fix
  move_corners(mesh, found.corners, no_turn, c, r);
  follow_with_edges(mesh, weights, no_turn, c, r);
  close_faces(mesh, geometry, weights, r, c);
}

}  // namespace detail

Connection globally_optimal(const Mesh& mesh, const Geometry& geometry, const GlobalOptions& options) {
  detail::LiftedResiduals residuals;
  Connection c = detail::polar_start(mesh, geometry, PolarCenter::incenter, residuals);
  detail::optimise_globally(mesh, geometry, options, c, residuals);
  c.kind = ConnectionKind::global;
  return c;
}

}  // namespace alcap
