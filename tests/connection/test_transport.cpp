// SPDX-License-Identifier: MIT
//
// Parallel transport: holonomy is the curvature inside, on every mesh and for every connection.
#include "alcap/transport.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <set>

#include "alcap/operators.h"
#include "alcap/shortest_path.h"
#include "alcap/streamlines.h"
#include "alcap/strokes.h"
#include "src/base/random.h"
#include "src/connection/edge_to_face.h"
#include "tests/support/mesh_families.h"
#include "tests/support/surfaces.h"

using namespace alcap;
using namespace alcap::test;

namespace {

using C = Complex<double>;

SurfacePolyline through(const ConnectedSurface& s, const std::vector<SurfacePoint>& points) {
  return stroke_through_points(s, points);
}

SurfacePoint corner(Index h) { return detail::on_halfedge(h, 0); }

std::vector<ConnectedSurface> connections(const MeshData& data) {
  const Surface surface(data.V, data.F);
  return {{surface, polar(surface)},
          {surface, polar(surface, {.center = PolarCenter::barycenter})},
          {surface, locally_optimal(surface)},
          {surface, globally_optimal(surface)}};
}

double error_of_angle(double a, double b) { return std::abs(wrap(a - b)); }

SurfacePoint random_point(const Mesh& mesh, detail::Random& random) {
  const double r = std::sqrt(random.uniform()), q = random.uniform();
  return {static_cast<Index>(random.below(mesh.faces())), {1 - r, r * (1 - q), r * q}};
}

/// Between random points, through faces and vertices; short enough to exist.
std::vector<SurfacePolyline> random_strokes(const ConnectedSurface& s, int count) {
  std::vector<SurfacePolyline> strokes;
  detail::Random random(5);
  while (static_cast<int>(strokes.size()) < count) {
    const SurfacePoint p = random_point(s.mesh(), random);
    const SurfacePoint q = strokes.size() % 3 == 0 ? corner(static_cast<Index>(random.below(s.mesh().halfedges())))
                                                   : random_point(s.mesh(), random);
    if (p.face == q.face || position(s, p).dot(position(s, q)) < -0.8) continue;
    try {
      strokes.push_back(through(s, {p, q}));
    } catch (const OptionError&) {  // a hole is in the way
    }
  }
  return strokes;
}

/// A disk of faces with its boundary as a path of vertices, counter-clockwise, and the curvature inside.
struct Patch {
  std::vector<Index> rim;
  double curvature = 0;
};

/// Grown from a face breadth-first; nothing when that is not a disk.
std::optional<Patch> patch(const ConnectedSurface& s, Index seed, std::size_t size) {
  const Mesh& mesh = s.mesh();
  std::vector<Index> faces{seed};
  for (std::size_t k = 0; k < faces.size() && faces.size() < size; ++k)
    for (Index h = 3 * faces[k]; h < 3 * faces[k] + 3; ++h) {
      const Index g = mesh.twin(h);
      if (g != none && std::find(faces.begin(), faces.end(), g / 3) == faces.end()) faces.push_back(g / 3);
    }
  Faces F(static_cast<Eigen::Index>(faces.size()), 3);
  Patch out;
  for (std::size_t k = 0; k < faces.size(); ++k) {
    F.row(static_cast<Eigen::Index>(k)) = mesh.F().row(faces[k]);
    out.curvature += s.connection().K[faces[k]];
  }
  try {
    const Mesh piece(F, mesh.vertices());
    const Topology topology = find_topology(piece);
    if (topology.loops.size() != 1 || topology.euler() != 1) return std::nullopt;
    for (const Index h : topology.loops[0].halfedges) out.rim.push_back(piece.tail(h));
    out.rim.push_back(out.rim.front());
    return out;
  } catch (const MeshError&) {
    return std::nullopt;
  }
}

/// Twice the area of a polygon of one face in units of twice the face: the part of the face that it holds.
double part_of_face(const std::vector<std::array<double, 3>>& polygon) {
  double sum = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const auto &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
    sum += p[1] * q[2] - p[2] * q[1];
  }
  return sum;
}

