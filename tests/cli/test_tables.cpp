// SPDX-License-Identifier: MIT
//
// The accuracy tables: the harmonics they rest on, what they must show, and that they are reproducible.
#include "apps/alcap/tables/tables.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <sstream>

#include "alcap/conventions.h"
#include "apps/alcap/tables/tables_harmonics.h"
#include "apps/alcap/tables/tables_published.h"
#include "apps/alcap/tables/tables_shapes.h"
#include "src/base/parallel.h"

using namespace alcap;
using namespace alcap::app;

namespace {

/// Calls body(point, weight) over a product rule of the unit sphere that is exact for polynomials of degree 15.
template <class Body>
void over_sphere(Body&& body) {
  // Gauss-Legendre with eight points.
  const double z[] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
  const double w[] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};
  for (int i = 0; i < 4; ++i)
    for (const double sign : {-1.0, 1.0})
      for (int k = 0; k < 16; ++k) {
        const double r = std::sqrt(1 - z[i] * z[i]), a = 2 * pi<double> * k / 16;
        body(Eigen::RowVector3d(r * std::cos(a), r * std::sin(a), sign * z[i]), w[i] * 2 * pi<double> / 16);
      }
}

const OperatorRow& find(const TablesResult& r, const char* sphere, int level, const char* connection,
                        const char* kind) {
  for (const OperatorRow& row : r.operators)
    if (row.sphere == sphere && row.level == level && row.connection == connection && row.kind == kind) return row;
  throw Error("no such row");
}

/// Measured once for several tests.
const TablesResult& three_levels() {
  static const TablesResult result = compute_tables({.levels = {2, 3, 4}, .fields = 20});
  return result;
}

}  // namespace

TEST_CASE("harmonics and their unit gradients are orthonormal on the sphere") {
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(max_harmonics, max_harmonics), gradients = values, mixed = values;
  over_sphere([&](const Eigen::RowVector3d& p, double weight) {
    Eigen::VectorXd y(max_harmonics);
    Eigen::Matrix<double, Eigen::Dynamic, 3> g(max_harmonics, 3), turned(max_harmonics, 3);
    harmonics(p, y);
    harmonic_gradients(p, g);
    for (int k = 0; k < max_harmonics; ++k) turned.row(k) = p.cross(Eigen::RowVector3d(g.row(k)));
    values += weight * y * y.transpose();
    gradients += weight * g * g.transpose();
    mixed += weight * g * turned.transpose();
  });
  const auto identity = Eigen::MatrixXd::Identity(max_harmonics, max_harmonics);
  CHECK((values - identity).cwiseAbs().maxCoeff() < 1e-13);
  CHECK((gradients - identity).cwiseAbs().maxCoeff() < 1e-13);
  CHECK(mixed.cwiseAbs().maxCoeff() < 1e-13);
}

TEST_CASE("gradients are the slopes of the harmonics, and tangential") {
  const Eigen::RowVector3d p = Eigen::RowVector3d(0.4, -0.7, 0.3).normalized();
  const Eigen::RowVector3d s = Eigen::RowVector3d(0.1, 0.9, 0.5).cross(p).normalized();
  constexpr double step = 1e-4;
  Eigen::VectorXd ahead(max_harmonics), behind(max_harmonics);
  harmonics(std::cos(step) * p + std::sin(step) * s, ahead);
  harmonics(std::cos(step) * p - std::sin(step) * s, behind);
  Eigen::Matrix<double, Eigen::Dynamic, 3> g(max_harmonics, 3);
  harmonic_gradients(p, g);
  for (int k = 0; k < max_harmonics; ++k) {
    const double l = harmonic_degree(k);
    CHECK(g.row(k).dot(s) * std::sqrt(l * (l + 1)) ==
          doctest::Approx((ahead[k] - behind[k]) / (2 * step)).epsilon(1e-6));
    CHECK(std::abs(g.row(k).dot(p)) < 1e-14);
  }
  CHECK(harmonic_degree(0) == 1);
  CHECK(harmonic_degree(2) == 1);
  CHECK(harmonic_degree(3) == 2);
  CHECK(harmonic_degree(47) == 6);
}

