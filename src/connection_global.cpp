// SPDX-License-Identifier: MIT
//
// connection_global.cpp: the connection that minimises D_T + lambda D_E (LTGD 2016, Sec. 5.3).
//
// Iterative refinement: the gradient at the current lifted state is taken in the connection's own precision, the
// correction it asks for is solved by conjugate gradients in float (src/correction_system.h), which halves the memory
// traffic that bounds them; where float makes no headway (extreme slivers) the next correction is solved in full
// precision.
#include <optional>
#include <string>

#include "alcap/connection.h"
#include "alcap/parallel.h"
#include "kernels/connection_energy.h"
#include "src/correction_system.h"

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

// The correction of rho_{v->e} at both ends of edge e that is best for the state r (src/correction_system.h).
template <class T>
std::pair<T, T> edge_correction(const Mesh& mesh, const VectorX<T>& weights, const detail::LiftedResiduals<T>& r,
                                Index e) {
  const Index h = mesh.halfedge(e), g = mesh.twin(h);
  if (g == none) return {r.start[h], r.end[h]};
  const T sum = weights[h] + weights[g];
  return {(weights[h] * r.start[h] + weights[g] * r.end[g]) / sum,
          (weights[h] * r.end[h] + weights[g] * r.start[g]) / sum};
}

template <class To, class From>
detail::Correction<To> cast(const detail::Correction<From>& x) {
  return {x.X.template cast<To>(), x.R.template cast<To>()};
}

// Solves A x = -gradient to `reduction`, arithmetic in S.
template <class S, class T>
int solve_in(detail::CorrectionSystem<S>& system, const detail::Correction<T>& gradient, double reduction,
             int max_iterations, detail::Correction<T>& x) {
  detail::Correction<S> residual{-gradient.X.template cast<S>(), -gradient.R.template cast<S>()}, correction;
  const int iterations = detail::conjugate_gradients(system, residual, reduction, max_iterations, correction);
  x = cast<T>(correction);
  return iterations;
}

}  // namespace

namespace detail {

template <class T>
void optimise_globally(const Mesh& mesh, const Geometry<T>& geometry, const GlobalOptions& options, bool fix_rho,
                       Connection<T>& c, LiftedResiduals<T>& r) {
  validate(options);
  // A float solve gains about five digits before its rounding shows; less than one digit means it is of no use here.
  constexpr double float_reduction = 1e-5, useful_reduction = 0.1;
  // Blocks pay on slivers (an equilateral triangle's cotangents sum to 1.7, those of one with a corner of 10 degrees to
  // 5.8), and on every face when little weight on D_E leaves D_T's own couplings to the preconditioner.
  constexpr double sliver = 6, small_detail = 0.5, no_blocks = std::numeric_limits<double>::infinity();
  const double block_above = options.detail < small_detail ? 0 : sliver;

  const VectorX<T> weights = halfedge_weights(mesh, geometry, options);
  VectorX<T> edge_weight(mesh.edges());
  parallel_for(mesh.edges(), [&](std::int64_t e) {
    const Index h = mesh.halfedge(static_cast<Index>(e)), g = mesh.twin(h);
    edge_weight[e] =
        g == none ? T(0) : static_cast<T>(options.detail) * weights[h] * weights[g] / (weights[h] + weights[g]);
  });
  CorrectionSystem<T> system(mesh, geometry.cots(), edge_weight, fix_rho, no_blocks);
  const VectorX<float> float_cots = geometry.cots().template cast<float>();
  const VectorX<float> float_weight = edge_weight.template cast<float>();
  CorrectionSystem<float> float_system(mesh, float_cots, float_weight, fix_rho, block_above);
  std::optional<CorrectionSystem<T>> full_system;  // only where float does not do

  const double tolerance = std::max(options.tolerance, 4.0 * double(std::numeric_limits<T>::epsilon()));
  Correction<T> gradient = system.zeros(), x;
  Correction<float> measured = float_system.zeros();
  double first = 0, last = 0;
  c.report.iterations = 0;
  for (int round = 0;; ++round) {
    system.gradient(c.tau, r.start, r.end, gradient);
    // Measured through the preconditioner; float is enough for a norm.
    const double norm = std::sqrt(std::max(0.0, float_system.precondition(cast<float>(gradient), measured)));
    if (round == 0) first = norm;
    // Where the start is already the optimum (a flat piece) the gradient is rounding and nothing is left to do.
    const double floor = double(std::numeric_limits<T>::epsilon()) * std::sqrt(double(mesh.halfedges()));
    c.report.residual = first > floor ? norm / first : 0.0;
    const int left = options.max_iterations - c.report.iterations;
    if (c.report.residual <= tolerance || left <= 0) break;
    if (round > 0 && norm > useful_reduction * last) {
      if (full_system) break;  // full precision has reached its own rounding
      full_system.emplace(mesh, geometry.cots(), edge_weight, fix_rho, block_above);
    }
    last = norm;
    const double wanted = 0.5 * tolerance / c.report.residual;
    c.report.iterations += full_system ? solve_in(*full_system, gradient, wanted, left, x)
                                       : solve_in(float_system, gradient, std::max(float_reduction, wanted), left, x);
    parallel_for(mesh.faces(), [&](std::int64_t t) {
      const Index h = static_cast<Index>(3 * t);
      for (Index k = 0; k < 3; ++k) {
        const Index ahead = h + (k + 1) % 3, e = mesh.edge(h + k);
        c.rho_t[h + k] += x.X[h + k];
        r.start[h + k] += x.X[h + k];
        r.end[h + k] += x.X[ahead];
        c.tau[h + k] += x.X[ahead] - x.X[h + k];
        if (!fix_rho) c.tau[h + k] += mesh.canonical(h + k) ? x.R[e] : -x.R[e];
      }
    });
    if (!fix_rho)
      parallel_for(mesh.edges(), [&](std::int64_t e) {
        c.rho[e] += x.R[e];
        c.eps[e] += x.R[e];
      });
  }
  c.report.converged = c.report.residual <= tolerance;
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

template void measure_deviation(const Mesh&, const Geometry<float>&, const GlobalOptions&, Connection<float>&);
template void measure_deviation(const Mesh&, const Geometry<double>&, const GlobalOptions&, Connection<double>&);

}  // namespace alcap
