// SPDX-License-Identifier: MIT
//
// optimise.cpp: the connection that minimises D_T + lambda D_E (LTGD 2016, Sec. 5.3).
//
// Iterative refinement: the gradient is taken in double, the correction it asks for is solved by conjugate gradients in
// float (src/connection/global/correction_system.h), which halves the memory traffic that bounds them; where float
// makes no headway (extreme slivers) the next correction is solved in double. The gradient is what
// src/connection/global/face_states.h says of faces.
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "alcap/connection.h"
#include "kernels/connection_energy.h"
#include "src/base/large_array.h"
#include "src/base/parallel.h"
#include "src/connection/global/correction_system.h"
#include "src/connection/global/face_pairs.h"
#include "src/connection/global/face_states.h"
#include "src/connection/grounded_laplacian.h"

namespace alcap {
namespace {

using detail::EdgeValues;
using detail::FaceStates;
using detail::HalfedgeWeights;
using detail::Values;
using detail::ValuesOut;

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

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
std::pair<double, double> edge_correction(const Mesh& mesh, const HalfedgeWeights& weights,
                                          const detail::LiftedResiduals& r, Index e) {
  const Index h = mesh.halfedge(e), g = mesh.twin(h);
  if (g == none) return {r.start[h], r.end[h]};
  const double here = weights(h), there = weights(g), sum = here + there;
  return {(here * r.start[h] + there * r.end[g]) / sum, (here * r.end[h] + there * r.start[g]) / sum};
}

// The faces' pull on outer edge i, the right-hand side of the correction, from the parts of its two faces.
std::array<double, 3> pull_on(const Values& parts, std::int64_t i, bool open) {
  const std::int64_t row = 2 * i;
  if (open) return {parts(0, row), parts(1, row), -parts(2, row)};
  return {parts(0, row) + parts(0, row + 1), parts(1, row) - parts(1, row + 1), parts(2, row + 1) - parts(2, row)};
}

void deviation(const Mesh& mesh, const Geometry& geometry, const HalfedgeWeights& weights, Connection& c) {
  c.report.D_T = parallel_sum<double>(mesh.faces(), [&](std::int64_t t) {
    const Index h = static_cast<Index>(3 * t);
    const double cot[3] = {geometry.cot(h), geometry.cot(h + 1), geometry.cot(h + 2)};
    const double tau[3] = {c.tau[h], c.tau[h + 1], c.tau[h + 2]};
    return double(kernels::triangle_energy(cot, tau));
  });
  c.report.D_E = parallel_sum<double>(mesh.halfedges(), [&](std::int64_t i) {
    const Index h = static_cast<Index>(i);
    const double to_face = c.edge_to_face(geometry, h);
    const double at_tail = wrap(c.rho_t[h] - c.rho_start(mesh, h) - to_face);
    const double at_tip = wrap(c.rho_t[Mesh::next(h)] - c.rho_end(mesh, h) - to_face);
    return double(kernels::halfedge_energy(weights(h), at_tail, at_tip));
  });
}

// tau, K and the deviations of a connection whose lifted residuals are r.
void close_faces(const Mesh& mesh, const Geometry& geometry, const HalfedgeWeights& weights,
                 const detail::LiftedResiduals& r, Connection& c) {
  using Sums = std::array<double, 2>;
  const Sums sums = parallel_reduce(
      mesh.faces(), Sums{},
      [&](std::int64_t begin, std::int64_t end) {
        Sums sum{};
        for (std::int64_t t = begin; t < end; ++t) {
          const Index h = static_cast<Index>(3 * t);
          const double cot[3] = {geometry.cot(h), geometry.cot(h + 1), geometry.cot(h + 2)};
          double tau[3];
          for (Index k = 0; k < 3; ++k) {
            c.tau[h + k] = tau[k] = c.eps_along(mesh, h + k) - r.start[h + k] + r.end[h + k];
            sum[1] += double(kernels::halfedge_energy(weights(h + k), r.start[h + k], r.end[h + k]));
          }
          c.K[t] = -(tau[0] + tau[1] + tau[2]);
          sum[0] += double(kernels::triangle_energy(cot, tau));
        }
        return sum;
      },
      [](const Sums& a, const Sums& b) {
        return Sums{a[0] + b[0], a[1] + b[1]};
      });
  c.report.D_T = sums[0];
  c.report.D_E = sums[1];
}

// With rho held (trivial connections) the problem is not local: turning all frames around slowly varying vertices costs
// next to nothing, the Dirichlet energy of the turn. So the edges' blocks are joined by a Poisson solve for such turns
// g: y = g at both ends of an edge, X = g in its faces. Conjugate gradients in double; returns the iterations.
class HeldRho {
 public:
  HeldRho(const Mesh& mesh, const Geometry& geometry)
      : mesh_(mesh), poisson_(make_linear_solver<double>({.tolerance = 1e-4})) {
    const SparseMatrix<double> L = detail::grounded_laplacian(mesh, geometry, find_topology(mesh));
    poisson_->analyse(L);
    poisson_->factorise(L);
  }

