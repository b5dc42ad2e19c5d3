// SPDX-License-Identifier: MIT
//
// connection_global.cpp: the connection that minimises D_T + lambda D_E (LTGD 2016, Sec. 5.3), matrix-free.
//
// Unknowns are corrections x = (X, R): X per corner to rho_{v->t}, R per edge to rho_ij. The correction y to rho_{v->e}
// is eliminated edge by edge: with the lifted residuals a, b of the two sides of an edge, weights p, q and
// Q(r, s) = (r^2 + r s + s^2)/3, min over y of p Q(a - y) + q Q(b - y) is pq/(p+q) Q(a - b), at y = (p a + q b)/(p + q).
// What is left is a local symmetric semidefinite system (kernel: one gauge angle per vertex) whose condition does not
// grow with the mesh; conjugate gradients stay orthogonal to the kernel.
#include <string>

#include "alcap/connection.h"
#include "alcap/parallel.h"

namespace alcap {
namespace {

// Whitney 1-form mass matrix of a face times tau, in cotangents alone (math: <phi_ij, phi_kl>, LTGD 2016 Sec. 4.2):
// W_(ij)(ij) = (cot_i + cot_j + 3 cot_k)/12, W_(ij)(jk) = (cot_j - cot_i - cot_k)/12.
template <class T>
void whitney_times(const T* cot, const T* tau, T* out) {
  const T sum = cot[0] + cot[1] + cot[2];
  const T off[3] = {2 * cot[0] - sum, 2 * cot[1] - sum, 2 * cot[2] - sum};  // off[v]: edges that meet at corner v
  const T diagonal[3] = {sum + 2 * cot[2], sum + 2 * cot[0], sum + 2 * cot[1]};
  out[0] = (diagonal[0] * tau[0] + off[1] * tau[1] + off[0] * tau[2]) / 12;
  out[1] = (off[1] * tau[0] + diagonal[1] * tau[1] + off[2] * tau[2]) / 12;
  out[2] = (off[0] * tau[0] + off[2] * tau[1] + diagonal[2] * tau[2]) / 12;
}

template <class T>
T edge_energy(T r, T s) {
  return (r * r + r * s + s * s) / 3;
}

// tan of the angle opposite a halfedge, capped, times the length factor.
template <class T>
VectorX<T> halfedge_weights(const Mesh& mesh, const Geometry<T>& geometry, const GlobalOptions& options) {
  VectorX<T> weights(mesh.halfedges());
  const T cap = static_cast<T>(options.tan_cap);
  VectorX<T> mean;  // mean edge length per component
  std::vector<Index> face_component;
  if (options.length_factor == LengthFactor::mean_edge) {
    Topology topology = find_topology(mesh);
    mean = VectorX<T>::Zero(static_cast<Eigen::Index>(topology.components.size()));
    for (Index e = 0; e < mesh.edges(); ++e)
      mean[topology.face_component[static_cast<std::size_t>(Mesh::face(mesh.halfedge(e)))]] += geometry.length(e);
    for (Eigen::Index c = 0; c < mean.size(); ++c)
      mean[c] /= static_cast<T>(topology.components[static_cast<std::size_t>(c)].edges);
    face_component = std::move(topology.face_component);
  }
  parallel_for(mesh.halfedges(), [&](std::int64_t i) {
    const Index h = static_cast<Index>(i);
    const T cot = geometry.cot(Mesh::prev(h));
    const T tangent = cot * cap > T(1) ? T(1) / cot : cap;
    T factor = 1;
    if (options.length_factor == LengthFactor::metric) factor = geometry.length(mesh.edge(h));
    if (options.length_factor == LengthFactor::mean_edge)
      factor = geometry.length(mesh.edge(h)) / mean[face_component[static_cast<std::size_t>(Mesh::face(h))]];
    weights[i] = tangent * factor;
  });
  return weights;
}

void validate(const GlobalOptions& o) {
  const auto refuse = [](const char* field, double value, const char* rule) {
    throw OptionError(field, std::to_string(value), rule);
  };
  if (!(o.detail > 0) || !std::isfinite(o.detail)) refuse("detail", o.detail, "must be positive and finite");
  if (!(o.tan_cap > 0) || !std::isfinite(o.tan_cap)) refuse("tan_cap", o.tan_cap, "must be positive and finite");
  if (!(o.tolerance > 0) || o.tolerance >= 1) refuse("tolerance", o.tolerance, "must lie in (0, 1)");
  if (o.max_iterations < 1) refuse("max_iterations", o.max_iterations, "must be at least 1");
}

// The system of the corrections, applied without a matrix.
template <class T>
class CorrectionSystem {
 public:
  struct Vector {
    VectorX<T> X, R;
  };

