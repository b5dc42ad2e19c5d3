// SPDX-License-Identifier: MIT
#include "src/distributed/analysis.h"

#include <algorithm>
#include <cmath>

#include "src/base/array.h"
#include "src/base/numbers.h"

namespace alcap::detail::distributed {
namespace {

double argument_of(const Complex<double>& z) { return z == Complex<double>(0) ? 0.0 : std::arg(z); }

/// Turns of the field relative to the tangents of the boundary loops, summed for every component, as index_sums() of
/// singularities.h. Whoever owns the tip of a boundary halfedge adds what belongs to it.
std::vector<double> boundary_turns(const Patch& patch, const Connection& connection, const Field& field,
                                   const Components& components) {
  const Mesh& mesh = patch.mesh;
  std::vector<double> turns(components.list.size(), 0);
  for (Index h = 0; h < mesh.halfedges(); ++h) {
    const Index tip = mesh.tip(h);
    if (!mesh.boundary_halfedge(h) || tip >= patch.owned) continue;
    const Index next = mesh.first(tip);
    const double tangent = 2 * pi<double> + connection.rho_start(mesh, next) - connection.rho_end(mesh, h);
    const double turn =
        wrap(argument_of(field.u[tip]) - argument_of(field.u[mesh.tail(h)]) + field.n * connection.rho_along(mesh, h));
    turns[at(components.of_vertex[at(tip)])] += turn - field.n * (connection.eps_along(mesh, h) + tangent);
  }
  sum_all(turns);
  return turns;
}

}  // namespace

std::vector<DistributedSingularity> analyse(const Patch& patch, const Connection& connection, const Field& field,
                                            Components& components) {
  std::vector<DistributedSingularity> found;
  std::vector<std::int64_t> sums(components.list.size(), 0);
  agreed([&] {
    if (patch.empty()) return;
    std::vector<int> indices = face_indices(patch.mesh, connection, field);
    for (std::size_t t = 0; t < indices.size(); ++t) {
      if (patch.mine[t] == 0) indices[t] = 0;
      if (indices[t] != 0) sums[at(components.of_vertex[at(patch.mesh.F()(static_cast<Index>(t), 0))])] += indices[t];
    }
    for (const Singularity& s : find_singularities(patch.mesh, patch.geometry, connection, field, indices)) {
      DistributedSingularity& here = found.emplace_back(DistributedSingularity{s});
      const auto f = patch.mesh.F().row(s.face);
      for (int c = 0; c < 3; ++c)
        for (int i = 0; i < 3; ++i) here.position[at(i)] += s.barycentric[at(c)] * patch.V(f(c), i);
      here.component = components.of_vertex[at(f(0))];
      here.face = patch.face[at(s.face)];
    }
  });
  sum_all(sums);
  const std::vector<double> turns = boundary_turns(patch, connection, field, components);
  for (std::size_t k = 0; k < sums.size(); ++k) {
    IndexSum& indices = components.list[k].indices;
    indices.sum = sums[k];
    indices.expected =
        field.n * components.list[k].euler + rounded<std::int64_t>(turns[k] / (2 * pi<double>)).value_or(0);
  }
  found = gather_all(found);
  std::ranges::sort(found, {}, &DistributedSingularity::face);
  return found;
}

}  // namespace alcap::detail::distributed
