// SPDX-License-Identifier: MIT
#include "src/connection/global/solve.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "src/base/parallel.h"
#include "src/connection/global/conjugate_gradients.h"
#include "src/connection/global/held_rotations.h"
#include "src/connection/global/rounds.h"
#include "src/connection/global/system.h"

namespace alcap::detail {
namespace {

// The norm that gradients have when every angle is off by its rounding: the root of the sum of the energies, less what
// faces hide from their neighbours (kernels/face_relaxation.h).
double rounding_of(const FaceEnergy& energy) {
  const double weights = parallel_sum<double>(energy.mesh.faces(), [&](std::int64_t t) {
    double sum = 0;
    for (Index h = static_cast<Index>(3 * t), k = 0; k < 3; ++k) {
      sum += energy.geometry.cot(h + k) / 36;
      if (!energy.mesh.boundary_halfedge(h + k)) sum += energy.lambda * energy.weights(h + k);
    }
    return sum;
  });
  return force_digits * std::sqrt(weights);
}

Corrections no_corrections(const Mesh& mesh, FacePairs faces) {
  Corrections c{std::move(faces), Array<EdgeCorrection>(mesh.edges()), Array<double>(mesh.halfedges()), {}};
  parallel_for(mesh.edges(), [&](std::int64_t e) { c.edges[e] = {0, 0, 0}; });
  return c;
}

bool open(const Mesh& mesh, const FacePairs& faces, std::int64_t i) {
  return mesh.boundary_halfedge(mesh.halfedge(faces.edge[i]));
}

}  // namespace

Corrections solve_free(const FaceEnergy& energy, const LiftedState& state, const GlobalOptions& options) {
  // What a float solve gains before its rounding shows. It shows in the number of iterations at first, so a little more
  // is right where that is the end; less so the harder the system, whose condition grows as 1 / detail.
  constexpr double float_reduction = 1e-5, last_of_all = 3e-7;
  const double last_reduction = last_of_all / std::sqrt(std::min(1.0, energy.lambda));
  const Mesh& mesh = energy.mesh;
  Corrections c = no_corrections(mesh, pair_faces(mesh, energy.geometry));
  Array<EdgeCorrection> forces(2 * std::int64_t{c.faces.outer});
  const FaceRelaxation relaxation(energy, c.faces, state, c.edges, forces, c.corners);
  const auto coefficients = [&](const auto& first, auto& out) { energy.coefficients(first, out); };
  const auto gradient = [&](Index i) { return relaxation.force(i, open(mesh, c.faces, i)); };
  // The first relaxation comes with the coefficients that both need.
  CorrectionSystem<float> system(mesh, c.faces, coefficients, Rotations::free, relaxation);
  std::optional<CorrectionSystem<double>> in_double;  // only where float does not do

  const auto improve = [&](auto& some, double square, double wanted, int most) {
    const int done = conjugate_gradients(some, square, wanted, most);
    parallel_for(c.faces.outer,
                 [&](std::int64_t i) { c.edges[i] = c.edges[i] + some.solution(static_cast<Index>(i)); });
    return done;
  };
  Rounds rounds(options, rounding_of(energy), c.refinement);
  for (double square = system.start(gradient); rounds.another(square); square = system.start(gradient)) {
    if (rounds.stalled()) {
      if (in_double) break;  // which has reached its own rounding, too
      in_double.emplace(mesh, c.faces, coefficients, Rotations::free, NoVisitor{});
    }
    if (in_double)
      rounds.add(improve(*in_double, in_double->start(gradient), rounds.wanted(), rounds.left()));
    else
      rounds.add(improve(system, square, rounds.wanted() >= last_reduction ? rounds.wanted() : float_reduction,
                         rounds.left()));
    relaxation.all(system);
  }
  return c;
}

Corrections solve_held(const FaceEnergy& energy, const LiftedState& state, const GlobalOptions& options) {
  const Mesh& mesh = energy.mesh;
  Corrections c = no_corrections(mesh, single_faces(mesh));
  Array<EdgeCorrection> forces(2 * std::int64_t{mesh.edges()});
  const FaceRelaxation relaxation(energy, c.faces, state, c.edges, forces, c.corners);
  const auto coefficients = [&](const auto& first, auto& out) { energy.coefficients(first, out); };
  const auto held_force = [&](const FaceRelaxation& faces, Index e) {
    const EdgeCorrection force = faces.force(e, open(mesh, c.faces, e));
    return EdgeCorrection{force.mean, force.difference, 0};
  };
  const auto gradient = [&](Index e) { return held_force(relaxation, e); };
  CorrectionSystem<float> blocks(mesh, c.faces, coefficients, Rotations::held, relaxation);
  const HeldRotations held(mesh, energy.geometry);

  // A p: minus the forces of faces at rest whose edges are turned by p.
  Array<double> unused(mesh.halfedges());
  const auto product = [&](Array<EdgeCorrection>& p, Array<EdgeCorrection>& q) {
    const FaceRelaxation rest(energy, c.faces, {}, p, forces, unused);
    rest.all(blocks);
    parallel_for(mesh.edges(), [&](std::int64_t e) { q[e] = -1.0 * held_force(rest, static_cast<Index>(e)); });
  };
  Array<EdgeCorrection> residual(mesh.edges());
  Rounds rounds(options, rounding_of(energy), c.refinement);
  int stalls = 0;
  while (rounds.another(blocks.start(gradient))) {
    stalls += rounds.stalled() ? 1 : 0;
    if (stalls > 1) break;
    parallel_for(mesh.edges(), [&](std::int64_t e) { residual[e] = gradient(static_cast<Index>(e)); });
    rounds.add(
        held.solve(blocks, residual, std::max(least_held_reduction, rounds.wanted()), rounds.left(), product, c.edges));
    relaxation.all(blocks);
  }
  return c;
}

}  // namespace alcap::detail
