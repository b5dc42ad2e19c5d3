// SPDX-License-Identifier: MIT
#include "alcap/sharp_edges.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

#include "tests/support/mesh_families.h"
#include "tests/support/surfaces.h"

using namespace alcap;
using namespace alcap::test;

namespace {

Surface surface_of(const MeshData& data) { return {data.V, data.F}; }

/// An L of two unit squares and one between them, drawn up to height 1: 18 edges, one of them concave, 12 corners.
MeshData l_prism() {
  MeshData out{Positions<double>(12, 3), Faces(20, 3)};
  const double outline[6][2] = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  for (Index k = 0; k < 6; ++k)
    for (Index z = 0; z < 2; ++z) out.V.row(6 * z + k) << outline[k][0], outline[k][1], z;
  Index t = 0;
  for (Index k = 0; k < 6; ++k) {
    const Index l = (k + 1) % 6;
    out.F.row(t++) << k, l, l + 6;
    out.F.row(t++) << k, l + 6, k + 6;
  }
  for (const auto& [a, b, c] : {std::array<Index, 3>{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}) {
    out.F.row(t++) << a, c, b;
    out.F.row(t++) << a + 6, b + 6, c + 6;
  }
  return out;
}

Index count(const FeatureGraph& graph, FeatureVertex kind) {
  return static_cast<Index>(std::count(graph.vertices.begin(), graph.vertices.end(), kind));
}

/// What every graph must be: every feature edge in exactly one line, lines that are chains, broken exactly at ends and
/// corners, and kinds that fit the number of edges.
void check_graph(const Surface& surface, const FeatureGraph& graph) {
  const Mesh& mesh = surface.mesh();
  REQUIRE(graph.vertices.size() == static_cast<std::size_t>(mesh.vertices()));
  REQUIRE(graph.angles.size() == graph.edges.size());
  CHECK(std::is_sorted(graph.edges.begin(), graph.edges.end()));
  std::vector<Index> met;
  const auto passes = [&](Index v) { return graph.vertices[static_cast<std::size_t>(v)] == FeatureVertex::crease; };
  Index bad = 0;
  for (const FeatureLine& line : graph.lines) {
    REQUIRE(line.vertices.size() == line.edges.size() + 1);
    REQUIRE(!line.edges.empty());
    for (std::size_t k = 0; k < line.edges.size(); ++k) {
      bad += mesh.edge(line.vertices[k], line.vertices[k + 1]) != line.edges[k];
      bad += k > 0 && !passes(line.vertices[k]);
    }
    bad += line.closed != (line.vertices.front() == line.vertices.back());
    bad += passes(line.vertices.front()) != passes(line.vertices.back());
    bad += passes(line.vertices.front()) && !line.closed;
    met.insert(met.end(), line.edges.begin(), line.edges.end());
  }
  std::sort(met.begin(), met.end());
  CHECK(met == graph.edges);
  std::vector<Index> degree(graph.vertices.size(), 0);
  for (const Index e : graph.edges)
    for (const Index v : {mesh.tail(mesh.halfedge(e)), mesh.tip(mesh.halfedge(e))})
      ++degree[static_cast<std::size_t>(v)];
  for (std::size_t v = 0; v < degree.size(); ++v) {
    const FeatureVertex kind = graph.vertices[v];
    bad += (kind == FeatureVertex::smooth) != (degree[v] == 0);
    bad += (kind == FeatureVertex::end) != (degree[v] == 1);
    bad += kind == FeatureVertex::crease && degree[v] != 2;
    bad += kind == FeatureVertex::corner && degree[v] < 2;
  }
  CHECK(bad == 0);
}

/// By the angle between normals and by whether the other face lies below or above this one.
double dihedral_by_hand(const Surface& surface, Index e) {
  const Mesh& mesh = surface.mesh();
  const auto& V = surface.V();
  const Index h = mesh.halfedge(e), g = mesh.twin(h);
  if (g == none) return 0;
  const auto normal = [&](Index a) -> Eigen::RowVector3d {
    const Eigen::RowVector3d p = V.row(mesh.tail(a)), q = V.row(mesh.tip(a)), r = V.row(mesh.tip(Mesh::next(a)));
    return (q - p).cross(r - p).normalized();
  };
  const Eigen::RowVector3d m = normal(h), n = normal(g);
  const double angle = 2 * std::atan2((m - n).norm(), (m + n).norm());
  return m.dot(V.row(mesh.tip(Mesh::next(g))) - V.row(mesh.tail(h))) > 0 ? -angle : angle;
}

}  // namespace

TEST_CASE("a cube: its 12 edges, convex by a right angle, and 8 corners") {
  const Surface surface = surface_of(cube());
  for (const double angle : {SharpEdgeOptions{}.angle, pi<double> / 2}) {
    const FeatureGraph graph = sharp_edges(surface, {.angle = angle});
    check_graph(surface, graph);
    CHECK(graph.edges.size() == 12);
    for (const double a : graph.angles) CHECK(a == doctest::Approx(pi<double> / 2));
    CHECK(count(graph, FeatureVertex::corner) == 8);
    CHECK(graph.lines.size() == 12);
  }
  CHECK(sharp_edges(surface, {.angle = 1.6}).edges.empty());
}

TEST_CASE("an L-shaped prism: 18 edges of which one is concave, 12 corners") {
  const Surface surface = surface_of(l_prism());
  const FeatureGraph graph = sharp_edges(surface);
  check_graph(surface, graph);
  REQUIRE(graph.edges.size() == 18);
  CHECK(count(graph, FeatureVertex::corner) == 12);
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    const bool concave = graph.edges[k] == surface.mesh().edge(3, 9);
    CHECK(graph.angles[k] == doctest::Approx(concave ? -pi<double> / 2 : pi<double> / 2));
  }
}

