// SPDX-License-Identifier: MIT
#include "src/connection/global/energy.h"

#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "kernels/connection_energy.h"
#include "src/base/array.h"
#include "src/base/parallel.h"

namespace alcap {
namespace detail {

void validate(const GlobalOptions& o) {
  const auto refuse = [](const char* field, double value, const char* rule) { throw OptionError(field, value, rule); };
  // Beyond, one of the two parts of the energy has no digits left.
  if (!(o.detail >= 1e-12 && o.detail <= 1e12)) refuse("detail", o.detail, "must be in [1e-12, 1e12]");
  if (!(o.tan_cap > 0) || !std::isfinite(o.tan_cap)) refuse("tan_cap", o.tan_cap, "must be positive and finite");
  if (!(o.tolerance > 0) || o.tolerance >= 1) refuse("tolerance", o.tolerance, "must lie in (0, 1)");
  if (o.max_iterations < 1) refuse("max_iterations", o.max_iterations, "must be at least 1");
}

HalfedgeWeights::HalfedgeWeights(const Mesh& mesh, const Geometry& geometry, const GlobalOptions& options)
    : mesh_(mesh), geometry_(geometry), cap_(options.tan_cap), factor_(options.length_factor) {
  if (factor_ != LengthFactor::mean_edge) return;
  Topology topology = find_topology(mesh);
  if (topology.components.size() == 1) {
    const double sum =
        parallel_sum<double>(mesh.edges(), [&](std::int64_t e) { return geometry.length(static_cast<Index>(e)); });
    per_length_ = {static_cast<double>(mesh.edges()) / sum};
    return;
  }
  std::vector<double> sum(topology.components.size());
  for (Index e = 0; e < mesh.edges(); ++e)
    sum[at(topology.face_component[at(Mesh::face(mesh.halfedge(e)))])] += geometry.length(e);
  for (std::size_t c = 0; c < sum.size(); ++c)
    per_length_.push_back(static_cast<double>(topology.components[c].edges) / sum[c]);
  face_component_ = std::move(topology.face_component);
}

double HalfedgeWeights::operator()(Index h) const {
  return kernels::capped_tangent(geometry_.cot(Mesh::prev(h)), cap_) * length_factor(h);
}

double HalfedgeWeights::length_factor(Index h) const {
  if (factor_ == LengthFactor::per_edge) return 1;
  const double length = geometry_.length(mesh_.edge(h));
  if (factor_ == LengthFactor::metric) return length;
  return length * per_length_[at(face_component_.empty() ? 0 : face_component_[at(Mesh::face(h))])];
}

void close_faces(const Mesh& mesh, const Geometry& geometry, const HalfedgeWeights& weights, const LiftedResiduals& r,
                 Connection& c) {
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

}  // namespace detail

void measure_deviation(const Mesh& mesh, const Geometry& geometry, const GlobalOptions& options, Connection& c) {
  detail::validate(options);
  c.options = options;
  const detail::HalfedgeWeights weights(mesh, geometry, options);
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

}  // namespace alcap
