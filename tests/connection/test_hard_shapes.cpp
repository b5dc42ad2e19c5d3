// SPDX-License-Identifier: MIT
//
// Shapes on which the start of the globally optimal connection is nearly its optimum, on which boundaries turn by more
// than half a turn at a vertex, and cones of open surfaces.
#include <doctest/doctest.h>

#include <Eigen/QR>
#include <algorithm>

#include <cmath>
#include <string>
#include <vector>

#include "alcap/cones.h"
#include "alcap/connected_surface.h"
#include "alcap/field.h"
#include "alcap/generators.h"
#include "alcap/singularities.h"
#include "alcap/smoothest.h"
#include "src/base/random.h"
#include "tests/support/mesh_families.h"

using namespace alcap;

namespace {

/// As a file with so many decimals would hold it, turned first.
MeshData rounded(MeshData m, int decimals, std::uint64_t seed) {
  detail::Random random(seed);
  Eigen::Matrix3d turn;
  for (int i = 0; i < 9; ++i) turn(i / 3, i % 3) = random.uniform() - 0.5;
  const Eigen::Matrix3d rotation = Eigen::HouseholderQR<Eigen::Matrix3d>(turn).householderQ();
  const double unit = std::pow(10.0, decimals);
  m.V = ((m.V * rotation) * unit).array().round() / unit;
  return m;
}

/// A closed cylinder, or two cones where the ends are far out.
MeshData rod(Index sides, double height, double tip) {
  MeshData m{Positions<double>(2 * sides + 2, 3), Faces(4 * sides, 3)};
  for (Index k = 0; k < sides; ++k) {
    const double a = 2 * pi<double> * k / sides;
    m.V.row(2 * k) << std::cos(a), std::sin(a), 0;
    m.V.row(2 * k + 1) << std::cos(a), std::sin(a), height;
    const Index p = 2 * k, q = 2 * ((k + 1) % sides);
    m.F.row(4 * k) << p, q, q + 1;
    m.F.row(4 * k + 1) << p, q + 1, p + 1;
    m.F.row(4 * k + 2) << q, p, 2 * sides;
    m.F.row(4 * k + 3) << p + 1, q + 1, 2 * sides + 1;
  }
  m.V.row(2 * sides) << 0, 0, -tip;
  m.V.row(2 * sides + 1) << 0, 0, height + tip;
  return m;
}

/// Without the faces `gone`.
MeshData without(const MeshData& m, const std::vector<Index>& gone) {
  MeshData out{m.V, Faces(m.F.rows() - static_cast<Eigen::Index>(gone.size()), 3)};
  Eigen::Index row = 0;
  for (Index t = 0; t < m.F.rows(); ++t)
    if (std::find(gone.begin(), gone.end(), t) == gone.end()) out.F.row(row++) = m.F.row(t);
  return out;
}

/// A ring of vertices around one that stands out.
MeshData spike(int ring, double height, detail::Random& random) {
  MeshData m{Positions<double>(ring + 1, 3), Faces(ring, 3)};
  for (int k = 0; k < ring; ++k) {
    const double a = 2 * pi<double> * (k + 0.6 * random.uniform()) / ring, r = 0.3 + random.uniform();
    m.V.row(k) << r * std::cos(a), r * std::sin(a), 0.3 * random.uniform();
    m.F.row(k) << k, (k + 1) % ring, ring;
  }
  m.V.row(ring) << random.uniform() - 0.5, random.uniform() - 0.5, height * random.uniform();
  return m;
}

void check_sums(const ConnectedSurface& s, int n, std::uint64_t seed) {
  detail::Random random(seed);
  Field field{.n = n, .u = ComplexVectorX<double>(s.mesh().vertices()), .frames = s.frames()};
  for (Index v = 0; v < s.mesh().vertices(); ++v) field.u[v] = {random.uniform() - 0.5, random.uniform() - 0.5};
  const std::vector<int> indices = face_indices(s.mesh(), s.connection(), field);
  for (const IndexSum& sum :
       index_sums(s.mesh(), s.geometry(), s.connection(), field, indices, find_topology(s.mesh())))
    CHECK(sum.sum == sum.expected);
}

}  // namespace

