// SPDX-License-Identifier: MIT
//
// correction_system.h: the linear system of the globally optimal connection (LTGD 2016, Sec. 5.3), applied without a
// matrix, and conjugate gradients on it.
//
// Unknowns are corrections (X, R): X per corner to rho_{v->t}, R per edge to rho_ij. The correction y to rho_{v->e} is
// eliminated edge by edge: with lifted residuals a, b of the two sides of an edge, weights p, q and
// Q(r, s) = (r^2 + r s + s^2)/3, the minimum over y of p Q(a - y) + q Q(b - y) is pq/(p+q) Q(a - b), reached at
// y = (p a + q b)/(p + q); a boundary edge has none left. What remains is local and symmetric positive semidefinite
// (kernel: one gauge angle per vertex), and its condition does not grow with the mesh. Right-hand sides and search
// directions are orthogonal to the kernel, so conjugate gradients need no care for it.
//
// The preconditioner is the diagonal, except on badly shaped faces: a sliver's Whitney matrix ties its three corners
// and three edges together with a stiffness of 1 / (smallest angle), which a diagonal cannot see. Their six unknowns
// are solved together (additive Schwarz), which keeps the iterations of scans and CAD near those of clean meshes.
#pragma once

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <vector>

#include "alcap/geometry.h"
#include "alcap/mesh.h"
#include "alcap/parallel.h"
#include "kernels/whitney.h"

namespace alcap::detail {

/// A value per corner and a value per edge; R is empty when the vertex-to-vertex rotations are held.
template <class S>
struct Correction {
  VectorX<S> X, R;
};

/// edge_weight: #E, detail * p q / (p + q), zero on the boundary.
template <class S>
class CorrectionSystem {
 public:
  /// Faces whose cotangents sum to more than `block_above` are preconditioned as blocks.
  CorrectionSystem(const Mesh& mesh, const VectorX<S>& cots, const VectorX<S>& edge_weight, bool hold_rho,
                   double block_above)
      : mesh_(mesh), cot_(cots), weight_(edge_weight), hold_rho_(hold_rho), tau_force_(mesh.halfedges()) {
    scale_ = {VectorX<S>(mesh.halfedges()), VectorX<S>(hold_rho ? 0 : mesh.edges())};
    parallel_for(mesh.halfedges(), [&](std::int64_t i) {
      const Index h = static_cast<Index>(i), n = Mesh::next(h), p = Mesh::prev(h);
      // W_hh + W_pp - 2 W_hp of the two halfedges that meet here, and a third of both edges' weights.
      const S whitney = (cot_[n] + cot_[p]) / 2;
      scale_.X[i] = inverse(whitney + (weight_[mesh.edge(h)] + weight_[mesh.edge(p)]) / 3);
    });
    parallel_for(scale_.R.size(), [&](std::int64_t e) { scale_.R[e] = inverse(edge_mass(static_cast<Index>(e))); });
    collect_bad_faces(block_above);
  }

  /// z = P r with the preconditioner P; returns r' P r.
  double precondition(const Correction<S>& r, Correction<S>& z) {
    const auto diagonal = [](const VectorX<S>& d, const VectorX<S>& rv, VectorX<S>& zv) {
      parallel_for(rv.size(), [&](std::int64_t i) { zv[i] = d[i] * rv[i]; });
    };
    diagonal(scale_.X, r.X, z.X);
    diagonal(scale_.R, r.R, z.R);
    parallel_for(static_cast<std::int64_t>(bad_.size()), [&](std::int64_t b) {
      BadFace& f = bad_[static_cast<std::size_t>(b)];
      const Index h = 3 * f.face;
      Eigen::Matrix<S, 6, 1> in;
      for (Index k = 0; k < 3; ++k) {
        in[k] = r.X[h + k];
        in[3 + k] = hold_rho_ ? S(0) : r.R[mesh_.edge(h + k)];
      }
      const Eigen::Matrix<S, 6, 1> out = f.inverse * in;
      for (Index k = 0; k < 3; ++k) z.X[h + k] = out[k];
      f.edges = out.template tail<3>();
    });
    if (!hold_rho_)
      parallel_for(static_cast<std::int64_t>(bad_edges_.size()), [&](std::int64_t i) {
        const BadEdge& e = bad_edges_[static_cast<std::size_t>(i)];
        S sum = 0;
        for (const Index slot : e.slots)
          if (slot != none) sum += bad_[static_cast<std::size_t>(slot / 3)].edges[slot % 3];
        z.R[e.edge] = sum;
      });
    const auto product = [](const VectorX<S>& a, const VectorX<S>& b) {
      return parallel_sum<double>(a.size(), [&](std::int64_t i) { return double(a[i]) * double(b[i]); });
    };
    return product(r.X, z.X) + product(r.R, z.R);
  }

  [[nodiscard]] Correction<S> zeros() const {
    return {VectorX<S>::Zero(scale_.X.size()), VectorX<S>::Zero(scale_.R.size())};
  }

