// SPDX-License-Identifier: MIT
//
// trivial.cpp: connections with prescribed cones, multiples of 1/n or any (LTGD 2016, Sec. 5.4; Crane et al. 2010): the
// rotations across edges of cone_problem.h, half of them on each side, then the corners and edges that are optimal for
// them.
#include <algorithm>
#include <cmath>
#include <string>

#include "alcap/connection.h"
#include "src/base/array.h"
#include "src/connection/cone_problem.h"
#include "src/connection/cone_request.h"
#include "src/connection/construction.h"

namespace alcap {
namespace {

using Vector = Eigen::VectorXd;
using detail::at;

// What is asked for besides cones and loops, and how it is found.
struct Wish {
  detail::ConeRequest cones;
  const std::vector<double>& generator_holonomy;
  const GlobalOptions& global;
  const std::string& solver;
};

detail::ConeSurface surface_of(const Mesh& mesh, const Topology& topology) {
  detail::ConeSurface surface{.vertices = mesh.vertices()};
  for (const ComponentInfo& c : topology.components) surface.euler.push_back(static_cast<double>(c.euler));
  for (const Loop& loop : topology.loops) surface.loop_component.push_back(loop.component);
  return surface;
}

std::vector<detail::ConePlace> places_of(const Mesh& mesh, const Topology& topology, const std::vector<Cone>& cones) {
  std::vector<detail::ConePlace> places(cones.size());
  for (std::size_t k = 0; k < cones.size(); ++k) {
    const Index v = cones[k].vertex;
    if (v < 0 || v >= mesh.vertices()) continue;
    places[k] = {.component = topology.vertex_component[at(v)], .boundary = mesh.boundary_vertex(v)};
  }
  return places;
}

Connection with_cones(const Mesh& mesh, const Geometry& geometry, const Wish& wish) {
  const Topology topology = find_topology(mesh);
  const detail::ConeRequest& request = wish.cones;
  const detail::ConeSurface surface = surface_of(mesh, topology);
  const std::vector<detail::ConePlace> places = places_of(mesh, topology, request.cones);
  check_cones(request, surface, places);
  Vector vertex_index = Vector::Zero(mesh.vertices());
  for (const Cone& cone : request.cones) vertex_index[cone.vertex] += cone.index;
  const std::vector<Loop> generators = homology_generators(mesh, topology);
  if (!wish.generator_holonomy.empty()) {
    if (wish.generator_holonomy.size() != generators.size())
      throw OptionError("generator_holonomy", std::to_string(wish.generator_holonomy.size()) + " entries",
                        "needs one per generator, " + std::to_string(generators.size()));
    for (const double turns : wish.generator_holonomy) request.check("generator_holonomy", turns);
  }
  detail::ConeProblem problem(mesh, geometry, topology);
  const detail::ConeWish cone_wish{
      .n = request.n, .generator_holonomy = wish.generator_holonomy, .solver = wish.solver};
  std::vector<double> loop_index = request.loop_index;
  if (!request.any() && loop_index.empty() && !topology.loops.empty()) {
    const Vector free = problem.solve(vertex_index, {}, {}, cone_wish);
    loop_index = round_loops(request, surface, places, problem.loop_turns(free));
  }
  const bool holonomies = !request.any() || !wish.generator_holonomy.empty();
  const Vector x = problem.solve(vertex_index, loop_index, holonomies ? generators : std::vector<Loop>{}, cone_wish);

  detail::LiftedResiduals residuals;
  Connection c = detail::build_connection(mesh, geometry, 2 * pi<double> * vertex_index,
                                          detail::adjustment_across(mesh, x), PolarCenter::incenter, residuals);
  detail::optimise_with_held_rotations(mesh, geometry, wish.global, c, residuals);
  c.kind = request.any() ? ConnectionKind::metric : ConnectionKind::trivial;
  c.flat = true;
  c.cones = request.cones;
  // As found, without the solver's rounding where they are known to be multiples.
  const auto turns = [&](double found) { return request.any() ? found : detail::nearest_multiple(found, request.n); };
  for (const Loop& generator : generators)
    c.generator_holonomy.push_back(turns(holonomy(mesh, geometry, c, generator) / (2 * pi<double>)));
  for (const double found : problem.loop_turns(x)) c.loop_index.push_back(turns(found));
  return c;
}

}  // namespace

bool Connection::admits_parallel(int n) const {
  if (!flat) return false;
  // Holonomies and loop indices are found by a solver, to its tolerance.
  const auto whole = [&](double turns) {
    return std::abs(turns * n - std::nearbyint(turns * n)) <= detail::multiple_tolerance;
  };
  return std::all_of(cones.begin(), cones.end(), [&](const Cone& cone) { return whole(cone.index); }) &&
         std::all_of(generator_holonomy.begin(), generator_holonomy.end(), whole) &&
         std::all_of(loop_index.begin(), loop_index.end(), whole);
}

Connection trivial(const Mesh& mesh, const Geometry& geometry, const std::vector<Cone>& cones,
                   const TrivialOptions& options) {
  if (options.n < 1) throw OptionError("n", options.n, "the degree of a field is at least 1");
  return with_cones(mesh, geometry,
                    {.cones = {.cones = cones, .n = options.n, .loop_index = options.loop_index},
                     .generator_holonomy = options.generator_holonomy,
                     .global = options.global,
                     .solver = options.solver});
}

Connection metric_connection(const Mesh& mesh, const Geometry& geometry, const std::vector<Cone>& cones,
                             const MetricOptions& options) {
  return with_cones(mesh, geometry,
                    {.cones = {.cones = cones, .n = 0, .loop_index = options.loop_index},
                     .generator_holonomy = options.generator_holonomy,
                     .global = options.global,
                     .solver = options.solver});
}

}  // namespace alcap
