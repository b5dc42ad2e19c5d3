// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "alcap/aligned.h"
#include "alcap/connected_surface.h"
#include "alcap/generators.h"
#include "alcap/smoothest.h"
#include "tests/support/parts.h"
#include "tests/support/surfaces.h"

using namespace alcap;

namespace {

struct Aligned {
  ConnectedSurface surface;
  FeatureGraph features;
  AlignedResult result;
  std::vector<Singularity> zeros;
  FeatureReport report;

  explicit Aligned(const MeshData& data, const AlignedOptions& options = {})
      : surface(test::connected(data)),
        features(sharp_edges(surface)),
        result(aligned_field(surface, features, options)),
        zeros(find_singularities(surface, result.field)),
        report(measure_features(surface, result.field, features, zeros, options.across)) {}

  [[nodiscard]] bool settled() const {
    return std::all_of(result.pieces.begin(), result.pieces.end(), [](const AlignedPiece& p) { return p.settled; });
  }
  [[nodiscard]] int index_sum() const {
    int sum = 0;
    for (const Singularity& s : zeros) sum += s.index;
    return sum;
  }
};

// Four vortices of a boundary-aligned cross field on the unit disk, at the corners of a square of circumradius r, have
// the renormalised energy -[12 log r + 4 log(1 - r^8)] (Bethuel, Brezis and Helein 1994): pairs (a, b) weigh
// log|a - b| and, with their images, log|1 - a conj(b)|. Its derivative vanishes where 12 / r = 32 r^7 / (1 - r^8).
double best_radius() {
  double low = 0.1, high = 0.999;
  for (int k = 0; k < 60; ++k) {
    const double r = (low + high) / 2;
    (12 / r > 32 * std::pow(r, 7) / (1 - std::pow(r, 8)) ? low : high) = r;
  }
  return low;
}

MeshData l_plate() {
  MeshData s = grid(24, 24, 2, 2);
  std::vector<Eigen::Index> kept;
  for (Eigen::Index t = 0; t < s.F.rows(); ++t) {
    Eigen::RowVector3d middle = Eigen::RowVector3d::Zero(), low = s.V.colwise().minCoeff();
    for (int c = 0; c < 3; ++c) middle += s.V.row(s.F(t, c)) / 3;
    if (middle[0] - low[0] < 1 || middle[1] - low[1] < 1) kept.push_back(t);
  }
  Faces F(static_cast<Eigen::Index>(kept.size()), 3);
  for (std::size_t k = 0; k < kept.size(); ++k) F.row(static_cast<Eigen::Index>(k)) = s.F.row(kept[k]);
  s.F = F;
  return s;
}

}  // namespace

TEST_CASE("a boundary-aligned cross field on a disk has four zeros where the renormalised energy is least") {
  CHECK(best_radius() == doctest::Approx(std::pow(3.0 / 11.0, 0.125)).epsilon(1e-12));
  const Aligned disk_field(disk(40));
  CHECK(disk_field.settled());
  REQUIRE(disk_field.zeros.size() == 4);
  std::vector<double> angles;
  for (const Singularity& s : disk_field.zeros) {
    const Eigen::RowVector3d at = position(disk_field.surface, s);
    CHECK(s.index == 1);
    CHECK(at.norm() == doctest::Approx(best_radius()).epsilon(0.02));
    angles.push_back(std::atan2(at.y(), at.x()));
  }
  std::sort(angles.begin(), angles.end());
  for (std::size_t k = 1; k < 4; ++k) CHECK(std::abs(angles[k] - angles[k - 1] - pi<double> / 2) < 0.05);
  CHECK(disk_field.report.all.worst_degrees < 0.1);
  // Finer meshes come closer: the smaller steps of a smaller tau do not end it early.
  const Aligned finer(disk(80));
  CHECK(finer.settled());
  REQUIRE(finer.zeros.size() == 4);
  for (const Singularity& s : finer.zeros)
    CHECK(position(finer.surface, s).norm() == doctest::Approx(best_radius()).epsilon(0.01));
  // The harmonic field alone has them crowded in the middle.
  const Aligned harmonic(disk(40), {.linear = true});
  for (const Singularity& s : harmonic.zeros) CHECK(position(harmonic.surface, s).norm() < 0.1);
}

