// SPDX-License-Identifier: MIT
//
// connection_global.cpp: the connection that minimises D_T + lambda D_E (LTGD 2016, Sec. 5.3).
//
// Iterative refinement: the gradient is taken in double, the correction it asks for is solved by conjugate gradients in
// float (src/correction_system.h), which halves the memory traffic that bounds them; where float makes no headway
// (extreme slivers) the next correction is solved in double.
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "alcap/connection.h"
#include "alcap/parallel.h"
#include "kernels/connection_energy.h"
#include "src/correction_system.h"
#include "src/grounded_laplacian.h"

namespace alcap {
namespace {

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
    const T tangent = kernels::capped_tangent(geometry.cot(Mesh::prev(h)), cap);
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

// The correction of rho_{v->e} at both ends of edge e that is best for the state r.
template <class T>
std::pair<T, T> edge_correction(const Mesh& mesh, const VectorX<T>& weights, const detail::LiftedResiduals<T>& r,
                                Index e) {
  const Index h = mesh.halfedge(e), g = mesh.twin(h);
  if (g == none) return {r.start[h], r.end[h]};
  const T sum = weights[h] + weights[g];
  return {(weights[h] * r.start[h] + weights[g] * r.end[g]) / sum,
          (weights[h] * r.end[h] + weights[g] * r.start[g]) / sum};
}

// The faces' pull on each edge, the right-hand side of the correction, at the lifted state r, tau plus u. `pull` holds
// the parts of the two faces in between, x receives what the relaxed corners move by.
template <class T>
void edge_pull(const Mesh& mesh, const Geometry<T>& geometry, const VectorX<T>& weights, const VectorX<T>& tau,
               const detail::LiftedResiduals<T>& r, const detail::EdgeValues<double>& u,
               detail::EdgeValues<double>& pull, detail::EdgeValues<double>& out, VectorX<double>& x) {
  parallel_for(mesh.faces(), [&](std::int64_t t) {
    const Index h = static_cast<Index>(3 * t);
    double cot[3], p[3], mean[3], difference[3], turn[3];
    for (Index k = 0; k < 3; ++k) {
      const Index e = mesh.edge(h + k);
      const double sign = mesh.canonical(h + k) ? 1.0 : -1.0;
      cot[k] = geometry.cot(h + k);
      p[k] = weights[h + k];
      mean[k] = (double(r.start[h + k]) + double(r.end[h + k])) / 2 - u(0, e);
      difference[k] = double(r.end[h + k]) - double(r.start[h + k]) - sign * u(1, e);
      turn[k] = double(tau[h + k]) + sign * u(2, e);
    }
    const auto moved = detail::relax(detail::face_coefficients(cot, p), mean, difference, turn);
    for (Index k = 0; k < 3; ++k) {
      pull(0, h + k) = mean[k];
      pull(1, h + k) = difference[k];
      pull(2, h + k) = -turn[k];
      x[h + k] = moved[static_cast<std::size_t>(k)];
    }
  });
  parallel_for(mesh.edges(), [&](std::int64_t e) {
    const Index h = mesh.halfedge(static_cast<Index>(e)), g = mesh.twin(h);
    out.col(e) = pull.col(h);
    if (g == none) return;
    out(0, e) += pull(0, g);
    out(1, e) -= pull(1, g);
    out(2, e) -= pull(2, g);
  });
}

template <class T>
void deviation(const Mesh& mesh, const Geometry<T>& geometry, const VectorX<T>& weights, Connection<T>& c) {
  c.report.D_T = parallel_sum<double>(mesh.faces(), [&](std::int64_t t) {
    const Index h = static_cast<Index>(3 * t);
    const T cot[3] = {geometry.cot(h), geometry.cot(h + 1), geometry.cot(h + 2)};
    const T tau[3] = {c.tau[h], c.tau[h + 1], c.tau[h + 2]};
    return double(kernels::triangle_energy(cot, tau));
  });
  c.report.D_E = parallel_sum<double>(mesh.halfedges(), [&](std::int64_t i) {
    const Index h = static_cast<Index>(i);
    const T to_face = c.edge_to_face(geometry, h);
    const T at_tail = wrap(c.rho_t[h] - c.rho_start(mesh, h) - to_face);
    const T at_tip = wrap(c.rho_t[Mesh::next(h)] - c.rho_end(mesh, h) - to_face);
    return double(kernels::halfedge_energy(weights[h], at_tail, at_tip));
  });
}

// With rho held (trivial connections) the problem is not local: turning all frames around slowly varying vertices costs
// next to nothing, the Dirichlet energy of the turn. So the edges' blocks are joined by a Poisson solve for such turns
// g: y = g at both ends of an edge, X = g in its faces. Conjugate gradients in double; returns the iterations.
class HeldRho {
 public:
  template <class T>
  HeldRho(const Mesh& mesh, const Geometry<T>& geometry)
      : mesh_(mesh), poisson_(make_linear_solver<double>({.tolerance = 1e-4})) {
    const SparseMatrix<double> L = detail::grounded_laplacian(mesh, geometry, find_topology(mesh));
    poisson_->analyse(L);
    poisson_->factorise(L);
  }

