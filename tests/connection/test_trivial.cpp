// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include "alcap/connection.h"
#include "alcap/generators.h"
#include "alcap/singularities.h"
#include "alcap/smoothest.h"
#include "tests/support/mesh_case.h"

using namespace alcap;

namespace {

struct Case : test::MeshCase {
  using MeshCase::MeshCase;
  Topology topology = find_topology(mesh);

  // Whether face t touches one of the cones.
  [[nodiscard]] bool touches(Index t, const std::vector<Cone>& cones) const {
    for (const Cone& cone : cones)
      for (int c = 0; c < 3; ++c)
        if (mesh.F()(t, c) == cone.vertex) return true;
    return false;
  }
};

// Total curvature that the connection puts around an interior vertex: 2 pi minus the angles seen.
double curvature_at(const Case& s, const Connection& c, Index v) {
  double sum = 2 * pi<double>;
  s.mesh.for_each_outgoing(v, [&](Index h) { sum -= s.geometry.angle(h) + c.alpha[h] - c.alpha[Mesh::prev(h)]; });
  return sum;
}

std::vector<Cone> spread(const Mesh& mesh, std::initializer_list<double> indices) {
  std::vector<Cone> cones;
  const auto step = mesh.vertices() / static_cast<Index>(indices.size() + 1);
  Index v = step / 2;
  for (const double index : indices) {
    while (mesh.boundary_vertex(v)) ++v;
    cones.push_back({v, index});
    v += step;
  }
  return cones;
}

void check_flat_off_cones(const Case& s, const Connection& c, const std::vector<Cone>& cones) {
  double worst = 0;
  for (Index t = 0; t < s.mesh.faces(); ++t)
    if (!s.touches(t, cones)) worst = std::max(worst, std::abs(c.K[t]));
  CHECK(worst < 1e-11);
  Eigen::VectorXd wanted = Eigen::VectorXd::Zero(s.mesh.vertices());
  for (const Cone& cone : cones) wanted[cone.vertex] += 2 * pi<double> * cone.index;
  worst = 0;
  for (Index v = 0; v < s.mesh.vertices(); ++v)
    if (!s.mesh.boundary_vertex(v)) worst = std::max(worst, std::abs(curvature_at(s, c, v) - wanted[v]));
  CHECK(worst < 1e-9);
}

void check_holonomies(const Case& s, const Connection& c, int n) {
  for (const Loop& strip : homology_generators(s.mesh, s.topology))
    CHECK(std::abs(wrap(n * holonomy(s.mesh, s.geometry, c, strip))) < 1e-8);
}

// The smoothest field of the connection is parallel away from the cones: its singularities touch them.
void check_singularities(const Case& s, const Connection& c, const std::vector<Cone>& cones, int n) {
  const auto result = smoothest_field(s.mesh, s.geometry, c, nullptr, {.n = n});
  CHECK(result.components[0].converged);
  int sum = 0;
  double expected = 0;
  for (const Singularity& singularity : find_singularities(s.mesh, s.geometry, c, result.field)) {
    CHECK(s.touches(singularity.face, cones));
    sum += singularity.index;
  }
  for (const Cone& cone : cones) expected += cone.index;
  CHECK(sum == std::lround(expected * n));
}

}  // namespace

TEST_CASE("genus 0: two, four, five and eight cones, n = 1, 2, 4") {
  const Case s(jittered_sphere(3, 0.2, 4));
  const std::vector<std::pair<int, std::vector<Cone>>> designs = {
      {1, spread(s.mesh, {1, 1})},
      {2, spread(s.mesh, {0.5, 0.5, 0.5, 0.5})},
      {2, spread(s.mesh, {1, 0.5, 0.5, 0.5, -0.5})},
      {4, spread(s.mesh, {0.25, 0.25, 0.25, 0.25, 0.25, 0.25, 0.25, 0.25})},
      {1, spread(s.mesh, {2})}};
  for (const auto& [n, cones] : designs) {
    const auto c = trivial(s.mesh, s.geometry, cones, {.n = n});
    CHECK(c.report.converged);
    check_flat_off_cones(s, c, cones);
    check_singularities(s, c, cones, n);
  }
}

