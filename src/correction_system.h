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
#pragma once

#include <cmath>

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
  CorrectionSystem(const Mesh& mesh, const VectorX<S>& cots, const VectorX<S>& edge_weight, bool hold_rho)
      : mesh_(mesh), cot_(cots), weight_(edge_weight), hold_rho_(hold_rho), tau_force_(mesh.halfedges()) {
    scale_ = {VectorX<S>(mesh.halfedges()), VectorX<S>(hold_rho ? 0 : mesh.edges())};
    parallel_for(mesh.halfedges(), [&](std::int64_t i) {
      const Index h = static_cast<Index>(i), n = Mesh::next(h), p = Mesh::prev(h);
      // W_hh + W_pp - 2 W_hp of the two halfedges that meet here, and a third of both edges' weights.
      const S whitney = (cot_[n] + cot_[p]) / 2;
      scale_.X[i] = inverse(whitney + (weight_[mesh.edge(h)] + weight_[mesh.edge(p)]) / 3);
    });
    parallel_for(scale_.R.size(), [&](std::int64_t e) {
      const Index h = mesh.halfedge(static_cast<Index>(e)), g = mesh.twin(h);
      scale_.R[e] = inverse(own_mass(h) + (g == none ? S(0) : own_mass(g)));
    });
  }

  /// The inverse diagonal.
  [[nodiscard]] const Correction<S>& scale() const { return scale_; }

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
  static S inverse(S x) { return x > S(0) ? S(1) / x : S(0); }

  [[nodiscard]] S own_mass(Index h) const {
    return (cot_[h] + cot_[Mesh::next(h)] + 3 * cot_[Mesh::prev(h)]) / 12;
  }

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
};

/// r' D r with the inverse diagonal D: the squared norm that residuals are measured in.
template <class S>
[[nodiscard]] double squared_norm(const Correction<S>& scale, const Correction<S>& r) {
  const auto part = [](const VectorX<S>& d, const VectorX<S>& v) {
    return parallel_sum<double>(v.size(), [&](std::int64_t i) { return double(v[i]) * double(v[i]) * double(d[i]); });
  };
  return part(scale.X, r.X) + part(scale.R, r.R);
}

/// Jacobi-preconditioned conjugate gradients for A x = residual from x = 0, until the norm has fallen by `reduction`
/// or `max_iterations` are done; `residual` is overwritten. Returns the iterations.
template <class S>
int conjugate_gradients(CorrectionSystem<S>& system, Correction<S>& residual, double reduction, int max_iterations,
                        Correction<S>& x) {
  const Correction<S>& scale = system.scale();
  const auto zero_like = [](const Correction<S>& v) {
    return Correction<S>{VectorX<S>::Zero(v.X.size()), VectorX<S>::Zero(v.R.size())};
  };
  x = zero_like(residual);
  Correction<S> p = zero_like(residual), q = zero_like(residual);
  double square = squared_norm(scale, residual);
  const double target = square * reduction * reduction;
  double beta = 0;
  int iteration = 0;
  while (square > target && iteration < max_iterations) {
    const auto direct = [b = static_cast<S>(beta)](const VectorX<S>& d, const VectorX<S>& r, VectorX<S>& v) {
      parallel_for(v.size(), [&](std::int64_t i) { v[i] = d[i] * r[i] + b * v[i]; });
    };
    direct(scale.X, residual.X, p.X);
    direct(scale.R, residual.R, p.R);
    const double curvature = system.apply(p, q);
    if (!(curvature > 0)) break;  // rounding has used up the search directions
    const auto step = [a = static_cast<S>(square / curvature)](const VectorX<S>& d, const VectorX<S>& pv,
                                                               const VectorX<S>& qv, VectorX<S>& xv, VectorX<S>& rv) {
      return parallel_sum<double>(rv.size(), [&](std::int64_t i) {
        xv[i] += a * pv[i];
        rv[i] -= a * qv[i];
        return double(rv[i]) * double(rv[i]) * double(d[i]);
      });
    };
    const double next =
        step(scale.X, p.X, q.X, x.X, residual.X) + step(scale.R, p.R, q.R, x.R, residual.R);
    beta = next / square;
    square = next;
    ++iteration;
  }
  return iteration;
}

}  // namespace alcap::detail
