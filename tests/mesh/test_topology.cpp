// SPDX-License-Identifier: MIT
//
// Components, loops, genus and homology generators against brute force and exact linear algebra.
#include <doctest/doctest.h>

#include <map>
#include <set>

#include "alcap/mesh_check.h"
#include "alcap/topology.h"
#include "src/base/parallel.h"
#include "tests/support/mesh_helpers.h"

using namespace alcap;
using namespace alcap::test;

namespace {

using Row = std::vector<std::int64_t>;

/// Rank of an integer matrix modulo a prime, exactly.
Index rank_modulo(std::vector<Row> rows, std::int64_t prime) {
  const auto residue = [prime](std::int64_t x) { return ((x % prime) + prime) % prime; };
  const auto inverse = [&](std::int64_t x) {
    std::int64_t result = 1, base = residue(x);
    for (std::int64_t e = prime - 2; e > 0; e /= 2, base = base * base % prime) {
      if (e % 2 == 1) result = result * base % prime;
    }
    return prime == 2 ? residue(x) : result;
  };
  Index rank = 0;
  const std::size_t columns = rows.empty() ? 0 : rows[0].size();
  for (std::size_t c = 0; c < columns && rank < static_cast<Index>(rows.size()); ++c) {
    auto at = static_cast<std::size_t>(rank);
    while (at < rows.size() && residue(rows[at][c]) == 0) ++at;
    if (at == rows.size()) continue;
    std::swap(rows[at], rows[static_cast<std::size_t>(rank)]);
    const Row& pivot = rows[static_cast<std::size_t>(rank)];
    const std::int64_t scale = inverse(pivot[c]);
    for (std::size_t r = static_cast<std::size_t>(rank) + 1; r < rows.size(); ++r) {
      const std::int64_t factor = residue(rows[r][c]) * scale % prime;
      if (factor == 0) continue;
      for (std::size_t k = c; k < columns; ++k) rows[r][k] = residue(rows[r][k] - factor * residue(pivot[k]));
    }
    ++rank;
  }
  return rank;
}

void add_crossing(const Mesh& mesh, Row& row, Index h) {
  if (!mesh.boundary_halfedge(h)) row[static_cast<std::size_t>(mesh.edge(h))] += mesh.canonical(h) ? 1 : -1;
}

/// Strips of faces as chains on the interior edges they cross: around interior vertices these are boundaries, around
/// boundary loops they are the loops pushed inside. Generators and all loops but one must be independent modulo the
/// vertices' rings, modulo every prime tried, and nothing may be missing: rank H_1 = 2 genus + max(loops - 1, 0).
void check_generators(const Mesh& mesh) {
  const Topology topology = find_topology(mesh);
  const std::vector<Loop> generators = homology_generators(mesh, topology);
  Index interior = 0, expected = 0;
  const auto edges = static_cast<std::size_t>(mesh.edges());
  std::vector<Row> rings, all;
  for (Index v = 0; v < mesh.vertices(); ++v) {
    if (!mesh.referenced(v) || mesh.boundary_vertex(v)) continue;
    Row row(edges, 0);
    mesh.for_each_outgoing(v, [&](Index h) { add_crossing(mesh, row, h); });
    rings.push_back(row);
    ++interior;
  }
  for (const ComponentInfo& c : topology.components) {
    expected += 2 * c.genus + std::max<Index>(c.boundary_loops - 1, 0);
    if (c.boundary_loops == 0) --interior;  // the rings of a closed component sum to zero
  }
  all = rings;
  std::map<Index, Index> count;
  Index last_component = 0;
  for (const Loop& g : generators) {
    CHECK(g.component >= last_component);
    last_component = g.component;
    ++count[g.component];
    Row row(edges, 0);
    std::set<Index> met;
    for (std::size_t k = 0; k < g.halfedges.size(); ++k) {
      const Index h = g.halfedges[k], next = g.halfedges[(k + 1) % g.halfedges.size()];
      REQUIRE_FALSE(mesh.boundary_halfedge(h));
      REQUIRE(Mesh::face(mesh.twin(h)) == Mesh::face(next));
      REQUIRE(topology.face_component[static_cast<std::size_t>(Mesh::face(h))] == g.component);
      REQUIRE(met.insert(Mesh::face(h)).second);  // no face twice
      add_crossing(mesh, row, h);
    }
    all.push_back(row);
  }
  for (std::size_t c = 0; c < topology.components.size(); ++c) {
    CHECK(count[static_cast<Index>(c)] == 2 * topology.components[c].genus);
  }
  for (const Loop& loop : topology.loops) {
    Row row(edges, 0);
    for (const Index h : loop.halfedges) {
      mesh.for_each_outgoing(mesh.tail(h), [&](Index k) { add_crossing(mesh, row, k); });
      // The walk leaves out the incoming boundary edge, which no strip crosses.
    }
    all.push_back(row);
  }
  for (const std::int64_t prime : {2, 3, 1000003}) {
    CHECK(rank_modulo(rings, prime) == interior);
    CHECK(rank_modulo(all, prime) == interior + expected);
  }
}

/// Components by repeated relabelling: the smallest vertex of each.
std::vector<Index> labels(const Mesh& mesh) {
  std::vector<Index> label(static_cast<std::size_t>(mesh.vertices()));
  for (std::size_t v = 0; v < label.size(); ++v) label[v] = static_cast<Index>(v);
  for (bool changed = true; changed;) {
    changed = false;
    for (Index h = 0; h < mesh.halfedges(); ++h) {
      Index& a = label[static_cast<std::size_t>(mesh.tail(h))];
      Index& b = label[static_cast<std::size_t>(mesh.tip(h))];
      if (a == b) continue;
      a = b = std::min(a, b);
      changed = true;
    }
  }
  return label;
}

/// Boundary loops by following tips; counts them by component and returns what is wrong.
Index check_loops(const Mesh& mesh, const Topology& topology, std::vector<ComponentInfo>& expected) {
  Index bad = 0;
  std::set<Index> on_loops;
  Index last_start = -1;
  for (const Loop& loop : topology.loops) {
    ++expected[static_cast<std::size_t>(loop.component)].boundary_loops;
    bad += loop.halfedges.front() <= last_start;
    last_start = loop.halfedges.front();
    bad += *std::min_element(loop.halfedges.begin(), loop.halfedges.end()) != last_start;
    for (std::size_t k = 0; k < loop.halfedges.size(); ++k) {
      const Index h = loop.halfedges[k];
      bad += !mesh.boundary_halfedge(h) || !on_loops.insert(h).second;
      bad += mesh.tip(h) != mesh.tail(loop.halfedges[(k + 1) % loop.halfedges.size()]);
      bad += topology.face_component[static_cast<std::size_t>(Mesh::face(h))] != loop.component;
    }
  }
  CHECK(static_cast<Index>(on_loops.size()) == mesh.boundary_edges());
  return bad;
}

/// Everything that find_topology() says, counted another way.
void check_topology(const Mesh& mesh) {
  const Topology topology = find_topology(mesh);
  const std::vector<Index> label = labels(mesh);
  std::map<Index, Index> number;  // label to component, in the order of the faces
  std::vector<ComponentInfo> expected;
  Index bad = 0;
  for (Index t = 0; t < mesh.faces(); ++t) {
    const auto [at, added] =
        number.try_emplace(label[static_cast<std::size_t>(mesh.F()(t, 0))], static_cast<Index>(number.size()));
    if (added) {
      expected.emplace_back();
      expected.back().first_face = t;
    }
    ++expected[static_cast<std::size_t>(at->second)].faces;
    bad += topology.face_component[static_cast<std::size_t>(t)] != at->second;
  }
  REQUIRE(topology.components.size() == expected.size());
  for (Index v = 0; v < mesh.vertices(); ++v) {
    const auto at = number.find(label[static_cast<std::size_t>(v)]);
    const Index c = at == number.end() ? none : at->second;
    bad += topology.vertex_component[static_cast<std::size_t>(v)] != c;
    if (c != none) ++expected[static_cast<std::size_t>(c)].vertices;
  }
  for (Index e = 0; e < mesh.edges(); ++e) {
    ++expected[static_cast<std::size_t>(number.at(label[static_cast<std::size_t>(mesh.tail(mesh.halfedge(e)))]))].edges;
  }
  bad += check_loops(mesh, topology, expected);
  Index euler = 0;
  for (std::size_t c = 0; c < expected.size(); ++c) {
    const ComponentInfo& info = topology.components[c];
    bad += info.vertices != expected[c].vertices || info.faces != expected[c].faces || info.edges != expected[c].edges;
    bad += info.boundary_loops != expected[c].boundary_loops || info.first_face != expected[c].first_face;
    bad += info.euler != info.vertices - info.edges + info.faces;
    bad += info.euler != 2 - 2 * info.genus - info.boundary_loops || info.genus < 0;
    euler += info.euler;
  }
  CHECK(topology.euler() == euler);
  CHECK(bad == 0);
}

/// Removes up to `count` random faces, each only if the rest stays a mesh.
Faces with_random_holes(const MeshData& s, Index count, std::uint64_t seed) {
  Faces F = s.F;
  detail::Random random(seed);
  for (Index k = 0; k < count; ++k) {
    Faces fewer(F.rows() - 1, 3);
    const Eigen::Index gone = random.below(F.rows());
    fewer << F.topRows(gone), F.bottomRows(F.rows() - 1 - gone);
    if (find_defects(fewer, s.V.rows()).empty()) F = fewer;
  }
  return F;
}

}  // namespace

