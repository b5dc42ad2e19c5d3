// SPDX-License-Identifier: MIT
//
// Half-edge identities on good meshes; every defect of bad ones, named; repairs.
#include <doctest/doctest.h>

#include <limits>
#include <map>
#include <set>

#include "alcap/geometry.h"
#include "alcap/mesh.h"
#include "alcap/mesh_check.h"
#include "src/base/parallel.h"
#include "tests/support/mesh_families.h"

using namespace alcap;
using namespace alcap::test;

namespace {

/// All identities that define a half-edge mesh, by brute force.
void check_identities(const Mesh& mesh, const Faces& F, Index vertices) {
  REQUIRE(mesh.faces() == F.rows());
  REQUIRE(mesh.vertices() == vertices);
  REQUIRE((mesh.F().array() == F.array()).all());
  std::map<std::pair<Index, Index>, Index> halfedge;
  for (Index h = 0; h < mesh.halfedges(); ++h) halfedge[{mesh.tail(h), mesh.tip(h)}] = h;
  std::map<std::pair<Index, Index>, Index> edges;  // (smaller, larger) to smallest halfedge
  Index bad = 0, boundary = 0;
  for (Index h = 0; h < mesh.halfedges(); ++h) {
    const Index i = F(h / 3, h % 3), j = F(h / 3, (h + 1) % 3);
    bad += mesh.tail(h) != i || mesh.tip(h) != j || Mesh::face(h) != h / 3;
    bad += Mesh::next(Mesh::next(Mesh::next(h))) != h || Mesh::prev(Mesh::next(h)) != h;
    bad += mesh.tail(Mesh::next(h)) != mesh.tip(h);
    const auto twin = halfedge.find({j, i});
    bad += mesh.twin(h) != (twin == halfedge.end() ? none : twin->second);
    bad += mesh.twin(h) != none && mesh.twin(mesh.twin(h)) != h;
    bad += mesh.boundary_halfedge(h) != (mesh.twin(h) == none);
    boundary += mesh.boundary_halfedge(h);
    const auto [at, added] = edges.try_emplace({std::min(i, j), std::max(i, j)}, h);
    bad += mesh.halfedge(mesh.edge(h)) != at->second;  // canonical: the smallest
    bad += mesh.canonical(h) != added;
    if (added) bad += mesh.edge(h) != static_cast<Index>(edges.size()) - 1;  // numbered in order
  }
  CHECK(bad == 0);
  CHECK(mesh.edges() == static_cast<Index>(edges.size()));
  CHECK(mesh.boundary_edges() == boundary);

  std::vector<std::set<Index>> corners(static_cast<std::size_t>(vertices));
  for (Index h = 0; h < mesh.halfedges(); ++h) corners[static_cast<std::size_t>(mesh.tail(h))].insert(h);
  Index referenced = 0;
  for (Index v = 0; v < vertices; ++v) {
    const std::set<Index>& all = corners[static_cast<std::size_t>(v)];
    std::vector<Index> met;
    mesh.for_each_outgoing(v, [&](Index h) { met.push_back(h); });
    bad += met.size() != all.size() || std::set<Index>(met.begin(), met.end()) != all;
    bad += mesh.referenced(v) != !all.empty();
    referenced += !all.empty();
    if (all.empty()) {
      bad += mesh.first(v) != none || mesh.boundary_vertex(v);
      continue;
    }
    const bool on_boundary = std::any_of(all.begin(), all.end(), [&](Index h) { return mesh.boundary_halfedge(h); });
    bad += mesh.boundary_vertex(v) != on_boundary;
    bad += on_boundary ? !mesh.boundary_halfedge(mesh.first(v)) : mesh.first(v) != *all.begin();
    for (std::size_t k = 1; k < met.size(); ++k) {  // counter-clockwise: the next corner lies across the previous edge
      bad += mesh.tail(Mesh::prev(met[k - 1])) != mesh.tip(met[k]);
    }
  }
  CHECK(bad == 0);
  CHECK(mesh.referenced_vertices() == referenced);
}

void check_identities(const MeshData& s) {
  check_identities(Mesh(s.F, s.V.rows()), s.F, static_cast<Index>(s.V.rows()));
}

/// The one defect that F has; the Mesh must refuse it with the same words.
DefectReport only_defect(const Faces& F, std::int64_t vertices) {
  const std::vector<DefectReport> reports = find_defects(F, vertices);
  REQUIRE(reports.size() == 1);
  try {
    const Mesh mesh(F, vertices);
    FAIL("accepted");
  } catch (const MeshError& e) {
    CHECK(e.what() == reports[0].message);
    CHECK(e.defect() == reports[0].defect);
    CHECK(e.element() == reports[0].element);
    CHECK(e.count() == reports[0].count);
    CHECK(e.first() == reports[0].first);
  }
  return reports[0];
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::vector<Defect> kinds(const std::vector<DefectReport>& reports) {
  std::vector<Defect> result;
  for (const DefectReport& r : reports) result.push_back(r.defect);
  return result;
}

using List = std::vector<Index>;

}  // namespace

TEST_CASE("half-edge identities hold on closed, open and mixed meshes") {
  for (const MeshData& s :
       {single_triangle(), tetrahedron(), cube(), icosphere(2), torus_random_diagonals(9, 7, 1, 0.4, 3),
        genus_surface(2, 2), grid(5, 4), disk(4), cylinder(7, 3), cad_like(16, 3), noisy_scan(3, 0.1, 7),
        together(grid(1, 1), together(icosphere(0), cylinder(3, 1)))}) {
    check_identities(s);
    CHECK(find_defects(s.F, s.V.rows()).empty());
    CHECK(find_defects(s.V, s.F).empty());
    check_identities(relabelled(s, random_order(s.V.rows(), 1), random_order(s.F.rows(), 2)));
  }
}

TEST_CASE("halfedge(i, j) and edge(i, j) find what joins two vertices, and nothing else, for all pairs") {
  for (const Family& family : mesh_families(2)) {
    CAPTURE(family.name);
    const Mesh mesh(family.surface.F, family.surface.V.rows() + 1);  // one vertex that no face uses
    std::map<std::pair<Index, Index>, Index> halfedge;
    for (Index h = 0; h < mesh.halfedges(); ++h) halfedge[{mesh.tail(h), mesh.tip(h)}] = h;
    Index bad = 0;
    for (Index i = 0; i < mesh.vertices(); ++i)
      for (Index j = 0; j < mesh.vertices(); ++j) {
        const auto there = halfedge.find({i, j}), back = halfedge.find({j, i});
        const Index h = there == halfedge.end() ? none : there->second;
        const Index g = back == halfedge.end() ? none : back->second;
        bad += mesh.halfedge(i, j) != h;
        bad += mesh.edge(i, j) != (h != none ? mesh.edge(h) : g != none ? mesh.edge(g) : none);
      }
    CHECK(bad == 0);
  }
}

TEST_CASE("halfedge(i, j) and edge(i, j) refuse numbers of no vertex") {
  const Mesh mesh(tetrahedron().F, 4);
  for (const Index bad : {-1, 4}) {
    CHECK_THROWS_AS(static_cast<void>(mesh.halfedge(bad, 0)), OptionError);
    CHECK_THROWS_AS(static_cast<void>(mesh.halfedge(0, bad)), OptionError);
    CHECK_THROWS_AS(static_cast<void>(mesh.edge(0, bad)), OptionError);
  }
  try {
    static_cast<void>(mesh.halfedge(0, 4));
    FAIL("accepted");
  } catch (const OptionError& error) {
    CHECK(error.field() == "j");
    CHECK(error.value() == "4");
  }
}

TEST_CASE("a vertex of valence 2000 is walked completely") {
  const MeshData s = fan(2000);
  check_identities(s);
  // The hub as the largest and as a middle number sorts differently.
  for (const Index hub : {Index{2000}, Index{1000}}) {
    List number(2001);
    for (Index v = 0; v < 2001; ++v) number[static_cast<std::size_t>(v)] = v == 0 ? hub : v <= hub ? v - 1 : v;
    check_identities(relabelled(s, number, random_order(2000, 5)));
  }
}

TEST_CASE("unreferenced vertices are allowed and flagged") {
  const MeshData s = tetrahedron();
  const Faces F = (s.F.array() * 2 + 1).matrix();
  const Mesh mesh(F, 10);
  check_identities(mesh, F, 10);
  CHECK(mesh.referenced_vertices() == 4);
  CHECK_FALSE(mesh.referenced(0));
  CHECK(mesh.referenced(1));
  CHECK_FALSE(mesh.referenced(9));
}

TEST_CASE("the mesh does not depend on the number of threads") {
  const MeshData clean = noisy_scan(4, 0.1, 3);
  const MeshData s = relabelled(clean, random_order(clean.V.rows(), 8), random_order(clean.F.rows(), 9));
  const auto arrays = [&](int threads) {
    std::vector<Index> all;
    run_with_threads(threads, [&] {
      const Mesh mesh(s.F, s.V.rows());
      for (Index h = 0; h < mesh.halfedges(); ++h) all.insert(all.end(), {mesh.twin(h), mesh.edge(h)});
      for (Index e = 0; e < mesh.edges(); ++e) all.push_back(mesh.halfedge(e));
      for (Index v = 0; v < mesh.vertices(); ++v) all.push_back(mesh.first(v));
    });
    return all;
  };
  const std::vector<Index> one = arrays(1);
  CHECK(arrays(2) == one);
  CHECK(arrays(4) == one);
}

TEST_CASE("shuffled faces give the same mesh up to relabelling") {
  const MeshData s = noisy_scan(3, 0.1, 5);
  const List number = random_order(s.V.rows(), 3), row = random_order(s.F.rows(), 4);
  const MeshData t = relabelled(s, number, row);
  const Mesh a(s.F, s.V.rows()), b(t.F, t.V.rows());
  const auto image = [&](Index h) { return h == none ? none : 3 * row[static_cast<std::size_t>(h / 3)] + h % 3; };
  Index bad = 0;
  for (Index h = 0; h < a.halfedges(); ++h) {
    bad += image(a.twin(h)) != b.twin(image(h));
    bad += (a.twin(h) != none) && (b.edge(image(h)) != b.edge(image(a.twin(h))));
    bad += number[static_cast<std::size_t>(a.tail(h))] != b.tail(image(h));
  }
  CHECK(bad == 0);
  CHECK(a.edges() == b.edges());
  CHECK(a.boundary_edges() == b.boundary_edges());
}

TEST_CASE("defect: no faces") {
  const DefectReport r = only_defect(Faces(0, 3), 5);
  CHECK(r.defect == Defect::empty);
  CHECK(only_defect(Faces(0, 3), 0).defect == Defect::empty);
}

TEST_CASE("defect: index out of range") {
  const DefectReport r = only_defect(faces({{0, 1, 2}, {0, 2, 4}, {-1, 0, 1}, {3, 2, 1}}), 4);
  CHECK(r.defect == Defect::index_out_of_range);
  CHECK(r.element == Element::face);
  CHECK(r.count == 2);
  CHECK(r.first == List{1, 2});
  CHECK(contains(r.message, "2 faces"));
  CHECK(contains(r.message, "0 to 3"));
  for (const Index huge : {std::numeric_limits<Index>::max(), std::numeric_limits<Index>::min()}) {
    CHECK(only_defect(faces({{0, 1, huge}}), 3).first == List{0});
  }
  CHECK(only_defect(faces({{0, 1, 2}}), 0).defect == Defect::index_out_of_range);
  CHECK(only_defect(faces({{0, 1, 2}}), -7).defect == Defect::index_out_of_range);
  CHECK(only_defect(faces({{0, 1, 2}}), std::numeric_limits<Index>::max()).element == Element::vertex);
}

TEST_CASE("defect: repeated vertex in a face") {
  const DefectReport r = only_defect(faces({{0, 1, 2}, {2, 2, 3}, {3, 0, 3}, {1, 4, 4}, {5, 5, 5}}), 6);
  CHECK(r.defect == Defect::repeated_vertex_in_face);
  CHECK(r.count == 4);
  CHECK(r.first == List{1, 2, 3, 4});
}

TEST_CASE("defect: duplicate faces in either orientation") {
  const DefectReport r = only_defect(faces({{0, 1, 2}, {1, 3, 2}, {2, 0, 1}, {2, 3, 1}}), 4);
  CHECK(r.defect == Defect::duplicate_face);
  CHECK(r.element == Element::face);
  CHECK(r.first == List{2, 3});
  CHECK(only_defect(faces({{0, 1, 2}, {0, 2, 1}}), 3).first == List{1});  // a pillow
  CHECK(only_defect(faces({{0, 1, 2}, {0, 1, 2}, {0, 1, 2}}), 3).first == List{1, 2});
}

TEST_CASE("defect: non-manifold edge") {
  const DefectReport r = only_defect(faces({{0, 1, 2}, {1, 0, 3}, {4, 0, 1}}), 5);
  CHECK(r.defect == Defect::non_manifold_edge);
  CHECK(r.element == Element::edge);
  CHECK(r.count == 1);
  CHECK(r.first == List{0, 1});
  CHECK(contains(r.message, "1 edge has more than two faces (non-manifold): (0, 1); "));
  // Two cubes that share an edge: four faces there, and the ends are no bow-ties besides.
  MeshData two = together(cube(), cube());
  for (Eigen::Index t = 12; t < 24; ++t) {
    for (int c = 0; c < 3; ++c) {
      if (two.F(t, c) == 8) two.F(t, c) = 7;
      if (two.F(t, c) == 9) two.F(t, c) = 6;
    }
  }
  CHECK(only_defect(two.F, 16).first == List{6, 7});
}

TEST_CASE("defect: inconsistent orientation names the edges and the repair") {
  MeshData s = tetrahedron();
  std::swap(s.F(2, 0), s.F(2, 1));
  const DefectReport r = only_defect(s.F, 4);
  CHECK(r.defect == Defect::inconsistent_orientation);
  CHECK(r.element == Element::edge);
  CHECK(r.count == 3);
  CHECK(r.first == List{0, 2, 0, 3, 2, 3});
  CHECK(contains(r.message, "3 edges"));
  CHECK(contains(r.message, "(0, 2), (0, 3), (2, 3)"));
  CHECK(contains(r.message, "turn the faces with repair_orientation()"));
  MeshData many = icosphere(2);
  for (Eigen::Index t = 0; t < 320; t += 8) std::swap(many.F(t, 1), many.F(t, 2));
  const DefectReport long_list = only_defect(many.F, many.V.rows());
  CHECK(long_list.first.size() == 16);
  CHECK(long_list.count > 8);
  CHECK(contains(long_list.message, "...;"));
}

TEST_CASE("defect: not orientable") {
  const MeshData sphere = icosphere(0);
  Faces F(30, 3);
  F << sphere.F, (moebius_strip(5).array() + 12).matrix();
  const DefectReport r = only_defect(F, 22);
  CHECK(r.defect == Defect::not_orientable);
  CHECK(r.element == Element::face);
  CHECK(r.count == 1);
  CHECK(r.first == List{20});
}

TEST_CASE("defect: bow-tie") {
  const DefectReport open = only_defect(faces({{0, 1, 2}, {2, 3, 4}}), 5);
  CHECK(open.defect == Defect::non_manifold_vertex);
  CHECK(open.element == Element::vertex);
  CHECK(open.first == List{2});
  MeshData closed = together(tetrahedron(), tetrahedron());
  for (Eigen::Index t = 4; t < 8; ++t) {
    for (int c = 0; c < 3; ++c) {
      if (closed.F(t, c) == 4) closed.F(t, c) = 3;
    }
  }
  CHECK(only_defect(closed.F, 8).first == List{3});
  MeshData mixed = together(fan(5), fan(6));  // one boundary, one interior vertex: 1 and the second hub
  for (Eigen::Index t = 5; t < 11; ++t) mixed.F(t, 0) = 1;
  CHECK(only_defect(mixed.F, 13).first == List{1});
}

TEST_CASE("several defects are all reported, each once, in the order of repair") {
  const Faces F = faces({{0, 1, 2},
                         {0, 1, 99},  // out of range
                         {3, 3, 4},   // repeated
                         {2, 1, 0},   // duplicate
                         {5, 6, 7},
                         {6, 5, 8},
                         {5, 6, 9},  // non-manifold edge 5-6
                         {10, 11, 12},
                         {10, 11, 13},  // inconsistent 10-11
                         {14, 15, 16},
                         {16, 17, 18}});  // bow-tie 16
  const std::vector<DefectReport> r = find_defects(F, 20);
  CHECK(kinds(r) == std::vector<Defect>{Defect::index_out_of_range, Defect::repeated_vertex_in_face,
                                        Defect::duplicate_face, Defect::non_manifold_edge,
                                        Defect::inconsistent_orientation, Defect::non_manifold_vertex});
  REQUIRE(r.size() == 6);
  CHECK(r[0].first == List{1});
  CHECK(r[1].first == List{2});
  CHECK(r[2].first == List{3});
  CHECK(r[3].first == List{5, 6});
  CHECK(r[4].first == List{10, 11});
  CHECK(r[5].first == List{16});
  CHECK_THROWS_AS(throw_defect(r[3]), MeshError);
}

TEST_CASE("garbage is accepted or refused alike by the check and by the mesh") {
  detail::Random random(11);
  int good = 0, refused = 0;
  for (int round = 0; round < 3000; ++round) {
    const Index vertices = 3 + static_cast<Index>(random.below(6));
    Faces F(1 + random.below(7), 3);
    for (Eigen::Index k = 0; k < F.size(); ++k) {
      F.data()[k] = static_cast<Index>(random.below(vertices + (round % 5 == 0 ? 1 : 0)));
    }
    const std::vector<DefectReport> reports = find_defects(F, vertices);
    try {
      check_identities(Mesh(F, vertices), F, vertices);
      REQUIRE(reports.empty());
      ++good;
    } catch (const MeshError& e) {
      REQUIRE_FALSE(reports.empty());
      REQUIRE(e.defect() == reports.front().defect);
      ++refused;
    }
  }
  CHECK(good > 100);
  CHECK(refused > 1000);
  // Many faces on few vertices and one vertex in every face.
  Faces F(200000, 3);
  for (Eigen::Index t = 0; t < F.rows(); ++t) {
    F.row(t) << 0, static_cast<Index>(random.below(1000)), static_cast<Index>(random.below(1 << 30));
  }
  CHECK(find_defects(F, 1 << 29).front().defect == Defect::index_out_of_range);
  F.col(2) = F.col(2).unaryExpr([](Index v) { return v % 1000; });
  CHECK_FALSE(find_defects(F, 1000).empty());
}

TEST_CASE("geometric defects name their elements") {
  MeshData s = icosphere(1);
  s.V(4, 1) = std::numeric_limits<double>::quiet_NaN();
  s.V(9, 2) = -std::numeric_limits<double>::infinity();
  const std::vector<DefectReport> r = find_defects(s.V, s.F);
  CHECK(kinds(r) == std::vector<Defect>{Defect::not_finite});
  CHECK(r.at(0).first == List{4, 9});
  CHECK(r.at(0).element == Element::vertex);

  MeshData g = grid(4, 4);
  g.V.row(7) = g.V.row(6);  // neighbours
  const std::vector<DefectReport> q = find_defects(g.V, g.F);
  REQUIRE(kinds(q) == std::vector<Defect>{Defect::zero_length_edge});
  CHECK(q[0].first == List{6, 7});
  CHECK(contains(q[0].message, "1 edge has length zero: (6, 7); "));

  Positions<double> V(4, 3);
  V << 0, 0, 0, 1, 1, 1, 3, 3, 3, 0, 1, 0;
  const std::vector<DefectReport> line = find_defects(V, faces({{0, 3, 1}, {0, 1, 2}}));
  CHECK(kinds(line) == std::vector<Defect>{Defect::zero_area_face});
  CHECK(line.at(0).first == List{1});
  // Out of range and repeated vertices are another check's business.
  CHECK(find_defects(V, faces({{0, 3, 1}, {0, 99, -2}, {1, 1, 2}})).empty());
}

TEST_CASE("meshes too large or too small for products of lengths are refused in the same words everywhere") {
  const MeshData m = icosphere(1);
  const Mesh mesh(m.F, m.V.rows());
  for (const double scale : {1e-300, 1e-155, 1e-90, 1e-61, 1e62, 1e80, 1e155, 1e300}) {
    CAPTURE(scale);
    const Positions<double> V = scale * m.V;
    const std::vector<DefectReport> r = find_defects(V, m.F);
    REQUIRE(kinds(r) == std::vector<Defect>{Defect::scale_out_of_range});
    CHECK(r[0].count == m.F.rows());
    try {
      const Geometry geometry(mesh, V);
      FAIL_CHECK("was taken");
    } catch (const MeshError& e) {
      CHECK(e.what() == r[0].message);
      CHECK(e.defect() == Defect::scale_out_of_range);
    }
    const VectorX<double> lengths = VectorX<double>::Constant(mesh.edges(), scale);
    CHECK_THROWS_AS((void)Geometry::from_lengths(mesh, lengths), MeshError);
  }
  for (const double scale : {1e-58, 1e-30, 1e30, 1e58}) {
    CAPTURE(scale);
    CHECK(find_defects(scale * m.V, m.F).empty());
    const Geometry unit(mesh, m.V), scaled(mesh, scale * m.V);
    CHECK((scaled.angles() - unit.angles()).cwiseAbs().maxCoeff() < 1e-12);
    CHECK(scaled.total_area() / unit.total_area() / scale / scale == doctest::Approx(1));
  }
}

TEST_CASE("degenerate() accepts slivers and does not depend on the unit of length") {
  using Point = Eigen::RowVector3d;
  const Point a(0, 0, 0), b(1, 0, 0), line(0.3, 0, 0), sliver(0.3, 1e-12, 0);
  for (const double scale : {1e-300, 1e-150, 1e-6, 1.0, 1e6, 1e150, 1e300}) {
    CHECK(degenerate(a * scale, b * scale, line * scale));
    CHECK_FALSE(degenerate(a * scale, b * scale, sliver * scale));
  }
  // Far from the origin the same sliver is below the rounding of the coordinates.
  const Point far(1e6, 1e6, 1e6);
  CHECK(degenerate(a + far, b + far, sliver + far));
  CHECK(degenerate(a, a, b));
  CHECK(degenerate(a, b, Point(std::numeric_limits<double>::quiet_NaN(), 1, 0)));
  CHECK(degenerate(a, b, Point(std::numeric_limits<double>::infinity(), 1, 0)));
}

TEST_CASE("repair: random flips are undone, and the smallest face keeps its orientation") {
  for (const MeshData& s : {icosphere(2), grid(6, 5), torus(8, 6, 1, 0.4), noisy_scan(3, 0, 1),
                            together(cylinder(5, 2), together(genus_surface(2, 1), single_triangle()))}) {
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      const Faces turned = randomly_turned(s.F, seed);
      List flipped;
      const Faces repaired = repair_orientation(turned, s.V.rows(), &flipped);
      CHECK(find_defects(repaired, s.V.rows()).empty());
      // Piece by piece all faces are as they were, or all are turned: compare with the first face of the piece.
      const Mesh mesh(s.F, s.V.rows());
      const auto same = [&](Index t, const Faces& G) {
        for (int c = 0; c < 3; ++c) {
          if (s.F(t, 0) == G(t, c) && s.F(t, 1) == G(t, (c + 1) % 3)) return true;
        }
        return false;
      };
      Index bad = 0;
      for (Index h = 0; h < mesh.halfedges(); ++h) {
        if (mesh.twin(h) == none) continue;
        bad += same(h / 3, repaired) != same(mesh.twin(h) / 3, repaired);
      }
      CHECK(bad == 0);
      CHECK(same(0, repaired) == same(0, turned));
      for (Index t = 0; t < s.F.rows(); ++t) {
        const bool listed = std::binary_search(flipped.begin(), flipped.end(), t);
        bad += listed == (turned.row(t) == repaired.row(t));
      }
      CHECK(bad == 0);
    }
    List none_flipped{1, 2, 3};
    CHECK(repair_orientation(s.F, s.V.rows(), &none_flipped) == s.F);
    CHECK(none_flipped.empty());
  }
}

