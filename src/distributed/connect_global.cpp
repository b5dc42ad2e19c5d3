// SPDX-License-Identifier: MIT
//
// connect_global.cpp: the globally optimal connection by conjugate gradients on corrections of edges, as
// src/connection/global/ has it on one machine, in double and with single faces. An edge is owned with its smaller
// vertex. Its owner has both of its faces, whose other edges' corrections come from their owners in every step.
#include <algorithm>
#include <array>
#include <cmath>

#include "kernels/face_relaxation.h"
#include "src/base/array.h"
#include "src/base/parallel.h"
#include "src/connection/global/conjugate_gradients.h"
#include "src/connection/global/edge_correction.h"
#include "src/connection/global/flexible_conjugate_gradients.h"
#include "src/connection/global/rounds.h"
#include "src/connection/global/system.h"
#include "src/distributed/connect.h"
#include "src/distributed/linear.h"

namespace alcap::detail::distributed {
namespace {

using Values = std::array<double, 3>;  // of an edge: mean, difference, rotation
static_assert(sizeof(Values) == sizeof(EdgeCorrection));

/// The edges of core faces: owned ones first, then those of others.
struct EdgeNumbers {
  std::vector<Index> number;  // per edge of the mesh, or `none`
  std::vector<Index> edge;    // back
  Index owned = 0;
  Exchange others;  // roots: owned ones; leaves: the rest
};

/// The edges from vertex v to larger ones, by the number of those. Complete around inner vertices.
std::vector<Index> edges_up(const Patch& patch, Index v) {
  struct Up {
    Index vertex, edge;
  };
  std::vector<Up> up;
  const auto add = [&](Index other, Index e) {
    if (patch.vertex[at(other)] > patch.vertex[at(v)]) up.push_back({patch.vertex[at(other)], e});
  };
  patch.mesh.for_each_outgoing(v, [&](Index h) {
    add(patch.mesh.tip(h), patch.mesh.edge(h));
    const Index p = Mesh::prev(h);
    if (patch.mesh.boundary_halfedge(p)) add(patch.mesh.tail(p), patch.mesh.edge(p));
  });
  std::ranges::sort(up, {}, &Up::vertex);
  std::vector<Index> edges;
  for (const Up& u : up) edges.push_back(u.edge);
  return edges;
}

EdgeNumbers number_edges_of(const Patch& patch) {
  const Mesh& mesh = patch.mesh;
  EdgeNumbers n;
  n.number.assign(at(mesh.edges()), none);
  std::vector<Index> first(at(patch.inner), 0);  // number of the first edge up from each owned vertex
  for (Index v = 0; v < patch.owned; ++v) {
    first[at(v)] = static_cast<Index>(n.edge.size());
    if (patch.empty()) continue;
    for (const Index e : edges_up(patch, v)) {
      n.number[at(e)] = static_cast<Index>(n.edge.size());
      n.edge.push_back(e);
    }
  }
  n.owned = static_cast<Index>(n.edge.size());
  patch.extend(first.data());
  std::vector<char> wanted(at(mesh.edges()), 0);
  for (Index h = 0; h < mesh.halfedges(); ++h)
    if (patch.core[at(h / 3)] != 0 && n.number[at(mesh.edge(h))] == none) wanted[at(mesh.edge(h))] = 1;
  std::vector<Node> nodes;
  for (Index v = patch.owned; v < (patch.empty() ? 0 : patch.inner); ++v) {
    const std::vector<Index> up = edges_up(patch, v);
    for (std::size_t k = 0; k < up.size(); ++k) {
      if (wanted[at(up[k])] == 0) continue;
      n.number[at(up[k])] = static_cast<Index>(n.edge.size());
      n.edge.push_back(up[k]);
      nodes.push_back({patch.ring_node[at(v - patch.owned)].rank, first[at(v)] + static_cast<Index>(k)});
    }
  }
  n.others = Exchange(n.owned, nodes);
  return n;
}

class TogetherSystem {
 public:
  using Scalar = double;