/// Where a point on the border of a face lies on the way around it: 1.25 is a quarter along its second halfedge.
double along_border(const std::array<double, 3>& b) {
  for (std::size_t c = 0; c < 3; ++c)
    if (b[(c + 2) % 3] == 0 && b[c] > 0) return static_cast<double>(c) + b[(c + 1) % 3];
  return -1;
}

/// The curvature on the left of a closed path: parts of the faces that it crosses, and all faces beyond them. Nothing
/// when it crosses a face twice or passes through a vertex.
std::optional<double> enclosed(const ConnectedSurface& s, SurfacePolyline loop) {
  auto& segments = loop.segments;
  for (std::size_t k = 0; segments.front().face == segments.back().face && k < segments.size(); ++k)
    std::rotate(segments.begin(), segments.begin() + 1, segments.end());
  std::map<Index, std::vector<std::array<double, 3>>> chains;
  Index last = none;
  for (const SurfaceSegment& segment : segments) {
    if (segment.face != last && chains.count(segment.face) > 0) return std::nullopt;
    last = segment.face;
    auto& chain = chains[last];
    if (chain.empty()) chain.push_back(segment.a);
    chain.push_back(segment.b);
  }
  double sum = 0;
  std::vector<Index> inside;
  std::set<Index> seen;
  for (auto& [t, chain] : chains) {
    const double from = along_border(chain.front());
    double at = along_border(chain.back());
    REQUIRE((from >= 0 && at >= 0));
    if (std::abs(from - std::nearbyint(from)) < 1e-6 || std::abs(at - std::nearbyint(at)) < 1e-6) return std::nullopt;
    for (const double stop = from > at ? from : from + 3; std::floor(at) + 1 <= stop; at = std::floor(at) + 1) {
      const auto c = static_cast<int>(std::floor(at) + 1) % 3;
      inside.push_back(s.mesh().F()(t, c));
      chain.push_back(corner(3 * t + c).barycentric);
    }
    sum += s.connection().K[t] * part_of_face(chain);
    seen.insert(t);
  }
  while (!inside.empty()) {
    const Index v = inside.back();
    inside.pop_back();
    s.mesh().for_each_outgoing(v, [&](Index h) {
      if (!seen.insert(Mesh::face(h)).second) return;
      sum += s.connection().K[Mesh::face(h)];
      for (int c = 0; c < 3; ++c) inside.push_back(s.mesh().F()(Mesh::face(h), c));
    });
  }
  return sum;
}

/// A curve traced from inside a face until it comes back into that face, and straight from there to its start.
std::vector<SurfacePoint> closed_part(const std::vector<SurfacePoint>& points) {
  bool away = false;
  for (std::size_t k = 1; k < points.size(); ++k) {
    if (away && points[k].face == points[0].face) {
      std::vector<SurfacePoint> loop(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(k));
      loop.push_back(points[0]);
      return loop;
    }
    away = away || points[k].face != points[0].face;
  }
  return {};
}

}  // namespace

TEST_CASE("around a face a vector turns by its curvature, lifted, and an n-vector by n times that") {
  for (const Family& family : mesh_families(2)) {
    CAPTURE(family.name);
    for (const ConnectedSurface& s : connections(family.surface)) {
      double worst = 0;
      for (Index t = 0; t < s.mesh().faces(); ++t) {
        const Index h = 3 * t;
        const SurfacePolyline around = through(s, {corner(h), corner(h + 1), corner(h + 2), corner(h)});
        REQUIRE(around.closed);
        const double K = s.connection().K[t], scale = 1 + std::abs(K);
        const Transported once = transport(s, around, C(0.6, 0.8));
        worst = std::max(worst, std::abs(once.z - C(0.6, 0.8) * std::polar(1.0, K)) / scale);
        worst = std::max(worst, std::abs(once.turn_from_path + 2 * pi<double> - K) / scale);
        const Transported many = transport(s, around, 1.0, 30);
        worst = std::max(worst, std::abs(many.z - std::polar(1.0, 30 * K)) / (30 * scale));
      }
      CHECK(worst < 1e-11);
    }
  }
}

