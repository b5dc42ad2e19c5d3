// SPDX-License-Identifier: MIT
//
// trivial.cpp: trivial connections with prescribed cones (LTGD 2016, Sec. 5.4; Crane et al. 2010).
//
// x per edge is the extra rotation across it. Among all x that give every vertex its curvature (A x = b) and every
// generator its holonomy (H x = c), the one that minimises sum x^2 / w is x = w (A' mu + H' nu). The mu come from
// Poisson solves with A w A', the nu from a dense system of one row per generator. A boundary loop is one node, or none
// when its index is free (mu = 0 there).
#include <Eigen/Cholesky>
#include <numeric>
#include <string>

#include "alcap/connection.h"
#include "alcap/solve.h"
#include "src/base/parallel.h"

namespace alcap {
namespace {

using Vector = Eigen::VectorXd;

// Cotangent weights at obtuse angles are raised to this: any positive weight gives a valid connection.
constexpr double least_weight = 1e-3;
// How far an index may be from a multiple of 1/n, in units of 1/n.
constexpr double multiple_tolerance = 1e-6;

double nearest_multiple(double turns, int n) { return std::nearbyint(turns * n) / n; }

void check_multiple(const char* field, double value, int n) {
  if (!(std::abs(value * n - std::nearbyint(value * n)) <= multiple_tolerance))
    throw OptionError(field, std::to_string(value), "must be a multiple of 1/" + std::to_string(n));
}

// The Poisson problem over interior vertices and boundary loops.
class ConeProblem {
 public:
  ConeProblem(const Mesh& mesh, const Geometry& geometry, const Topology& topology)
      : mesh_(mesh), topology_(topology), weight_(mesh.edges()), defect_(mesh.vertices()) {
    for (Index e = 0; e < mesh.edges(); ++e) {
      const Index h = mesh.halfedge(e), g = mesh.twin(h);
      weight_[e] = g == none
                       ? 0.0
                       : std::max(least_weight,
                                  0.5 * (double(geometry.cot(Mesh::prev(h))) + double(geometry.cot(Mesh::prev(g)))));
    }
    for (Index v = 0; v < mesh.vertices(); ++v) defect_[v] = double(geometry.defect(mesh, v));
    loop_of_vertex_.assign(static_cast<std::size_t>(mesh.vertices()), none);
    for (std::size_t l = 0; l < topology.loops.size(); ++l)
      for (const Index h : topology.loops[l].halfedges)
        loop_of_vertex_[static_cast<std::size_t>(mesh.tail(h))] = static_cast<Index>(l);
  }

  // x of least norm for the wanted vertex indices (turns); loops get theirs, or stay free when `loop_index` is empty.
  [[nodiscard]] Vector solve(const Vector& vertex_index, const std::vector<double>& loop_index,
                             const std::vector<Loop>& generators, const TrivialOptions& options,
                             const Vector& levi_civita_holonomy) {
    number_nodes(!loop_index.empty());
    factorise(options.solver);
    Vector b = Vector::Zero(nodes_);
    for (Index v = 0; v < mesh_.vertices(); ++v)
      if (node(v) != none)
        b[node(v)] += loop_of(v) == none ? 2 * pi<double> * vertex_index[v] - defect_[v] : -defect_[v];
    if (!loop_index.empty())
      for (std::size_t l = 0; l < loop_index.size(); ++l) {
        const Index at = node(mesh_.tail(topology_.loops[l].halfedges.front()));
        if (at != none) b[at] += 2 * pi<double> * loop_index[l];
      }
    Vector x = flow(potentials(b));
    if (!generators.empty()) add_generators(generators, options, levi_civita_holonomy, x);
    return x;
  }

  // Turns that each boundary loop has under x.
  [[nodiscard]] std::vector<double> loop_turns(const Vector& x) const {
    std::vector<double> turns(topology_.loops.size(), 0.0);
    for (Index e = 0; e < mesh_.edges(); ++e) {
      const Index h = mesh_.halfedge(e);
      if (mesh_.boundary_halfedge(h)) continue;
      if (const Index l = loop_of(mesh_.tail(h)); l != none) turns[static_cast<std::size_t>(l)] += x[e];
      if (const Index l = loop_of(mesh_.tip(h)); l != none) turns[static_cast<std::size_t>(l)] -= x[e];
    }
    for (Index v = 0; v < mesh_.vertices(); ++v)
      if (const Index l = loop_of(v); l != none) turns[static_cast<std::size_t>(l)] += defect_[v];
    for (double& t : turns) t /= 2 * pi<double>;
    return turns;
  }

 private:
  [[nodiscard]] Index loop_of(Index v) const { return loop_of_vertex_[static_cast<std::size_t>(v)]; }
  [[nodiscard]] Index node(Index v) const { return node_of_vertex_[static_cast<std::size_t>(v)]; }

