// SPDX-License-Identifier: MIT
//
// connect_cones.cpp: trivial and metric connections over all ranks. The x per edge is that of cone_problem.h; its
// potentials are zero on the boundary at first. Where boundary loops have indices, the potentials that the loops take
// come from a small dense system per component: one Poisson solve for each loop but the first of its component, those
// of different components at once.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "solvers/dense/hermitian.h"
#include "src/base/array.h"
#include "src/connection/cone_problem.h"
#include "src/connection/cone_request.h"
#include "src/distributed/connect.h"
#include "src/distributed/design_place.h"
#include "src/distributed/linear.h"

namespace alcap::detail::distributed {
namespace {

using Vector = VectorX<double>;

/// Handles need generators of homology, which are found by walking over the whole surface.
void refuse_handles(const Components& components, ConnectionKind kind) {
  for (std::size_t k = 0; k < components.list.size(); ++k) {
    const DistributedComponent& c = components.list[k];
    const std::int64_t genus = (2 - c.boundary_loops - c.euler) / 2;
    if (genus > 0)
      throw OptionError("connection", std::string(name(kind)),
                        "component " + std::to_string(k) + " has genus " + std::to_string(genus) +
                            ": holonomies around handles are not available over several ranks; alcap takes them on one "
                            "machine");
  }
}

ConeSurface surface_of(const Patch& patch, const Components& components, const BoundaryLoops& loops) {
  ConeSurface surface{.vertices = sum(std::int64_t{patch.owned}), .loop_component = loops.component};
  for (const DistributedComponent& c : components.list) surface.euler.push_back(static_cast<double>(c.euler));
  return surface;
}

std::vector<ConePlace> places_of(const Patch& patch, const Components& components, const std::vector<Cone>& cones) {
  struct Place {
    std::size_t cone;
    Index component, boundary;
  };
  std::vector<Place> mine;
  for (std::size_t k = 0; k < cones.size(); ++k) {
    const Index v = own_vertex(patch, cones[k].vertex);
    if (v == none || components.of_vertex[at(v)] == none) continue;
    mine.push_back({k, components.of_vertex[at(v)], patch.mesh.boundary_vertex(v) ? 1 : 0});
  }
  std::vector<ConePlace> places(cones.size());
  for (const Place& p : gather_all(mine)) places[p.cone] = {.component = p.component, .boundary = p.boundary != 0};
  return places;
}

/// Wanted indices of local vertices.
Vector local_indices(const Patch& patch, const std::vector<Cone>& cones) {
  std::vector<Cone> sorted = cones;
  std::ranges::stable_sort(sorted, {}, &Cone::vertex);
  Vector index = Vector::Zero(count_of(patch.vertex));
  for (Index v = 0; v < index.size(); ++v) {
    const auto here = patch.vertex[at(v)];
    auto cone = std::ranges::lower_bound(sorted, here, {}, &Cone::vertex);
    for (; cone != sorted.end() && cone->vertex == here; ++cone) index[v] += cone->index;
  }
  return index;
}

/// The Poisson problem of the rotations across edges.
class ConePotentials {
 public:
  ConePotentials(const Patch& patch, const Components& components, const BoundaryLoops& loops, const Vector& index,
                 int max_iterations)
      : patch_(patch),
        loops_(loops),
        weight_(cone_weights(patch.mesh, patch.geometry)),
        defect_(Vector::Zero(patch.owned)),
        load_(Vector::Zero(patch.owned)),
        poisson_(assemble_laplacian(patch, components, on_boundary()), nullptr, tolerance, max_iterations),
        place_(loops.component.size(), 0) {
    for (Index v = 0; v < patch.owned; ++v) {
      if (components.of_vertex[at(v)] == none) continue;
      defect_[v] = patch.geometry.defect(patch.mesh, v);
      if (loop_of(v) == none) load_[v] = 2 * pi<double> * index[v] - defect_[v];
    }
    std::vector<Index> count(components.list.size(), 0);
    for (std::size_t l = 0; l < place_.size(); ++l) place_[l] = count[at(loops.component[l])]++;
  }