TEST_CASE("inside one face the turn itself is the curvature enclosed, which is spread evenly") {
  const ConnectedSurface s = connected(tetrahedron());  // curvature pi in every face
  for (Index t = 0; t < 4; ++t) {
    SurfacePolyline whole;
    for (Index c = 0; c < 3; ++c) {
      SurfaceSegment side{t, {}, {}};
      side.a[static_cast<std::size_t>(c)] = side.b[static_cast<std::size_t>((c + 1) % 3)] = 1;
      whole.segments.push_back(side);
    }
    CHECK(s.connection().K[t] == doctest::Approx(pi<double>));
    CHECK(transport(s, whole, 1.0).turn == doctest::Approx(s.connection().K[t]));
    const auto small =
        through(s, {{t, {0.8, 0.1, 0.1}}, {t, {0.1, 0.8, 0.1}}, {t, {0.1, 0.1, 0.8}}, {t, {0.8, 0.1, 0.1}}});
    CHECK(transport(s, small, 1.0).turn == doctest::Approx(0.49 * s.connection().K[t]));
  }
}

TEST_CASE("around a vertex, through its faces, a vector turns by the curvature that the loop encloses") {
  for (const Family& family : mesh_families(2)) {
    CAPTURE(family.name);
    for (const ConnectedSurface& s : connections(family.surface)) {
      detail::Random random(3);
      const Mesh& mesh = s.mesh();
      double worst = 0;
      for (Index v = 0; v < mesh.vertices(); ++v) {
        if (mesh.boundary_vertex(v)) continue;
        std::vector<SurfacePoint> ring;
        std::vector<double> at;
        std::vector<Index> out;
        mesh.for_each_outgoing(v, [&](Index h) {
          out.push_back(h);
          at.push_back(0.2 + 0.7 * random.uniform());
          ring.push_back(detail::on_halfedge(h, at.back()));
        });
        double enclosed = 0;
        for (std::size_t k = 0; k < out.size(); ++k)
          enclosed += s.connection().K[Mesh::face(out[k])] * at[k] * at[(k + 1) % at.size()];
        ring.push_back(ring.front());
        const Transported round = transport(s, through(s, ring), 1.0);
        worst = std::max(worst, std::abs(round.turn_from_path + 2 * pi<double> - enclosed));
        worst = std::max(worst, error_of_angle(round.turn, enclosed));
        worst = std::max(worst, std::abs(round.z - std::polar(1.0, enclosed)));
      }
      CHECK(worst < 1e-10);
    }
  }
}

TEST_CASE("around a disk, along edges, a vector turns by the curvature inside") {
  for (const Family& family : mesh_families(2)) {
    CAPTURE(family.name);
    for (const ConnectedSurface& s : connections(family.surface)) {
      detail::Random random(4);
      for (int k = 0; k < 30; ++k) {
        const auto seed = static_cast<Index>(random.below(s.mesh().faces()));
        const auto disk = patch(s, seed, 1 + static_cast<std::size_t>(random.below(40)));
        if (!disk) continue;
        const Transported round = transport(s, disk->rim, C(0, 2));
        CHECK(error_of_angle(round.turn, disk->curvature) < 1e-11);
        CHECK(std::abs(round.z - C(0, 2) * std::polar(1.0, disk->curvature)) < 1e-11);
        CHECK(error_of_angle(round.turn_from_path, disk->curvature) < 1e-11);
        CHECK(std::abs(transport(s, disk->rim, 1.0, 4).z - std::polar(1.0, 4 * disk->curvature)) < 1e-11);
      }
    }
  }
}