TEST_CASE("components, loops and genus agree with brute force") {
  const MeshData mixed =
      together(grid(3, 2), together(torus(5, 4, 1, 0.4), together(cylinder(5, 2), genus_surface(2, 1))));
  for (const MeshData& s : {single_triangle(), tetrahedron(), icosphere(1), torus(4, 3, 1, 0.4), genus_surface(3, 1),
                            disk(3), cylinder(4, 2), noisy_scan(3, 0, 2), mixed}) {
    check_topology(Mesh(s.F, s.V.rows()));
    const MeshData t = relabelled(s, random_order(s.V.rows(), 1), random_order(s.F.rows(), 2));
    check_topology(Mesh(t.F, t.V.rows()));
  }
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const MeshData s = torus_random_diagonals(6, 5, 1, 0.4, seed);
    check_topology(Mesh(with_random_holes(s, 4 + static_cast<Index>(seed), seed), s.V.rows()));
  }
}

TEST_CASE("a thousand components") {
  MeshData s{Positions<double>(5000, 3), Faces(3000, 3)};
  Eigen::Index row = 0;
  for (Index k = 0; k < 1000; ++k) {
    const MeshData piece = k % 2 == 0 ? tetrahedron() : grid(1, 1);
    s.V.middleRows(4 * k, 4) = piece.V;
    for (Eigen::Index t = 0; t < piece.F.rows(); ++t) {
      s.F.row(row++) = (piece.F.row(t).array() + 4 * k).matrix();
    }
  }
  REQUIRE(row == 3000);
  s.V.bottomRows(1000).setZero();  // unreferenced
  const std::vector<Index> order = random_order(3000, 4), number = random_order(5000, 5);
  const MeshData t = relabelled(s, number, order);
  const Mesh mesh(t.F, 5000);
  check_topology(mesh);
  const Topology topology = find_topology(mesh);
  CHECK(topology.components.size() == 1000);
  CHECK(topology.loops.size() == 500);
  CHECK(topology.euler() == 500 * 2 + 500 * 1);
  CHECK(homology_generators(mesh, topology).empty());
  Index last = -1, unreferenced = 0;
  for (const ComponentInfo& c : topology.components) {
    CHECK(c.first_face > last);
    last = c.first_face;
  }
  for (const Index c : topology.vertex_component) unreferenced += c == none;
  CHECK(unreferenced == 1000);
}