TEST_CASE("spheres have no sharp edges, rods their rims: closed lines without a corner") {
  for (int level = 1; level <= 4; ++level) {
    const FeatureGraph none_at_all = sharp_edges(surface_of(icosphere(level)));
    CHECK(none_at_all.edges.empty());
    CHECK(none_at_all.lines.empty());
    CHECK(count(none_at_all, FeatureVertex::smooth) == 10 * (Index{1} << (2 * level)) + 2);
  }
  for (const int segments : {10, 24, 60}) {
    const Surface surface = surface_of(cad_like(segments, 1));
    const FeatureGraph graph = sharp_edges(surface);
    check_graph(surface, graph);
    CHECK(count(graph, FeatureVertex::corner) == 0);
    CHECK(count(graph, FeatureVertex::crease) == static_cast<Index>(graph.edges.size()));
    REQUIRE(graph.lines.size() == 2);
    for (const FeatureLine& line : graph.lines) {
      CHECK(line.closed);
      CHECK(line.edges.size() == static_cast<std::size_t>(segments));
    }
  }
  // Eight sides meet at 45 degrees: as sharp as a chamfer.
  const FeatureGraph octagonal = sharp_edges(surface_of(cad_like(8, 1)));
  CHECK(octagonal.edges.size() == 24);
  CHECK(count(octagonal, FeatureVertex::corner) == 16);
}

TEST_CASE("boundaries: features if wanted, with a corner where they turn and none on a circle") {
  const Surface sheet = surface_of(grid(5, 4));
  const FeatureGraph graph = sharp_edges(sheet);
  check_graph(sheet, graph);
  CHECK(graph.edges.size() == 18);
  CHECK(count(graph, FeatureVertex::corner) == 4);
  CHECK(graph.lines.size() == 4);
  for (const double a : graph.angles) CHECK(a == 0);
  CHECK(sharp_edges(sheet, {.boundary = false}).edges.empty());
  CHECK(sharp_edges(sheet, {.corner_angle = 1.7}).lines.size() == 1);

  const Surface tube = surface_of(cylinder(24, 6));
  const FeatureGraph rims = sharp_edges(tube);
  check_graph(tube, rims);
  CHECK(rims.lines.size() == 2);
  for (const FeatureLine& line : rims.lines) {
    CHECK(line.closed);
    // Along the boundary, the surface on the left.
    for (std::size_t k = 0; k < line.edges.size(); ++k)
      CHECK(tube.mesh().halfedge(line.vertices[k], line.vertices[k + 1]) != none);
  }
}

TEST_CASE("every mesh: dihedral angles as by hand, and a graph that holds together at every threshold") {
  for (const Family& family : mesh_families(2)) {
    CAPTURE(family.name);
    const Surface surface = surface_of(family.surface);
    double worst = 0;
    for (Index e = 0; e < surface.mesh().edges(); ++e)
      worst = std::max(worst, std::abs(dihedral_angle(surface, e) - dihedral_by_hand(surface, e)));
    CHECK(worst < 1e-12);
    for (const double angle : {0.1, 0.4, 0.7, 1.5}) {
      const FeatureGraph graph = sharp_edges(surface, {.angle = angle});
      check_graph(surface, graph);
      std::vector<Index> expected;
      for (Index e = 0; e < surface.mesh().edges(); ++e)
        if (surface.mesh().boundary_halfedge(surface.mesh().halfedge(e)) ||
            std::abs(dihedral_by_hand(surface, e)) >= angle)
          expected.push_back(e);
      CHECK(graph.edges == expected);
    }
  }
}