TEST_CASE("along edges the turn against the path keeps its lift: big patches of a sphere") {
  const ConnectedSurface s = connected(icosphere(3));
  for (const std::size_t size : {1U, 10U, 100U, 400U, 640U, 900U}) {
    const auto disk = patch(s, 17, size);
    REQUIRE(disk);
    CHECK(transport(s, disk->rim, 1.0).turn_from_path + 2 * pi<double> ==
          doctest::Approx(disk->curvature).epsilon(1e-11));
  }
}

TEST_CASE("there and back is the identity; n-vectors turn n times; a cut segment is the same segment") {
  for (const MeshData& data : {jittered_sphere(3, 0.2, 4), bumpy_sphere(3, 0.2, 4), disk(9), noisy_scan(3, 0.2, 3)}) {
    for (const ConnectedSurface& s : connections(data)) {
      for (const SurfacePolyline& path : random_strokes(s, 30)) {
        const C z(0.3, -1.2);
        const Transported there = transport(s, path, z), back = transport(s, path.reversed(), there.z);
        CHECK(std::abs(back.z - z) < 1e-12);
        CHECK(error_of_angle(back.turn, -there.turn) < 1e-12);
        CHECK(back.turn_from_path == doctest::Approx(-there.turn_from_path).epsilon(1e-10).scale(1));
        CHECK(std::abs(std::abs(there.z) - std::abs(z)) < 1e-14);
        const Transported cross = transport(s, path, z * z * z * z, 4);
        CHECK(std::abs(cross.z - std::pow(there.z, 4)) < 1e-11);

        SurfacePolyline cut;
        for (const SurfaceSegment& whole : path.segments) {
          SurfaceSegment first = whole, second = whole;
          first.b = second.a = whole.at(0.3);
          cut.segments.push_back(first);
          cut.segments.push_back(second);
        }
        const Transported same = transport(s, cut, z);
        CHECK(std::abs(same.z - there.z) < 1e-12);
        CHECK(same.turn == doctest::Approx(there.turn).epsilon(1e-12).scale(1));
        CHECK(same.turn_from_path == doctest::Approx(there.turn_from_path).epsilon(1e-12).scale(1));
      }
    }
  }
}

TEST_CASE("on a flat surface a vector stays what it is in space, and never turns against a straight path") {
  for (const MeshData& data : {grid(8, 6, 3, 2), disk(7), fan(9)}) {
    const ConnectedSurface s = connected(data);
    const Frames faces = face_frames(s);
    for (const SurfacePolyline& path : random_strokes(s, 30)) {
      const C z(0.3, -1.2);
      const Transported there = transport(s, path, z);
      const Eigen::RowVector3d before = faces.vector(path.segments.front().face, z);
      CHECK((faces.vector(path.segments.back().face, there.z) - before).norm() < 1e-12);
      CHECK(std::abs(there.turn_from_path) < 1e-8);  // strokes put points within 1e-9 of an edge onto it
    }
    const auto frames = s.frames();
    for (Index to = 1; to < s.mesh().vertices(); to += 3) {
      const Transported there = transport(s, shortest_path(s, 0, to), C(0.3, -1.2));
      CHECK((frames->vector(to, there.z) - frames->vector(0, C(0.3, -1.2))).norm() < 1e-12);
    }
  }
}

TEST_CASE("along edges it is the same from vertex to vertex and through the faces beside them, both ways") {
  for (const Family& family : mesh_families(2)) {
    CAPTURE(family.name);
    for (const ConnectedSurface& s : connections(family.surface)) {
      const Connection& connection = s.connection();
      const Index last = s.mesh().vertices() - 1;
      const std::vector<Index> path = shortest_path(s, last / 2, last);
      if (path.size() < 2) continue;
      for (const int n : {1, 4}) {
        const C z(-0.4, 1.1);
        const Transported by_vertices = transport(s, path, z, n);
        const SurfacePolyline line = stroke_along_vertices(s, path);
        const auto to_face = [&](Index face, const std::array<double, 3>& b) {
          const auto c = std::max_element(b.begin(), b.end()) - b.begin();
          return std::polar(1.0, -n * connection.rho_t[3 * face + c]);
        };
        const auto &first = line.segments.front(), &end = line.segments.back();
        const Transported by_faces = transport(s, line, z * to_face(first.face, first.a), n);
        CHECK(std::abs(by_faces.z - by_vertices.z * to_face(end.face, end.b)) < 1e-11);
        const Transported back = transport(s, {path.rbegin(), path.rend()}, by_vertices.z, n);
        CHECK(std::abs(back.z - z) < 1e-12);
        CHECK(back.turn == doctest::Approx(-by_vertices.turn));
      }
    }
  }
}