TEST_CASE("generators are closed strips and a basis on closed surfaces") {
  for (const MeshData& s : {icosphere(1), torus(3, 3, 1, 0.4), torus(7, 5, 1, 0.4),
                            torus_random_diagonals(6, 8, 1, 0.4, 2), genus_surface(2, 1), genus_surface(3, 1),
                            together(genus_surface(2, 1), together(icosphere(0), torus(4, 3, 1, 0.4)))}) {
    check_generators(Mesh(s.F, s.V.rows()));
    const MeshData t = relabelled(s, random_order(s.V.rows(), 3), random_order(s.F.rows(), 4));
    check_generators(Mesh(t.F, t.V.rows()));
  }
}

TEST_CASE("generators and loops are a basis on surfaces with boundary") {
  check_generators(Mesh(cylinder(5, 2).F, 15));
  check_generators(Mesh(grid(3, 2).F, 12));
  Index with_handles = 0, several_loops = 0;
  for (std::uint64_t seed = 0; seed < 24; ++seed) {
    const MeshData s = seed % 2 == 0 ? torus_random_diagonals(6, 5, 1, 0.4, seed) : genus_surface(2, 1);
    const Mesh mesh(with_random_holes(s, 1 + 2 * static_cast<Index>(seed % 9), seed), s.V.rows());
    check_generators(mesh);
    for (const ComponentInfo& c : find_topology(mesh).components) {
      with_handles += c.genus > 0 && c.boundary_loops > 0;
      several_loops += c.genus > 0 && c.boundary_loops > 1;
    }
  }
  CHECK(with_handles > 10);
  CHECK(several_loops > 5);
}

