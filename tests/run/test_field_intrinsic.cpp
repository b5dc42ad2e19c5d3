// SPDX-License-Identifier: MIT
//
// Fields that are solved on an intrinsic triangulation: the surface's, in the frames of the mesh.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "alcap/field_run.h"
#include "alcap/generators.h"
#include "src/base/parallel.h"
#include "tests/support/parts.h"
#include "tests/support/slivers.h"

using namespace alcap;

namespace {

bool said(const FieldRun& run, const std::string& code) {
  return std::any_of(run.remarks.begin(), run.remarks.end(), [&](const Remark& r) { return r.code == code; });
}

FieldRun solved(const MeshData& mesh, Triangulation kind, double min_angle = FieldRunOptions{}.min_angle) {
  return run_field(mesh.V, mesh.F, {.n = 4, .triangulation = kind, .min_angle = min_angle});
}

/// |<a, b>| / (|a| |b|) over the vertices that both meshes have, after a's vectors are seen in b's frames.
double agreement(const FieldRun& a, const FieldRun& b) {
  const int n = a.field.n;
  const Index shared = std::min(a.mesh().vertices(), b.mesh().vertices());
  const Positions<double> vectors = a.field.vectors(0);
  Complex<double> product = 0;
  double aa = 0, bb = 0;
  for (Index v = 0; v < shared; ++v) {
    const Complex<double> z = b.field.frames->component(v, vectors.row(v)), u = std::pow(z, n);
    product += std::conj(u) * b.field.u[v];
    aa += std::norm(u);
    bb += std::norm(b.field.u[v]);
  }
  return std::abs(product) / std::sqrt(aa * bb);
}

/// A cone of `around` needles over a fan, their common point at this height.
MeshData cone(Index around, double height) {
  MeshData out{Positions<double>(around + 2, 3), Faces(2 * around, 3)};
  for (Index i = 0; i < around; ++i) {
    const double t = 2 * pi<double> * i / around;
    const Index j = (i + 1) % around;
    out.V.row(i) << std::cos(t), std::sin(t), 0;
    out.F.row(2 * i) << i, j, around;
    out.F.row(2 * i + 1) << j, i, around + 1;
  }
  out.V.row(around) << 0, 0, height;
  out.V.row(around + 1) << 0, 0, 0;
  return out;
}

/// A rod with one quad per side from end to end, and fans at its ends.
MeshData rod(Index around, double length) {
  MeshData out{Positions<double>(2 * around + 2, 3), Faces(4 * around, 3)};
  const Index low = 2 * around, high = low + 1;
  for (Index i = 0; i < around; ++i) {
    const double t = 2 * pi<double> * i / around;
    const Index j = (i + 1) % around;
    out.V.row(i) << std::cos(t), std::sin(t), 0;
    out.V.row(around + i) << std::cos(t), std::sin(t), length;
    out.F.row(4 * i) << i, j, around + i;
    out.F.row(4 * i + 1) << j, around + j, around + i;
    out.F.row(4 * i + 2) << j, i, low;
    out.F.row(4 * i + 3) << around + i, around + j, high;
  }
  out.V.row(low) << 0, 0, 0;
  out.V.row(high) << 0, 0, length;
  return out;
}

}  // namespace

TEST_CASE(
    "needles that meet in points, and rods: by default there is a field, and no worse triangles than the mesh's") {
  struct Shape {
    const char* name;
    MeshData mesh;
  };
  for (const Shape& shape :
       {Shape{"cone 96, 5", cone(96, 5)}, Shape{"cone 96, 30", cone(96, 30)}, Shape{"cone 200, 10", cone(200, 10)},
        Shape{"cone 24, 1e6", cone(24, 1e6)}, Shape{"rod 24, 1000", rod(24, 1000)},
        Shape{"rod 48, 3000", rod(48, 3000)}, Shape{"rod 12, 5000", rod(12, 5000)}}) {
    CAPTURE(shape.name);
    const FieldRun run = solved(shape.mesh, Triangulation::automatic);
    CHECK(run.certificate.holds());
    CHECK(said(run, "own_triangles") == !run.triangulation.has_value());
    if (run.triangulation) {
      CHECK(run.triangulation->after.angle_min >= run.triangulation->before.angle_min);
      CHECK(run.triangulation->complete == !said(run, "triangulation_incomplete"));
    }
    const FieldRun along = run_field(shape.mesh.V, shape.mesh.F, {.n = 4, .align = FieldAlignment{}});
    CHECK(along.certificate.holds());
    CHECK(along.features->report.all.mean_degrees < 1);
  }
}