  /// out = A x; returns x' A x.
  double apply(const Correction<S>& x, Correction<S>& out) {
    const S* const X = x.X.data();
    const S* const R = x.R.data();
    double product = parallel_reduce(
        std::int64_t{mesh_.faces()}, 0.0,
        [&](std::int64_t begin, std::int64_t end) {
          double sum = 0;
          for (std::int64_t t = begin; t < end; ++t) {
            const Index h = static_cast<Index>(3 * t);
            S tau[3], jump_tail[3], jump_tip[3];
            for (Index k = 0; k < 3; ++k) {
              const Index e = mesh_.edge(h + k), g = mesh_.twin(h + k);
              const S here = X[h + k], ahead = X[h + (k + 1) % 3];
              tau[k] = ahead - here;
              if (!hold_rho_) tau[k] += g == none || h + k < g ? R[e] : -R[e];
              const S w = weight_[e] / 6;
              const S tail = g == none ? S(0) : here - X[Mesh::next(g)], tip = g == none ? S(0) : ahead - X[g];
              jump_tail[k] = w * (2 * tail + tip);
              jump_tip[k] = w * (tail + 2 * tip);
            }
            sum += finish_face(h, tau, jump_tail, jump_tip, X, out);
          }
          return sum;
        },
        [](double a, double b) { return a + b; });
    product += finish_edges(R, out);
    return product;
  }

  /// Half of the gradient of D_T + detail D_E at a lifted state.
  void gradient(const VectorX<S>& tau, const VectorX<S>& start, const VectorX<S>& end, Correction<S>& out) {
    parallel_for(mesh_.faces(), [&](std::int64_t t) {
      const Index h = static_cast<Index>(3 * t);
      S jump_tail[3], jump_tip[3];
      for (Index k = 0; k < 3; ++k) {
        const Index g = mesh_.twin(h + k);
        const S w = weight_[mesh_.edge(h + k)] / 6;
        const S tail = g == none ? S(0) : start[h + k] - end[g], tip = g == none ? S(0) : end[h + k] - start[g];
        jump_tail[k] = w * (2 * tail + tip);
        jump_tip[k] = w * (tail + 2 * tip);
      }
      const S here[3] = {tau[h], tau[h + 1], tau[h + 2]};
      (void)finish_face(h, here, jump_tail, jump_tip, start.data(), out);
    });
    (void)finish_edges(out.R.data(), out);
  }

 private:
  struct BadFace {
    Index face = none;
    Eigen::Matrix<S, 6, 6> inverse = Eigen::Matrix<S, 6, 6>::Zero();  // corners, then edges, each as its edge runs
    Eigen::Matrix<S, 3, 1> edges = Eigen::Matrix<S, 3, 1>::Zero();    // its part of the result
  };
  struct BadEdge {
    Index edge;
    Index slots[2];  // 3 * (place in bad_) + halfedge, or none
  };

  static S inverse(S x) { return x > S(0) ? S(1) / x : S(0); }

  [[nodiscard]] S edge_mass(Index e) const {
    const Index h = mesh_.halfedge(e), g = mesh_.twin(h);
    return own_mass(h) + (g == none ? S(0) : own_mass(g));
  }

  void collect_bad_faces(double block_above) {
    for (Index t = 0; t < mesh_.faces(); ++t)
      if (cot_[3 * t] + cot_[3 * t + 1] + cot_[3 * t + 2] > block_above) bad_.push_back({.face = t});
    std::vector<Index> place(bad_.empty() ? 0 : static_cast<std::size_t>(mesh_.faces()), none);
    for (std::size_t b = 0; b < bad_.size(); ++b) place[static_cast<std::size_t>(bad_[b].face)] = static_cast<Index>(b);
    parallel_for(static_cast<std::int64_t>(bad_.size()),
                 [&](std::int64_t b) { invert(bad_[static_cast<std::size_t>(b)]); });
    for (std::size_t b = 0; b < bad_.size(); ++b)
      for (Index k = 0; k < 3; ++k) {
        const Index h = 3 * bad_[b].face + k, g = mesh_.twin(h);
        const Index other = g == none ? none : place[static_cast<std::size_t>(g / 3)];
        if (other != none && other < static_cast<Index>(b)) continue;  // listed by the other face
        bad_edges_.push_back(
            {mesh_.edge(h), {static_cast<Index>(3 * b) + k, other == none ? none : 3 * other + g % 3}});
      }
  }