  /// x per local edge, right around inner vertices. Boundary loops are free.
  [[nodiscard]] Vector with_free_loops() {
    Vector x = flow(potentials({}, true));
    free_turns_ = loop_turns(x);
    share_from_first(free_turns_);
    return x;
  }
  /// Turns that the loops then have.
  [[nodiscard]] const std::vector<double>& free_turns() const { return free_turns_; }

  /// The same with an index for every loop, after with_free_loops().
  [[nodiscard]] Vector with_loops(const std::vector<double>& loop_index) {
    return flow(potentials(loop_potentials(loop_index), true));
  }

  /// Turns that each boundary loop has under x.
  [[nodiscard]] std::vector<double> loop_turns(const Vector& x) const {
    std::vector<double> turns = loop_flows(x);
    std::vector<double> defects(turns.size(), 0);
    for (Index v = 0; v < patch_.owned; ++v)
      if (const Index l = loop_of(v); l != none) defects[at(l)] += defect_[v];
    sum_all(defects);
    for (std::size_t l = 0; l < turns.size(); ++l) turns[l] = (turns[l] + defects[l]) / (2 * pi<double>);
    return turns;
  }

  /// The largest relative residual of the solves.
  [[nodiscard]] double residual() const { return residual_; }

 private:
  static constexpr double tolerance = 1e-13;

  [[nodiscard]] Index loop_of(Index v) const { return loops_.of_vertex[at(v)]; }
  [[nodiscard]] std::vector<char> on_boundary() const {
    std::vector<char> held(at(patch_.inner), 0);
    for (Index v = 0; v < patch_.inner; ++v) held[at(v)] = loop_of(v) == none ? 0 : 1;
    return held;
  }

  /// Potentials at owned vertices: `of_loop` on the boundary (empty: zero), and inside what the load asks for, or
  /// harmonic.
  [[nodiscard]] Vector potentials(const std::vector<double>& of_loop, bool loaded) {
    Vector b = loaded ? load_ : Vector(Vector::Zero(patch_.owned));
    const auto value = [&](Index v) {
      const Index l = v < patch_.inner ? loop_of(v) : none;
      return of_loop.empty() || l == none ? 0.0 : of_loop[at(l)];
    };
    if (!of_loop.empty()) {
      for (Index v = 0; v < patch_.owned; ++v)
        if (loop_of(v) != none) b[v] = value(v);
      for (Index e = 0; e < patch_.mesh.edges(); ++e) {
        const Index h = patch_.mesh.halfedge(e), i = patch_.mesh.tail(h), j = patch_.mesh.tip(h);
        if (i < patch_.owned && loop_of(i) == none) b[i] += weight_[e] * value(j);
        if (j < patch_.owned && loop_of(j) == none) b[j] += weight_[e] * value(i);
      }
    }
    ComplexVectorX<double> mu, rest;
    const ComplexVectorX<double> load = b.cast<C>();
    poisson_.solve(load, mu);
    poisson_.multiply(mu, rest);
    const double size = norm(load);
    if (size > 0) residual_ = std::max(residual_, norm(rest - load) / size);
    return mu.real();
  }

  [[nodiscard]] Vector flow(const Vector& potentials) const {
    const Vector mu = at_local_vertices(patch_, potentials);
    return flow_between(patch_.mesh, weight_, [&](Index v) { return mu[v]; });
  }

  /// What x takes from each loop, in radians.
  [[nodiscard]] std::vector<double> loop_flows(const Vector& x) const {
    std::vector<double> flows(place_.size(), 0);
    add_flow_of_loops(
        patch_.mesh, x, [&](Index v) { return v < patch_.owned ? loop_of(v) : none; }, flows);
    sum_all(flows);
    return flows;
  }

