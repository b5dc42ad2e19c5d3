// SPDX-License-Identifier: MIT
//
// From values per face to values per vertex.
#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "alcap/field.h"
#include "alcap/surface_path.h"
#include "src/base/random.h"
#include "tests/support/mesh_families.h"
#include "tests/support/surfaces.h"

using namespace alcap;
using namespace alcap::test;

namespace {

using C = Complex<double>;

ComplexVectorX<double> random_values(Eigen::Index count, std::uint64_t seed) {
  detail::Random random(seed);
  ComplexVectorX<double> u(count);
  for (C& z : u) z = {random.uniform() - 0.5, random.uniform() - 0.5};
  return u;
}

/// The gradient of the sphere's function xy + 2 z + z^3 - 3 z x^2 times r, plus its turn by a right angle times q.
Eigen::RowVector3d tangent_field(const Eigen::RowVector3d& at, double r, double q) {
  const Eigen::RowVector3d p = at.normalized();
  const double x = p.x(), y = p.y(), z = p.z();
  const Eigen::RowVector3d gradient(y - 6 * z * x, x, 2 + 3 * z * z - 3 * x * x);
  const Eigen::RowVector3d g = gradient - gradient.dot(p) * p;
  return r * g + q * p.cross(g);
}

struct Errors {
  double mean = 0, worst = 0;
};

/// Of at_vertices() for that field sampled at barycenters, against the field at the vertices, as n-vectors.
Errors sphere_error(const MeshData& data, int n) {
  const ConnectedSurface s = connected(data);
  const auto frames = std::make_shared<const Frames>(face_frames(s));
  Positions<double> there(s.mesh().faces(), 3), here(s.mesh().vertices(), 3);
  for (Index t = 0; t < s.mesh().faces(); ++t)
    there.row(t) = tangent_field(position(s, {t, {1.0 / 3, 1.0 / 3, 1.0 / 3}}), 0.3, 0.2);
  for (Index v = 0; v < s.mesh().vertices(); ++v) here.row(v) = tangent_field(s.V().row(v), 0.3, 0.2);
  const Field found = at_vertices(s, from_vectors(n, there, frames)), exact = from_vectors(n, here, s.frames());
  const VectorX<double> error = (found.u - exact.u).cwiseAbs();
  return {std::sqrt(error.squaredNorm() / static_cast<double>(error.size())), error.maxCoeff()};
}

}  // namespace

TEST_CASE("at_vertices: constant fields of flat surfaces are exact, up to and on the boundary, n = 1, 2, 4, 6") {
  for (const MeshData& data : {grid(7, 5, 3, 2), disk(6), fan(7), single_triangle()}) {
    const ConnectedSurface s = connected(data);
    const auto frames = std::make_shared<const Frames>(face_frames(s));
    const Eigen::RowVector3d vector(0.6, -1.1, 0);
    for (const int n : {1, 2, 4, 6}) {
      const Field faces = from_vectors(n, Positions<double>(vector.replicate(s.mesh().faces(), 1)), frames);
      const Field exact = from_vectors(n, Positions<double>(vector.replicate(s.mesh().vertices(), 1)), s.frames());
      const Field found = at_vertices(s, faces);
      CHECK(found.n == n);
      CHECK(found.frames == s.frames());
      CHECK((found.u - exact.u).cwiseAbs().maxCoeff() < 1e-12 * std::abs(exact.u[0]));
    }
  }
}