  // u += the solution for rhs, to the relative reduction `wanted`; product(p) is A p.
  template <class System, class Product>
  int solve(System& system, const EdgeValues& rhs, double wanted, int most, const Product& product,
            ValuesOut& u) const {
    EdgeValues r = rhs, z(3, r.cols()), p, before = r;
    double square = precondition(system, r, z), first = square;
    p = z;
    int done = 0;
    while (done < most && square > wanted * wanted * first) {
      ++done;
      const EdgeValues q = product(p);
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
  static double dot(const EdgeValues& a, const EdgeValues& b) {
    return parallel_sum<double>(a.cols(), [&](std::int64_t e) { return a.col(e).dot(b.col(e)); });
  }

  // z = P r; returns r' z.
  template <class System>
  double precondition(System& system, const EdgeValues& r, EdgeValues& z) const {
    (void)system.start([&](Index e) { return std::array<double, 3>{r(0, e), r(1, e), r(2, e)}; });
    parallel_for(mesh_.edges(), [&](std::int64_t e) {
      const auto blocks = system.preconditioned(static_cast<Index>(e));
      for (Eigen::Index k = 0; k < 3; ++k) z(k, e) = double(blocks[static_cast<std::size_t>(k)]);
    });
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

void optimise_globally(const Mesh& mesh, const Geometry& geometry, const GlobalOptions& options, bool fix_rho,
                       Connection& c, LiftedResiduals& r) {
  validate(options);
  // A float solve gains about five digits before its rounding shows; less than one digit means it is of no use here.
  constexpr double float_reduction = 1e-5, useful_reduction = 0.1;

  const HalfedgeWeights weights(mesh, geometry, options);
  const FaceStates states{mesh, geometry, weights, options.detail, c.tau, r};
  const auto coefficients = [&](const auto& first, auto& out) { states.coefficients(first, out); };
  const LargeArray<double> u_memory(3 * static_cast<std::size_t>(mesh.edges()));
  const LargeArray<double> x(static_cast<std::size_t>(mesh.halfedges()));
  ValuesOut u(u_memory.data(), 3, mesh.edges());
  parallel_for(mesh.edges(), [&](std::int64_t e) { u.col(e).setZero(); });
  const FacePairs faces = fix_rho ? single_faces(mesh) : pair_faces(mesh, geometry);
  {
    const LargeArray<double> parts_memory(6 * static_cast<std::size_t>(faces.outer));
    ValuesOut parts(parts_memory.data(), 3, 2 * std::int64_t{faces.outer});
    const Pull pulls{states, faces, u, parts, x.data()};
    // The first pull comes with the coefficients that both need.
    CorrectionSystem<float> system(mesh, faces, coefficients, fix_rho, pulls);
    std::optional<CorrectionSystem<double>> full_system;  // only where float does not do
    std::optional<HeldRho> held;
    if (fix_rho) held.emplace(mesh, geometry);

    const double tolerance = std::max(options.tolerance, 4.0 * double(std::numeric_limits<double>::epsilon()));
    const auto rhs = [&](Index i) {
      std::array<double, 3> pull = pull_on(parts, i, mesh.boundary_halfedge(mesh.halfedge(faces.edge[at(i)])));
      if (fix_rho) pull[2] = 0;
      return pull;
    };
    const auto improve = [&](const auto& solved) {
      parallel_for(faces.outer, [&](std::int64_t i) {
        const auto gain = solved.solution(static_cast<Index>(i));
        for (Eigen::Index k = 0; k < 3; ++k) u(k, i) += double(gain[static_cast<std::size_t>(k)]);
      });
    };
    double first = 0, last = 0;
    c.report.iterations = 0;
    for (int round = 0;; ++round) {
      if (round > 0) pulls.all(system);
      // Measured through the preconditioner; float is enough for a norm.
      const double square = system.start(rhs);
      const double norm = std::sqrt(std::max(0.0, square));
      if (round == 0) first = norm;
      // Where the start is already the optimum (a flat piece) the gradient is rounding and nothing is left to do.
      const double floor = double(std::numeric_limits<double>::epsilon()) * std::sqrt(double(mesh.halfedges()));
      c.report.residual = first > floor ? norm / first : 0.0;
      const int left = options.max_iterations - c.report.iterations;
      if (c.report.residual <= tolerance || left <= 0) break;
      if (round > 0 && norm > useful_reduction * last) {
        if (full_system) break;  // full precision has reached its own rounding
        full_system.emplace(mesh, faces, coefficients, fix_rho, NoVisitor{});
      }
      last = norm;
      const double wanted = 0.5 * tolerance / c.report.residual;
      if (held) {
        const VectorX<double> nothing;
        const LiftedResiduals nowhere;
        const FaceStates rest{mesh, geometry, weights, options.detail, nothing, nowhere, true};
        VectorX<double> moved(mesh.halfedges());
        EdgeValues gradient(3, mesh.edges());
        parallel_for(mesh.edges(), [&](std::int64_t e) {
          const auto pull = rhs(static_cast<Index>(e));
          for (Eigen::Index k = 0; k < 3; ++k) gradient(k, e) = pull[static_cast<std::size_t>(k)];
        });
        const auto product = [&](EdgeValues& direction) {
          EdgeValues out(3, mesh.edges());
          ValuesOut turned(direction.data(), 3, mesh.edges());
          Pull{rest, faces, turned, parts, moved.data()}.all(system);
          parallel_for(mesh.edges(), [&](std::int64_t e) {
            const auto pull = rhs(static_cast<Index>(e));
            out(0, e) = -pull[0];
            out(1, e) = -pull[1];
            out(2, e) = 0;
          });
          return out;
        };
        c.report.iterations += held->solve(system, gradient, std::max(1e-8, wanted), left, product, u);
      } else if (full_system) {
        c.report.iterations += conjugate_gradients(*full_system, full_system->start(rhs), wanted, left);
        improve(*full_system);
      } else {
        c.report.iterations += conjugate_gradients(system, square, std::max(float_reduction, wanted), left);
        improve(system);
      }
    }
    c.report.converged = c.report.residual <= tolerance;
  }
  c.report.message.clear();
  if (!c.report.converged)
    c.report.message = "the global connection stopped after " + std::to_string(c.report.iterations) +
                       " iterations above its tolerance; raise max_iterations, tolerance or detail";

  // The frame of a vertex may be turned without a change of energy. The one that is kept turns the directions of the
  // vertex's faces by 0 on average, whichever way the iteration took.
  VectorX<double> turn(mesh.vertices());
  parallel_for(mesh.vertices(), [&](std::int64_t v) {
    double sum = 0, weight = 0;
    if (!fix_rho)
      mesh.for_each_outgoing(static_cast<Index>(v), [&](Index h) {
        sum += double(geometry.angle(h)) * x[at(h)];
        weight += double(geometry.angle(h));
      });
    turn[v] = weight > 0 ? sum / weight : 0.0;
  });
  parallel_for(mesh.faces(), [&](std::int64_t t) {
    const Index h = static_cast<Index>(3 * t);
    for (Index k = 0; k < 3; ++k) {
      const Index e = mesh.edge(h + k);
      const double here = x[at(h + k)];
      c.rho_t[h + k] += static_cast<double>(here - turn[mesh.tail(h + k)]);
      r.start[h + k] += static_cast<double>(here);
      r.end[h + k] += static_cast<double>(x[at(h + (k + 1) % 3)]);
      if (!fix_rho && mesh.canonical(h + k)) {
        c.rho[e] += static_cast<double>(u(2, faces.number[at(e)]) - turn[mesh.tail(h + k)] + turn[mesh.tip(h + k)]);
        c.eps[e] += static_cast<double>(u(2, faces.number[at(e)]));
      }
    }
  });
  parallel_for(mesh.edges(), [&](std::int64_t e) {
    const auto [at_tail, at_tip] = edge_correction(mesh, weights, r, static_cast<Index>(e));
    const Index h = mesh.halfedge(static_cast<Index>(e)), g = mesh.twin(h);
    c.rho_e[2 * e] += at_tail - static_cast<double>(turn[mesh.tail(h)]);
    c.rho_e[2 * e + 1] += at_tip - static_cast<double>(turn[mesh.tip(h)]);
    c.eps[e] += at_tip - at_tail;
    r.start[h] -= at_tail;
    r.end[h] -= at_tip;
    if (g != none) {
      r.end[g] -= at_tail;
      r.start[g] -= at_tip;
    }
  });
  close_faces(mesh, geometry, weights, r, c);
}

}  // namespace detail

void measure_deviation(const Mesh& mesh, const Geometry& geometry, const GlobalOptions& options, Connection& c) {
  validate(options);
  deviation(mesh, geometry, HalfedgeWeights(mesh, geometry, options), c);
}

}  // namespace alcap