  TogetherSystem(const Patch& patch, const PatchWeights& weights, double lambda, Rotations rotations,
                 const Connection& c, const LiftedResiduals& r)
      : patch_(patch),
        mesh_(patch.mesh),
        rotations_(rotations),
        edges_(number_edges_of(patch)),
        c_(c),
        r_(r),
        face_(at(patch.mesh.faces())),
        force_(at(patch.mesh.halfedges())),
        z_(edges_.edge.size(), Values{}),
        p_(at(edges_.owned), Values{}),
        corners(at(patch.mesh.halfedges()), 0),
        x(edges_.edge.size(), Values{}) {
    r_edges_ = q_ = w_ = p_;
    each_core([&](Index t) {
      const Index h = 3 * t;
      const double cot[3] = {patch.geometry.cot(h), patch.geometry.cot(h + 1), patch.geometry.cot(h + 2)};
      double p[3];
      for (Index k = 0; k < 3; ++k) p[k] = mesh_.boundary_halfedge(h + k) ? 0 : lambda * weights(h + k);
      kernels::face_coefficients(cot, p, face_[at(t)]);
    });
    set_blocks();
    rounding_ = rounding(lambda, weights);
  }

  [[nodiscard]] Index owned() const { return edges_.owned; }
  [[nodiscard]] const EdgeNumbers& edges() const { return edges_; }
  [[nodiscard]] double rounding() const { return rounding_; }

  /// r = the forces in the state with the corrections so far, z = P r; r' z.
  double start() {
    forces(x, false, r_edges_);
    return precondition();
  }

  /// w = A z, minus the forces of faces at rest; z' w.
  double apply() {
    forces(z_, true, w_);
    return -dot(z_, w_);
  }

  /// See conjugate_gradients.h; x goes on from where it is.
  double step(double alpha, double beta) {
    parallel_for(edges_.owned, [&](std::int64_t i) {
      for (std::size_t k = 0; k < 3; ++k) {
        p_[at(i)][k] = z_[at(i)][k] + beta * p_[at(i)][k];
        q_[at(i)][k] = w_[at(i)][k] + beta * q_[at(i)][k];
        x[at(i)][k] += alpha * p_[at(i)][k];
        r_edges_[at(i)][k] += alpha * q_[at(i)][k];
      }
    });
    return precondition();
  }

  /// Sums over the owned edges of all ranks.
  [[nodiscard]] double dot(const std::vector<Values>& a, const std::vector<Values>& b) const {
    return sum(parallel_sum<double>(edges_.owned, [&](std::int64_t i) {
      return a[at(i)][0] * b[at(i)][0] + a[at(i)][1] * b[at(i)][1] + a[at(i)][2] * b[at(i)][2];
    }));
  }

  /// z = P r on owned edges.
  void invert_blocks(const std::vector<Values>& r, std::vector<Values>& z) const {
    parallel_for(edges_.owned, [&](std::int64_t i) {
      const double in[3] = {r[at(i)][0], r[at(i)][1], r[at(i)][2]};
      double out[3];
      kernels::multiply_symmetric(inverse_[at(i)].a, in, out);
      z[at(i)] = {out[0], out[1], out[2]};
    });
  }

  /// q = A p on owned edges; fetches what others own of p.
  void multiply(std::vector<Values>& p, std::vector<Values>& q) {
    forces(p, true, q);
    parallel_for(edges_.owned, [&](std::int64_t i) { q[at(i)] = {-q[at(i)][0], -q[at(i)][1], -q[at(i)][2]}; });
  }

  /// After start(): the forces on owned edges.
  [[nodiscard]] const std::vector<Values>& residual() const { return r_edges_; }

 private:
  struct Block {
    double a[6];
  };

  /// Forces on owned edges: in the lifted state with corrections `at_edges`, or at rest. Fetches what others own.
  void forces(std::vector<Values>& at_edges, bool at_rest, std::vector<Values>& out) {
    edges_.others.fetch(at_edges.data(), at_edges.data() + edges_.owned);
    each_core([&](Index t) { relax(t, at_edges, at_rest); });
    parallel_for(edges_.owned, [&](std::int64_t i) {
      const Index h = mesh_.halfedge(edges_.edge[at(i)]), g = mesh_.twin(h);
      const Values& a = force_[at(h)];
      out[at(i)] = {a[0], a[1], -a[2]};
      if (g == none) return;
      const Values& b = force_[at(g)];
      out[at(i)] = {a[0] + b[0], a[1] - b[1], b[2] - a[2]};
    });
    if (rotations_ == Rotations::held)
      for (Index i = 0; i < edges_.owned; ++i) out[at(i)][2] = 0;
  }

  /// z = P r, the inverse of every edge's own block; r' z.
  double precondition() {
    invert_blocks(r_edges_, z_);
    return dot(r_edges_, z_);
  }