  /// Potentials of the loops for which they have these indices. The first of each component is zero.
  [[nodiscard]] std::vector<double> loop_potentials(const std::vector<double>& loop_index) {
    const std::size_t count = place_.size();
    std::vector<double> missing(count), found(count, 0);
    for (std::size_t l = 0; l < count; ++l) missing[l] = 2 * pi<double> * (loop_index[l] - free_turns_[l]);
    const Index most = count == 0 ? 0 : *std::ranges::max_element(place_);
    std::vector<std::vector<double>> response;  // at each loop, to the loop of its component at this place
    for (Index place = 1; place <= most; ++place) {
      std::vector<double> one(count, 0);
      for (std::size_t l = 0; l < count; ++l) one[l] = place_[l] == place ? 1 : 0;
      response.push_back(loop_flows(flow(potentials(one, false))));
    }
    std::vector<std::vector<std::size_t>> loops;  // of each component
    for (std::size_t l = 0; l < count; ++l) {
      loops.resize(std::max(loops.size(), at(loops_.component[l]) + 1));
      loops[at(loops_.component[l])].push_back(l);
    }
    for (const std::vector<std::size_t>& of : loops) {
      const Eigen::Index size = count_of(of) - 1;
      if (size < 1) continue;
      Eigen::MatrixXd A(size, size);
      Eigen::VectorXd b(size);
      for (Eigen::Index k = 0; k < size; ++k) {
        b[k] = missing[of[at(k + 1)]];
        for (Eigen::Index l = 0; l < size; ++l) A(k, l) = response[at(l)][of[at(k + 1)]];
      }
      const Eigen::VectorXd solved = symmetric_solve((A + A.transpose()) / 2, b);
      for (Eigen::Index k = 0; k < size; ++k) found[of[at(k + 1)]] = solved[k];
    }
    share_from_first(found);
    return found;
  }

  const Patch& patch_;
  const BoundaryLoops& loops_;
  Vector weight_, defect_, load_;
  LinearSystem poisson_;
  std::vector<Index> place_;  // of each loop among those of its component
  std::vector<double> free_turns_;
  double residual_ = 0;
};

/// The same on all ranks: what a solver's rounding leaves of a residual that is a defect.
void tell_residual(double residual, ConnectionReport& report) {
  constexpr double enough = 1e-9;
  if (residual <= enough) return;
  char text[32];
  std::snprintf(text, sizeof text, "%.1e", residual);
  report.converged = false;
  report.message = "the Poisson problem of the cones stopped at a relative residual of " + std::string(text) +
                   "; it needs more iterations, or rounding stops it: slivers are the usual reason";
}

}  // namespace

Connection connect_cones(const Patch& patch, const Components& components, const PatchWeights& weights,
                         const DistributedOptions& options, LiftedResiduals& r) {
  const ConnectionKind kind = options.connection.kind;
  refuse_handles(components, kind);
  const BoundaryLoops loops = find_loops(patch, components);
  const ConeSurface surface = surface_of(patch, components, loops);
  const std::vector<ConePlace> places = places_of(patch, components, options.cones);
  const ConeRequest request{
      .cones = options.cones, .n = kind == ConnectionKind::metric ? 0 : options.n, .loop_index = options.loop_index};
  check_cones(request, surface, places);
  const Vector index = local_indices(patch, options.cones);
  ConePotentials problem(patch, components, loops, index, options.max_iterations);
  Vector x = problem.with_free_loops();
  std::vector<double> loop_index = options.loop_index;
  if (!request.any() && loop_index.empty()) loop_index = round_loops(request, surface, places, problem.free_turns());
  if (!loop_index.empty()) x = problem.with_loops(loop_index);
  Connection c;
  if (!patch.empty())
    c = build_connection(patch.mesh, patch.geometry, 2 * pi<double> * index, adjustment_across(patch.mesh, x),
                         PolarCenter::incenter, r);
  optimise_held_together(patch, components, weights, options.global, c, r);
  tell_residual(problem.residual(), c.report);
  c.flat = true;
  c.cones = options.cones;
  for (const double turns : problem.loop_turns(x))
    c.loop_index.push_back(request.any() ? turns : nearest_multiple(turns, request.n));
  return c;
}

}  // namespace alcap::detail::distributed
