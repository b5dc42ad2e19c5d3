// SPDX-License-Identifier: MIT
#include "src/distributed/connect.h"

#include "kernels/connection_energy.h"
#include "src/base/array.h"
#include "src/connection/global/energy.h"

namespace alcap::detail::distributed {
namespace {

/// D_T and D_E, every face by one rank.
void measure_together(const Patch& patch, const PatchWeights& weights, const LiftedResiduals& r, Connection& c) {
  double sums[2] = {0, 0};
  for (Index t = 0; t < patch.mesh.faces(); ++t) {
    if (patch.mine[at(t)] == 0) continue;
    const Index h = 3 * t;
    const double cot[3] = {patch.geometry.cot(h), patch.geometry.cot(h + 1), patch.geometry.cot(h + 2)};
    const double tau[3] = {c.tau[h], c.tau[h + 1], c.tau[h + 2]};
    sums[0] += kernels::triangle_energy(cot, tau);
    for (Index k = h; k < h + 3; ++k) sums[1] += kernels::halfedge_energy(weights(k), r.start[k], r.end[k]);
  }
  sum_all(sums);
  c.report.D_T = sums[0];
  c.report.D_E = sums[1];
}

}  // namespace

PatchWeights::PatchWeights(const Patch& patch, const Components& components, const GlobalOptions& options)
    : patch_(patch), components_(components), cap_(options.tan_cap), factor_(options.length_factor) {
  if (factor_ != LengthFactor::mean_edge) return;
  const Mesh& mesh = patch.mesh;
  per_length_.assign(components.list.size(), 0);
  for (Index e = 0; e < mesh.edges(); ++e) {
    const Index h = mesh.halfedge(e), i = mesh.tail(h), j = mesh.tip(h);
    if ((patch.vertex[at(i)] < patch.vertex[at(j)] ? i : j) >= patch.owned) continue;
    per_length_[at(components.of_vertex[at(std::min(i, j))])] += patch.geometry.length(e);
  }
  sum_all(per_length_);
  for (std::size_t k = 0; k < per_length_.size(); ++k)
    per_length_[k] = static_cast<double>(components.list[k].edges) / per_length_[k];
}

double PatchWeights::operator()(Index h) const {
  const double tangent = kernels::capped_tangent(patch_.geometry.cot(Mesh::prev(h)), cap_);
  if (factor_ == LengthFactor::per_edge) return tangent;
  const double length = patch_.geometry.length(patch_.mesh.edge(h));
  if (factor_ == LengthFactor::metric) return tangent * length;
  return tangent * length * per_length_[at(components_.of_vertex[at(patch_.mesh.tail(h))])];
}

Connection connect(const Patch& patch, const Components& components, const DistributedOptions& options) {
  validate(options.global);
  const ConnectionKind kind = options.connection.kind;
  const bool flat = kind == ConnectionKind::trivial || kind == ConnectionKind::metric;
  if (!flat && !(options.cones.empty() && options.loop_index.empty()))
    throw OptionError(options.cones.empty() ? "loop_index" : "cones", "given",
                      "is of trivial and metric connections; " + std::string(name(kind)) + " has none");
  Connection c;
  LiftedResiduals r;
  const PolarCenter center = kind == ConnectionKind::polar ? options.connection.center : PolarCenter::incenter;
  const PatchWeights weights(patch, components, options.global);
  if (flat)
    c = connect_cones(patch, components, weights, options, r);
  else if (!patch.empty())
    c = polar_start(patch.mesh, patch.geometry, center, r);
  if (kind == ConnectionKind::local && !patch.empty()) optimise_locally(patch.mesh, c, r);
  if (kind == ConnectionKind::global) optimise_together(patch, weights, options.global, c, r);
  c.kind = kind;
  c.center = center;
  c.options = options.global;
  measure_together(patch, weights, r, c);
  return c;
}

}  // namespace alcap::detail::distributed
