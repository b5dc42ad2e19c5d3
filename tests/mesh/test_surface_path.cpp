// SPDX-License-Identifier: MIT
//
// Points of a surface in space; shortest paths of edges against Bellman and Ford.
#include "alcap/surface_path.h"

#include <doctest/doctest.h>

#include <limits>
#include <set>

#include "alcap/shortest_path.h"
#include "alcap/singularities.h"
#include "tests/support/mesh_families.h"
#include "tests/support/surfaces.h"

using namespace alcap;
using namespace alcap::test;

namespace {

/// Distances along edges from a vertex, by relaxing every edge until nothing changes.
std::vector<double> bellman_ford(const Surface& surface, Index from) {
  const Mesh& mesh = surface.mesh();
  std::vector<double> distance(static_cast<std::size_t>(mesh.vertices()), std::numeric_limits<double>::infinity());
  distance[static_cast<std::size_t>(from)] = 0;
  for (bool changed = true; changed;) {
    changed = false;
    for (Index e = 0; e < mesh.edges(); ++e) {
      double &a = distance[static_cast<std::size_t>(mesh.tail(mesh.halfedge(e)))],
             &b = distance[static_cast<std::size_t>(mesh.tip(mesh.halfedge(e)))];
      const double length = surface.geometry().length(e);
      changed = changed || a + length < b || b + length < a;
      b = std::min(b, a + length);
      a = std::min(a, b + length);
    }
  }
  return distance;
}

/// The neighbours that the rule for ties chooses: of those on a shortest way to a vertex the nearest, then the
/// smallest.
std::vector<Index> rule(const Surface& surface, const std::vector<double>& distance) {
  const Mesh& mesh = surface.mesh();
  std::vector<std::set<std::pair<double, Index>>> candidates(distance.size());
  for (Index h = 0; h < mesh.halfedges(); ++h) {
    for (const auto& [p, q] : {std::pair(mesh.tail(h), mesh.tip(h)), std::pair(mesh.tip(h), mesh.tail(h))}) {
      const double before = distance[static_cast<std::size_t>(p)];
      if (before + surface.geometry().length(mesh.edge(h)) == distance[static_cast<std::size_t>(q)])
        candidates[static_cast<std::size_t>(q)].insert({before, p});
    }
  }
  std::vector<Index> chosen;
  for (const auto& c : candidates) chosen.push_back(c.empty() ? none : c.begin()->second);
  return chosen;
}

}  // namespace

TEST_CASE("shortest_path: as short as any, to the last bit, and among equals the one of the rule") {
  for (const Family& family : mesh_families(2)) {
    CAPTURE(family.name);
    const Surface surface(family.surface.V, family.surface.F);
    const Index count = surface.mesh().vertices();
    for (const Index from : {Index{0}, count / 3}) {
      const std::vector<double> distance = bellman_ford(surface, from);
      const std::vector<Index> chosen = rule(surface, distance);
      for (Index to = from; to < count; ++to) {
        const std::vector<Index> path = shortest_path(surface, from, to);
        if (distance[static_cast<std::size_t>(to)] == std::numeric_limits<double>::infinity()) {
          CHECK(path.empty());
          continue;
        }
        REQUIRE(!path.empty());
        CHECK(path.front() == from);
        CHECK(path.back() == to);
        double length = 0;
        Index bad = 0;
        for (std::size_t k = 0; k + 1 < path.size(); ++k) {
          const Index e = surface.mesh().edge(path[k], path[k + 1]);
          REQUIRE(e != none);
          length += surface.geometry().length(e);
          bad += chosen[static_cast<std::size_t>(path[k + 1])] != path[k];
        }
        CHECK(bad == 0);
        CHECK(length == distance[static_cast<std::size_t>(to)]);
        CHECK(shortest_path(surface, to, from) == std::vector<Index>(path.rbegin(), path.rend()));
      }
    }
  }
}

TEST_CASE("shortest_path: ends that are equal, out of reach, or no vertices") {
  MeshData two = together(tetrahedron(), grid(2, 2));
  two.V.conservativeResize(two.V.rows() + 1, 3);  // a vertex that no face uses
  two.V.bottomRows(1).setZero();
  const Surface surface(two.V, two.F);
  const auto last = static_cast<Index>(two.V.rows()) - 1;
  CHECK(shortest_path(surface, 2, 2) == std::vector<Index>{2});
  CHECK(shortest_path(surface, last, last) == std::vector<Index>{last});
  CHECK(shortest_path(surface, 0, 5).empty());
  CHECK(shortest_path(surface, 5, 0).empty());
  CHECK(shortest_path(surface, 0, last).empty());
  for (const Index bad : {Index{-1}, last + 1}) {
    CHECK_THROWS_AS(static_cast<void>(shortest_path(surface, bad, 0)), OptionError);
    CHECK_THROWS_AS(static_cast<void>(shortest_path(surface, 0, bad)), OptionError);
  }
}

TEST_CASE("position: the corners, the barycenter, and the points of a halfedge from both sides") {
  const Surface surface(jittered_sphere(2, 0.2, 1).V, jittered_sphere(2, 0.2, 1).F);
  const Mesh& mesh = surface.mesh();
  const auto& V = surface.V();
  for (Index h = 0; h < mesh.halfedges(); ++h) {
    CHECK(position(surface, detail::on_halfedge(h, 0)) == V.row(mesh.tail(h)));
    CHECK(position(surface, detail::on_halfedge(h, 1)) == V.row(mesh.tip(h)));
    const Eigen::RowVector3d x = position(surface, detail::on_halfedge(h, 0.25));
    CHECK((x - (0.75 * V.row(mesh.tail(h)) + 0.25 * V.row(mesh.tip(h)))).norm() < 1e-15);
    CHECK((x - position(surface, detail::on_halfedge(mesh.twin(h), 0.75))).norm() < 1e-15);
  }
  const Eigen::RowVector3d mean = (V.row(mesh.F()(7, 0)) + V.row(mesh.F()(7, 1)) + V.row(mesh.F()(7, 2))) / 3;
  CHECK((position(surface, {7, {1.0 / 3, 1.0 / 3, 1.0 / 3}}) - mean).norm() < 1e-15);
  CHECK((position(surface, Singularity{.face = 7, .barycentric = {1.0 / 3, 1.0 / 3, 1.0 / 3}}) - mean).norm() < 1e-15);
}

TEST_CASE("position: no such face, and surfaces that lie in no space") {
  const MeshData data = tetrahedron();
  const Surface surface(data.V, data.F);
  for (const Index bad : {-1, 4})
    CHECK_THROWS_AS(static_cast<void>(position(surface, SurfacePoint{bad, {1, 0, 0}})), OptionError);
  CHECK_THROWS_AS(static_cast<void>(position(flat_torus_surface(4, 4), SurfacePoint{0, {1, 0, 0}})), OptionError);
}