TEST_CASE("along an edge the field that is interpolated between parallel values is the parallel one") {
  for (const ConnectedSurface& s : connections(jittered_sphere(2, 0.2, 4))) {
    for (const int n : {1, 2, 4}) {
      for (Index h = 0; h < s.mesh().halfedges(); h += 7) {
        const Index t = Mesh::face(h);
        ComplexVectorX<double> u = ComplexVectorX<double>::Zero(s.mesh().vertices());
        const C z(0.5, 0.7);
        u[s.mesh().tail(h)] = z;
        u[s.mesh().tip(h)] = transport(s, {s.mesh().tail(h), s.mesh().tip(h)}, z, n).z;
        const FaceField field = face_field(s, n, u, t);
        const C start = z * std::polar(1.0, -n * s.connection().rho_t[h]);
        for (const double at : {0.1, 0.5, 0.9}) {
          const SurfacePolyline part = through(s, {corner(h), detail::on_halfedge(h, at)});
          REQUIRE(part.segments[0].face == t);
          CHECK(std::abs(transport(s, part, start, n).z - field.at(detail::on_halfedge(h, at).barycentric).u) < 1e-12);
        }
      }
    }
  }
}

TEST_CASE("around the handles of a flat connection a vector turns by the holonomy of the strip") {
  const MeshData data = torus_random_diagonals(20, 10, 1, 0.4, 2);
  const Surface surface(data.V, data.F);
  for (const auto& holonomies : {std::vector<double>{0, 0}, std::vector<double>{0.25, -0.5}}) {
    const ConnectedSurface s(surface, trivial(surface, {}, {.n = 4, .generator_holonomy = holonomies}));
    for (const Loop& strip : homology_generators(s)) {
      std::vector<SurfacePoint> points;
      for (const Index h : strip.halfedges) {
        points.push_back({Mesh::face(h), {1.0 / 3, 1.0 / 3, 1.0 / 3}});
        points.push_back(detail::on_halfedge(h, 0.4));
      }
      points.push_back(points.front());
      const Transported round = transport(s, through(s, points), 1.0);
      CHECK(error_of_angle(round.turn, holonomy(s, strip)) < 1e-10);
      CHECK(std::abs(transport(s, through(s, points), 1.0, 4).z - 1.0) < 1e-10);
    }
  }
}

TEST_CASE("paths that are none are refused, by the name of what is wrong") {
  const ConnectedSurface s = connected(together(icosphere(1), tetrahedron()));
  const auto field_of = [&](auto&& path) -> std::string {
    try {
      static_cast<void>(transport(s, path, 1.0));
    } catch (const OptionError& error) {
      return error.field();
    }
    return "accepted";
  };
  CHECK(field_of(std::vector<Index>{}) == "vertices");
  CHECK(field_of(std::vector<Index>{0, 43}) == "vertices");
  CHECK(field_of(std::vector<Index>{-1}) == "vertices");
  CHECK(field_of(std::vector<Index>{3}) == "accepted");
  CHECK(transport(s, {3, 3}, C(2, 1)).z == C(2, 1));

  CHECK(field_of(SurfacePolyline{}) == "path.segments");
  SurfacePolyline jump{{{0, {1, 0, 0}, {0.2, 0.2, 0.6}}, {0, {0.3, 0.1, 0.6}, {0, 1, 0}}}};
  CHECK(field_of(jump) == "path.segments[1]");
  jump.segments[1].a = jump.segments[0].b;
  CHECK(field_of(jump) == "accepted");
  jump.closed = true;
  CHECK(field_of(jump) == "path.segments[0]");
  jump.segments[1].face = 80;  // of the tetrahedron
  CHECK(field_of(jump) == "path.segments[1]");
  jump.segments[1].face = 84;
  CHECK(field_of(jump) == "path.segments[1].face");
}