  // The inverse of the system's 6 x 6 block of one face, in double: slivers leave float nothing.
  void invert(BadFace& f) const {
    const Index h = 3 * f.face;
    const double cot[3] = {double(cot_[h]), double(cot_[h + 1]), double(cot_[h + 2])};
    const kernels::Symmetric3<double> w = kernels::whitney_mass(cot);
    Eigen::Matrix3d W;
    Eigen::Matrix<double, 3, 6> T = Eigen::Matrix<double, 3, 6>::Zero();  // tau of the six unknowns
    for (Index k = 0; k < 3; ++k) {
      W(k, k) = w.diagonal[k];
      W(k, (k + 1) % 3) = W((k + 1) % 3, k) = w.off[k];
      T(k, k) = -1;
      T(k, (k + 1) % 3) = 1;
      T(k, 3 + k) = hold_rho_ ? 0.0 : mesh_.canonical(h + k) ? 1.0 : -1.0;
    }
    Eigen::Matrix<double, 6, 6> A = T.transpose() * W * T;
    for (Index k = 0; k < 3; ++k) {
      const Index e = mesh_.edge(h + k), next = (k + 1) % 3;
      const double jump = double(weight_[e]) / 6;
      A(k, k) += 2 * jump;
      A(next, next) += 2 * jump;
      A(k, next) += jump;
      A(next, k) += jump;
      A(3 + k, 3 + k) += hold_rho_ ? 1.0 : double(edge_mass(e)) - w.diagonal[k];
    }
    // A boundary can leave a block singular by one gauge angle; a trace of the diagonal makes it invertible.
    A.diagonal() *= 1 + 1e-12;
    f.inverse = A.ldlt().solve(Eigen::Matrix<double, 6, 6>::Identity()).template cast<S>();
  }

  [[nodiscard]] S own_mass(Index h) const { return (cot_[h] + cot_[Mesh::next(h)] + 3 * cot_[Mesh::prev(h)]) / 12; }

  // From tau and the jump forces of a face's halfedges to the forces on its corners; returns X' out.X.
  double finish_face(Index h, const S (&tau)[3], const S (&jump_tail)[3], const S (&jump_tip)[3], const S* X,
                     Correction<S>& out) {
    const S cot[3] = {cot_[h], cot_[h + 1], cot_[h + 2]};
    S force[3];
    kernels::multiply(kernels::whitney_mass(cot), tau, force);
    double sum = 0;
    for (Index k = 0; k < 3; ++k) {
      const Index before = (k + 2) % 3;
      tau_force_[h + k] = force[k];
      out.X[h + k] = force[before] - force[k] + jump_tail[k] + jump_tip[before];
      sum += double(X[h + k]) * double(out.X[h + k]);
    }
    return sum;
  }

  // Forces on the edges; returns R' out.R.
  double finish_edges(const S* R, Correction<S>& out) {
    return parallel_reduce(
        hold_rho_ ? std::int64_t{0} : std::int64_t{mesh_.edges()}, 0.0,
        [&](std::int64_t begin, std::int64_t end) {
          double sum = 0;
          for (std::int64_t e = begin; e < end; ++e) {
            const Index h = mesh_.halfedge(static_cast<Index>(e)), g = mesh_.twin(h);
            const S force = g == none ? tau_force_[h] : tau_force_[h] - tau_force_[g];
            sum += double(R[e]) * double(force);
            out.R[e] = force;
          }
          return sum;
        },
        [](double a, double b) { return a + b; });
  }

  const Mesh& mesh_;
  const VectorX<S>& cot_;
  const VectorX<S>& weight_;
  bool hold_rho_;
  VectorX<S> tau_force_;
  Correction<S> scale_;
  std::vector<BadFace> bad_;
  std::vector<BadEdge> bad_edges_;
};

/// Preconditioned conjugate gradients for A x = residual from x = 0, until the norm r' P r has fallen by `reduction`
/// squared or `max_iterations` are done; `residual` is overwritten. Returns the iterations.
template <class S>
int conjugate_gradients(CorrectionSystem<S>& system, Correction<S>& residual, double reduction, int max_iterations,
                        Correction<S>& x) {
  x = system.zeros();
  Correction<S> p = system.zeros(), q = system.zeros(), z = system.zeros();
  double square = system.precondition(residual, z);
  const double target = square * reduction * reduction;
  double beta = 0;
  int iteration = 0;
  while (square > target && iteration < max_iterations) {
    const auto direct = [b = static_cast<S>(beta)](const VectorX<S>& zv, VectorX<S>& v) {
      parallel_for(v.size(), [&](std::int64_t i) { v[i] = zv[i] + b * v[i]; });
    };
    direct(z.X, p.X);
    direct(z.R, p.R);
    const double curvature = system.apply(p, q);
    if (!(curvature > 0)) break;  // rounding has used up the search directions
    const auto step = [a = static_cast<S>(square / curvature)](const VectorX<S>& pv, const VectorX<S>& qv,
                                                               VectorX<S>& xv, VectorX<S>& rv) {
      parallel_for(rv.size(), [&](std::int64_t i) {
        xv[i] += a * pv[i];
        rv[i] -= a * qv[i];
      });
    };
    step(p.X, q.X, x.X, residual.X);
    step(p.R, q.R, x.R, residual.R);
    const double next = system.precondition(residual, z);
    beta = next / square;
    square = next;
    ++iteration;
  }
  return iteration;
}

}  // namespace alcap::detail