  CorrectionSystem(const Mesh& mesh, const Geometry<T>& geometry, const VectorX<T>& weights, T detail, bool fix_rho)
      : mesh_(mesh), geometry_(geometry), fix_rho_(fix_rho), edge_weight_(mesh.edges()), tau_force_(mesh.halfedges()) {
    parallel_for(mesh.edges(), [&](std::int64_t e) {
      const Index h = mesh_.halfedge(static_cast<Index>(e)), g = mesh_.twin(h);
      edge_weight_[e] = g == none ? T(0) : detail * weights[h] * weights[g] / (weights[h] + weights[g]);
    });
    jump_force_.resize(2 * std::int64_t{mesh.edges()});
  }

  // Gradient (halved) of the energy at the given lifted state.
  void gradient(const VectorX<T>& tau, const detail::LiftedResiduals<T>& r, Vector& out) {
    parallel_for(mesh_.faces(), [&](std::int64_t t) {
      whitney_times(&geometry_.cots()[3 * t], &tau[3 * t], &tau_force_[3 * t]);
    });
    parallel_for(mesh_.edges(), [&](std::int64_t e) {
      const Index h = mesh_.halfedge(static_cast<Index>(e)), g = mesh_.twin(h);
      if (g == none)
        set_jump(e, 0, 0);
      else
        set_jump(e, r.start[h] - r.end[g], r.end[h] - r.start[g]);
    });
    collect(out);
  }

  void apply(const Vector& x, Vector& out) {
    parallel_for(mesh_.faces(), [&](std::int64_t t) {
      const Index h = static_cast<Index>(3 * t);
      T tau[3];
      for (Index k = 0; k < 3; ++k) {
        const Index e = mesh_.edge(h + k);
        const T along = fix_rho_ ? T(0) : mesh_.halfedge(e) == h + k ? x.R[e] : -x.R[e];
        tau[k] = along - x.X[h + k] + x.X[h + (k + 1) % 3];
      }
      whitney_times(&geometry_.cots()[3 * t], tau, &tau_force_[3 * t]);
    });
    parallel_for(mesh_.edges(), [&](std::int64_t e) {
      const Index h = mesh_.halfedge(static_cast<Index>(e)), g = mesh_.twin(h);
      if (g == none)
        set_jump(e, 0, 0);
      else
        set_jump(e, x.X[h] - x.X[Mesh::next(g)], x.X[Mesh::next(h)] - x.X[g]);
    });
    collect(out);
  }

  [[nodiscard]] Vector inverse_diagonal() const {
    Vector d{VectorX<T>(mesh_.halfedges()), VectorX<T>(fix_rho_ ? 0 : mesh_.edges())};
    parallel_for(mesh_.halfedges(), [&](std::int64_t i) {
      const Index h = static_cast<Index>(i), n = Mesh::next(h), p = Mesh::prev(h);
      // (W_hh + W_pp - 2 W_hp) for the two halfedges that meet at the corner, plus a third of both edges' weights.
      const T whitney = (2 * geometry_.cot(n) + 2 * geometry_.cot(p)) / 4;
      d.X[i] = inverse(whitney + (edge_weight_[mesh_.edge(h)] + edge_weight_[mesh_.edge(p)]) / 3);
    });
    parallel_for(d.R.size(), [&](std::int64_t e) {
      const Index h = mesh_.halfedge(static_cast<Index>(e)), g = mesh_.twin(h);
      d.R[e] = inverse(own_mass(h) + (g == none ? T(0) : own_mass(g)));
    });
    return d;
  }

  // The eliminated correction of rho_{v->e} at both ends of edge e.
  static std::pair<T, T> edge_correction(const Mesh& mesh, const VectorX<T>& weights,
                                         const detail::LiftedResiduals<T>& r, Index e) {
    const Index h = mesh.halfedge(e), g = mesh.twin(h);
    if (g == none) return {r.start[h], r.end[h]};
    const T sum = weights[h] + weights[g];
    return {(weights[h] * r.start[h] + weights[g] * r.end[g]) / sum,
            (weights[h] * r.end[h] + weights[g] * r.start[g]) / sum};
  }

 private:
  static T inverse(T x) { return x > T(0) ? T(1) / x : T(0); }

