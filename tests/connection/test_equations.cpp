// SPDX-License-Identifier: MIT
//
// The numbered equations of LTGD 2016, Secs. 4 and 5, as the paper states them, computed here from positions in space.
// docs/notation.md says which test proves what.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "tests/support/mesh_case.h"

using namespace alcap;

namespace {

using test::MeshCase;

MeshCase round() { return MeshCase(jittered_sphere(3, 0.2, 5)); }

/// Angle from the axis of the frame of face t (along halfedge 3 t) to a vector in space, counter-clockwise.
double angle_in_face(const MeshCase& s, Index t, const Eigen::RowVector3d& w) {
  const auto point = [&](int c) -> Eigen::RowVector3d { return s.surface.V.row(s.mesh.F()(t, c)); };
  const Eigen::RowVector3d X = (point(1) - point(0)).normalized();
  const Eigen::RowVector3d N = (point(1) - point(0)).cross(point(2) - point(0)).normalized();
  return std::atan2(w.dot(N.cross(X)), w.dot(X));
}

Eigen::RowVector3d edge_vector(const MeshCase& s, Index h) {
  return s.surface.V.row(s.mesh.tip(h)) - s.surface.V.row(s.mesh.tail(h));
}

/// rho_{e->t} at the fraction x of halfedge h, as eq. 9 interpolates it, less the angle of eq. 10, near zero.
double deviation_at(const MeshCase& s, const Connection& c, Index h, double x) {
  const double start = c.rho_t[h] - c.rho_start(s.mesh, h);
  const double end = c.rho_t[Mesh::next(h)] - c.rho_end(s.mesh, h);
  const double levi_civita = -angle_in_face(s, h / 3, edge_vector(s, h));
  return (1 - x) * wrap(start - levi_civita) + x * wrap(end - levi_civita);
}

}  // namespace

TEST_CASE("eq. 6 and 11: around a vertex of the polar map, edges turn by the corner times 2 pi / the sum of corners") {
  const MeshCase s = round();
  const Connection c = polar(s.mesh, s.geometry);
  double worst = 0;
  for (Index h = 0; h < s.mesh.halfedges(); ++h) {
    const Index v = s.mesh.tail(h), next = s.mesh.twin(Mesh::prev(h));
    const double scale = 2 * pi<double> / s.geometry.angle_sum(v);
    const double turn = c.rho_start(s.mesh, next) - c.rho_start(s.mesh, h);
    worst = std::max(worst, std::abs(wrap(turn - scale * s.geometry.angle(h))));
  }
  CHECK(worst < 1e-13);
}

TEST_CASE("eq. 7: transport along an edge is the same by the edge and by either face") {
  const MeshCase s = round();
  for (const Connection& c :
       {polar(s.mesh, s.geometry), locally_optimal(s.mesh, s.geometry), globally_optimal(s.mesh, s.geometry)}) {
    double worst = 0;
    for (Index h = 0; h < s.mesh.halfedges(); ++h) {
      const double by_edge = c.rho_start(s.mesh, h) + c.eps_along(s.mesh, h) - c.rho_end(s.mesh, h);
      const double by_face = c.rho_t[h] + c.tau[h] - c.rho_t[Mesh::next(h)];
      worst = std::max(worst, std::abs(wrap(by_edge - by_face)));
    }
    CHECK(worst < 1e-12);
  }
}

TEST_CASE("eq. 9 and 10: D_E is the integral of the squared difference of both, over the edges of all faces") {
  const MeshCase s = round();
  const double mean_length = s.geometry.lengths().mean();
  for (const Connection& c : {polar(s.mesh, s.geometry), globally_optimal(s.mesh, s.geometry)}) {
    double sum = 0;
    for (Index h = 0; h < s.mesh.halfedges(); ++h) {
      const double angle = s.geometry.angle(Mesh::prev(h));
      const double tangent = angle < pi<double> / 2 ? std::min(std::tan(angle), 10.0) : 10.0;
      const auto square = [&](double x) { return std::pow(deviation_at(s, c, h, x), 2); };
      const double mean = (square(0) + 4 * square(0.5) + square(1)) / 6;  // Simpson: exact for squares of lines
      sum += tangent * s.geometry.length(s.mesh.edge(h)) / mean_length * mean;
    }
    CHECK(c.report.D_E == doctest::Approx(sum).epsilon(1e-10));
  }
}

TEST_CASE("eq. 12: rho_{v->t} goes through the direction of a point of the face, incenter or barycenter") {
  const MeshCase s = round();
  for (const PolarCenter center : {PolarCenter::incenter, PolarCenter::barycenter}) {
    const Connection c = polar(s.mesh, s.geometry, {.center = center});
    double worst = 0;
    for (Index h = 0; h < s.mesh.halfedges(); ++h) {
      const Index t = h / 3, v = s.mesh.tail(h);
      Eigen::RowVector3d point = Eigen::RowVector3d::Zero();
      double weights = 0;
      for (Index k = 0; k < 3; ++k) {
        // The incenter weighs each corner by the length of the opposite edge.
        const double weight = center == PolarCenter::barycenter ? 1 : edge_vector(s, 3 * t + (k + 1) % 3).norm();
        point += weight * s.surface.V.row(s.mesh.F()(t, k));
        weights += weight;
      }
      const Eigen::RowVector3d direction = point / weights - s.surface.V.row(v);
      const double scaled_half = pi<double> / s.geometry.angle_sum(v) * s.geometry.angle(h);
      const double to_point = c.rho_start(s.mesh, h) + scaled_half;  // rho_{vi->c}
      const double expected = to_point - angle_in_face(s, t, direction);
      worst = std::max(worst, std::abs(wrap(c.rho_t[h] - expected)));
    }
    CHECK(worst < 1e-12);
  }
}

TEST_CASE("eq. 13: the locally optimal rho_{v->t} is the mean of the three that keep one corner of the polar map") {
  const MeshCase s = round();
  const Connection start = polar(s.mesh, s.geometry), c = locally_optimal(s.mesh, s.geometry);
  double worst = 0;
  for (Index t = 0; t < s.mesh.faces(); ++t) {
    for (Index q = 0; q < 3; ++q) {
      double turn = 0;
      for (Index kept = 0; kept < 3; ++kept) {
        // From the kept corner i to q: along i -> q if that is a halfedge of the face, else against q -> i.
        const bool forward = q == (kept + 1) % 3;
        const Index h = 3 * t + (forward ? kept : q);
        const double along = (forward ? 1 : -1) * (-c.K[t] / 3 - start.rho_along(s.mesh, h));  // tau_iq + rho_qi
        const double rho_q = kept == q ? start.rho_t[3 * t + q] : start.rho_t[3 * t + kept] + along;
        turn += wrap(rho_q - start.rho_t[3 * t + q]) / 3;
      }
      worst = std::max(worst, std::abs(wrap(c.rho_t[3 * t + q] - start.rho_t[3 * t + q] - turn)));
    }
  }
  CHECK(worst < 1e-12);
}