TEST_CASE("a Delaunay mesh is solved on as it is: the same values") {
  const MeshData mesh = bumpy_sphere(3, 0.2, 4);
  const FieldRun given = solved(mesh, Triangulation::extrinsic), there = solved(mesh, Triangulation::intrinsic, 0);
  REQUIRE(there.triangulation);
  CHECK(there.triangulation->added == 0);
  if (there.triangulation->flips == 0)
    CHECK(there.eigen[0].lambda == doctest::Approx(given.eigen[0].lambda).epsilon(1e-7));
  CHECK(agreement(given, there) > 0.995);
  CHECK(there.connection().kind == ConnectionKind::local);
  CHECK(there.certificate.holds());
  CHECK(said(there, "intrinsic_triangulation"));
  CHECK_FALSE(given.triangulation);
}

TEST_CASE("slivers change nothing: the field of the clean mesh at its vertices") {
  const MeshData clean = bumpy_sphere(4, 0.2, 3);
  const FieldRun without = solved(clean, Triangulation::extrinsic);
  for (const double height : {1e-3, 1e-6}) {
    CAPTURE(height);
    const MeshData bad = test::with_slivers(clean, 37, height);
    const FieldRun with = solved(bad, Triangulation::automatic);
    REQUIRE(with.triangulation);
    CHECK(with.certificate.holds());
    CHECK(with.triangulation->after.angle_min > 14.9 * pi<double> / 180);
    CHECK(with.eigen[0].lambda == doctest::Approx(without.eigen[0].lambda).epsilon(5e-3));
    CHECK(agreement(without, with) > 0.995);
    // It converges as without them.
    CHECK(with.triangulation->connection.iterations <= 2 * without.connection().report.iterations);
    CHECK(with.eigen[0].iterations <= without.eigen[0].iterations + 4);
  }
}

TEST_CASE("on a flat plate with slivers crosses along the boundary are those of the axes, everywhere") {
  const MeshData plate = test::with_slivers(grid(12, 9, 4, 3), 7, 1e-5);
  const FieldRun run =
      run_field(plate.V, plate.F, {.n = 4, .align = FieldAlignment{}, .triangulation = Triangulation::intrinsic});
  REQUIRE(run.triangulation);
  CHECK(run.triangulation->flips > 0);
  CHECK(run.certificate.holds());
  CHECK(run.singularities.empty());
  CHECK(run.features->followed);
  const Positions<double> vectors = run.field.vectors(0);
  for (Index v = 0; v < run.mesh().vertices(); ++v) {
    const double angle = std::atan2(vectors(v, 1), vectors(v, 0));
    CHECK(std::abs(std::remainder(angle, pi<double> / 2)) < 1e-6);
  }
}

/// cad_like(segments, 1), finely meshed: rings along the profile, triangles as long as wide.
MeshData fine_cylinder(int segments, double radius, double height) {
  const int around = segments, along = static_cast<int>(height * segments / (2 * pi<double> * radius)),
            inward = static_cast<int>(segments / (2 * pi<double>));
  const int rings = along + 2 * inward - 1;
  MeshData out{Positions<double>(rings * around + 2, 3), Faces(2 * rings * around, 3)};
  out.V.row(0).setZero();
  out.V.row(rings * around + 1) << 0, 0, height;
  Index t = 0;
  for (int r = 0; r < rings; ++r) {
    const double here = r < inward           ? radius * (r + 1) / inward
                        : r < inward + along ? radius
                                             : radius * (rings - r) / inward;
    const double z = r < inward ? 0 : r < inward + along ? height * (r - inward + 1) / along : height;
    for (int k = 0; k < around; ++k) {
      const double angle = 2 * pi<double> * k / around;
      const Index a = 1 + r * around + k, b = 1 + r * around + (k + 1) % around;
      out.V.row(a) << here * std::cos(angle), here * std::sin(angle), z;
      if (r == 0) out.F.row(t++) << 0, b, a;
      if (r + 1 < rings) {
        out.F.row(t++) << a, b, b + around;
        out.F.row(t++) << a, b + around, a + around;
      } else {
        out.F.row(t++) << a, b, rings * around + 1;
      }
    }
  }
  return out;
}