TEST_CASE("neither scale, from 1e-9 to 1e9, nor position matters") {
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (const MeshData& data : {cube(), l_prism(), cad_like(24, 3), noisy_scan(3, 0.2, 3), grid(4, 4)}) {
    // Right angles stand exactly at this threshold.
    for (const SharpEdgeOptions& options : {SharpEdgeOptions{}, SharpEdgeOptions{.angle = pi<double> / 2}}) {
      const FeatureGraph graph = sharp_edges(surface_of(data), options);
      for (const double scale : {1e-9, 1e-3, 1e9}) {
        const Positions<double> V = scale * data.V * rotation.transpose();
        const FeatureGraph moved = sharp_edges(Surface(V, data.F), options);
        CHECK(moved.edges == graph.edges);
        CHECK(moved.vertices == graph.vertices);
        REQUIRE(moved.lines.size() == graph.lines.size());
        for (std::size_t k = 0; k < graph.lines.size(); ++k) CHECK(moved.lines[k].vertices == graph.lines[k].vertices);
        for (std::size_t k = 0; k < graph.edges.size(); ++k) CHECK(std::abs(moved.angles[k] - graph.angles[k]) < 1e-12);
      }
    }
  }
}

TEST_CASE("turning all faces over turns the signs and nothing else") {
  for (const MeshData& data : {l_prism(), cad_like(12, 3), noisy_scan(3, 0.2, 3), cylinder(24, 6)}) {
    MeshData over = data;
    over.F.col(1).swap(over.F.col(2));
    const Surface before = surface_of(data), after = surface_of(over);
    const auto by_ends = [](const Surface& surface, const FeatureGraph& graph) {
      std::map<std::pair<Index, Index>, double> angles;
      for (std::size_t k = 0; k < graph.edges.size(); ++k) {
        const Index h = surface.mesh().halfedge(graph.edges[k]);
        angles[std::minmax({surface.mesh().tail(h), surface.mesh().tip(h)})] = graph.angles[k];
      }
      return angles;
    };
    const FeatureGraph graph = sharp_edges(before), turned = sharp_edges(after);
    CHECK(graph.vertices == turned.vertices);
    CHECK(graph.lines.size() == turned.lines.size());
    const auto a = by_ends(before, graph), b = by_ends(after, turned);
    REQUIRE(a.size() == b.size());
    REQUIRE(!a.empty());
    for (const auto& [ends, angle] : a) {
      REQUIRE(b.contains(ends));
      CHECK(std::abs(b.at(ends) + angle) < 1e-12);
    }
  }
}

TEST_CASE("feature_graph: a crease that ends, a loop through one corner, edges given twice") {
  const Surface surface = surface_of(grid(4, 4));  // vertex (i, j) is 5 j + i
  const Mesh& mesh = surface.mesh();
  const auto edges = [&](const std::vector<Index>& path) {
    std::vector<Index> out;
    for (std::size_t k = 0; k + 1 < path.size(); ++k) out.push_back(mesh.edge(path[k], path[k + 1]));
    return out;
  };
  std::vector<Index> straight = edges({11, 12, 13});
  straight.push_back(straight.front());
  const FeatureGraph line = feature_graph(surface, straight);
  check_graph(surface, line);
  CHECK(line.edges.size() == 2);
  REQUIRE(line.lines.size() == 1);
  CHECK(line.lines[0].vertices == std::vector<Index>{11, 12, 13});
  CHECK(!line.lines[0].closed);
  CHECK(line.vertices[11] == FeatureVertex::end);
  CHECK(line.vertices[12] == FeatureVertex::crease);

  std::vector<Index> lasso = edges({6, 7, 12, 11, 6});
  lasso.push_back(mesh.edge(6, 5));
  const FeatureGraph loop = feature_graph(surface, lasso, pi<double>);
  check_graph(surface, loop);
  REQUIRE(loop.lines.size() == 2);
  CHECK(loop.lines[0].vertices == std::vector<Index>{5, 6});
  CHECK(loop.lines[1].closed);
  CHECK(loop.lines[1].vertices.front() == 6);
  CHECK(loop.vertices[6] == FeatureVertex::corner);
  CHECK(feature_graph(surface, {}).lines.empty());
}