  // u += the solution for rhs, to the relative reduction `wanted`; product(p) is A p.
  template <class System, class Product>
  int solve(System& system, const detail::EdgeValues<double>& rhs, double wanted, int most, const Product& product,
            detail::EdgeValues<double>& u) const {
    detail::EdgeValues<double> r = rhs, z(3, r.cols()), p, before = r;
    double square = precondition(system, r, z), first = square;
    p = z;
    int done = 0;
    while (done < most && square > wanted * wanted * first) {
      ++done;
      const detail::EdgeValues<double> q = product(p);
      const double alpha = square / dot(p, q);
      if (!std::isfinite(alpha)) break;
      u += alpha * p;
      before = r;
      r -= alpha * q;
      const double next = precondition(system, r, z);
      // Flexible: the float blocks and the Poisson solver are not exactly linear.
      const double beta = (next - dot(before, z)) / square;
      square = next;
      p = z + beta * p;
    }
    return done;
  }

 private:
  static double dot(const detail::EdgeValues<double>& a, const detail::EdgeValues<double>& b) {
    return parallel_sum<double>(a.cols(), [&](std::int64_t e) { return a.col(e).dot(b.col(e)); });
  }

  // z = P r; returns r' z.
  template <class System>
  double precondition(System& system, const detail::EdgeValues<double>& r, detail::EdgeValues<double>& z) const {
    (void)system.start(r);
    system.preconditioned(z);
    MatrixX<double> b = MatrixX<double>::Zero(mesh_.vertices(), 1), g(mesh_.vertices(), 1);
    for (Index e = 0; e < mesh_.edges(); ++e) {
      const Index h = mesh_.halfedge(e);
      b(mesh_.tail(h), 0) += r(0, e) / 2 - r(1, e);
      b(mesh_.tip(h), 0) += r(0, e) / 2 + r(1, e);
    }
    (void)poisson_->solve(b, g);
    parallel_for(mesh_.edges(), [&](std::int64_t e) {
      const Index h = mesh_.halfedge(static_cast<Index>(e));
      const double tail = g(mesh_.tail(h), 0), tip = g(mesh_.tip(h), 0);
      z(0, e) += (tail + tip) / 2;
      z(1, e) += tip - tail;
      z(2, e) = 0;
    });
    return dot(r, z);
  }