  template <class Body>
  void each_core(Body&& body) const {
    parallel_for(mesh_.faces(), [&](std::int64_t t) {
      if (patch_.core[at(t)] != 0) body(static_cast<Index>(t));
    });
  }

  /// Signs: the first face of an edge sees (-m, -d, R), the second (-m, d, -R), as FaceRelaxation::gather().
  void relax(Index t, const std::vector<Values>& at_edges, bool at_rest) {
    kernels::FaceState<double> v;
    double moved[3];
    for (Index k = 0; k < 3; ++k) {
      const Index h = 3 * t + k, e = mesh_.edge(h);
      const Values& u = at_edges[at(edges_.number[at(e)])];
      const double sign = mesh_.halfedge(e) == h ? 1 : -1;
      v.mean[k] = (at_rest ? 0 : (r_.start[h] + r_.end[h]) / 2) - u[0];
      v.difference[k] = (at_rest ? 0 : r_.end[h] - r_.start[h]) - sign * u[1];
      v.tau[k] = (at_rest ? 0 : c_.tau[h]) + sign * u[2];
    }
    kernels::relax(face_[at(t)], v, moved);
    for (Index k = 0; k < 3; ++k) {
      force_[at(3 * t + k)] = {v.mean[k], v.difference[k], v.tau[k]};
      if (!at_rest) corners[at(3 * t + k)] = moved[k];
    }
  }

  void own_block(Index h, double (&own)[6]) const {
    double pull[3][3];
    kernels::unit_pulls(face_[at(h / 3)], h % 3, pull);
    kernels::own_block(face_[at(h / 3)], h % 3, pull, own);
  }

  void set_blocks() {
    inverse_.resize(at(edges_.owned));
    parallel_for(edges_.owned, [&](std::int64_t i) {
      const Index h = mesh_.halfedge(edges_.edge[at(i)]), g = mesh_.twin(h);
      double a[6], b[6] = {};
      own_block(h, a);
      if (g != none) own_block(g, b);
      // Seen from the first face (m, d, t) is (-m, -d, R), from the second (-m, d, -R).
      for (int k = 0; k < 6; ++k) a[k] = k == 1 || k == 2 ? a[k] - b[k] : a[k] + b[k];
      a[2] = -a[2];
      a[4] = -a[4];
      if (rotations_ == Rotations::held) a[2] = a[4] = a[5] = 0;
      kernels::invert_symmetric(a, inverse_[at(i)].a);
    });
  }

  /// As rounding_of() of src/connection/global/solve.cpp.
  double rounding(double lambda, const PatchWeights& weights) const {
    const double total = sum(parallel_sum<double>(mesh_.faces(), [&](std::int64_t t) {
      double energy = 0;
      if (patch_.mine[at(t)] == 0) return energy;
      for (Index h = static_cast<Index>(3 * t); h < 3 * t + 3; ++h) {
        energy += patch_.geometry.cot(h) / 36;
        if (!mesh_.boundary_halfedge(h)) energy += lambda * weights(h);
      }
      return energy;
    }));
    return force_digits * std::sqrt(total);
  }

  const Patch& patch_;
  const Mesh& mesh_;
  Rotations rotations_;
  EdgeNumbers edges_;
  const Connection& c_;
  const LiftedResiduals& r_;
  std::vector<kernels::FaceCoefficients<double>> face_;
  std::vector<Values> force_;  // per halfedge
  std::vector<Block> inverse_;
  double rounding_ = 0;
  // Conjugate gradients: on owned edges, z also on those of others.
  std::vector<Values> z_, p_, r_edges_, q_, w_;