TEST_CASE("bad angles, bad edges, and surfaces that lie in no space are refused") {
  const Surface surface = surface_of(cube());
  for (const double bad : {0.0, -1.0, 3.2, std::numeric_limits<double>::quiet_NaN()}) {
    CHECK_THROWS_AS(static_cast<void>(sharp_edges(surface, {.angle = bad})), OptionError);
    CHECK_THROWS_AS(static_cast<void>(sharp_edges(surface, {.corner_angle = bad})), OptionError);
  }
  for (const Index bad : {-1, 18}) {
    CHECK_THROWS_AS(static_cast<void>(dihedral_angle(surface, bad)), OptionError);
    CHECK_THROWS_AS(static_cast<void>(feature_graph(surface, {0, bad})), OptionError);
  }
  const Surface flat = flat_torus_surface(4, 4);
  CHECK_THROWS_AS(static_cast<void>(sharp_edges(flat)), OptionError);
  CHECK_THROWS_AS(static_cast<void>(dihedral_angle(flat, 0)), OptionError);
}

namespace {

/// A long roof along x: its ridge at y = 0 folds by `low` degrees for |x| < 1 and by 60 elsewhere, over 8 x 2 squares.
Surface roof(double low) {
  MeshData s = grid(8, 2, 8, 2);
  const double y = s.V.col(1).mean(), x = s.V.col(0).mean();
  for (Eigen::Index v = 0; v < s.V.rows(); ++v) {
    const double fold = (std::abs(s.V(v, 0) - x) < 1.5 ? low : 60) * pi<double> / 180;
    s.V(v, 2) = -std::tan(fold / 2) * std::abs(s.V(v, 1) - y);
  }
  return Surface(s.V, s.F);
}

std::size_t ridge(const FeatureGraph& graph, const Surface& surface) {
  std::size_t count = 0;
  for (const Index e : graph.edges) count += surface.mesh().boundary_halfedge(surface.mesh().halfedge(e)) ? 0 : 1;
  return count;
}

}  // namespace

TEST_CASE("low angles are followed from sharp edges, gaps are closed, spurs removed; off, nothing changes") {
  const Surface surface = roof(30);
  const auto degrees = [](double d) { return d * pi<double> / 180; };
  const std::size_t plain = ridge(sharp_edges(surface), surface);
  CHECK(plain < 8);
  CHECK(ridge(sharp_edges(surface, {.low_angle = degrees(25)}), surface) >= 8);
  const FeatureGraph closed = sharp_edges(surface, {.boundary = false, .gap = 4});
  CHECK(ridge(closed, surface) >= 8);
  CHECK(closed.edges.size() > sharp_edges(surface, {.boundary = false}).edges.size());
  CHECK(ridge(sharp_edges(surface, {.gap = 0.5}), surface) == plain);
  // Without its boundary the ridge is two lines with ends, of at most 4; all of them go.
  CHECK(sharp_edges(surface, {.boundary = false, .spur = 5}).edges.empty());
  CHECK(sharp_edges(surface, {.boundary = false, .spur = 1e-3}).edges ==
        sharp_edges(surface, {.boundary = false}).edges);
  // Low folds that no sharp edge touches are none.
  CHECK(ridge(sharp_edges(surface, {.angle = degrees(100), .low_angle = degrees(25)}), surface) == 0);
  CHECK(sharp_edges(surface, {.creases = false}).edges.size() ==
        static_cast<std::size_t>(surface.mesh().boundary_edges()));
  CHECK_THROWS_AS((void)sharp_edges(surface, {.low_angle = 3}), OptionError);
  CHECK_THROWS_AS((void)sharp_edges(surface, {.gap = -1}), OptionError);
  CHECK_THROWS_AS((void)sharp_edges(surface, {.spur = -1}), OptionError);
}

TEST_CASE("edges between vertices") {
  const MeshData box = cube();
  const Surface surface(box.V, box.F);
  const Index e = 5, h = surface.mesh().halfedge(e);
  CHECK(edges_between(surface, {{surface.mesh().tip(h), surface.mesh().tail(h)}}) == std::vector<Index>{e});
  CHECK_THROWS_AS((void)edges_between(surface, {{0, 0}}), OptionError);
}