TEST_CASE("boundary-aligned crosses on plates have the zeros that topology and symmetry ask for") {
  struct Plate {
    const char* name;
    MeshData surface;
    int sum;
    std::size_t count;
  };
  const test::Outline wedge30{{0, 0}, {2, 0}, {2 * std::cos(pi<double> / 6), 1}};
  for (const Plate& plate : {Plate{"square", grid(20, 20), 0, 0}, Plate{"L", l_plate(), 0, 0},
                             Plate{"annulus", test::ring_plate(0.4, 80, 12), 0, 0},
                             Plate{"triangle", test::plate(test::regular(3), 24), 1, 1},
                             Plate{"pentagon", test::plate(test::regular(5), 20), -1, 1},
                             Plate{"wedge of 30 degrees", test::plate(wedge30, 20), 0, 0},
                             Plate{"plate with a hole", test::plate_with_hole(0.35, 12, 16), -4, 4}}) {
    CAPTURE(plate.name);
    const Aligned field(plate.surface);
    CHECK(field.settled());
    CHECK(field.index_sum() == plate.sum);
    CHECK(field.zeros.size() == plate.count);
    CHECK(field.report.all.mean_degrees < 1);
    CHECK(field.report.all.worst_degrees < 10);
    CHECK(field.report.all.singularities == 0);
    if (plate.count == 1) CHECK(position(field.surface, field.zeros.at(0)).norm() < 0.1);
  }
}

TEST_CASE("on CAD parts crosses follow every crease, without singularities on them") {
  for (const test::Part& part : test::cad_parts()) {
    CAPTURE(part.name);
    const Aligned field(part.surface);
    CHECK(field.settled());
    CHECK(field.index_sum() == 4 * field.surface.topology().euler());
    CHECK(field.report.all.mean_degrees < 1);
    CHECK(field.report.all.worst_degrees < 10);
    CHECK(field.report.all.singularities == 0);
    for (const LineDeviation& line : field.report.lines) {
      CHECK(line.mean_degrees < 1);
      CHECK(line.worst_degrees < 10);
    }
  }
}

TEST_CASE("steps lower the energy of directions at one tau, and every one is reported") {
  const Aligned field(disk(24));
  const std::vector<AlignedStep>& steps = field.result.pieces.at(0).steps;
  REQUIRE(steps.size() > 4);
  CHECK(steps.front().tau == doctest::Approx(1 / field.result.pieces[0].lambda));
  // lambda_1 of the disk with u = 0 on its rim is the square of the first zero of J_0.
  CHECK(field.result.pieces[0].lambda == doctest::Approx(2.404825557695773 * 2.404825557695773).epsilon(0.02));
  for (std::size_t k = 1; k < steps.size(); ++k) {
    CHECK(steps[k].tau <= steps[k - 1].tau);
    CHECK(steps[k].largest_degrees >= steps[k].rms_degrees);
  }
  CHECK(steps.back().energy < steps.front().energy);
  CHECK(steps.back().largest_degrees <=
        AlignedOptions{}.settled_degrees * std::min(1.0, steps.back().tau * field.result.pieces[0].lambda));
  const Aligned cut(disk(24), {.max_steps = 3});
  CHECK(cut.result.pieces.at(0).steps.size() == 3);
  CHECK_FALSE(cut.settled());
}

