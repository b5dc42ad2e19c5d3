// SPDX-License-Identifier: MIT
//
// trivial.cpp: trivial connections with prescribed cones (LTGD 2016, Sec. 5.4; Crane et al. 2010): the rotations across
// edges of cone_problem.h, half of them on each side, then the corners and edges that are optimal for them.
#include <algorithm>
#include <cmath>
#include <string>

#include "alcap/connection.h"
#include "src/base/array.h"
#include "src/base/parallel.h"
#include "src/connection/cone_index.h"
#include "src/connection/cone_problem.h"
#include "src/connection/construction.h"

namespace alcap {
namespace {

using Vector = Eigen::VectorXd;
using detail::at;
using detail::check_multiple;

// Wanted vertex indices; throws unless every component's sum can be met.
Vector check_cones(const Mesh& mesh, const Topology& topology, const std::vector<Cone>& cones,
                   const TrivialOptions& options) {
  if (options.n < 1) throw OptionError("n", options.n, "the degree of a field is at least 1");
  Vector index = Vector::Zero(mesh.vertices());
  std::vector<double> sum(topology.components.size(), 0.0);
  for (const Cone& cone : cones) {
    const std::string name = std::to_string(cone.vertex);
    if (cone.vertex < 0 || cone.vertex >= mesh.vertices())
      throw OptionError("cones", name, "there is no such vertex; the mesh has " + std::to_string(mesh.vertices()));
    if (!mesh.referenced(cone.vertex)) throw OptionError("cones", name, "no face uses this vertex");
    if (mesh.boundary_vertex(cone.vertex))
      throw OptionError("cones", name, "this vertex lies on the boundary; give its loop an index instead");
    check_multiple("cones", cone.index, options.n);
    index[cone.vertex] += cone.index;
    sum[at(topology.vertex_component[static_cast<std::size_t>(cone.vertex)])] += cone.index;
  }
  if (!options.loop_index.empty()) {
    if (options.loop_index.size() != topology.loops.size())
      throw OptionError("loop_index", std::to_string(options.loop_index.size()) + " entries",
                        "needs one per boundary loop, " + std::to_string(topology.loops.size()));
    for (std::size_t l = 0; l < topology.loops.size(); ++l) {
      check_multiple("loop_index", options.loop_index[l], options.n);
      sum[at(topology.loops[l].component)] += options.loop_index[l];
    }
  }
  for (std::size_t c = 0; c < sum.size(); ++c) {
    const ComponentInfo& component = topology.components[c];
    if (component.boundary_loops > 0 && options.loop_index.empty()) continue;
    const double missing = component.euler - sum[c];
    if (std::abs(missing) * options.n > detail::multiple_tolerance)
      throw OptionError("cones", detail::nearest_multiple(sum[c], options.n),
                        "the indices of component " + std::to_string(c) + " must sum to its Euler characteristic " +
                            std::to_string(component.euler) + "; " +
                            detail::number_text(detail::nearest_multiple(missing, options.n)) + " is missing");
  }
  return index;
}

// Loop indices: multiples of 1/n nearest to `turns` whose sum over each component is what the cones leave.
std::vector<double> round_loops(const Topology& topology, const Vector& vertex_index, const std::vector<double>& turns,
                                int n) {
  std::vector<double> rounded(turns.size());
  for (std::size_t c = 0; c < topology.components.size(); ++c) {
    std::vector<std::size_t> loops;
    for (std::size_t l = 0; l < turns.size(); ++l)
      if (topology.loops[l].component == static_cast<Index>(c)) loops.push_back(l);
    if (loops.empty()) continue;
    double missing = topology.components[c].euler;
    for (Eigen::Index v = 0; v < vertex_index.size(); ++v)
      if (topology.vertex_component[at(v)] == static_cast<Index>(c)) missing -= vertex_index[v];
    for (const std::size_t l : loops) missing -= rounded[l] = detail::nearest_multiple(turns[l], n);
    // Whole steps of 1/n are left over; they go where rounding went furthest the other way.
    for (auto steps = std::lround(missing * n); steps != 0; steps += steps > 0 ? -1 : 1) {
      const double step = steps > 0 ? 1.0 : -1.0;
      const std::size_t best = *std::max_element(loops.begin(), loops.end(), [&](std::size_t a, std::size_t b) {
        return step * (turns[a] - rounded[a]) < step * (turns[b] - rounded[b]);
      });
      rounded[best] += step / n;
    }
  }
  return rounded;
}

}  // namespace

Connection trivial(const Mesh& mesh, const Geometry& geometry, const std::vector<Cone>& cones,
                   const TrivialOptions& options) {
  const Topology topology = find_topology(mesh);
  const Vector vertex_index = check_cones(mesh, topology, cones, options);
  const std::vector<Loop> generators = homology_generators(mesh, topology);
  if (!options.generator_holonomy.empty()) {
    if (options.generator_holonomy.size() != generators.size())
      throw OptionError("generator_holonomy", std::to_string(options.generator_holonomy.size()) + " entries",
                        "needs one per generator, " + std::to_string(generators.size()));
    for (const double turns : options.generator_holonomy) check_multiple("generator_holonomy", turns, options.n);
  }
  Vector levi_civita(static_cast<Eigen::Index>(generators.size()));
  for (std::size_t k = 0; k < generators.size(); ++k)
    levi_civita[static_cast<Eigen::Index>(k)] = holonomy(mesh, geometry, Connection{}, generators[k]);

  detail::ConeProblem problem(mesh, geometry, topology);
  std::vector<double> loop_index = options.loop_index;
  if (loop_index.empty() && !topology.loops.empty()) {
    const Vector free = problem.solve(vertex_index, {}, {}, options, levi_civita);
    loop_index = round_loops(topology, vertex_index, problem.loop_turns(free), options.n);
  }
  const Vector x = problem.solve(vertex_index, loop_index, generators, options, levi_civita);

  VectorX<double> alpha(mesh.halfedges());
  parallel_for(mesh.halfedges(), [&](std::int64_t i) {
    const Index h = static_cast<Index>(i);
    const double half = x[mesh.edge(h)] / 2;
    alpha[h] = mesh.canonical(h) ? -half : half;
  });
  VectorX<double> curvature(mesh.vertices());
  for (Index v = 0; v < mesh.vertices(); ++v) curvature[v] = 2 * pi<double> * vertex_index[v];

  detail::LiftedResiduals residuals;
  Connection c = detail::build_connection(mesh, geometry, curvature, alpha, PolarCenter::incenter, residuals);
  detail::optimise_with_held_rotations(mesh, geometry, options.global, c, residuals);
  c.kind = ConnectionKind::trivial;
  c.cones = cones;
  return c;
}

}  // namespace alcap
