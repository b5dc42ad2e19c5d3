// SPDX-License-Identifier: MIT
//
// nearest.cpp: the discrete connection nearest to any metric connection (LTGD 2016, Sec. 5.4): the target's adjustment
// angles and the curvature they leave around vertices, then the optimisation of Sec. 5.3 with them.
#include <cmath>
#include <string>

#include "alcap/connection.h"
#include "src/base/array.h"
#include "src/base/parallel.h"
#include "src/connection/cone_index.h"
#include "src/connection/cone_problem.h"
#include "src/connection/construction.h"
#include "src/connection/face_curvature.h"

namespace alcap {
namespace {

using detail::at;

// How far curvatures of a component may be from their sum, in radians for each full turn that they add up.
constexpr double sum_tolerance = 1e-6;

void check_array(const char* field, const VectorX<double>& values, std::int64_t size, const char* what) {
  if (values.size() == 0) return;
  if (values.size() != size)
    throw OptionError(field, std::to_string(values.size()) + " entries",
                      std::string("needs one per ") + what + ", " + std::to_string(size));
  for (Eigen::Index k = 0; k < values.size(); ++k)
    if (!(std::abs(values[k]) <= 2 * pi<double> * detail::most_turns))
      throw OptionError(std::string(field) + "[" + std::to_string(k) + "]", values[k],
                        "must be finite, and at most a million turns, in radians");
}

// Throws unless the curvatures of every closed component sum to 2 pi chi.
template <class ComponentOf>
void check_sums(const char* field, const Topology& topology, const VectorX<double>& curvature,
                ComponentOf&& component_of) {
  std::vector<double> sum(topology.components.size(), 0.0), size(sum);
  for (Eigen::Index k = 0; k < curvature.size(); ++k) {
    const Index c = component_of(k);
    if (c == none) continue;
    sum[at(c)] += curvature[k];
    size[at(c)] += std::abs(curvature[k]);
  }
  for (std::size_t c = 0; c < sum.size(); ++c) {
    if (topology.components[c].boundary_loops > 0) continue;
    const double wanted = 2 * pi<double> * static_cast<double>(topology.components[c].euler);
    if (std::abs(sum[c] - wanted) > sum_tolerance * std::max(1.0, size[c]))
      throw OptionError(field, sum[c],
                        "the curvatures of component " + std::to_string(c) +
                            " must sum to 2 pi times its Euler characteristic, " + detail::number_text(wanted));
  }
}

void check_vertex_curvature(const Mesh& mesh, const Topology& topology, const VectorX<double>& curvature) {
  for (Index v = 0; v < mesh.vertices(); ++v)
    if (curvature[v] != 0 && (!mesh.referenced(v) || mesh.boundary_vertex(v)))
      throw OptionError("vertex_curvature[" + std::to_string(v) + "]", curvature[v],
                        "must be 0 at a vertex of the boundary or of no face");
  check_sums("vertex_curvature", topology, curvature, [&](Eigen::Index v) { return topology.vertex_component[at(v)]; });
}

void check(const Mesh& mesh, const Topology& topology, const ConnectionTarget& target) {
  const auto given = [](const VectorX<double>& x) { return x.size() > 0 ? 1 : 0; };
  if (given(target.rotation) + given(target.adjustment) + given(target.vertex_curvature) +
          given(target.face_curvature) >
      1)
    throw OptionError("target", "several arrays",
                      "takes one of rotation, adjustment, vertex_curvature, face_curvature");
  check_array("rotation", target.rotation, mesh.halfedges(), "halfedge");
  check_array("adjustment", target.adjustment, mesh.halfedges(), "halfedge");
  check_array("vertex_curvature", target.vertex_curvature, mesh.vertices(), "vertex");
  check_array("face_curvature", target.face_curvature, mesh.faces(), "face");
  if (target.vertex_curvature.size() > 0) check_vertex_curvature(mesh, topology, target.vertex_curvature);
  if (target.face_curvature.size() > 0)
    check_sums("face_curvature", topology, target.face_curvature,
               [&](Eigen::Index t) { return topology.face_component[at(t)]; });
}

// alpha of every halfedge; empty for the Levi-Civita connection.
VectorX<double> adjustment(const Mesh& mesh, const Geometry& geometry, const Topology& topology,
                           const ConnectionTarget& target, const std::string& solver) {
  if (target.adjustment.size() > 0) return target.adjustment;
  if (target.rotation.size() > 0) {
    VectorX<double> alpha(mesh.halfedges());
    for (Index h = 0; h < mesh.halfedges(); ++h) alpha[h] = wrap(target.rotation[h] + geometry.direction(h));
    return alpha;
  }
  if (target.vertex_curvature.size() == 0) return {};
  detail::ConeProblem problem(mesh, geometry, topology);
  const std::vector<double> no_holonomy;
  return detail::adjustment_across(mesh, problem.solve(target.vertex_curvature / (2 * pi<double>), {}, {},
                                                       {.n = 0, .generator_holonomy = no_holonomy, .solver = solver}));
}

// 2 pi less the corners that the target sees around each interior vertex (LTGD 2016, Sec. 5.4).
VectorX<double> curvature_of(const Mesh& mesh, const Geometry& geometry, const VectorX<double>& alpha) {
  VectorX<double> curvature(mesh.vertices());
  parallel_for(mesh.vertices(), [&](std::int64_t i) {
    const auto v = static_cast<Index>(i);
    curvature[v] = geometry.defect(mesh, v);
    if (alpha.size() > 0) mesh.for_each_outgoing(v, [&](Index h) { curvature[v] -= alpha[h] - alpha[Mesh::prev(h)]; });
  });
  return curvature;
}

}  // namespace

Connection nearest_connection(const Mesh& mesh, const Geometry& geometry, const ConnectionTarget& target,
                              const NearestOptions& options) {
  const Topology topology = find_topology(mesh);
  check(mesh, topology, target);
  const VectorX<double> alpha = adjustment(mesh, geometry, topology, target, options.solver);
  const VectorX<double> curvature =
      target.vertex_curvature.size() > 0 ? target.vertex_curvature : curvature_of(mesh, geometry, alpha);
  detail::LiftedResiduals residuals;
  Connection c = detail::build_connection(mesh, geometry, curvature, alpha, PolarCenter::incenter, residuals);
  const bool faces = target.face_curvature.size() > 0;
  if (faces) detail::set_face_curvature(mesh, geometry, topology, target.face_curvature, options.solver, residuals, c);
  if (options.spread && !faces)
    detail::optimise_globally(mesh, geometry, options.global, c, residuals);
  else
    detail::optimise_with_held_rotations(mesh, geometry, options.global, c, residuals);
  c.kind = ConnectionKind::metric;
  c.to_target = !target.levi_civita();
  return c;
}

}  // namespace alcap
