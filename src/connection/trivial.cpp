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
#include "src/base/numbers.h"
#include "src/base/parallel.h"
#include "src/connection/cone_index.h"
#include "src/connection/cone_problem.h"
#include "src/connection/construction.h"

namespace alcap {
namespace {

using Vector = Eigen::VectorXd;
using detail::at;
using detail::check_multiple;

// How far sums of indices that are no multiples of anything may be off, in turns.
constexpr double turn_tolerance = 1e-6;

// What is asked for. n = 0: cones, holonomies and indices of any size.
struct Wish {
  const std::vector<Cone>& cones;
  int n;
  const std::vector<double>& generator_holonomy;
  const std::vector<double>& loop_index;
  const GlobalOptions& global;
  const std::string& solver;

  [[nodiscard]] bool any() const { return n == 0; }
  void check(const char* field, double turns) const {
    detail::check_turns(field, turns);
    if (!any()) check_multiple(field, turns, n);
  }
};

// What the indices of a component sum to and should; throws unless it can be met.
void check_sum(const Wish& wish, Index component, double euler, double sum) {
  const double missing = euler - sum;
  if (std::abs(missing) * std::max(1, wish.n) <= (wish.any() ? turn_tolerance : detail::multiple_tolerance)) return;
  const auto shown = [&](double turns) { return wish.any() ? turns : detail::nearest_multiple(turns, wish.n); };
  throw OptionError("cones", shown(sum),
                    "the indices of component " + std::to_string(component) + " must sum to its Euler characteristic " +
                        detail::number_text(euler) + "; " + detail::number_text(shown(missing)) + " is missing");
}

void check_cone(const Mesh& mesh, const Wish& wish, const Cone& cone) {
  const std::string name = std::to_string(cone.vertex);
  if (cone.vertex < 0 || cone.vertex >= mesh.vertices())
    throw OptionError("cones", name, "there is no such vertex; the mesh has " + std::to_string(mesh.vertices()));
  if (!mesh.referenced(cone.vertex)) throw OptionError("cones", name, "no face uses this vertex");
  if (mesh.boundary_vertex(cone.vertex))
    throw OptionError("cones", name, "this vertex lies on the boundary; give its loop an index instead");
  wish.check("cones", cone.index);
}

// Wanted vertex indices; throws unless every component's sum can be met.
Vector check_cones(const Mesh& mesh, const Topology& topology, const Wish& wish) {
  Vector index = Vector::Zero(mesh.vertices());
  std::vector<double> sum(topology.components.size(), 0.0);
  for (const Cone& cone : wish.cones) {
    check_cone(mesh, wish, cone);
    index[cone.vertex] += cone.index;
    sum[at(topology.vertex_component[at(cone.vertex)])] += cone.index;
  }
  if (!wish.loop_index.empty()) {
    if (wish.loop_index.size() != topology.loops.size())
      throw OptionError("loop_index", std::to_string(wish.loop_index.size()) + " entries",
                        "needs one per boundary loop, " + std::to_string(topology.loops.size()));
    for (std::size_t l = 0; l < topology.loops.size(); ++l) {
      wish.check("loop_index", wish.loop_index[l]);
      sum[at(topology.loops[l].component)] += wish.loop_index[l];
    }
  }
  for (std::size_t c = 0; c < sum.size(); ++c)
    if (topology.components[c].boundary_loops == 0 || !wish.loop_index.empty())
      check_sum(wish, static_cast<Index>(c), topology.components[c].euler, sum[c]);
  return index;
}

// Loop indices: multiples of 1/n nearest to `turns` whose sum over each component is what the cones leave.
std::vector<double> round_loops(const Topology& topology, const Vector& vertex_index, const std::vector<double>& turns,
                                int n) {
  std::vector<double> rounded(turns.size()), missing(topology.components.size());
  std::vector<std::vector<std::size_t>> loops(topology.components.size());
  for (std::size_t c = 0; c < missing.size(); ++c) missing[c] = topology.components[c].euler;
  for (Eigen::Index v = 0; v < vertex_index.size(); ++v)
    if (topology.vertex_component[at(v)] != none) missing[at(topology.vertex_component[at(v)])] -= vertex_index[v];
  for (std::size_t l = 0; l < turns.size(); ++l) {
    const std::size_t c = at(topology.loops[l].component);
    loops[c].push_back(l);
    missing[c] -= rounded[l] = detail::nearest_multiple(turns[l], n);
  }
  for (std::size_t c = 0; c < loops.size(); ++c) {
    if (loops[c].empty()) continue;
    // Whole steps of 1/n are left over, fewer than there are loops unless the cones take far too much. They are spread
    // evenly, and the last ones go where rounding went furthest the other way.
    const auto steps = detail::rounded<std::int64_t>(missing[c] * n);
    if (!steps) throw SolveError("the boundary loops have no finite turns; the mesh is too far from regular triangles");
    const std::int64_t count = detail::count_of(loops[c]), even = *steps / count, rest = *steps % count;
    const double step = rest > 0 ? 1.0 : -1.0;
    std::stable_sort(loops[c].begin(), loops[c].end(), [&](std::size_t i, std::size_t j) {
      return step * (turns[i] - rounded[i]) > step * (turns[j] - rounded[j]);
    });
    for (std::int64_t k = 0; k < count; ++k)
      rounded[loops[c][at(k)]] += (double(even) + (k < std::abs(rest) ? step : 0.0)) / n;
  }
  return rounded;
}

Connection with_cones(const Mesh& mesh, const Geometry& geometry, const Wish& wish) {
  const Topology topology = find_topology(mesh);
  const Vector vertex_index = check_cones(mesh, topology, wish);
  const std::vector<Loop> generators = homology_generators(mesh, topology);
  if (!wish.generator_holonomy.empty()) {
    if (wish.generator_holonomy.size() != generators.size())
      throw OptionError("generator_holonomy", std::to_string(wish.generator_holonomy.size()) + " entries",
                        "needs one per generator, " + std::to_string(generators.size()));
    for (const double turns : wish.generator_holonomy) wish.check("generator_holonomy", turns);
  }
  detail::ConeProblem problem(mesh, geometry, topology);
  const detail::ConeWish cone_wish{.n = wish.n, .generator_holonomy = wish.generator_holonomy, .solver = wish.solver};
  std::vector<double> loop_index = wish.loop_index;
  if (!wish.any() && loop_index.empty() && !topology.loops.empty()) {
    const Vector free = problem.solve(vertex_index, {}, {}, cone_wish);
    loop_index = round_loops(topology, vertex_index, problem.loop_turns(free), wish.n);
  }
  const bool holonomies = !wish.any() || !wish.generator_holonomy.empty();
  const Vector x = problem.solve(vertex_index, loop_index, holonomies ? generators : std::vector<Loop>{}, cone_wish);

  detail::LiftedResiduals residuals;
  Connection c = detail::build_connection(mesh, geometry, 2 * pi<double> * vertex_index,
                                          detail::adjustment_across(mesh, x), PolarCenter::incenter, residuals);
  detail::optimise_with_held_rotations(mesh, geometry, wish.global, c, residuals);
  c.kind = wish.any() ? ConnectionKind::metric : ConnectionKind::trivial;
  c.flat = true;
  c.cones = wish.cones;
  // As found, without the solver's rounding where they are known to be multiples.
  const auto turns = [&](double found) { return wish.any() ? found : detail::nearest_multiple(found, wish.n); };
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
                    {.cones = cones,
                     .n = options.n,
                     .generator_holonomy = options.generator_holonomy,
                     .loop_index = options.loop_index,
                     .global = options.global,
                     .solver = options.solver});
}

Connection metric_connection(const Mesh& mesh, const Geometry& geometry, const std::vector<Cone>& cones,
                             const MetricOptions& options) {
  return with_cones(mesh, geometry,
                    {.cones = cones,
                     .n = 0,
                     .generator_holonomy = options.generator_holonomy,
                     .loop_index = options.loop_index,
                     .global = options.global,
                     .solver = options.solver});
}

}  // namespace alcap