 public:
  std::vector<double> corners;  ///< 3 #F: what rho_{v->t} of core faces moves by
  std::vector<Values> x;        ///< the corrections
};

void tell(const RefinementState& state, ConnectionReport& report) {
  report.iterations = state.iterations;
  report.residual = state.residual;
  report.converged = state.converged;
  if (!state.converged)
    report.message = "the global connection stopped after " + std::to_string(state.iterations) +
                     " iterations above its tolerance; raise GlobalOptions::max_iterations, "
                     "GlobalOptions::tolerance or GlobalOptions::detail";
}

/// Rounds of conjugate gradients, each from the true gradient, as solve_free() of src/connection/global/solve.cpp.
void solve(TogetherSystem& system, const GlobalOptions& options, ConnectionReport& report) {
  RefinementState state;
  Rounds rounds(options, system.rounding(), state);
  for (double square = system.start(); rounds.another(square) && !rounds.stalled(); square = system.start())
    rounds.add(conjugate_gradients(system, square, rounds.wanted(), rounds.left()));
  tell(state, report);
}

/// What joins the edges where rotations are held: conjugate gradients with the edges' blocks and a Poisson solve for
/// turns of vertices, as src/connection/global/held_rotations.h.
class HeldSpace {
 public:
  HeldSpace(const Patch& patch, const Components& components, TogetherSystem& system)
      : patch_(patch),
        system_(system),
        // A preconditioner, as on one machine.
        poisson_(assemble_laplacian(patch, components, std::vector<char>(at(patch.inner), 0)), nullptr, 1e-4, 1000) {}

  double precondition(const std::vector<Values>& r, std::vector<Values>& z) const {
    const EdgeNumbers& n = system_.edges();
    system_.invert_blocks(r, z);
    VectorX<double> b = VectorX<double>::Zero(patch_.inner);
    each_edge(n, [&](std::size_t i, Index tail, Index tip) {
      b[tail] += r[i][0] / 2 - r[i][1];
      b[tip] += r[i][0] / 2 + r[i][1];
    });
    patch_.ring.reduce(b.data() + patch_.owned, b.data(), MPI_SUM);
    ComplexVectorX<double> turn;
    poisson_.solve(b.head(patch_.owned).cast<C>(), turn);
    VectorX<double> g(patch_.inner);
    g.head(patch_.owned) = turn.real();
    patch_.extend(g.data());
    each_edge(n, [&](std::size_t i, Index tail, Index tip) {
      z[i][0] += (g[tail] + g[tip]) / 2;
      z[i][1] += g[tip] - g[tail];
    });
    return system_.dot(r, z);
  }
  void product(std::vector<Values>& p, std::vector<Values>& q) const { system_.multiply(p, q); }
  [[nodiscard]] double dot(const std::vector<Values>& a, const std::vector<Values>& b) const {
    return system_.dot(a, b);
  }
  void combine(const std::vector<Values>& x, double s, const std::vector<Values>& d, std::vector<Values>& y) const {
    parallel_for(system_.owned(), [&](std::int64_t i) {
      for (std::size_t k = 0; k < 3; ++k) y[at(i)][k] = x[at(i)][k] + s * d[at(i)][k];
    });
  }

 private:
  template <class Body>
  void each_edge(const EdgeNumbers& n, Body&& body) const {
    for (Index i = 0; i < n.owned; ++i) {
      const Index h = patch_.mesh.halfedge(n.edge[at(i)]);
      body(at(i), patch_.mesh.tail(h), patch_.mesh.tip(h));
    }
  }