TEST_CASE("one fixed vertex: the same singularities by every linear solver, however far they are") {
  for (const MeshData& data : {icosphere(4), bumpy_sphere(4, 0.3, 5), noisy_scan(4, 0.2, 3)}) {
    const ConnectedSurface surface = test::connected(data);
    const bool closed = surface.topology().loops.empty(), symmetric = data.V.rowwise().norm().maxCoeff() < 1 + 1e-9;
    std::vector<Index> expected;
    for (const std::string& solver : linear_solvers()) {
      CAPTURE(solver);
      const AlignedResult result =
          aligned_field(surface, feature_graph(surface, {}),
                        {.n = 4, .fixed = {{.vertex = 100, .value = 2.0}}, .eigen = {.solver = solver}});
      CHECK(result.pieces.at(0).settled);
      CHECK(result.fixed_degrees < 1e-9);
      std::vector<Index> faces;
      int sum = 0;
      for (const Singularity& s : find_singularities(surface, result.field)) {
        faces.push_back(s.face);
        sum += s.index;
      }
      if (expected.empty()) expected = faces;
      CHECK(faces.size() == expected.size());
      if (!symmetric) CHECK(faces == expected);  // a sphere has the mirror image as well
      if (closed) CHECK(sum == 8);
      if (closed) CHECK(faces.size() == 8);
    }
  }
}

TEST_CASE("along and across, hard and soft, even degrees") {
  const MeshData box = test::blocks(test::cells(2, 2, 1, [](int, int, int) { return false; }), 6);
  for (const int n : {2, 4, 6})
    for (const bool across : {false, true})
      for (const double weight : {0.0, 20.0}) {
        CAPTURE(n);
        CAPTURE(across);
        CAPTURE(weight);
        const Aligned field(box, {.n = n, .across = across, .weight = weight});
        CHECK(field.report.all.mean_degrees < (weight > 0 ? 5 : 1));
        CHECK(field.index_sum() == 2 * n);
      }
  CHECK_THROWS_AS(Aligned(box, {.n = 1}), OptionError);
  CHECK_THROWS_AS(Aligned(box, {.n = 4, .weight = -1}), OptionError);
  CHECK_THROWS_AS(Aligned(box, {.fixed = {{.vertex = 0, .value = 0.0}}}), OptionError);
  CHECK_THROWS_AS(Aligned(box, {.finest = 0}), OptionError);
}

TEST_CASE("corners are held where their features agree with an n-direction, and told where they do not") {
  const Aligned square(grid(12, 12));
  CHECK(square.result.free_corners.empty());
  const Aligned box(test::blocks({{0, 0, 0}}, 6));
  CHECK(box.result.free_corners.size() == 8);
  CHECK(box.zeros.size() == 8);
  CHECK(box.report.singularities_at_corners == 8);
  const Aligned hexagon(test::plate(test::regular(6), 8), {.n = 6});
  CHECK(hexagon.result.free_corners.empty());
  CHECK(hexagon.zeros.empty());
}

TEST_CASE("pieces without features get their smoothest field, and each piece is solved as if alone") {
  const MeshData sphere = jittered_sphere(3, 0.1, 2);
  const ConnectedSurface both = test::connected(test::together(grid(12, 12), sphere));
  const AlignedResult result = aligned_field(both, sharp_edges(both), {.n = 4});
  REQUIRE(result.pieces.size() == 2);
  CHECK_FALSE(result.pieces[0].eigen.has_value());
  REQUIRE(result.pieces[1].eigen.has_value());
  const SmoothestResult alone = smoothest_field(test::connected(sphere), {.n = 4});
  CHECK(result.pieces[1].eigen->lambda == doctest::Approx(alone.components[0].lambda).epsilon(1e-6));
  CHECK(find_singularities(both, result.field).size() ==
        find_singularities(test::connected(sphere), alone.field).size());
}

TEST_CASE("turning, moving and scaling the surface turns the field with it; threads change nothing") {
  const MeshData part = test::cad_parts().at(1).surface;
  CHECK(test::cad_parts().at(1).name == "L-bracket");
  const Aligned before(part);
  MeshData moved = part;
  Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  moved.V = ((part.V * turn.transpose()) * 1e-3).rowwise() + Eigen::RowVector3d(1, 2, 3);
  const Aligned after(moved);
  CHECK((before.result.field.u - after.result.field.u).cwiseAbs().maxCoeff() < 1e-4);
  const Aligned one(part, {.control = {.threads = 1}});
  CHECK(before.result.field.u == one.result.field.u);
}

TEST_CASE("cancelling ends the call") {
  std::atomic<int> asked{0};
  CHECK_THROWS_AS(Aligned(disk(30), {.control = {.cancel = [&] { return ++asked > 2; }}}), Cancelled);
}
