// SPDX-License-Identifier: MIT
//
// The pieces of connections on every rank's patch against those of one machine, number by number.
#include <algorithm>

#include "src/distributed/connect.h"
#include "tests/distributed/ranks_fixture.h"

using namespace alcap;
using namespace alcap::test;

namespace {

/// The largest differences at core faces; of `rho_t` and `rho_e` less the turn that all frames of a component have in
/// common where rotations are held, which nothing decides.
struct Differences {
  double K = 0, tau = 0, rho = 0, rho_t = 0, rho_e = 0, alpha = 0;
};

Differences compare(const MeshData& data, const DistributedOptions& options) {
  const OneMachine one(data, options);
  const Connection& o = one.connection;
  const detail::petsc::Session session;
  auto part = detail::distributed::make_patch(slice_of(data.V, data.F), PartitionMethod::scotch);
  const auto& patch = part.patch;
  detail::distributed::measure(part.patch);
  const auto components = detail::distributed::find_components(patch);
  const Connection c = detail::distributed::connect(patch, components, options);
  CHECK(c.kind == o.kind);
  CHECK(c.flat == o.flat);
  CHECK(c.report.converged);
  CHECK(c.report.D_T == doctest::Approx(o.report.D_T).epsilon(1e-9));
  CHECK(c.report.D_E == doctest::Approx(o.report.D_E).epsilon(1e-9));
  Differences d;
  const auto most = [](double& of, double value) { of = std::max(of, std::abs(value)); };
  const auto each_core = [&](auto&& body) {
    for (Index t = 0; t < patch.mesh.faces(); ++t)
      if (patch.core[static_cast<std::size_t>(t)] != 0) body(t, patch.face[static_cast<std::size_t>(t)]);
  };
  std::vector<double> turns(components.list.size(), 0);
  if (o.flat)
    each_core([&](Index t, Index T) {
      const Index k = one.topology.face_component[static_cast<std::size_t>(T)];
      if (T == one.topology.components[static_cast<std::size_t>(k)].first_face)
        turns[static_cast<std::size_t>(k)] = wrap(c.rho_t[3 * t] - o.rho_t[3 * T]);
    });
  if (o.flat) {  // the rank that owns the smallest vertex of the first face says it; all that have the face say the
                 // same
    std::vector<double> least = turns;
    for (double& x : least) x = -x;
    detail::distributed::largest_all(turns);
    detail::distributed::largest_all(least);
    for (std::size_t k = 0; k < turns.size(); ++k)
      if (turns[k] == 0) turns[k] = -least[k];
  }
  each_core([&](Index t, Index T) {
    most(d.K, c.K[t] - o.K[T]);
    const double turn = turns[static_cast<std::size_t>(one.topology.face_component[static_cast<std::size_t>(T)])];
    for (Index k = 0; k < 3; ++k) {
      const Index h = 3 * t + k, H = 3 * T + k;
      most(d.tau, c.tau[h] - o.tau[H]);
      most(d.rho, wrap(c.rho_along(patch.mesh, h) - o.rho_along(one.mesh, H)));
      most(d.rho_t, wrap(c.rho_t[h] - o.rho_t[H] - turn));
      most(d.rho_e, wrap(c.rho_start(patch.mesh, h) - o.rho_start(one.mesh, H) - turn));
      if (o.flat) most(d.alpha, c.alpha[h] - o.alpha[H]);
    }
  });
  REQUIRE(c.loop_index.size() == o.loop_index.size());
  for (std::size_t l = 0; l < c.loop_index.size(); ++l) CHECK(std::abs(c.loop_index[l] - o.loop_index[l]) <= 1e-9);
  return d;
}

}  // namespace

TEST_CASE("curvature, rotations and directions of core faces are those of one machine") {
  for (const MeshData& data :
       {noisy_scan(3, 0.3, 7), side_by_side({bumpy_sphere(3, 0.4, 3), disk(8)}), cad_like(20, 5)})
    for (const ConnectionKind kind : {ConnectionKind::polar, ConnectionKind::local, ConnectionKind::global}) {
      CAPTURE(std::string(name(kind)));
      const double tolerance = kind == ConnectionKind::global ? 1e-10 : 1e-15;
      const Differences d = compare(data, {.connection = {kind}});
      const double scale = std::max(1.0, OneMachine(data, kind, 1).connection.K.cwiseAbs().maxCoeff());
      CHECK(d.K <= tolerance * scale);
      CHECK(d.tau <= 10 * tolerance * scale);
      CHECK(d.rho <= 10 * tolerance * scale);
      CHECK(d.rho_t <= 100 * tolerance * scale);
      CHECK(d.rho_e <= 100 * tolerance * scale);
    }
}

TEST_CASE("trivial and metric connections are those of one machine") {
  const ConnectionKind trivial = ConnectionKind::trivial, metric = ConnectionKind::metric;
  const MeshData sphere = jittered_sphere(3, 0.2, 3), bumpy = bumpy_sphere(3, 0.4, 3);
  const MeshData holes = punctured(bumpy, {12, 40, 200, 333, 500});
  MeshData data;
  DistributedOptions options{.n = 4, .connection = {trivial}};
  SUBCASE("closed, cones of quarters") {
    data = sphere;
    for (const Index v : {1, 70, 150, 220, 300, 301, 450, 600}) options.cones.push_back({v, 0.25});
  }
  SUBCASE("closed, one cone twice and one negative") {
    data = bumpy;
    options.n = 1;
    options.cones = {{5, 1}, {5, 1}, {77, 1}, {600, -1}};
  }
  SUBCASE("closed, cones of any size") {
    data = bumpy;
    options.connection.kind = metric;
    options.cones = {{5, 0.3}, {77, 1.123}, {601, 0.577}};
  }
  SUBCASE("a disk, its loop takes what the cones leave") {
    data = disk(10);
    options.cones = {{20, 0.25}, {100, -0.5}};
  }
  SUBCASE("a cylinder without cones") { data = cylinder(20, 20); }
  SUBCASE("five holes, free") {
    data = holes;
    options.cones = {{1, 0.25}, {600, -0.25}};
  }
  SUBCASE("five holes with an index each") {
    data = holes;
    options.n = 2;
    options.cones = {{1, 0.5}};
    options.loop_index = {1, -0.5, 0, 0.5, -4.5};
  }
  SUBCASE("five holes, metric, free and given") {
    data = holes;
    options.connection.kind = metric;
    options.cones = {{1, 0.7}};
    (void)compare(data, options);
    options.loop_index = {0.1, 0.2, 0.3, 0.4, -4.7};
  }
  SUBCASE("many components, open and closed") {
    data = side_by_side({sphere, disk(5), holes, tetrahedron(), single_triangle()});
    const auto first = static_cast<Index>(data.V.rows() - 7);  // of the tetrahedron
    options.cones = {{7, 1.5}, {90, 0.5}, {first + 2, 1}, {first, 2}, {first + 1, -1}};
  }
  const Differences d = compare(data, options);
  CHECK(d.alpha <= 1e-9);
  CHECK(d.rho <= 1e-9);
  CHECK(d.K <= 1e-8);
  CHECK(d.tau <= 1e-8);
  CHECK(d.rho_t <= 1e-8);
  CHECK(d.rho_e <= 1e-8);
}