/// Corners (radius, height) of the profile of cad_like(., steps), from pole to pole.
std::vector<std::array<double, 2>> profile_of_shaft(int steps) {
  const double radii[4] = {1, 2, 1.25, 1.75};
  std::vector<std::array<double, 2>> corners = {{0, 0}};
  double height = 0;
  for (int step = 0; step < steps; ++step) {
    corners.push_back({radii[step % 4], height});
    height += step % 2 == 0 ? 6 : 1;
    corners.push_back({radii[step % 4], height});
  }
  corners.push_back({0, height});
  return corners;
}

/// The smallest eigenvalue of n-fields on the smooth surface of revolution with these corners, r(s) along its profile.
/// In the frame of profile and circle fields f(s) e^{i m angle} have the energy int (f'^2 + (m - n r')^2 / r^2 f^2) r
/// ds against int f^2 r ds: a one-dimensional problem for every m, here in linear elements. Its smallest eigenvalue is
/// the largest lambda up to which no pivot of the tridiagonal matrix is negative.
double eigenvalue_of_shaft(int steps, int n) {
  constexpr double elements_per_length = 1000;  // 500 and 2,000 differ by 2e-6, relatively
  double least = 1e3;
  const auto corners = profile_of_shaft(steps);
  for (int m = -n; m <= n; ++m) {
    std::vector<double> diagonal = {0}, mass = {0}, beside;
    for (std::size_t k = 0; k + 1 < corners.size(); ++k) {
      const double along = corners[k + 1][0] - corners[k][0], up = corners[k + 1][1] - corners[k][1];
      const double length = std::hypot(along, up);
      const int count = static_cast<int>(length * elements_per_length);
      for (int i = 0; i < count; ++i) {
        const double ds = length / count, r = corners[k][0] + along * (i + 0.5) / count, bent = m - n * along / length;
        const double own = r / ds + bent * bent / r * ds / 2;
        diagonal.back() += own;
        diagonal.push_back(own);
        beside.push_back(r / ds);
        mass.back() += r * ds / 2;
        mass.push_back(r * ds / 2);
      }
    }
    const auto below = [&](double lambda) {
      double pivot = diagonal[0] - lambda * mass[0];
      for (std::size_t i = 0; i < beside.size() && pivot > 0; ++i)
        pivot = diagonal[i + 1] - lambda * mass[i + 1] - beside[i] * beside[i] / pivot;
      return pivot > 0;
    };
    double low = 0, high = least;
    for (int k = 0; k < 50; ++k) (below((low + high) / 2) ? low : high) = (low + high) / 2;
    least = std::min(least, high);
  }
  return least;
}

TEST_CASE("shafts of needles: the eigenvalue of the smooth surface to a thousandth") {
  // The reference, against well-shaped triangles: these spread the curvature of a rim over one row, and are off by a
  // part of an edge.
  const double one = eigenvalue_of_shaft(1, 4), seven = eigenvalue_of_shaft(7, 4);
  double last = 0;
  for (const int segments : {100, 200, 400}) {
    const double lambda = solved(fine_cylinder(segments, 1, 6), Triangulation::extrinsic).eigen[0].lambda;
    CHECK(std::abs(lambda / one - 1) < 0.8 / segments);
    CHECK(lambda > last);
    last = lambda;
  }
  // One cylinder of 81,916 needles, seven of 163,852.
  const FieldRun shaft = solved(cad_like(20480, 1), Triangulation::automatic);
  REQUIRE(shaft.triangulation);
  CHECK(shaft.certificate.holds());
  CHECK(std::abs(shaft.eigen[0].lambda / one - 1) < 1e-3);
  const FieldRun stepped = solved(cad_like(5852, 7), Triangulation::automatic);
  REQUIRE(stepped.triangulation);
  CHECK(stepped.certificate.holds());
  CHECK(std::abs(stepped.eigen[0].lambda / seven - 1) < 1e-3);
}