  // Interior vertices, then loops when they are nodes. One node of each component without free loops is the ground.
  void number_nodes(bool loops_are_nodes) {
    std::vector<Index> node_of_loop(topology_.loops.size(), none);
    std::vector<bool> grounded(topology_.components.size(), false);
    if (!loops_are_nodes)
      for (const Loop& loop : topology_.loops) grounded[static_cast<std::size_t>(loop.component)] = true;
    node_of_vertex_.assign(static_cast<std::size_t>(mesh_.vertices()), none);
    nodes_ = 0;
    const auto take = [&](Index component) -> Index {
      if (grounded[static_cast<std::size_t>(component)]) return nodes_++;
      grounded[static_cast<std::size_t>(component)] = true;
      return none;
    };
    if (loops_are_nodes)
      for (std::size_t l = 0; l < topology_.loops.size(); ++l) node_of_loop[l] = take(topology_.loops[l].component);
    for (Index v = 0; v < mesh_.vertices(); ++v) {
      if (!mesh_.referenced(v)) continue;
      node_of_vertex_[static_cast<std::size_t>(v)] = loop_of(v) == none
                                                         ? take(topology_.vertex_component[static_cast<std::size_t>(v)])
                                                         : node_of_loop[static_cast<std::size_t>(loop_of(v))];
    }
  }

  void factorise(const std::string& name) {
    std::vector<Eigen::Triplet<double, Index>> entries;
    entries.reserve(4 * static_cast<std::size_t>(mesh_.edges()));
    for (Index e = 0; e < mesh_.edges(); ++e) {
      const Index h = mesh_.halfedge(e);
      if (mesh_.boundary_halfedge(h)) continue;
      const Index i = node(mesh_.tail(h)), j = node(mesh_.tip(h));
      if (i == j) continue;
      if (i != none) entries.emplace_back(i, i, weight_[e]);
      if (j != none) entries.emplace_back(j, j, weight_[e]);
      if (i == none || j == none) continue;
      entries.emplace_back(i, j, -weight_[e]);
      entries.emplace_back(j, i, -weight_[e]);
    }
    SparseMatrix<double> L(nodes_, nodes_);
    L.setFromTriplets(entries.begin(), entries.end());
    if (nodes_ == 0) return;
    solver_ = make_linear_solver<double>({.name = name});
    solver_->analyse(L);
    solver_->factorise(L);
  }

  [[nodiscard]] Vector potentials(const Vector& b) const {
    Eigen::MatrixXd X = Eigen::MatrixXd::Zero(nodes_, 1);
    if (nodes_ > 0) (void)solver_->solve(Eigen::MatrixXd(b), X);
    return X.col(0);
  }

  // w A' mu
  [[nodiscard]] Vector flow(const Vector& mu) const {
    Vector x(mesh_.edges());
    parallel_for(mesh_.edges(), [&](std::int64_t e) {
      const Index h = mesh_.halfedge(static_cast<Index>(e));
      const Index i = node(mesh_.tail(h)), j = node(mesh_.tip(h));
      x[e] = weight_[e] * ((i == none ? 0.0 : mu[i]) - (j == none ? 0.0 : mu[j]));
    });
    return x;
  }

  // Signed sum of x over the edges that a strip crosses.
  [[nodiscard]] double across(const Loop& strip, const Vector& x) const {
    double sum = 0;
    for (const Index h : strip.halfedges) sum += mesh_.canonical(h) ? x[mesh_.edge(h)] : -x[mesh_.edge(h)];
    return sum;
  }

  void add_generators(const std::vector<Loop>& generators, const TrivialOptions& options, const Vector& levi_civita,
                      Vector& x) const {
    const auto count = static_cast<Eigen::Index>(generators.size());
    Eigen::MatrixXd Z(mesh_.edges(), count);  // harmonic: no effect on any vertex
    for (Eigen::Index k = 0; k < count; ++k) {
      Vector z = Vector::Zero(mesh_.edges());
      for (const Index h : generators[static_cast<std::size_t>(k)].halfedges)
        z[mesh_.edge(h)] += (mesh_.canonical(h) ? 1.0 : -1.0) * weight_[mesh_.edge(h)];
      Vector b = Vector::Zero(nodes_);
      for (const Index h : generators[static_cast<std::size_t>(k)].halfedges) {
        const Index e = mesh_.edge(h), i = node(mesh_.tail(h)), j = node(mesh_.tip(h));
        if (i != none) b[i] += weight_[e];
        if (j != none) b[j] -= weight_[e];
      }
      Z.col(k) = z - flow(potentials(b));
    }
    // Holonomy = Levi-Civita's minus the sum of x across; wanted is a multiple of 1/n, or what was asked, modulo a
    // turn.
    Eigen::MatrixXd gram(count, count);
    Vector missing(count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const Loop& strip = generators[static_cast<std::size_t>(k)];
      for (Eigen::Index l = 0; l < count; ++l) gram(k, l) = across(strip, Z.col(l));
      const double now = (levi_civita[k] - across(strip, x)) / (2 * pi<double>);
      double wanted = nearest_multiple(now, options.n);
      if (!options.generator_holonomy.empty()) {
        wanted = options.generator_holonomy[static_cast<std::size_t>(k)];
        wanted += std::nearbyint(now - wanted);
      }
      missing[k] = 2 * pi<double> * (now - wanted);
    }
    x += Z * Eigen::LDLT<Eigen::MatrixXd>(gram).solve(missing);
  }