TEST_CASE("around a polygon of points inside a face a vector turns by the part of the face's curvature inside") {
  for (const ConnectedSurface& s : connections(bumpy_sphere(2, 0.3, 5))) {
    detail::Random random(6);
    for (int k = 0; k < 100; ++k) {
      const auto t = static_cast<Index>(random.below(s.mesh().faces()));
      std::vector<SurfacePoint> points;
      std::vector<std::array<double, 3>> polygon;
      for (int i = 0; i < 3 + k % 5; ++i) {
        points.push_back({t, random_point(s.mesh(), random).barycentric});
        polygon.push_back(points.back().barycentric);
      }
      points.push_back(points.front());
      const Transported round = transport(s, points, C(0.6, 0.8), 3);
      const double expected = s.connection().K[t] * part_of_face(polygon);
      CHECK(std::abs(round.turn - expected) < 1e-12);
      CHECK(std::abs(round.z - C(0.6, 0.8) * std::polar(1.0, 3 * expected)) < 1e-12);
    }
  }
}

TEST_CASE("around a polygon of points across an edge a vector turns by the curvature inside, whatever face is named") {
  for (const Family& family : mesh_families(2)) {
    CAPTURE(family.name);
    for (const ConnectedSurface& s : connections(family.surface)) {
      const Mesh& mesh = s.mesh();
      detail::Random random(7);
      for (Index h = 0; h < mesh.halfedges(); ++h) {
        const Index g = mesh.twin(h);
        if (g == none || Mesh::face(g) == Mesh::face(h)) continue;
        const double low = 0.1 + 0.3 * random.uniform(), high = 0.6 + 0.3 * random.uniform();
        const SurfacePoint left = {Mesh::face(h), random_point(mesh, random).barycentric};
        const SurfacePoint right = {Mesh::face(g), random_point(mesh, random).barycentric};
        const auto in_h = [&](double at) { return detail::on_halfedge(h, at); };
        const auto in_g = [&](double at) { return detail::on_halfedge(g, 1 - at); };
        const double expected = s.connection().K[Mesh::face(h)] *
                                    part_of_face({in_h(low).barycentric, in_h(high).barycentric, left.barycentric}) +
                                s.connection().K[Mesh::face(g)] *
                                    part_of_face({in_g(high).barycentric, in_g(low).barycentric, right.barycentric});
        // The points on the edge are named in one face and in the other; the start is one of them, too.
        for (const std::vector<SurfacePoint>& round :
             {std::vector<SurfacePoint>{left, in_h(low), right, in_g(high), left},
              std::vector<SurfacePoint>{in_h(low), right, in_g(high), left, in_g(low), in_h(low)}}) {
          const Transported there = transport(s, round, C(0, 1), 2);
          CHECK(std::abs(there.z - C(0, 1) * std::polar(1.0, 2 * expected)) < 1e-10 * (1 + std::abs(expected)));
        }
      }
    }
  }
}