TEST_CASE("shafts of needles: the eigenvalue of the surface") {
  const MeshData shaft = cad_like(400, 1);
  const FieldRun run = solved(shaft, Triangulation::automatic);
  REQUIRE(run.triangulation);
  CHECK(run.certificate.holds());
  CHECK(run.triangulation->connection.converged);
  const FieldRun fine = solved(fine_cylinder(400, 1, 6), Triangulation::extrinsic);
  const FieldRun needles = solved(shaft, Triangulation::extrinsic);
  const auto error = [&](const FieldRun& r) { return std::abs(r.eigen[0].lambda / fine.eigen[0].lambda - 1); };
  CHECK(error(run) < 1e-2);
  CHECK(error(run) < error(needles) / 10);
  std::int64_t sum = 0;
  for (const int i : run.indices) sum += i;
  CHECK(sum == 8);
  CHECK(run.field.u.size() == shaft.V.rows());
}

TEST_CASE("a proof that would take longer than the solve is not waited for: one solve, to the angle asked for") {
  // Rings of thousands of vertices make wide fronts.
  const MeshData shaft = cad_like(10240, 1);
  const FieldRun run = run_field(shaft.V, shaft.F,
                                 {.n = 4,
                                  .connection = {.kind = ConnectionKind::local},
                                  .triangulation = Triangulation::intrinsic,
                                  .min_angle = 20 * pi<double> / 180});
  CHECK(run.certificate.holds());
  REQUIRE(run.eigen[0].smallest == Smallest::not_checked);
  CHECK(run.eigen[0].smallest_note.find("longer than the solve") != std::string::npos);
  CHECK(*run.eigen[0].angle <= EigenOptions{}.angle_tolerance);
  // A second solve would have gone to 1e-8.
  CHECK(run.eigen[0].residual > 1e-8);
}

TEST_CASE("a part with needles is followed along its creases") {
  const MeshData shaft = cad_like(120, 3);
  const FieldRun run = run_field(shaft.V, shaft.F, {.n = 4, .align = FieldAlignment{}});
  REQUIRE(run.triangulation);
  CHECK(run.certificate.holds());
  CHECK(run.features->followed);
  CHECK(run.features->report.all.mean_degrees < 1);
  CHECK(run.features->graph.vertices.size() == static_cast<std::size_t>(shaft.V.rows()));
}

TEST_CASE("good meshes stay as they are") {
  CHECK_FALSE(solved(icosphere(3), Triangulation::automatic).triangulation);
  CHECK_THROWS_AS((void)solved(cad_like(40, 2), Triangulation::intrinsic, 1), OptionError);
}

TEST_CASE("cones are where they were: the parallel field of the clean mesh, in spite of slivers") {
  const MeshData clean = bumpy_sphere(4, 0.2, 3);
  std::vector<Cone> cones;
  for (Index v = 0; v < 8; ++v) cones.push_back({v, 0.25});
  for (const ConnectionKind kind : {ConnectionKind::trivial, ConnectionKind::metric}) {
    CAPTURE(name(kind));
    const FieldRunOptions options{.n = 4, .connection = {.kind = kind, .cones = cones}};
    const FieldRun without = run_field(clean.V, clean.F, options);
    const MeshData bad = test::with_slivers(clean, 37, 1e-5);
    const FieldRun with = run_field(bad.V, bad.F, options);
    REQUIRE(with.triangulation);
    CHECK(with.certificate.holds());
    CHECK(with.triangulation->cones.size() == 8);
    CHECK(with.triangulation->parallel);
    CHECK(agreement(without, with) > 0.99);
    CHECK(with.eigen[0].lambda == doctest::Approx(without.eigen[0].lambda).epsilon(0.1));
    CHECK(with.index_sums[0].sum == 8);
    // One zero at each cone, in a face around it or next to one: the mesh's slivers are a part of these.
    CHECK(with.triangulation->singularities == 8);
    CHECK(with.singularities.size() == 8);
  }
}

TEST_CASE("cones that balance are put at vertices of the mesh; loops keep their indices") {
  const MeshData shaft = cad_like(40, 2);
  const FieldRun balanced = run_field(shaft.V, shaft.F,
                                      {.n = 4,
                                       .connection = {.kind = ConnectionKind::trivial, .balance_cones = true},
                                       .triangulation = Triangulation::intrinsic});
  REQUIRE(balanced.triangulation);
  double sum = 0;
  for (const Cone& c : balanced.triangulation->cones) {
    CHECK(c.vertex < balanced.mesh().vertices());
    sum += c.index;
  }
  CHECK(sum == doctest::Approx(2));
  CHECK(balanced.index_sums[0].sum == 8);
  const MeshData clean = cylinder(24, 12, 1, 2), tube = test::with_slivers(clean, 5, 1e-4);
  const FieldRun turned = run_field(tube.V, tube.F,
                                    {.n = 4,
                                     .connection = {.kind = ConnectionKind::trivial, .loop_index = {0.25, -0.25}},
                                     .triangulation = Triangulation::intrinsic});
  REQUIRE(turned.triangulation);
  REQUIRE(turned.triangulation->loop_index.size() == 2);
  const FieldRun given = run_field(clean.V, clean.F,
                                   {.n = 4,
                                    .connection = {.kind = ConnectionKind::trivial, .loop_index = {0.25, -0.25}},
                                    .triangulation = Triangulation::extrinsic});
  CHECK(agreement(given, turned) > 0.98);
}