TEST_CASE("at_vertices is the inverse of at_faces for parallel fields, curved surfaces included") {
  const MeshData bent = torus_random_diagonals(16, 8, 1, 0.4, 2);
  const Surface surface(bent.V, bent.F), square = flat_torus_surface(9, 7);
  const ConnectedSurface glued = connect(  // drawn somewhere, though flat
      Surface::from_lengths(square.mesh(), square.geometry().lengths(), torus(9, 7, 1, 0.4).V));
  for (const int n : {1, 2, 4, 6}) {
    const auto flat = [&](const std::vector<double>& turns) {
      return ConnectedSurface(surface, trivial(surface, {}, {.n = n, .generator_holonomy = turns}));
    };
    for (const ConnectedSurface& s : {glued, flat({0, 0}), flat({1.0 / n, 2.0 / n})}) {
      // Carried from neighbour to neighbour: on a flat connection the way does not matter.
      Field field{n, ComplexVectorX<double>::Zero(s.mesh().vertices()), nullptr};
      field.u[0] = C(0.8, -0.7);
      std::vector<Index> queue{0};
      for (std::size_t k = 0; k < queue.size(); ++k)
        s.mesh().for_each_outgoing(queue[k], [&](Index h) {
          if (field.u[s.mesh().tip(h)] != 0.0) return;
          field.u[s.mesh().tip(h)] = field.u[queue[k]] * std::polar(1.0, -n * s.connection().rho_along(s.mesh(), h));
          queue.push_back(s.mesh().tip(h));
        });
      CHECK((at_vertices(s, at_faces(s, field)).u - field.u).cwiseAbs().maxCoeff() < 1e-10);
    }
  }
}

TEST_CASE("at_vertices: linear vector fields of a flat surface are exact at inner vertices, whatever the triangles") {
  MeshData data = grid(9, 7, 3, 2);
  detail::Random random(4);
  const Mesh mesh(data.F, data.V.rows());
  for (Index v = 0; v < mesh.vertices(); ++v)
    if (!mesh.boundary_vertex(v))
      data.V.row(v) += Eigen::RowVector3d(random.uniform() - 0.5, random.uniform() - 0.5, 0) / 6;
  const ConnectedSurface s = connected(data);
  Eigen::Matrix3d linear;
  linear << 0.7, -0.2, 0, 1.3, 0.4, 0, 0, 0, 0;
  const Eigen::RowVector3d shift(0.2, -0.5, 0);
  Positions<double> there(mesh.faces(), 3), here(mesh.vertices(), 3);
  for (Index t = 0; t < mesh.faces(); ++t)
    there.row(t) = position(s, {t, {1.0 / 3, 1.0 / 3, 1.0 / 3}}) * linear + shift;
  for (Index v = 0; v < mesh.vertices(); ++v) here.row(v) = data.V.row(v) * linear + shift;
  const auto frames = std::make_shared<const Frames>(face_frames(s));
  const Field found = at_vertices(s, from_vectors(1, there, frames)), exact = from_vectors(1, here, s.frames());
  for (Index v = 0; v < mesh.vertices(); ++v)
    if (!mesh.boundary_vertex(v)) CHECK(std::abs(found.u[v] - exact.u[v]) < 1e-12);
}

TEST_CASE("at_vertices: smooth fields on spheres, with an error of second order") {
  for (const int n : {1, 2, 4, 6}) {
    Errors ball[3], rough[3];
    for (int level = 3; level <= 5; ++level) {
      ball[level - 3] = sphere_error(icosphere(level), n);
      rough[level - 3] = sphere_error(jittered_sphere(level, 0.2, 4), n);
    }
    for (const auto& errors : {ball, rough})
      for (int k = 0; k < 2; ++k) {
        CHECK(errors[k].mean / errors[k + 1].mean > 3.7);
        CHECK(errors[k].worst / errors[k + 1].worst > 3.3);
      }
    CHECK(rough[2].mean < 0.001 * n * n);
  }
}

TEST_CASE("at_vertices: zero where no face is, never longer than its faces, and sizes are checked") {
  MeshData data = icosphere(1);
  data.V.conservativeResize(data.V.rows() + 1, 3);
  data.V.bottomRows(1).setConstant(5);
  const ConnectedSurface s = connected(data);
  Field faces{4, random_values(s.mesh().faces(), 3), nullptr};
  faces.u.array() /= faces.u.array().abs();
  const Field found = at_vertices(s, faces);
  CHECK(found.u[s.mesh().vertices() - 1] == C(0));
  CHECK(found.u.cwiseAbs().maxCoeff() < 1 + 1e-12);
  CHECK(found.u.cwiseAbs().maxCoeff() > 0.1);
  faces.u.conservativeResize(3);
  CHECK_THROWS_AS(static_cast<void>(at_vertices(s, faces)), OptionError);
  faces = {0, random_values(s.mesh().faces(), 3), nullptr};
  CHECK_THROWS_AS(static_cast<void>(at_vertices(s, faces)), OptionError);
}
