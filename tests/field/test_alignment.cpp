// SPDX-License-Identifier: MIT
#include "alcap/alignment.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include <cmath>

#include "alcap/designer.h"
#include "alcap/generators.h"
#include "tests/support/mesh_case.h"

using namespace alcap;

namespace {

using C = Complex<double>;
using Row = Eigen::RowVector3d;

struct Case : test::FramedCase {
  using FramedCase::FramedCase;
  [[nodiscard]] Field curvature(const CurvatureOptions& options) const { return curvature_field(connected(), options); }
  // Angle between a field's nearest branch and a direction of space.
  [[nodiscard]] double off(const Field& field, Index v, const Row& direction) const {
    return std::abs(wrap(std::arg(field.u[v]) - field.n * std::arg(frames->component(v, direction)))) / field.n;
  }
};

}  // namespace

TEST_CASE("on a torus the directions are those of its circles, and the length half the difference of curvatures") {
  const double R = 1, r = 0.4;
  for (const MeshData& surface : {torus(80, 40, R, r), torus_random_diagonals(80, 40, R, r, 3)}) {
    const Case s(surface);
    for (const int n : {2, 4, 6})
      for (const bool smallest : {false, true}) {
        const Field field = s.curvature({.n = n, .smallest = smallest});
        double worst = 0, relative = 0;
        for (Index v = 0; v < s.mesh.vertices(); ++v) {
          const Row x = surface.V.row(v);
          const double ring = std::hypot(x[0], x[1]);
          const Row around = Row(-x[1], x[0], 0) / ring, out = Row(x[0], x[1], 0) / ring;
          const Row meridian = Row::UnitZ() * (ring - R) / r - out * x[2] / r;
          // Curvature is 1/r along the meridian, (ring - R) / (r ring) around.
          worst = std::max(worst, s.off(field, v, smallest ? around : meridian));
          const double half = (1 / r - (ring - R) / (r * ring)) / 2;
          relative = std::max(relative, std::abs(std::abs(field.u[v]) / half - 1));
        }
        CHECK(worst < 0.12);
        CHECK(relative < 0.15);
      }
  }
}

TEST_CASE("an open cylinder bends around, never along; spheres and planes know no direction") {
  const Case pipe(cylinder(60, 20));
  const Field field = pipe.curvature({.n = 2});
  for (Index v = 0; v < pipe.mesh.vertices(); ++v) {
    if (pipe.mesh.boundary_vertex(v)) continue;
    const Row x = pipe.surface.V.row(v);
    CHECK(pipe.off(field, v, Row(-x[1], x[0], 0)) < 1e-3);
  }
  const Case sphere(icosphere(4)), plane(grid(8, 8));
  CHECK(sphere.curvature({.n = 4}).u.cwiseAbs().maxCoeff() < 0.15);  // of curvature 1: what the mesh leaves
  CHECK(plane.curvature({.n = 4}).u.cwiseAbs().maxCoeff() < 1e-12);
  CHECK_THROWS_AS((void)plane.curvature({.n = 3}), OptionError);
  CHECK_THROWS_AS((void)plane.curvature({.n = 4, .rings = -1}), OptionError);
}

TEST_CASE("the field turns with the surface, scales with curvature, and does not depend on the frames' gauge") {
  const MeshData bumpy = bumpy_sphere(3, 0.3, 3);
  const Case s(bumpy);
  MeshData turned = bumpy;
  const Eigen::Matrix3d Q = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  turned.V = 3 * bumpy.V * Q.transpose();
  const Case t(turned);
  const Field a = s.curvature({.n = 2}), b = t.curvature({.n = 2});
  const Positions<double> in_space = a.vectors(0);
  for (Index v = 0; v < s.mesh.vertices(); ++v) {
    CHECK(std::abs(b.u[v]) == doctest::Approx(std::abs(a.u[v]) / 3).epsilon(1e-6));
    if (std::abs(a.u[v]) > 1e-3) CHECK(t.off(b, v, in_space.row(v) * Q.transpose()) < 1e-5);
  }
  CHECK(root_mean_square(s.mesh, s.geometry, ComplexVectorX<double>::Constant(s.mesh.vertices(), C(0, 2))) ==
        doctest::Approx(2));
}

TEST_CASE("designs follow curvature the more, the smaller t is") {
  const Case s(torus(48, 24, 1, 0.4));
  for (const int n : {2, 4}) {
    const Field q = s.curvature({.n = n});
    double last = -1;
    for (const double t : {0.0, -1.0, -10.0, -1000.0}) {
      Designer designer(s.connected(), {.n = n, .t = t});
      designer.set_guidance(q.u);
      const Field u = normalised(designer.solve().field);
      double sum = 0, weights = 0;
      for (Index v = 0; v < s.mesh.vertices(); ++v) {
        sum += (std::conj(q.u[v]) * u.u[v]).real();
        weights += std::abs(q.u[v]);
      }
      CHECK(sum / weights > last - 1e-12);
      last = sum / weights;
    }
    CHECK(last > 0.999);
  }
}