  [[nodiscard]] T own_mass(Index h) const {
    const Index n = Mesh::next(h), p = Mesh::prev(h);
    return (geometry_.cot(h) + geometry_.cot(n) + 3 * geometry_.cot(p)) / 12;
  }

  void set_jump(std::int64_t e, T at_tail, T at_tip) {
    jump_force_[2 * e] = edge_weight_[e] * (2 * at_tail + at_tip) / 6;
    jump_force_[2 * e + 1] = edge_weight_[e] * (at_tail + 2 * at_tip) / 6;
  }

  // Gathers the forces of faces and edges at corners and edges.
  void collect(Vector& out) const {
    parallel_for(mesh_.halfedges(), [&](std::int64_t i) {
      const Index h = static_cast<Index>(i), p = Mesh::prev(h);
      const std::int64_t e = mesh_.edge(h), f = mesh_.edge(p);
      T sum = tau_force_[p] - tau_force_[h];
      sum += mesh_.halfedge(mesh_.edge(h)) == h ? jump_force_[2 * e] : -jump_force_[2 * e + 1];
      sum += mesh_.halfedge(mesh_.edge(p)) == p ? jump_force_[2 * f + 1] : -jump_force_[2 * f];
      out.X[i] = sum;
    });
    parallel_for(fix_rho_ ? 0 : mesh_.edges(), [&](std::int64_t e) {
      const Index h = mesh_.halfedge(static_cast<Index>(e)), g = mesh_.twin(h);
      out.R[e] = g == none ? tau_force_[h] : tau_force_[h] - tau_force_[g];
    });
  }

