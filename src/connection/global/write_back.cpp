// SPDX-License-Identifier: MIT
#include "src/connection/global/write_back.h"

#include "src/base/parallel.h"

namespace alcap::detail {
namespace {

struct EdgeEnds {
  double tail, tip;  // of the canonical halfedge
};

// The corrections of rho_{v->e} at both ends of edge e that are best for the state r.
EdgeEnds best_ends(const Mesh& mesh, const HalfedgeWeights& weights, const LiftedResiduals& r, Index e) {
  const Index h = mesh.halfedge(e), g = mesh.twin(h);
  if (g == none) return {r.start[h], r.end[h]};
  const double here = weights(h), there = weights(g), sum = here + there;
  return {(here * r.start[h] + there * r.end[g]) / sum, (here * r.end[h] + there * r.start[g]) / sum};
}

}  // namespace

void move_corners(const Mesh& mesh, const Array<double>& corners, const VectorX<double>& turn, Connection& c,
                  LiftedResiduals& r) {
  parallel_for(mesh.faces(), [&](std::int64_t t) {
    const Index h = static_cast<Index>(3 * t);
    for (Index k = 0; k < 3; ++k) {
      const double here = corners[h + k];
      c.rho_t[h + k] += here - turn[mesh.tail(h + k)];
      r.start[h + k] += here;
      r.end[h + k] += corners[h + (k + 1) % 3];
    }
  });
}

void move_rotations(const Mesh& mesh, const Corrections& found, const VectorX<double>& turn, Connection& c) {
  parallel_for(mesh.edges(), [&](std::int64_t e) {
    const Index h = mesh.halfedge(static_cast<Index>(e));
    const double rotation = found.edges[found.faces.number[e]].rotation;
    c.rho[e] += rotation - turn[mesh.tail(h)] + turn[mesh.tip(h)];
    c.eps[e] += rotation;
  });
}

void follow_with_edges(const Mesh& mesh, const HalfedgeWeights& weights, const VectorX<double>& turn, Connection& c,
                       LiftedResiduals& r) {
  parallel_for(mesh.edges(), [&](std::int64_t e) {
    const EdgeEnds best = best_ends(mesh, weights, r, static_cast<Index>(e));
    const Index h = mesh.halfedge(static_cast<Index>(e)), g = mesh.twin(h);
    c.rho_e[2 * e] += best.tail - turn[mesh.tail(h)];
    c.rho_e[2 * e + 1] += best.tip - turn[mesh.tip(h)];
    c.eps[e] += best.tip - best.tail;
    r.start[h] -= best.tail;
    r.end[h] -= best.tip;
    if (g != none) {
      r.end[g] -= best.tail;
      r.start[g] -= best.tip;
    }
  });
}

}  // namespace alcap::detail