TEST_CASE("genus 1, 2 and 3: cones and generators") {
  const Case one(torus(24, 16, 1, 0.4));
  for (const auto& cones : {std::vector<Cone>{}, spread(one.mesh, {0.25, -0.25}), spread(one.mesh, {1, -1})}) {
    const auto c = trivial(one.mesh, one.geometry, cones, {.n = 4});
    check_flat_off_cones(one, c, cones);
    check_holonomies(one, c, 4);
    check_singularities(one, c, cones, 4);
  }
  const Case two(genus_surface(2, 3));
  const auto cones_two = spread(two.mesh, {-1, -1});
  const auto c = trivial(two.mesh, two.geometry, cones_two, {.n = 1});
  check_flat_off_cones(two, c, cones_two);
  check_holonomies(two, c, 1);
  check_singularities(two, c, cones_two, 1);
  const Case three(genus_surface(3, 2));
  const auto cones_three = spread(three.mesh, {-0.5, -0.5, -0.5, -0.5, -0.5, -0.5, -0.5, -0.5});
  const auto d = trivial(three.mesh, three.geometry, cones_three, {.n = 2});
  check_flat_off_cones(three, d, cones_three);
  check_holonomies(three, d, 2);
  check_singularities(three, d, cones_three, 2);
}

TEST_CASE("prescribed holonomy of generators is met") {
  const Case s(torus(24, 16, 1, 0.4));
  const auto generators = homology_generators(s.mesh, s.topology);
  REQUIRE(generators.size() == 2);
  for (const double first : {0.0, 0.25, 0.5})
    for (const double second : {0.0, -0.25, 0.75}) {
      const auto c = trivial(s.mesh, s.geometry, {}, {.n = 4, .generator_holonomy = {first, second}});
      CHECK(std::abs(wrap(holonomy(s.mesh, s.geometry, c, generators[0]) - 2 * pi<double> * first)) < 1e-8);
      CHECK(std::abs(wrap(holonomy(s.mesh, s.geometry, c, generators[1]) - 2 * pi<double> * second)) < 1e-8);
      check_flat_off_cones(s, c, {});
    }
}

TEST_CASE("a trivial connection without cones has a parallel field") {
  const Case s(torus(24, 16, 1, 0.4));
  const auto c = trivial(s.mesh, s.geometry, {}, {.n = 1});
  const auto result = smoothest_field(s.mesh, s.geometry, c, nullptr, {.n = 1});
  CHECK(result.components[0].converged);
  CHECK(std::abs(result.components[0].lambda) < 1e-8 / s.geometry.total_area());
  CHECK(result.field.u.cwiseAbs().maxCoeff() / result.field.u.cwiseAbs().minCoeff() ==
        doctest::Approx(1).epsilon(1e-6));
}

TEST_CASE("boundary loops take an index, chosen or prescribed") {
  const Case s(cylinder(16, 8));
  const auto cones = spread(s.mesh, {0.25, -0.25, 0.5});
  const auto c = trivial(s.mesh, s.geometry, cones, {.n = 4});
  check_flat_off_cones(s, c, cones);
  check_singularities(s, c, cones, 4);
  const auto d = trivial(s.mesh, s.geometry, cones, {.n = 4, .loop_index = {-0.25, -0.25}});
  check_flat_off_cones(s, d, cones);
  // The angles seen along a loop turn by 2 pi times its index.
  for (std::size_t l = 0; l < s.topology.loops.size(); ++l) {
    double turning = 0;
    for (const Index h : s.topology.loops[l].halfedges) {
      turning += pi<double>;
      s.mesh.for_each_outgoing(s.mesh.tail(h),
                               [&](Index g) { turning -= s.geometry.angle(g) + d.alpha[g] - d.alpha[Mesh::prev(g)]; });
    }
    CHECK(turning == doctest::Approx(2 * pi<double> * -0.25).epsilon(1e-8));
  }
}

TEST_CASE("cones that cannot be are refused with the reason") {
  const Case s(icosphere(2));
  const auto reason = [&](const std::vector<Cone>& cones, const TrivialOptions& options) -> std::string {
    try {
      (void)trivial(s.mesh, s.geometry, cones, options);
    } catch (const OptionError& e) {
      return e.what();
    }
    return "";
  };
  CHECK(reason({{0, 1}}, {.n = 1}).find("; 1 is missing") != std::string::npos);
  CHECK(reason({{0, 1}, {5, 0.9}}, {.n = 4}).find("multiple of 1/4") != std::string::npos);
  CHECK(reason({{0, 1}, {9999, 1}}, {.n = 1}).find("no such vertex") != std::string::npos);
  CHECK(reason({{0, 2}}, {.n = 1, .generator_holonomy = {0.5}}).find("one per generator") != std::string::npos);
  CHECK(reason({{0, 2}}, {.n = 0}).find("'n'") != std::string::npos);
  const Case open(disk(3));
  CHECK_THROWS_AS((void)trivial(open.mesh, open.geometry, {{open.mesh.vertices() - 1, 1}}, {.n = 1}), OptionError);
}
