// SPDX-License-Identifier: MIT
//
// baselines.cpp: what others compute, beside ours, on spheres (perf_eigen has the matrices of Knoeppel et al. 2013: the
// polar map with a fixed number of inverse iterations).
//   field/backend:trivial-faces   a cross field per face for eight given cones (Crane, Desbrun, Schroeder 2010): one
//                                 Poisson solve for the least adjustment, one direction carried over all faces.
//                                 "closure": how far it is from itself, in degrees, across any edge away from cones
//   field/backend:trivial         our smoothest field of the trivial connection with the same cones
//   energy/backend:1-forms        E_A by 1-forms on edges (Fisher, Schroeder, Desbrun, Hoppe 2007)
//   energy/backend:operators      the same by our edge-based operators, which are made once
#include <algorithm>
#include <cmath>
#include <vector>

#include "alcap/operators.h"
#include "alcap/smoothest.h"
#include "apps/alcap/tables/tables_shapes.h"
#include "perf/common.h"

namespace {

using namespace alcap;
using perf::Prepared;
using Scalar = Complex<double>;

constexpr int n = 4, cone_count = 8;

/// Eight cones of a cross field on a sphere, anywhere.
std::vector<Cone> cones_of(const Mesh& mesh) {
  std::vector<Cone> cones;
  for (int k = 0; k < cone_count; ++k)
    cones.push_back({.vertex = static_cast<Index>((2 * k + 1) * std::int64_t{mesh.vertices()} / (2 * cone_count)),
                     .index = 2.0 / cone_count});
  return cones;
}

/// Angles by which directions turn across each edge, beyond the unfolding of its faces: the least ones for which they
/// close around every vertex but the cones. With the graph Laplacian, as the squares are not weighted.
VectorX<double> adjustments(const Prepared& p, const std::vector<Cone>& cones) {
  const Mesh& mesh = p.mesh;
  const Index V = mesh.vertices();
  std::vector<Eigen::Triplet<double, Index>> entries;
  for (Index e = 0; e < mesh.edges(); ++e) {
    const Index i = mesh.tail(mesh.halfedge(e)), j = mesh.tip(mesh.halfedge(e));
    for (const Index v : {i, j}) entries.emplace_back(v, v, 1.0);
    entries.emplace_back(i, j, -1.0);
    entries.emplace_back(j, i, -1.0);
  }
  entries.emplace_back(0, 0, 1.0);  // the constant
  SparseMatrix<double> L(V, V);
  L.setFromTriplets(entries.begin(), entries.end());
  MatrixX<double> b(V, 1), x(V, 1);
  for (Index v = 0; v < V; ++v) b(v, 0) = p.geometry.defect(mesh, v);
  for (const Cone& cone : cones) b(cone.vertex, 0) -= 2 * pi<double> * cone.index;
  const auto solver = make_linear_solver<double>({.right_hand_sides = 1});
  solver->analyse(L);
  solver->factorise(L);
  (void)solver->solve(b, x);
  VectorX<double> turns(mesh.edges());
  for (Index e = 0; e < mesh.edges(); ++e)
    turns[e] = x(mesh.tail(mesh.halfedge(e)), 0) - x(mesh.tip(mesh.halfedge(e)), 0);
  return turns;
}

/// The angle from the frame of the face of h to that of its twin's, adjusted.
double turn_across(const Prepared& p, const VectorX<double>& turns, Index h) {
  const Index g = p.mesh.twin(h);
  const double adjusted = (p.mesh.canonical(h) ? 1 : -1) * turns[p.mesh.edge(h)];
  return p.geometry.direction(g) + pi<double> - p.geometry.direction(h) + adjusted;
}

VectorX<double> carried(const Prepared& p, const VectorX<double>& turns) {
  VectorX<double> angle = VectorX<double>::Constant(p.mesh.faces(), std::nan(""));
  std::vector<Index> open{0};
  angle[0] = 0;
  for (std::size_t k = 0; k < open.size(); ++k)
    for (Index h = 3 * open[k]; h < 3 * open[k] + 3; ++h) {
      const Index g = p.mesh.twin(h);
      if (g == none || !std::isnan(angle[Mesh::face(g)])) continue;
      angle[Mesh::face(g)] = angle[open[k]] + turn_across(p, turns, h);
      open.push_back(Mesh::face(g));
    }
  return angle;
}

void per_face(benchmark::State& state, const Prepared& p, int threads) {
  const std::vector<Cone> cones = cones_of(p.mesh);
  VectorX<double> turns, angle;
  perf::timed(state, threads, [&] {
    turns = adjustments(p, cones);
    angle = carried(p, turns);
  });
  double worst = 0;
  for (Index h = 0; h < 3 * p.mesh.faces(); ++h) {
    const Index g = p.mesh.twin(h);
    if (g == none) continue;
    const double turned = n * (angle[Mesh::face(h)] + turn_across(p, turns, h) - angle[Mesh::face(g)]);
    worst = std::max(worst, std::abs(wrap(turned)));
  }
  state.counters["closure"] = worst / n * 180 / pi<double>;
}

void per_vertex(benchmark::State& state, const Prepared& p, int threads) {
  const std::vector<Cone> cones = cones_of(p.mesh);
  SmoothestResult result;
  perf::timed(state, threads, [&] {
    const Connection connection = trivial(p.mesh, p.geometry, cones, {.n = n});
    result = smoothest_field(p.mesh, p.geometry, connection, nullptr, {.n = n});
  });
  state.counters["its"] = result.components[0].iterations;
}

/// The integrals of a vector field along the edges.
MatrixX<double> integrals(const Prepared& p, const ComplexVectorX<double>& u) {
  MatrixX<double> omega(p.mesh.edges(), 1);
  for (Index e = 0; e < p.mesh.edges(); ++e)
    omega(e, 0) = flux_and_circulation(p.mesh, p.geometry, p.connection(), u, p.mesh.halfedge(e)).imag();
  return omega;
}

void energy(benchmark::State& state, const Prepared& p, int threads, bool forms) {
  const Field field = smoothest_field(p.mesh, p.geometry, p.connection(), nullptr, {.n = 1}).field;
  const MatrixX<double> omega = integrals(p, field.u);
  const FirstOrderOperators operators = first_order_operators(p.mesh, p.geometry, p.connection(), {.n = 1});
  double value = 0;
  perf::timed(state, threads, [&] {
    value = forms ? app::div_curl_energy(p.mesh, p.geometry, omega)[0]
                  : operator_energies(p.mesh, p.geometry, operators, field.u).antiholomorphic;
  });
  state.counters["energy"] = value;
}

void declare(const perf::Plan& plan) {
  perf::add(plan, "field", "n:4/backend:trivial-faces", per_face);
  perf::add(plan, "field", "n:4/backend:trivial", per_vertex);
  for (const bool forms : {true, false})
    perf::add(plan, "energy", std::string("n:1/backend:") + (forms ? "1-forms" : "operators"),
              [forms](benchmark::State& state, const Prepared& p, int threads) { energy(state, p, threads, forms); });
}

}  // namespace

int main(int argc, char** argv) { return perf::run(argc, argv, declare); }
