// SPDX-License-Identifier: MIT
//
// Fields along edges: the restriction of the field in the faces on both sides, differentiated as the connection says.
#include <doctest/doctest.h>

#include "alcap/transport.h"
#include "tests/energy/operators_fixture.h"
#include "tests/support/mesh_families.h"

using namespace alcap;
using namespace alcap::test;

namespace {

/// Component of the edge in the face of halfedge h at the fraction s.
C into_face(const MeshCase& s, const Connection& c, int n, Index h, double at, const C& z) {
  return z * std::exp(-I * (n * edge_to_face(s.mesh, c, h, at)));
}

/// Meshes with boundary, slivers and pieces, with an optimal and with an arbitrary connection.
template <class Body>
void for_cases(Body&& body) {
  for (const Family& family : mesh_families(2)) {
    CAPTURE(family.name);
    const MeshCase s(family.surface);
    detail::Random random(11);
    const Connection optimal = globally_optimal(s.mesh, s.geometry);
    const Vec u = random_field(s.mesh, random);
    body(s, optimal, u);
    body(s, scrambled(s.mesh, optimal, 0.7, random), u);
  }
}

}  // namespace

TEST_CASE("eq. 9: on an edge the field is that of the faces on both sides, turned by rho_{e->t} there") {
  for_cases([](const MeshCase& s, const Connection& c, const Vec& u) {
    double worst = 0, worst_slope = 0;
    for (const int n : {1, 2, 4, -3}) {
      for (Index h = 0; h < s.mesh.halfedges(); h += 3) {
        const EdgeField edge = edge_field(s.mesh, s.geometry, c, n, u, h);
        for (const double at : {0.0, 0.13, 0.5, 0.8, 1.0}) {
          const EdgeValue here = edge.at(at);
          for (const Index g : {h, s.mesh.twin(h)}) {
            if (g == none) continue;
            const double there = g == h ? at : 1 - at;
            const FieldValue face =
                face_field(s.mesh, s.geometry, c, n, u, Mesh::face(g)).at(detail::on_halfedge(g, there).barycentric);
            // The frame along the twin is turned by pi, and so is the direction of the derivative.
            const C turn = g == h ? C(1) : std::exp(-I * (n * pi<double>));
            const C slope = face.derivative(std::polar(1.0, s.geometry.direction(g))) * (g == h ? 1.0 : -1.0);
            worst = std::max(worst, std::abs(into_face(s, c, n, g, there, turn * here.u) - face.u));
            worst_slope =
                std::max(worst_slope, edge.length * std::abs(into_face(s, c, n, g, there, turn * here.along) - slope));
          }
        }
      }
    }
    CHECK(worst < 1e-11);
    CHECK(worst_slope < 1e-7);  // gradients in slivers
  });
}

TEST_CASE("the derivative along an edge is that of components carried back in parallel") {
  for_cases([](const MeshCase& s, const Connection& c, const Vec& u) {
    double worst = 0;
    for (const int n : {1, 4}) {
      for (Index h = 1; h < s.mesh.halfedges(); h += 5) {
        const EdgeField edge = edge_field(s.mesh, s.geometry, c, n, u, h);
        const double eps = c.eps_along(s.mesh, h), step = 1e-5;
        for (const double at : {0.2, 0.6}) {
          const C before = edge.at(at - step).u * std::exp(-I * (n * eps * step));
          const C behind = edge.at(at + step).u * std::exp(I * (n * eps * step));
          worst = std::max(worst, std::abs((behind - before) / (2 * step) - edge.at(at).along * edge.length));
        }
      }
    }
    CHECK(worst < 1e-8);
  });
}

TEST_CASE("at its ends the field on an edge is the vertex's, and between parallel values it is parallel") {
  for_cases([](const MeshCase& s, const Connection& c, const Vec& u) {
    for (Index h = 0; h < s.mesh.halfedges(); h += 7) {
      Vec v = u;
      // Components turn by -rho_ij along the edge.
      v[s.mesh.tip(h)] = v[s.mesh.tail(h)] * std::exp(-I * (2 * c.rho_along(s.mesh, h)));
      const EdgeField edge = edge_field(s.mesh, s.geometry, c, 2, v, h);
      CHECK(std::abs(edge.at(0).u - v[s.mesh.tail(h)] * std::exp(-I * (2 * c.rho_start(s.mesh, h)))) < 1e-13);
      CHECK(std::abs(edge.at(1).u - v[s.mesh.tip(h)] * std::exp(-I * (2 * c.rho_end(s.mesh, h)))) < 1e-13);
      CHECK(edge.length * std::abs(edge.at(0.4).along) < 1e-11);
      CHECK(std::abs(edge.at(0.4).u) == doctest::Approx(std::abs(v[s.mesh.tail(h)])));
    }
  });
}

TEST_CASE("the integral of the field along the edges of a face is the edge-based operator of the face") {
  const MeshCase s(bumpy_sphere(2, 0.3, 5));
  const Connection c = globally_optimal(s.mesh, s.geometry);
  detail::Random random(3);
  const Vec u = random_field(s.mesh, random);
  const Vec p = apply(s.mesh, first_order_operators(s.mesh, s.geometry, c, {1, OperatorKind::edge}).p, u);
  const auto rule = gauss(12);
  for (Index t = 0; t < s.mesh.faces(); ++t) {
    C sum = 0;  // flux to the right of the edge plus i circulation
    for (Index h = 3 * t; h < 3 * t + 3; ++h) {
      const EdgeField edge = edge_field(s.mesh, s.geometry, c, 1, u, h);
      for (const auto& [x, w] : rule) sum += w * edge.length * I * edge.at(x).u;
    }
    CHECK(std::abs(sum - p[t]) < 1e-12);
  }
}

TEST_CASE("what is no halfedge and no field is refused by name") {
  const MeshCase s(icosphere(1));
  const Connection c = polar(s.mesh, s.geometry);
  const Vec u = Vec::Ones(s.mesh.vertices());
  CHECK_THROWS_WITH_AS(static_cast<void>(edge_field(s.mesh, s.geometry, c, 1, u, s.mesh.halfedges())),
                       doctest::Contains("'h'"), OptionError);
  CHECK_THROWS_WITH_AS(static_cast<void>(edge_field(s.mesh, s.geometry, c, 1, u.head(3), 0)), doctest::Contains("'u'"),
                       OptionError);
  CHECK_THROWS_AS(static_cast<void>(edge_to_face(s.mesh, c, -1, 0.5)), OptionError);
}