  const Mesh& mesh_;
  const Geometry<T>& geometry_;
  bool fix_rho_;
  VectorX<T> edge_weight_, tau_force_, jump_force_;
};

// Jacobi-preconditioned conjugate gradients for A x = -g, x = 0 at the start. The kernel needs no care: g and every
// search direction are orthogonal to it up to rounding.
template <class T>
void solve_corrections(CorrectionSystem<T>& system, typename CorrectionSystem<T>::Vector& residual,
                       const GlobalOptions& options, typename CorrectionSystem<T>::Vector& x, ConnectionReport& report) {
  using Vector = typename CorrectionSystem<T>::Vector;
  const std::int64_t nX = residual.X.size(), nR = residual.R.size();
  const Vector scale = system.inverse_diagonal();
  x = {VectorX<T>::Zero(nX), VectorX<T>::Zero(nR)};
  Vector p{VectorX<T>::Zero(nX), VectorX<T>::Zero(nR)}, q{VectorX<T>(nX), VectorX<T>(nR)};
  // <r, D r> in double for both scalars: partial sums decide the step lengths.
  const auto weighted_square = [&] {
    return parallel_sum<double>(nX, [&](std::int64_t i) { return double(residual.X[i]) * residual.X[i] * scale.X[i]; }) +
           parallel_sum<double>(nR, [&](std::int64_t i) { return double(residual.R[i]) * residual.R[i] * scale.R[i]; });
  };
  parallel_for(nX, [&](std::int64_t i) { residual.X[i] = -residual.X[i]; });
  parallel_for(nR, [&](std::int64_t i) { residual.R[i] = -residual.R[i]; });
  double rho = weighted_square();
  const double start = rho;
  const double tolerance = std::max(options.tolerance, 4.0 * double(std::numeric_limits<T>::epsilon()));
  const double target = start * tolerance * tolerance;
  double beta = 0;
  int iteration = 0;
  while (rho > target && iteration < options.max_iterations) {
    const T b = static_cast<T>(beta);
    parallel_for(nX, [&](std::int64_t i) { p.X[i] = scale.X[i] * residual.X[i] + b * p.X[i]; });
    parallel_for(nR, [&](std::int64_t i) { p.R[i] = scale.R[i] * residual.R[i] + b * p.R[i]; });
    system.apply(p, q);
    const double curvature = parallel_sum<double>(nX, [&](std::int64_t i) { return double(p.X[i]) * q.X[i]; }) +
                             parallel_sum<double>(nR, [&](std::int64_t i) { return double(p.R[i]) * q.R[i]; });
    if (!(curvature > 0)) break;  // rounding has used up the search directions
    const T step = static_cast<T>(rho / curvature);
    parallel_for(nX, [&](std::int64_t i) {
      x.X[i] += step * p.X[i];
      residual.X[i] -= step * q.X[i];
    });
    parallel_for(nR, [&](std::int64_t i) {
      x.R[i] += step * p.R[i];
      residual.R[i] -= step * q.R[i];
    });
    const double next = weighted_square();
    beta = next / rho;
    rho = next;
    ++iteration;
  }
  report.iterations = iteration;
  report.residual = start > 0 ? std::sqrt(rho / start) : 0.0;
  report.converged = report.residual <= tolerance * (1 + 1e-6);
  if (!report.converged)
    report.message = "the global connection stopped after " + std::to_string(iteration) +
                     " iterations above its tolerance; raise max_iterations or detail";
}

}  // namespace

namespace detail {

template <class T>
void optimise_globally(const Mesh& mesh, const Geometry<T>& geometry, const GlobalOptions& options, bool fix_rho,
                       Connection<T>& c, LiftedResiduals<T>& r) {
  validate(options);
  const VectorX<T> weights = halfedge_weights(mesh, geometry, options);
  CorrectionSystem<T> system(mesh, geometry, weights, static_cast<T>(options.detail), fix_rho);
  typename CorrectionSystem<T>::Vector x;
  {
    typename CorrectionSystem<T>::Vector gradient{VectorX<T>(mesh.halfedges()),
                                                  VectorX<T>(fix_rho ? 0 : mesh.edges())};
    system.gradient(c.tau, r, gradient);
    solve_corrections(system, gradient, options, x, c.report);
  }

  parallel_for(mesh.halfedges(), [&](std::int64_t i) {
    const Index h = static_cast<Index>(i);
    c.rho_t[h] += x.X[h];
    r.start[h] += x.X[h];
    r.end[h] += x.X[Mesh::next(h)];
  });
  parallel_for(mesh.edges(), [&](std::int64_t e) {
    const auto [at_tail, at_tip] = CorrectionSystem<T>::edge_correction(mesh, weights, r, static_cast<Index>(e));
    const Index h = mesh.halfedge(static_cast<Index>(e)), g = mesh.twin(h);
    const T turn = fix_rho ? T(0) : x.R[e];
    c.rho[e] += turn;
    c.rho_e[2 * e] += at_tail;
    c.rho_e[2 * e + 1] += at_tip;
    c.eps[e] += turn - at_tail + at_tip;
    r.start[h] -= at_tail;
    r.end[h] -= at_tip;
    if (g != none) {
      r.end[g] -= at_tail;
      r.start[g] -= at_tip;
    }
  });

  c.report.D_T = 0;
  parallel_for(mesh.faces(), [&](std::int64_t t) {
    T sum = 0;
    for (Index h = static_cast<Index>(3 * t); h < 3 * t + 3; ++h) {
      c.tau[h] = c.eps_along(mesh, h) - r.start[h] + r.end[h];
      sum += c.tau[h];
    }
    c.K[t] = -sum;
  });
  measure_deviation(mesh, geometry, options, c);
}

template void optimise_globally(const Mesh&, const Geometry<float>&, const GlobalOptions&, bool, Connection<float>&,
                                LiftedResiduals<float>&);
template void optimise_globally(const Mesh&, const Geometry<double>&, const GlobalOptions&, bool, Connection<double>&,
                                LiftedResiduals<double>&);

}  // namespace detail

template <class T>
void measure_deviation(const Mesh& mesh, const Geometry<T>& geometry, const GlobalOptions& options, Connection<T>& c) {
  validate(options);
  const VectorX<T> weights = halfedge_weights(mesh, geometry, options);
  c.report.D_T = parallel_sum<double>(mesh.faces(), [&](std::int64_t t) {
    T force[3];
    whitney_times(&geometry.cots()[3 * t], &c.tau[3 * t], force);
    return double(c.tau[3 * t] * force[0] + c.tau[3 * t + 1] * force[1] + c.tau[3 * t + 2] * force[2]);
  });
  c.report.D_E = parallel_sum<double>(mesh.halfedges(), [&](std::int64_t i) {
    const Index h = static_cast<Index>(i);
    const T to_face = c.edge_to_face(geometry, h);
    const T at_tail = wrap(c.rho_t[h] - c.rho_start(mesh, h) - to_face);
    const T at_tip = wrap(c.rho_t[Mesh::next(h)] - c.rho_end(mesh, h) - to_face);
    return double(weights[h] * edge_energy(at_tail, at_tip));
  });
}

template void measure_deviation(const Mesh&, const Geometry<float>&, const GlobalOptions&, Connection<float>&);
template void measure_deviation(const Mesh&, const Geometry<double>&, const GlobalOptions&, Connection<double>&);

}  // namespace alcap