  const Patch& patch_;
  TogetherSystem& system_;
  mutable LinearSystem poisson_;
};

/// As solve_held() of src/connection/global/solve.cpp.
void solve_held_together(const HeldSpace& space, TogetherSystem& system, const GlobalOptions& options,
                         ConnectionReport& report) {
  RefinementState state;
  Rounds rounds(options, system.rounding(), state);
  int stalls = 0;
  while (rounds.another(system.start())) {
    stalls += rounds.stalled() ? 1 : 0;
    if (stalls > 1) break;
    std::vector<Values> residual = system.residual();
    residual.resize(system.edges().edge.size(), Values{});
    rounds.add(flexible_conjugate_gradients(space, std::max(least_held_reduction, rounds.wanted()), rounds.left(),
                                            residual, system.x));
  }
  tell(state, report);
}

/// The mean turn of each inner vertex's corners, weighed by angle, as mean_turns() of src/connection/global/gauge.h.
std::vector<double> turns(const Patch& patch, const std::vector<double>& corners) {
  std::vector<double> turn(at(patch.inner), 0);
  parallel_for(patch.empty() ? 0 : patch.owned, [&](std::int64_t v) {
    double total = 0, weight = 0;
    patch.mesh.for_each_outgoing(static_cast<Index>(v), [&](Index h) {
      total += patch.geometry.angle(h) * corners[at(h)];
      weight += patch.geometry.angle(h);
    });
    turn[at(v)] = weight > 0 ? total / weight : 0.0;
  });
  patch.extend(turn.data());
  return turn;
}

/// Final angles of owned edges, as move_rotations() and follow_with_edges() of src/connection/global/write_back.h, then
/// of those that others own; `best` receives what the residuals at both ends fall by.
using Angles = std::array<double, 6>;  // rho, rho_e at both ends, eps, best at tail and tip

std::vector<Angles> move_edges(const Patch& patch, const TogetherSystem& system, const PatchWeights& weights,
                               const std::vector<double>& turn, const LiftedResiduals& r, Connection& c) {
  const Mesh& mesh = patch.mesh;
  const EdgeNumbers& n = system.edges();
  std::vector<Angles> angles(n.edge.size());
  for (Index i = 0; i < n.owned; ++i) {
    const Index e = n.edge[at(i)], h = mesh.halfedge(e), g = mesh.twin(h);
    const double rotation = system.x[at(i)][2];
    double tail = r.start[h], tip = r.end[h];
    if (g != none) {
      const double here = weights(h), there = weights(g), total = here + there;
      tail = (here * r.start[h] + there * r.end[g]) / total;
      tip = (here * r.end[h] + there * r.start[g]) / total;
    }
    const double turn_tail = turn[at(mesh.tail(h))], turn_tip = turn[at(mesh.tip(h))];
    angles[at(i)] = {c.rho[e] + rotation - turn_tail + turn_tip,
                     c.rho_e[2 * std::int64_t{e}] + tail - turn_tail,
                     c.rho_e[2 * std::int64_t{e} + 1] + tip - turn_tip,
                     c.eps[e] + rotation + tip - tail,
                     tail,
                     tip};
  }
  n.others.fetch(angles.data(), angles.data() + n.owned);
  return angles;
}

/// As move_corners() and close_faces() of src/connection/global, and move_edges(). turn: of each inner vertex.
void write_back(const Patch& patch, const TogetherSystem& system, const PatchWeights& weights,
                const std::vector<double>& turn, Connection& c, LiftedResiduals& r) {
  const Mesh& mesh = patch.mesh;
  const auto each_core = [&](auto&& body) {
    parallel_for(mesh.faces(), [&](std::int64_t t) {
      if (patch.core[at(t)] != 0) body(static_cast<Index>(3 * t));
    });
  };
  each_core([&](Index h) {
    for (Index k = 0; k < 3; ++k) {
      const double here = system.corners[at(h + k)];
      c.rho_t[h + k] += here - turn[at(mesh.tail(h + k))];
      r.start[h + k] += here;
      r.end[h + k] += system.corners[at(h + (k + 1) % 3)];
    }
  });
  const std::vector<Angles> angles = move_edges(patch, system, weights, turn, r, c);
  const EdgeNumbers& n = system.edges();
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const std::int64_t e = n.edge[i];
    c.rho[e] = angles[i][0];
    c.rho_e[2 * e] = angles[i][1];
    c.rho_e[2 * e + 1] = angles[i][2];
    c.eps[e] = angles[i][3];
  }
  each_core([&](Index h) {
    double total = 0;
    for (Index k = h; k < h + 3; ++k) {
      const Index e = mesh.edge(k);
      const Angles& a = angles[at(n.number[at(e)])];
      const bool first = mesh.halfedge(e) == k;
      r.start[k] -= first ? a[4] : a[5];
      r.end[k] -= first ? a[5] : a[4];
      c.tau[k] = c.eps_along(mesh, k) - r.start[k] + r.end[k];
      total += c.tau[k];
    }
    c.K[h / 3] = -total;
  });
}

}  // namespace

void optimise_together(const Patch& patch, const PatchWeights& weights, const GlobalOptions& options, Connection& c,
                       LiftedResiduals& r) {
  TogetherSystem system(patch, weights, options.detail, Rotations::free, c, r);
  solve(system, options, c.report);
  write_back(patch, system, weights, turns(patch, system.corners), c, r);
}

void optimise_held_together(const Patch& patch, const Components& components, const PatchWeights& weights,
                            const GlobalOptions& options, Connection& c, LiftedResiduals& r) {
  TogetherSystem system(patch, weights, options.detail, Rotations::held, c, r);
  solve_held_together(HeldSpace(patch, components, system), system, options, c.report);
  // Held rotations leave no gauge to fix.
  write_back(patch, system, weights, std::vector<double>(at(patch.inner), 0), c, r);
}

}  // namespace alcap::detail::distributed