  const Mesh& mesh_;
  const Topology& topology_;
  Vector weight_, defect_;
  std::vector<Index> loop_of_vertex_, node_of_vertex_;
  Index nodes_ = 0;
  std::unique_ptr<LinearSolver<double>> solver_;
};

// Wanted vertex indices; throws unless every component's sum can be met.
Vector check_cones(const Mesh& mesh, const Topology& topology, const std::vector<Cone>& cones,
                   const TrivialOptions& options) {
  if (options.n < 1) throw OptionError("n", std::to_string(options.n), "the degree of a field is at least 1");
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
    sum[static_cast<std::size_t>(topology.vertex_component[static_cast<std::size_t>(cone.vertex)])] += cone.index;
  }
  if (!options.loop_index.empty()) {
    if (options.loop_index.size() != topology.loops.size())
      throw OptionError("loop_index", std::to_string(options.loop_index.size()) + " entries",
                        "needs one per boundary loop, " + std::to_string(topology.loops.size()));
    for (std::size_t l = 0; l < topology.loops.size(); ++l) {
      check_multiple("loop_index", options.loop_index[l], options.n);
      sum[static_cast<std::size_t>(topology.loops[l].component)] += options.loop_index[l];
    }
  }
  for (std::size_t c = 0; c < sum.size(); ++c) {
    const ComponentInfo& component = topology.components[c];
    if (component.boundary_loops > 0 && options.loop_index.empty()) continue;
    const double missing = component.euler - sum[c];
    if (std::abs(missing) * options.n > multiple_tolerance)
      throw OptionError("cones", std::to_string(sum[c]),
                        "the indices of component " + std::to_string(c) + " must sum to its Euler characteristic " +
                            std::to_string(component.euler) + "; " + std::to_string(missing) + " is missing");
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
      if (topology.vertex_component[static_cast<std::size_t>(v)] == static_cast<Index>(c)) missing -= vertex_index[v];
    for (const std::size_t l : loops) missing -= rounded[l] = nearest_multiple(turns[l], n);
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

double holonomy(const Mesh& mesh, const Geometry& geometry, const Connection& connection, const Loop& strip) {
  double sum = 0;
  for (const Index h : strip.halfedges) {
    const Index g = mesh.twin(h);
    if (g == none)
      throw OptionError("strip", std::to_string(h), "this halfedge lies on the boundary and cannot be crossed");
    sum += pi<double> + connection.edge_to_face(geometry, h) - connection.edge_to_face(geometry, g);
  }
  return wrap(sum);
}

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
    levi_civita[static_cast<Eigen::Index>(k)] = double(holonomy(mesh, geometry, Connection{}, generators[k]));

  ConeProblem problem(mesh, geometry, topology);
  std::vector<double> loop_index = options.loop_index;
  if (loop_index.empty() && !topology.loops.empty()) {
    const Vector free = problem.solve(vertex_index, {}, {}, options, levi_civita);
    loop_index = round_loops(topology, vertex_index, problem.loop_turns(free), options.n);
  }
  const Vector x = problem.solve(vertex_index, loop_index, generators, options, levi_civita);

  VectorX<double> alpha(mesh.halfedges());
  parallel_for(mesh.halfedges(), [&](std::int64_t i) {
    const Index h = static_cast<Index>(i);
    const double half = static_cast<double>(x[mesh.edge(h)] / 2);
    alpha[h] = mesh.canonical(h) ? -half : half;
  });
  VectorX<double> curvature(mesh.vertices());
  for (Index v = 0; v < mesh.vertices(); ++v) curvature[v] = static_cast<double>(2 * pi<double> * vertex_index[v]);

  detail::LiftedResiduals residuals;
  Connection c = detail::build_connection(mesh, geometry, curvature, alpha, PolarCenter::incenter, residuals);
  detail::optimise_globally(mesh, geometry, options.global, true, c, residuals);
  c.kind = ConnectionKind::trivial;
  c.cones = cones;
  return c;
}

}  // namespace alcap