TEST_CASE("repair: a Moebius strip cannot be oriented, nor can broken faces") {
  const auto refusal = [](const Faces& F, std::int64_t vertices) {
    try {
      (void)repair_orientation(F, vertices);
    } catch (const MeshError& e) {
      return e.defect();
    }
    return Defect::empty;  // no test below expects this one
  };
  for (Index n = 3; n < 9; ++n) CHECK(refusal(moebius_strip(n), 2 * n) == Defect::not_orientable);
  CHECK(refusal(randomly_turned(moebius_strip(7), 3), 14) == Defect::not_orientable);
  CHECK(refusal(faces({{0, 1, 2}, {1, 0, 3}, {4, 0, 1}}), 5) == Defect::non_manifold_edge);
  CHECK(refusal(faces({{0, 1, 9}}), 3) == Defect::index_out_of_range);
  CHECK(refusal(faces({{0, 1, 1}}), 3) == Defect::repeated_vertex_in_face);
}

TEST_CASE("repair: welding a soup gives the original topology") {
  for (const MeshData& s : {icosphere(2), grid(6, 5), cad_like(12, 2), noisy_scan(3, 0.1, 2)}) {
    const MeshData pieces = soup(s);
    CHECK(Mesh(pieces.F, pieces.V.rows()).boundary_edges() == 3 * s.F.rows());
    CHECK(duplicate_positions(pieces.V) == pieces.V.rows() - s.V.rows());
    CHECK(duplicate_positions(s.V) == 0);
    const Faces welded = repair_weld(pieces.V, pieces.F);
    const Mesh a(s.F, s.V.rows()), b(welded, pieces.V.rows());
    CHECK(b.referenced_vertices() == a.vertices());
    Index bad = 0;
    for (Index h = 0; h < a.halfedges(); ++h) {
      bad += a.twin(h) != b.twin(h);
      bad += pieces.V.row(b.tail(h)) != s.V.row(a.tail(h));
    }
    CHECK(bad == 0);
    CHECK(repair_weld(pieces.V, welded) == welded);
    CHECK(repair_weld(s.V, s.F) == s.F);
  }
  Positions<double> V(5, 3);
  V << 0, 0, 0, 1, 0, 0, 0, 1, 0, -0.0, 0, -0.0, std::numeric_limits<double>::quiet_NaN(), 0, 0;
  CHECK(duplicate_positions(V) == 1);  // 0 and -0; NaN equals nothing
  CHECK(repair_weld(V, faces({{1, 2, 3}, {4, 77, -3}})) == faces({{1, 2, 0}, {4, 77, -3}}));
}