TEST_CASE("solids, rods and cones of few digits have a converged connection") {
  std::vector<test::Family> shapes{{"tetrahedron", tetrahedron()},
                                   {"cube", cube()},
                                   {"icosahedron", icosphere(0)},
                                   {"sphere", icosphere(2)},
                                   {"grid", grid(6, 4)}};
  for (const Index sides : {3, 12, 48})
    for (const double height : {0.1, 10.0})
      for (const double tip : {0.0, 1.0})
        shapes.push_back({"rod " + std::to_string(sides) + " " + std::to_string(height) + " " + std::to_string(tip),
                          rod(sides, height, tip)});
  for (const auto& [name, shape] : shapes)
    for (const int decimals : {6, 9, 12, 15}) {
      const std::string shown = name;
      CAPTURE(shown);
      CAPTURE(decimals);
      const MeshData m = rounded(shape, decimals, 5);
      const Surface surface(m.V, m.F);
      const Connection global = globally_optimal(surface);
      CAPTURE(global.report.residual);
      CHECK(global.report.converged);
      const ConnectedSurface trivial =
          connect(surface, {.kind = ConnectionKind::trivial, .balance_cones = true, .n = 1});
      CAPTURE(trivial.connection().report.residual);
      CHECK(trivial.connection().report.converged);
    }
}

TEST_CASE("a connection that is far from its tolerance says so") {
  const MeshData m = noisy_scan(3, 0.3, 7);
  const Surface surface(m.V, m.F);
  const Connection c = globally_optimal(surface, {.max_iterations = 3});
  CHECK(!c.report.converged);
  CHECK(c.report.residual > 1e-8);
  CHECK(c.report.message.find("GlobalOptions::max_iterations") != std::string::npos);
}

TEST_CASE("indices sum to what topology demands where boundaries turn by any angle at a vertex") {
  detail::Random random(3);
  for (int trial = 0; trial < 400; ++trial) {
    const MeshData m = spike(3 + trial % 5, trial % 2 == 0 ? 6.0 : 1.0, random);
    CAPTURE(trial);
    const Surface surface(m.V, m.F);
    for (const auto kind :
         {ConnectionKind::polar, ConnectionKind::local, ConnectionKind::global, ConnectionKind::trivial})
      for (const int n : {1, 2, 4}) check_sums(connect(surface, {.kind = kind, .n = n}), n, 7);
  }
}

TEST_CASE("indices sum to what topology demands around holes of one and two faces") {
  const MeshData whole = icosphere(2);
  const Surface closed(whole.V, whole.F);
  const Index other = Mesh::face(closed.mesh().twin(0));
  for (const std::vector<Index>& gone : {std::vector<Index>{0}, {0, other}, {0, 100}, {0, other, 200}}) {
    const MeshData m = without(whole, gone);
    const Surface surface(m.V, m.F);
    for (const auto kind : {ConnectionKind::local, ConnectionKind::global, ConnectionKind::trivial})
      for (const int n : {1, 2, 4}) {
        CAPTURE(n);
        check_sums(connect(surface, {.kind = kind, .n = n}), n, 9);
        check_sums(connect(surface, {.kind = kind, .balance_cones = kind == ConnectionKind::trivial, .n = n}), n, 9);
      }
  }
}

TEST_CASE("balanced cones of open surfaces are where the curvature is, as on the closed ones") {
  const MeshData whole = icosphere(2);
  for (const int n : {1, 2, 4}) {
    const Surface closed(whole.V, whole.F);
    const std::vector<Cone> all = balance_cones(closed, {}, {.n = n});
    for (const std::vector<Index>& gone : {std::vector<Index>{0}, {0, 100}, {0, 50, 100, 150, 200}}) {
      const MeshData m = without(whole, gone);
      const Surface open(m.V, m.F);
      const std::vector<Cone> cones = balance_cones(open, {}, {.n = n});
      double sum = 0;
      for (const Cone& c : cones) {
        sum += c.index;
        CHECK(!open.mesh().boundary_vertex(c.vertex));
      }
      // A hole of one face has the curvature of that face: its loop turns by -1 and a little.
      CHECK(sum == doctest::Approx(2));
      CHECK(cones.size() == all.size());
      const Connection c = trivial(open, cones, {.n = n});
      CHECK(c.K.cwiseAbs().sum() < 2 * pi<double> * 2 + 1e-6);
    }
  }
  // Flat pieces need none, whatever their outline; strips without inner vertices cannot have any.
  for (const MeshData& m : {grid(5, 4), disk(3), cylinder(12, 4), grid(7, 1), single_triangle()}) {
    const Surface open(m.V, m.F);
    for (const int n : {1, 2, 4}) CHECK(balance_cones(open, {}, {.n = n}).empty());
  }
}
