// SPDX-License-Identifier: MIT
#include "src/connection/global/held_rotations.h"

#include <cmath>

#include "src/base/parallel.h"
#include "src/connection/global/flexible_conjugate_gradients.h"
#include "src/connection/grounded_laplacian.h"

namespace alcap::detail {
namespace {

using Edges = HeldRotations::Edges;

double dot_of_edges(const Edges& a, const Edges& b) {
  return parallel_sum<double>(a.size(), [&](std::int64_t e) { return dot(a[e], b[e]); });
}

// y = x + s * d; y may be x or d.
void combine_edges(const Edges& x, double s, const Edges& d, Edges& y) {
  parallel_for(x.size(), [&](std::int64_t e) { y[e] = x[e] + s * d[e]; });
}

}  // namespace

HeldRotations::HeldRotations(const Mesh& mesh, const Geometry& geometry)
    // A preconditioner: more digits than 1e-4 save no iteration.
    : mesh_(mesh), poisson_(make_linear_solver<double>({.tolerance = 1e-4})) {
  const SparseMatrix<double> L = grounded_laplacian(mesh, geometry, find_topology(mesh));
  poisson_->analyse(L);
  poisson_->factorise(L);
}

int HeldRotations::solve(CorrectionSystem<float>& blocks, Edges& r, double wanted, int most,
                         const std::function<void(Edges& p, Edges& q)>& product, Edges& edges) const {
  struct Space {
    const HeldRotations& held;
    CorrectionSystem<float>& blocks;
    const std::function<void(Edges& p, Edges& q)>& multiply;
    double precondition(const Edges& r, Edges& z) const { return held.precondition(blocks, r, z); }
    void product(Edges& p, Edges& q) const { multiply(p, q); }
    static double dot(const Edges& a, const Edges& b) { return dot_of_edges(a, b); }
    static void combine(const Edges& x, double s, const Edges& d, Edges& y) { combine_edges(x, s, d, y); }
  };
  return flexible_conjugate_gradients(Space{*this, blocks, product}, wanted, most, r, edges);
}

// z = P r; returns r' z.
double HeldRotations::precondition(CorrectionSystem<float>& blocks, const Edges& r, Edges& z) const {
  (void)blocks.start([&](Index e) { return r[e]; });
  parallel_for(mesh_.edges(), [&](std::int64_t e) { z[e] = blocks.preconditioned(static_cast<Index>(e)); });
  MatrixX<double> b = MatrixX<double>::Zero(mesh_.vertices(), 1), g(mesh_.vertices(), 1);
  for (Index e = 0; e < mesh_.edges(); ++e) {
    const Index h = mesh_.halfedge(e);
    b(mesh_.tail(h), 0) += r[e].mean / 2 - r[e].difference;
    b(mesh_.tip(h), 0) += r[e].mean / 2 + r[e].difference;
  }
  (void)poisson_->solve(b, g);
  parallel_for(mesh_.edges(), [&](std::int64_t e) {
    const Index h = mesh_.halfedge(static_cast<Index>(e));
    const double tail = g(mesh_.tail(h), 0), tip = g(mesh_.tip(h), 0);
    z[e] = {z[e].mean + (tail + tip) / 2, z[e].difference + (tip - tail), 0};
  });
  return dot_of_edges(r, z);
}

}  // namespace alcap::detail