TEST_CASE("generators of a torus grid are as short as they can be") {
  // Around nv = 6 or nu = 10 quads every strip crosses at least 2 nv or 2 nu edges; one of each is the shortest basis.
  const Mesh mesh(torus(10, 6, 1, 0.4).F, 60);
  std::vector<std::size_t> lengths;
  for (const Loop& g : homology_generators(mesh, find_topology(mesh))) lengths.push_back(g.halfedges.size());
  std::sort(lengths.begin(), lengths.end());
  CHECK(lengths == std::vector<std::size_t>{12, 20});
}

TEST_CASE("topology does not depend on the number of threads") {
  const MeshData s = genus_surface(3, 3);
  const auto result = [&](int threads) {
    std::vector<Index> all;
    run_with_threads(threads, [&] {
      const Mesh mesh(s.F, s.V.rows());
      const Topology topology = find_topology(mesh);
      for (const Loop& g : homology_generators(mesh, topology)) {
        all.insert(all.end(), g.halfedges.begin(), g.halfedges.end());
      }
      all.insert(all.end(), topology.vertex_component.begin(), topology.vertex_component.end());
    });
    return all;
  };
  CHECK(result(1) == result(2));
  CHECK(result(1) == result(4));
}

TEST_CASE("components become meshes of their own, with maps back") {
  const MeshData parts = together(torus(5, 4, 1, 0.4), together(disk(2), tetrahedron()));
  MeshData s = relabelled(parts, random_order(parts.V.rows(), 6), random_order(parts.F.rows(), 7));
  s.V.conservativeResize(s.V.rows() + 3, 3);  // unreferenced
  s.V.bottomRows(3).setConstant(9);
  const Mesh mesh(s.F, s.V.rows());
  const Topology topology = find_topology(mesh);
  const std::vector<Piece> pieces = split_components(mesh, s.V, topology);
  REQUIRE(pieces.size() == 3);
  std::set<Index> vertices, triangles;
  for (Index c = 0; c < 3; ++c) {
    const Piece& p = pieces[static_cast<std::size_t>(c)];
    const Piece alone = extract_component(mesh, s.V, topology, c);
    CHECK(alone.V == p.V);
    CHECK(alone.F == p.F);
    CHECK(alone.vertices == p.vertices);
    CHECK(alone.faces == p.faces);
    CHECK(std::is_sorted(p.vertices.begin(), p.vertices.end()));
    CHECK(std::is_sorted(p.faces.begin(), p.faces.end()));
    vertices.insert(p.vertices.begin(), p.vertices.end());
    triangles.insert(p.faces.begin(), p.faces.end());
    Index bad = 0;
    for (Eigen::Index t = 0; t < p.F.rows(); ++t) {
      for (int k = 0; k < 3; ++k) {
        const Index whole = p.vertices[static_cast<std::size_t>(p.F(t, k))];
        bad += s.F(p.faces[static_cast<std::size_t>(t)], k) != whole || p.V.row(p.F(t, k)) != s.V.row(whole);
      }
    }
    CHECK(bad == 0);
    const Topology own = find_topology(Mesh(p.F, p.V.rows()));
    REQUIRE(own.components.size() == 1);
    CHECK(own.components[0].genus == topology.components[static_cast<std::size_t>(c)].genus);
    CHECK(own.components[0].boundary_loops == topology.components[static_cast<std::size_t>(c)].boundary_loops);
  }
  CHECK(static_cast<Index>(vertices.size()) == mesh.referenced_vertices());
  CHECK(static_cast<Index>(triangles.size()) == mesh.faces());
  CHECK_THROWS_AS((void)extract_component(mesh, s.V, topology, 3), OptionError);
  CHECK_THROWS_AS((void)extract_component(mesh, s.V, topology, -1), OptionError);
}
