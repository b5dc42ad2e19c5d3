// SPDX-License-Identifier: MIT
//
// Connected surfaces: options choose the connection, frames are made once, and functions on surfaces give the bits of
// those on the parts.
#include "alcap/connected_surface.h"

#include <doctest/doctest.h>

#include <array>
#include <thread>

#include "alcap/cones.h"
#include "alcap/generators.h"

using namespace alcap;

namespace {

Surface surface_of(const MeshData& s) { return {s.V, s.F}; }

void check_same(const Connection& a, const Connection& b) {
  CHECK(a.kind == b.kind);
  CHECK(a.rho == b.rho);
  CHECK(a.rho_e == b.rho_e);
  CHECK(a.rho_t == b.rho_t);
  CHECK(a.tau == b.tau);
  CHECK(a.eps == b.eps);
  CHECK(a.K == b.K);
  CHECK(a.alpha == b.alpha);
}

Surface intrinsic() {
  const FlatTorus torus = flat_torus(6, 4);
  const Mesh mesh(torus.F, torus.vertices);
  VectorX<double> lengths(mesh.edges());
  for (Index e = 0; e < mesh.edges(); ++e) lengths[e] = torus.lengths.data()[mesh.halfedge(e)];
  return Surface::from_lengths(mesh, lengths);
}

}  // namespace

TEST_CASE("options choose the connection, the same as the functions on mesh and geometry give") {
  const Surface s = surface_of(bumpy_sphere(3, 0.3, 3));
  const Mesh& mesh = s.mesh();
  const Geometry& geometry = s.geometry();
  const GlobalOptions detail{.detail = 0.3};
  check_same(connect(s).connection(), globally_optimal(mesh, geometry));
  check_same(connect(s, {.global = detail}).connection(), globally_optimal(mesh, geometry, detail));
  check_same(connect(s, {.kind = ConnectionKind::local}).connection(), locally_optimal(mesh, geometry));
  const PolarOptions center{PolarCenter::barycenter};
  check_same(connect(s, {.kind = ConnectionKind::polar, .polar = center}).connection(), polar(mesh, geometry, center));
  const std::vector<Cone> cones = {{0, 1.0}, {5, 0.5}, {100, 0.5}};
  const Connection flat = trivial(mesh, geometry, cones, {.n = 2});
  const Connection chosen = connect(s, {.kind = ConnectionKind::trivial, .cones = cones, .n = 2}).connection();
  check_same(chosen, flat);
  CHECK(chosen.cones.size() == 3);

  check_same(polar(s), polar(mesh, geometry));
  check_same(locally_optimal(s), locally_optimal(mesh, geometry));
  check_same(globally_optimal(s, detail), globally_optimal(mesh, geometry, detail));
  check_same(trivial(s, cones, {.n = 2}), flat);
}

TEST_CASE("the weights of the options measure every kind of connection") {
  const Surface s = surface_of(bumpy_sphere(2, 0.3, 3));
  const GlobalOptions weights{.length_factor = LengthFactor::per_edge};
  for (const ConnectionKind kind : {ConnectionKind::local, ConnectionKind::polar}) {
    Connection expected = kind == ConnectionKind::local ? locally_optimal(s) : polar(s);
    measure_deviation(s.mesh(), s.geometry(), weights, expected);
    CHECK(connect(s, {.kind = kind, .global = weights}).connection().report.D_E == expected.report.D_E);
    CHECK(connect(s, {.kind = kind}).connection().report.D_E != expected.report.D_E);
  }
}

TEST_CASE("balanced cones are in the connection") {
  const Surface s = surface_of(bumpy_sphere(3, 0.3, 3));
  const std::vector<Cone> expected = balance_cones(s.mesh(), s.geometry(), {{7, 0.5}}, {.n = 4});
  const ConnectedSurface connected =
      connect(s, {.kind = ConnectionKind::trivial, .cones = {{7, 0.5}}, .balance_cones = true, .n = 4});
  const std::vector<Cone>& cones = connected.connection().cones;
  REQUIRE(cones.size() == expected.size());
  CHECK(cones.size() == 7);
  for (std::size_t k = 0; k < cones.size(); ++k) {
    CHECK(cones[k].vertex == expected[k].vertex);
    CHECK(cones[k].index == expected[k].index);
  }
  CHECK_THROWS_AS((void)connect(s, {.kind = ConnectionKind::trivial, .cones = {{7, 0.5}}, .n = 4}), OptionError);
}

TEST_CASE("frames are made once, by whoever asks first") {
  for (int round = 0; round < 20; ++round) {
    const ConnectedSurface s = connect(surface_of(icosphere(3)), {.kind = ConnectionKind::polar});
    const ConnectedSurface copy = s;
    std::array<std::shared_ptr<const Frames>, 4> frames;
    std::vector<std::thread> threads;
    for (std::size_t k = 0; k < frames.size(); ++k)
      threads.emplace_back([&, k] { frames[k] = (k % 2 == 0 ? s : copy).frames(); });
    for (std::thread& thread : threads) thread.join();
    for (const auto& f : frames) CHECK(f == frames[0]);
    const Frames expected = vertex_frames(s.mesh(), s.V(), s.connection());
    CHECK(*frames[0] == expected);
  }
}

TEST_CASE("frames outlive the surface, and the surface the handle it was made from") {
  std::shared_ptr<const Frames> frames;
  ConnectedSurface kept;
  {
    const Surface s = surface_of(icosphere(2));
    kept = connect(s);
    CHECK(&kept.mesh() == &s.mesh());
    frames = kept.frames();
  }
  CHECK(kept.mesh().vertices() == 162);
  kept = {};
  CHECK(frames->X.rows() == 162);
}

TEST_CASE("an intrinsic surface has a connection and no frames") {
  const ConnectedSurface s = connect(intrinsic());
  CHECK(s.connection().K.cwiseAbs().maxCoeff() < 1e-12);
  try {
    (void)s.frames();
    FAIL("frames without points");
  } catch (const OptionError& e) {
    CHECK(e.field() == "surface");
  }
  CHECK_THROWS_AS((void)face_frames(s), OptionError);
}

TEST_CASE("a connection of another mesh is refused, naming the array") {
  const Surface s = surface_of(icosphere(2));
  Connection other = polar(surface_of(icosphere(1)));
  try {
    const ConnectedSurface wrong(s, other);
    FAIL("a connection of another mesh was accepted");
  } catch (const OptionError& e) {
    CHECK(e.field() == "connection.rho");
  }
  other = polar(s);
  other.K.resize(0);
  CHECK_THROWS_AS((void)ConnectedSurface(s, other), OptionError);
}

TEST_CASE("holonomy and face frames are the same on a surface as on its parts") {
  const ConnectedSurface s = connect(surface_of(torus(16, 10, 1, 0.4)));
  for (const Loop& loop : homology_generators(s))
    CHECK(holonomy(s, loop) == holonomy(s.mesh(), s.geometry(), s.connection(), loop));
  CHECK(face_frames(s) == face_frames(s.mesh(), s.V()));
}