TEST_CASE("random fields have unit norm and depend on the seed alone") {
  const Eigen::MatrixXcd a = random_coefficients(40, 7, 3), b = random_coefficients(40, 7, 3);
  CHECK(a == b);
  CHECK(a != random_coefficients(40, 7, 4));
  for (int f = 0; f < 7; ++f) CHECK(a.col(f).norm() == doctest::Approx(1));
}

TEST_CASE("edge-based operators of smooth fields: as small as the best published, second order, on any sphere") {
  const TablesResult& r = three_levels();
  const double bound[] = {0.135, 0.034, 0.0087};  // 0.13, 0.033, 0.0084 and what twenty fields scatter
  for (const int level : {2, 3, 4}) {
    const OperatorRow& row = find(r, "clean", level, "global", "edge");
    CHECK(row.l2_div < bound[level - 2]);
    CHECK(row.l2_curl < bound[level - 2]);
    CHECK(row.l2_div >
          0.8 * bound[level - 2]);  // linear interpolation can do no better: fields that are no fields would
    CHECK(row.vertices == 10 * (1 << (2 * level)) + 2);
  }
  for (const char* sphere : {"clean", "jittered"}) {
    for (const char* kind : {"edge", "triangle"}) {
      for (const char* connection : {"polar", "local", "global"}) {
        CAPTURE(sphere);
        CAPTURE(kind);
        CAPTURE(connection);
        const OperatorRow& row = find(r, sphere, 4, connection, kind);
        CHECK(row.order_l2_div == doctest::Approx(2).epsilon(0.05));
        CHECK(row.order_l2_curl == doctest::Approx(2).epsilon(0.05));
        CHECK(row.order_linf_div > 0.6);
        CHECK(row.order_linf_curl > 0.6);
        CHECK(row.order_energy == doctest::Approx(2).epsilon(0.05));
        CHECK(std::isnan(find(r, sphere, 2, connection, kind).order_l2_div));
      }
    }
  }
  for (const StiffnessRow& row : r.stiffness)
    if (row.level == 4) CHECK(row.order_energy == doctest::Approx(2).epsilon(0.05));

  for (const EulerRow& row : r.euler) {
    CAPTURE(row.surface);
    CAPTURE(row.level);
    CAPTURE(row.connection);
    if (row.kind == "edge") {
      CHECK(std::abs(row.mean - row.expected) < 1e-3);
      CHECK(row.deviation < 2e-3);
    } else if (row.surface != "torus") {
      CHECK(row.mean < 4);  // |u| < 1 inside faces
      CHECK(row.mean > 3.3);
    }
  }
}

TEST_CASE("the polar map's center matters only where rho_{v->t} enters: there the energy stops converging") {
  const TablesResult& r = three_levels();
  for (const int level : {2, 3, 4}) {
    const OperatorRow& incenter = find(r, "jittered", level, "polar", "edge");
    const OperatorRow& barycenter = find(r, "jittered", level, "polar-barycenter", "edge");
    CHECK(incenter.l2_div == barycenter.l2_div);
    CHECK(incenter.energy == barycenter.energy);
  }
  const auto excess = [&](int level) {
    return find(r, "jittered", level, "polar-barycenter", "triangle").energy -
           find(r, "jittered", level, "polar", "triangle").energy;
  };
  CHECK(excess(3) > 1e-3);
  CHECK(excess(4) == doctest::Approx(excess(3)).epsilon(0.15));
}

TEST_CASE("the printed text shows every block, the paper's numbers and no NaN") {
  const TablesResult& r = three_levels();
  std::ostringstream out;
  print_tables(out, r);
  const std::string text = out.str();
  for (const char* part : {"L2 error of div, edge-based, clean", "Linf error of curl, triangle-based, jittered",
                           "error of E_D", "[0.0361]", "[3.9897]", "torus", "Table II"})
    CHECK(text.find(part) != std::string::npos);
  CHECK(text.find("nan") == std::string::npos);
}

TEST_CASE("fields of low degree are measured against their own exact energy") {
  // l = 1 alone: E_D = 1/2 for every field of unit norm, and errors far below those of forty harmonics.
  const TablesResult r = compute_tables({.levels = {2, 3}, .fields = 5, .harmonics = 3});
  const OperatorRow& row = find(r, "clean", 3, "global", "edge");
  CHECK(row.l2_div < 0.003);
  CHECK(row.energy < 0.01);
  CHECK(row.order_energy == doctest::Approx(2).epsilon(0.1));
}