TEST_CASE("a path of points is the polyline through them, from frame to frame") {
  const ConnectedSurface s = connected(bumpy_sphere(3, 0.2, 4));
  for (const SurfacePolyline& line : random_strokes(s, 40)) {
    std::vector<SurfacePoint> points = {{line.segments.front().face, line.segments.front().a}};
    for (const SurfaceSegment& segment : line.segments) points.push_back({segment.face, segment.b});
    const Transported by_line = transport(s, line, C(1, 2)), by_points = transport(s, points, C(1, 2));
    CHECK(std::abs(by_line.z - by_points.z) < 1e-11);
    CHECK(by_points.turn_from_path == doctest::Approx(by_line.turn_from_path).epsilon(1e-9).scale(1));
    const SurfacePolyline same = polyline_through(s, points);
    CHECK(same.length() == doctest::Approx(line.length()));
  }
  const std::vector<SurfacePoint> apart = {{0, {1, 0, 0}}, {s.mesh().faces() - 1, {0.2, 0.3, 0.5}}};
  CHECK_THROWS_WITH_AS(static_cast<void>(transport(s, apart, 1.0)), doctest::Contains("no face holds both"),
                       OptionError);
  CHECK_THROWS_AS(static_cast<void>(transport(s, std::vector<SurfacePoint>{}, 1.0)), OptionError);
  CHECK_THROWS_AS(static_cast<void>(polyline_through(s, {{0, {2, -1, 0}}})), OptionError);
}

TEST_CASE("from one name of a point to another a vector changes its frame and nothing else") {
  const ConnectedSurface s = connected(jittered_sphere(2, 0.2, 4));
  for (Index h = 0; h < s.mesh().halfedges(); ++h) {
    const Index g = s.mesh().twin(h), k = s.mesh().twin(Mesh::prev(h));
    const std::vector<SurfacePoint> edge = {detail::on_halfedge(h, 0.3), detail::on_halfedge(g, 0.7)};
    const double expected = detail::edge_to_face_at(s.mesh(), s.connection(), h, 0.3) -
                            detail::edge_to_face_at(s.mesh(), s.connection(), g, 0.7) + pi<double>;
    CHECK(error_of_angle(transport(s, edge, 1.0).turn, expected) < 1e-12);
    const std::vector<SurfacePoint> vertex = {corner(h), corner(k)};
    CHECK(error_of_angle(transport(s, vertex, 1.0).turn, s.connection().rho_t[h] - s.connection().rho_t[k]) < 1e-12);
  }
}

TEST_CASE("along closed streamlines a vector turns by the curvature on their left") {
  for (const MeshData& data : {icosphere(3), jittered_sphere(3, 0.2, 4), bumpy_sphere(3, 0.1, 3)}) {
    for (const ConnectedSurface& s : connections(data)) {
      // Turning around the z axis.
      Field field{.n = 1, .u = ComplexVectorX<double>(s.mesh().vertices()), .frames = s.frames()};
      for (Index v = 0; v < s.mesh().vertices(); ++v)
        field.u[v] = s.frames()->component(v, Eigen::RowVector3d::UnitZ().cross(Eigen::RowVector3d(s.V().row(v))));
      std::vector<CurveSeed> seeds;
      const Frames faces = face_frames(s);
      for (Index t = 3; t < s.mesh().faces(); t += 97) {
        const SurfacePoint p{t, {0.3, 0.4, 0.3}};
        const Eigen::RowVector3d x = position(s, p);
        if (std::abs(x.z()) > 0.8) continue;
        seeds.push_back({p, std::arg(faces.component(t, Eigen::RowVector3d::UnitZ().cross(x)))});
      }
      const CurveSet curves = trace_curves(s, field, seeds, {.sides = CurveSides::forward});
      int closed = 0;
      for (std::int64_t k = 0; k < curves.size(); ++k) {
        const std::vector<SurfacePoint> loop = closed_part(curves.path(k));
        if (loop.size() < 10) continue;
        const SurfacePolyline line = polyline_through(s, loop);
        REQUIRE(line.closed);
        const std::optional<double> expected = enclosed(s, line);
        if (!expected) continue;
        ++closed;
        CHECK(error_of_angle(transport(s, loop, 1.0).turn, *expected) < 1e-9);
        CHECK(transport(s, loop, 1.0).turn_from_path + 2 * pi<double> == doctest::Approx(*expected).epsilon(1e-9));
      }
      CHECK(closed > 4);
    }
  }
}