  const Mesh& mesh_;
  std::unique_ptr<LinearSolver<double>> poisson_;
};

}  // namespace

namespace detail {

template <class T>
void optimise_globally(const Mesh& mesh, const Geometry<T>& geometry, const GlobalOptions& options, bool fix_rho,
                       Connection<T>& c, LiftedResiduals<T>& r) {
  validate(options);
  // A float solve gains about five digits before its rounding shows; less than one digit means it is of no use here.
  constexpr double float_reduction = 1e-5, useful_reduction = 0.1;

  const VectorX<T> weights = halfedge_weights(mesh, geometry, options);
  {
    // On the boundary rho_{v->e} is free and follows its face.
    VectorX<T> p(mesh.halfedges());
    parallel_for(mesh.halfedges(), [&](std::int64_t h) {
      p[h] = mesh.boundary_halfedge(static_cast<Index>(h)) ? T(0) : static_cast<T>(options.detail) * weights[h];
    });
    CorrectionSystem<float> system(mesh, geometry.cots(), p, fix_rho);
    std::optional<CorrectionSystem<double>> full_system;  // only where float does not do
    std::optional<HeldRho> held;
    if (fix_rho) held.emplace(mesh, geometry);

    const double tolerance = std::max(options.tolerance, 4.0 * double(std::numeric_limits<T>::epsilon()));
    EdgeValues<double> u = EdgeValues<double>::Zero(3, mesh.edges()), rhs(3, mesh.edges()), pull(3, mesh.halfedges());
    VectorX<double> x(mesh.halfedges());
    double first = 0, last = 0;
    c.report.iterations = 0;
    for (int round = 0;; ++round) {
      edge_pull(mesh, geometry, p, c.tau, r, u, pull, rhs, x);
      if (fix_rho) rhs.row(2).setZero();
      // Measured through the preconditioner; float is enough for a norm.
      const double square = system.start(rhs);
      const double norm = std::sqrt(std::max(0.0, square));
      if (round == 0) first = norm;
      // Where the start is already the optimum (a flat piece) the gradient is rounding and nothing is left to do.
      const double floor = double(std::numeric_limits<T>::epsilon()) * std::sqrt(double(mesh.halfedges()));
      c.report.residual = first > floor ? norm / first : 0.0;
      const int left = options.max_iterations - c.report.iterations;
      if (c.report.residual <= tolerance || left <= 0) break;
      if (round > 0 && norm > useful_reduction * last) {
        if (full_system) break;  // full precision has reached its own rounding
        full_system.emplace(mesh, geometry.cots(), p, fix_rho);
      }
      last = norm;
      const double wanted = 0.5 * tolerance / c.report.residual;
      if (held) {
        const VectorX<T> still = VectorX<T>::Zero(mesh.halfedges());
        const LiftedResiduals<T> at_rest{still, still};
        VectorX<double> moved(mesh.halfedges());
        const auto product = [&](const EdgeValues<double>& direction) {
          EdgeValues<double> out(3, mesh.edges());
          edge_pull(mesh, geometry, p, still, at_rest, direction, pull, out, moved);
          out.row(2).setZero();
          out = -out;
          return out;
        };
        c.report.iterations += held->solve(system, rhs, std::max(1e-8, wanted), left, product, u);
      } else if (full_system) {
        c.report.iterations += conjugate_gradients(*full_system, full_system->start(rhs), wanted, left);
        full_system->add_solution(u);
      } else {
        c.report.iterations += conjugate_gradients(system, square, std::max(float_reduction, wanted), left);
        system.add_solution(u);
      }
    }
    c.report.converged = c.report.residual <= tolerance;
    parallel_for(mesh.faces(), [&](std::int64_t t) {
      const Index h = static_cast<Index>(3 * t);
      for (Index k = 0; k < 3; ++k) {
        const Index ahead = h + (k + 1) % 3, e = mesh.edge(h + k);
        c.rho_t[h + k] += static_cast<T>(x[h + k]);
        r.start[h + k] += static_cast<T>(x[h + k]);
        r.end[h + k] += static_cast<T>(x[ahead]);
        if (!fix_rho && mesh.canonical(h + k)) {
          c.rho[e] += static_cast<T>(u(2, e));
          c.eps[e] += static_cast<T>(u(2, e));
        }
      }
    });
  }
  c.report.message.clear();
  if (!c.report.converged)
    c.report.message = "the global connection stopped after " + std::to_string(c.report.iterations) +
                       " iterations above its tolerance; raise max_iterations, tolerance or detail";

  parallel_for(mesh.edges(), [&](std::int64_t e) {
    const auto [at_tail, at_tip] = edge_correction(mesh, weights, r, static_cast<Index>(e));
    const Index h = mesh.halfedge(static_cast<Index>(e)), g = mesh.twin(h);
    c.rho_e[2 * e] += at_tail;
    c.rho_e[2 * e + 1] += at_tip;
    c.eps[e] += at_tip - at_tail;
    r.start[h] -= at_tail;
    r.end[h] -= at_tip;
    if (g != none) {
      r.end[g] -= at_tail;
      r.start[g] -= at_tip;
    }
  });
  parallel_for(mesh.faces(), [&](std::int64_t t) {
    T sum = 0;
    for (Index h = static_cast<Index>(3 * t); h < 3 * t + 3; ++h) {
      c.tau[h] = c.eps_along(mesh, h) - r.start[h] + r.end[h];
      sum += c.tau[h];
    }
    c.K[t] = -sum;
  });
  deviation(mesh, geometry, weights, c);
}

template void optimise_globally(const Mesh&, const Geometry<float>&, const GlobalOptions&, bool, Connection<float>&,
                                LiftedResiduals<float>&);
template void optimise_globally(const Mesh&, const Geometry<double>&, const GlobalOptions&, bool, Connection<double>&,
                                LiftedResiduals<double>&);

}  // namespace detail

template <class T>
void measure_deviation(const Mesh& mesh, const Geometry<T>& geometry, const GlobalOptions& options, Connection<T>& c) {
  validate(options);
  deviation(mesh, geometry, halfedge_weights(mesh, geometry, options), c);
}

template void measure_deviation(const Mesh&, const Geometry<float>&, const GlobalOptions&, Connection<float>&);
template void measure_deviation(const Mesh&, const Geometry<double>&, const GlobalOptions&, Connection<double>&);

}  // namespace alcap