TEST_CASE("tables do not depend on the number of threads") {
  const auto run = [](int threads) {
    TablesResult r;
    run_with_threads(threads, [&] { r = compute_tables({.levels = {3}, .fields = 5}); });
    return r;
  };
  const TablesResult one = run(1), four = run(4);
  REQUIRE(one.operators.size() == four.operators.size());
  for (std::size_t i = 0; i < one.operators.size(); ++i) {
    CHECK(one.operators[i].l2_div == four.operators[i].l2_div);
    CHECK(one.operators[i].linf_curl == four.operators[i].linf_curl);
    CHECK(one.operators[i].energy == four.operators[i].energy);
  }
  REQUIRE(one.euler.size() == four.euler.size());
  for (std::size_t i = 0; i < one.euler.size(); ++i) CHECK(one.euler[i].mean == four.euler[i].mean);
}

TEST_CASE("published numbers stand beside the rows they belong to") {
  CHECK(published::operators("clean", 10242, "global", "edge").l2_div == 0.0020);
  CHECK(published::operators("clean", 642, "local", "edge").linf_curl == 0.5225);
  CHECK(published::operators("clean", 162, "polar-barycenter", "edge").energy == 2.1906);
  CHECK(std::isnan(published::operators("jittered", 162, "global", "edge").l2_div));
  CHECK(std::isnan(published::operators("clean", 162, "global", "triangle").l2_div));
  CHECK(std::isnan(published::operators("clean", 42, "global", "edge").l2_div));
  CHECK(published::stiffness_energy("clean", 2562, "global") == 0.1591);
  CHECK(published::euler("clean", 2562, "global", "edge").mean == 4.0);
  CHECK(published::euler("clean", 642, "local", "triangle").mean == 3.9897);
  CHECK(std::isnan(published::euler("torus", 162, "local", "triangle").mean));
}

TEST_CASE("options out of range are refused by name") {
  CHECK_THROWS_WITH_AS((void)compute_tables({.levels = {}}), doctest::Contains("levels"), OptionError);
  CHECK_THROWS_WITH_AS((void)compute_tables({.levels = {3, 2}}), doctest::Contains("levels"), OptionError);
  CHECK_THROWS_WITH_AS((void)compute_tables({.fields = 1}), doctest::Contains("fields"), OptionError);
  CHECK_THROWS_WITH_AS((void)compute_tables({.harmonics = 49}), doctest::Contains("harmonics"), OptionError);
  CHECK_THROWS_WITH_AS((void)compute_tables({.jitter = 0.5}), doctest::Contains("jitter"), OptionError);
}

TEST_CASE("random points and noise: closed spheres through every point") {
  const MeshData random = random_points_sphere(2, 5);
  const Mesh mesh(random.F, random.V.rows());
  CHECK(mesh.faces() == 2 * mesh.vertices() - 4);
  CHECK(mesh.boundary_edges() == 0);
  for (Eigen::Index v = 0; v < random.V.rows(); ++v) CHECK(random.V.row(v).norm() == doctest::Approx(1));
  for (Index t = 0; t < mesh.faces(); ++t) {
    const Row a = random.V.row(mesh.F()(t, 0)), b = random.V.row(mesh.F()(t, 1)), c = random.V.row(mesh.F()(t, 2));
    CHECK(a.dot(Row(b.cross(c))) > 0);  // outward
  }
  const MeshData noisy = noisy_sphere(3, 0.1, 2);
  const double edge = Geometry(Mesh(icosphere(3).F, 642), icosphere(3).V).lengths().mean();
  double most = 0;
  for (Eigen::Index v = 0; v < noisy.V.rows(); ++v) most = std::max(most, std::abs(noisy.V.row(v).norm() - 1));
  CHECK(most <= 0.1 * edge * (1 + 1e-12));
  CHECK(most > 0.09 * edge);
}