TEST_CASE("what belongs to the mesh's own triangles is refused by its name, or solved on them") {
  const MeshData mesh = test::with_slivers(torus(24, 12, 1, 0.4), 9, 1e-4);
  ConnectionOptions holonomies{.kind = ConnectionKind::trivial, .generator_holonomy = {0.25, 0}};
  ConnectionOptions target{.kind = ConnectionKind::metric};
  target.target.face_curvature = VectorX<double>::Zero(mesh.F.rows());
  for (const ConnectionOptions& connection : {holonomies, target}) {
    FieldRunOptions options{.n = 4, .connection = connection, .triangulation = Triangulation::intrinsic};
    try {
      (void)run_field(mesh.V, mesh.F, options);
      FAIL("not refused");
    } catch (const OptionError& e) {
      CHECK(e.field() == "triangulation");
    }
    options.triangulation = Triangulation::automatic;
    CHECK_FALSE(run_field(mesh.V, mesh.F, options).triangulation);
  }
  // Curvature per vertex carries over.
  ConnectionOptions flat{.kind = ConnectionKind::metric};
  flat.target.vertex_curvature = VectorX<double>::Zero(mesh.V.rows());
  const FieldRun run = run_field(mesh.V, mesh.F, {.n = 4, .connection = flat});
  REQUIRE(run.triangulation);
  CHECK(run.certificate.holds());
  CHECK(run.index_sums[0].sum == 0);
}

TEST_CASE("modes are handed back at the vertices of the mesh; threads do not matter") {
  const MeshData mesh = test::with_slivers(torus(24, 12, 1, 0.4), 9, 1e-4);
  const FieldRunOptions options{.n = 2, .modes = 3, .triangulation = Triangulation::intrinsic, .threads = 1};
  const FieldRun one = run_field(mesh.V, mesh.F, options);
  CHECK(one.modes.U.rows() == mesh.V.rows());
  CHECK(one.modes.U.cols() == 3);
  FieldRunOptions four = options;
  four.threads = 4;
  CHECK(run_field(mesh.V, mesh.F, four).field.u == one.field.u);
}

TEST_CASE("faces without area are mollified on request") {
  MeshData mesh = test::with_slivers(icosphere(3), 61, 0.0);  // points exactly on edges, as far as rounding goes
  mesh.V.row(mesh.V.rows() - 1) = mesh.V.row(mesh.F(mesh.F.rows() - 1, 1));  // and one on a vertex
  CHECK_THROWS_AS((void)run_field(mesh.V, mesh.F, {.n = 4}), MeshError);
  const FieldRun run = run_field(mesh.V, mesh.F, {.n = 4, .repairs = {Repair::mollify}});
  CHECK(run.certificate.holds());
  CHECK(said(run, "mollified"));
  CHECK(run.surface.in_space());
  CHECK(run.field.u.size() == mesh.V.rows());
  const FieldRun clean = run_field(icosphere(3).V, icosphere(3).F, {.n = 4});
  CHECK(run.eigen[0].lambda == doctest::Approx(clean.eigen[0].lambda).epsilon(0.02));
  // Nothing to do, nothing said.
  const FieldRun same = run_field(icosphere(3).V, icosphere(3).F, {.n = 4, .repairs = {Repair::mollify}});
  CHECK_FALSE(said(same, "mollified"));
  CHECK(same.eigen[0].lambda == clean.eigen[0].lambda);
  MeshData nowhere = icosphere(1);
  nowhere.V(3, 1) = std::nan("");
  CHECK_THROWS_AS((void)run_field(nowhere.V, nowhere.F, {.n = 4, .repairs = {Repair::mollify}}), MeshError);
}