TEST_CASE("on a body the exact integrals are those of the field: Stokes over all of it, and second order of ours") {
  for (const Body& body : {ellipsoid(), generic_body(), Body{.R = 1, .r = 0.4}}) {
    std::vector<double> errors;
    for (const int level : {2, 3, 4}) {
      const int rings = 5 << (level - 1);
      const BodyShape shape("body", level, body.R > 0 ? torus(2 * rings, rings, 1, 0.4) : icosphere(level), body, 6, 1);
      for (Eigen::Index v = 0; v < shape.surface.V.rows(); v += 7)
        CHECK(std::abs(body.value(shape.surface.V.row(v))) < 1e-12);
      // Divergence and curl of a field on a closed surface sum to nothing.
      if (level == 4) CHECK(shape.exact.colwise().sum().cwiseAbs().maxCoeff() < 1e-3 * shape.exact.cwiseAbs().sum());
      const Connection connection = globally_optimal(shape.mesh, shape.geometry);
      const Fields u = shape.sample(connection);
      const auto ops = first_order_operators(shape.mesh, shape.geometry, connection, {1, OperatorKind::edge});
      errors.push_back(measure(shape.mesh, shape.geometry, ops, u, &shape.exact).div2.sqrt().mean());
    }
    CHECK(errors[0] / errors[1] > 3.2);
    CHECK(errors[1] / errors[2] > 3.4);
  }
  // On a sphere the rule is exact to rounding, so nothing is left.
  const BodyShape sphere("sphere", 4, icosphere(4), {.a = 1, .b = 1, .c = 1}, 4, 1);
  CHECK(sphere.exact.colwise().sum().cwiseAbs().maxCoeff() < 1e-9);
}

TEST_CASE("by 1-forms on edges the energy of smooth fields is found as well") {
  Eigen::MatrixXcd coefficients = random_coefficients(15, 10, 3);
  Eigen::ArrayXd exact = Eigen::ArrayXd::Zero(10);
  for (int k = 0; k < 15; ++k) {
    const double l = harmonic_degree(k);
    exact += l * (l + 1) / 2 * coefficients.row(k).cwiseAbs2().transpose().array();
  }
  double before = 1;
  for (const int level : {2, 3, 4}) {
    const MeshData data = icosphere(level);
    const Mesh mesh(data.F, data.V.rows());
    const Eigen::ArrayXd found = one_form_energy(mesh, Geometry(mesh, data.V), data.V, coefficients);
    const double error = ((found - exact) / exact).abs().mean();
    CHECK(error < before / 3);
    before = error;
  }
}

TEST_CASE("away from its cones our field of a trivial connection nears the one per face") {
  // Ours is the smoothest, not the parallel one: the faces around cones bend it a little, less on finer meshes.
  CHECK(face_field_difference(icosphere(2)) < 0.5);
  CHECK(face_field_difference(icosphere(3)) < 0.5 * face_field_difference(icosphere(2)));
  CHECK(face_field_difference(jittered_sphere(3, 0.2, 4)) < 0.5);
}

TEST_CASE("more rows, the caller's mesh, and baselines, in numbers and in text") {
  TablesOptions options{.levels = {1, 2}, .fields = 4, .mesh = genus_surface(2, 2), .mesh_name = "two holes"};
  options.more = true;
  const TablesResult result = compute_tables(options);
  for (const char* name : {"noise 0.01", "noise 0.1", "random points", "ellipsoid", "body", "jittered body", "torus"})
    CHECK(std::any_of(result.operators.begin(), result.operators.end(),
                      [&](const OperatorRow& row) { return row.sphere == name; }));
  int rows = 0;
  for (const EulerRow& row : result.euler) {
    if (row.surface != "two holes") continue;
    ++rows;
    CHECK(row.expected == -4);
    if (row.kind == "edge") CHECK(row.mean == doctest::Approx(-4).epsilon(0.02));
  }
  CHECK(rows == 12);
  REQUIRE(result.baselines.size() == 4);
  CHECK(result.baselines[1].edge < result.baselines[0].edge);
  std::ostringstream text;
  print_tables(text, result);
  for (const char* part : {"two holes", "Baselines", "ellipsoid", "random points", "by face"})
    CHECK(text.str().find(part) != std::string::npos);
  CHECK(text.str().find("nan") == std::string::npos);
  options.mesh = disk(4);
  CHECK_THROWS_AS(static_cast<void>(compute_tables(options)), OptionError);
}

TEST_CASE("the largest error by face is about the published one, and at most the largest of all") {
  for (const OperatorRow& row : three_levels().operators) {
    CHECK(row.face_div <= 1.5 * row.linf_div);
    if (row.sphere != "clean" || row.connection != "global" || row.kind != "edge" || row.level < 3) continue;
    CHECK(row.face_div == doctest::Approx(row.paper_linf_div).epsilon(0.25));
  }
}
