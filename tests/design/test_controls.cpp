// SPDX-License-Identifier: MIT
//
// Controls of the designer beyond targets and strokes: directions, boundary, footprints, weights, the form with
// lambda_t, progress.
#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <cmath>
#include <stdexcept>
#include <string>

#include "alcap/energies.h"
#include "alcap/generators.h"
#include "alcap/singularities.h"
#include "alcap/smoothest.h"
#include "src/base/random.h"
#include "tests/design/designer_case.h"

using namespace alcap;

namespace {

using C = Complex<double>;

struct Case : test::DesignerCase {
  using DesignerCase::DesignerCase;
  [[nodiscard]] StiffnessMass matrices(int n) const {
    const HermitianPattern pattern(mesh);
    return stiffness_and_mass(mesh, pattern, geometry, connection, n);
  }
  [[nodiscard]] double unit(int n) const { return 8 * pi<double> * n / geometry.total_area(); }
  [[nodiscard]] ComplexVectorX<double> random_field(std::uint64_t seed) const {
    detail::Random random(seed);
    ComplexVectorX<double> u(mesh.vertices());
    for (C& z : u) z = {random.uniform(-1, 1), random.uniform(-1, 1)};
    return u;
  }
  [[nodiscard]] SurfacePolyline arc() const {
    Positions<double> points(5, 3);
    for (int k = 0; k < 5; ++k) {
      const double a = 0.3 + 0.3 * k;
      points.row(k) << 2 * std::cos(a), 1.2 * std::sin(a), 1.6 * std::sin(a);
    }
    return stroke_from_space(connected(), points);
  }
};

double relative(const ComplexVectorX<double>& a, const ComplexVectorX<double>& b) { return (a - b).norm() / b.norm(); }

}  // namespace

TEST_CASE("a fixed direction leaves the length free: the best of all lengths, by direct search") {
  const Case s(jittered_sphere(1, 0.1, 2));
  const int n = 2;
  const auto matrices = s.matrices(n);
  const auto &S = matrices.S, &M = matrices.M;
  const ComplexVectorX<double> u0 = s.random_field(1);
  const auto energy = [&](const ComplexVectorX<double>& u) {
    return u.dot(S * u).real() + 0.7 * s.unit(n) / 2 * (u - u0).dot(M * (u - u0)).real();
  };
  const C direction = std::polar(1.0, 1.1);
  auto designer = s.designer({.n = n, .guidance_weight = 0.7});
  designer.set_guidance(u0);
  const auto id = designer.add(VertexConstraint{.vertex = 7, .value = 3.0 * direction, .direction_only = true});
  const DesignResult free = designer.solve();
  CHECK(free.rows == 1);
  const C value = free.field.u[7];
  CHECK(std::abs((value * std::conj(direction)).imag()) < 1e-10);
  const double length = (value * std::conj(direction)).real(), least = energy(free.field.u);
  // Among exact values on the line none does better.
  for (const double factor : {-1.0, 0.9, 0.99, 1.01, 1.1, 2.0}) {
    designer.set(id, VertexConstraint{.vertex = 7, .value = factor * length * direction});
    CHECK(energy(designer.solve().field.u) > least);
  }
  designer.set(id, VertexConstraint{.vertex = 7, .value = length * direction});
  CHECK(relative(designer.solve().field.u, free.field.u) < 1e-9);
  CHECK_THROWS_AS(designer.add(VertexConstraint{.vertex = 7, .value = 0, .direction_only = true}), OptionError);
}

TEST_CASE("fields align with the boundary, along and across, for every n") {
  for (const MeshData& surface : {disk(12), cylinder(24, 12), noisy_scan(3, 0.05, 4)}) {
    const Case s(surface);
    for (int n = 1; n <= 6; ++n) {
      auto designer = s.designer({.n = n, .guidance_weight = 1e-3});
      const auto id = designer.add(BoundaryAlignment{.weight = 10});
      const DesignResult along = designer.solve();
      CHECK(along.controls[0].met);
      designer.set(id, BoundaryAlignment{.normal = true, .weight = 10});
      const DesignResult across = designer.solve();
      CHECK(across.controls[0].met);
      // A quarter turn of the field is n quarter turns of its n-th power.
      const C turn = std::polar(1.0, n * pi<double> / 2);
      CHECK(relative(across.field.u, turn * along.field.u) < 1e-7);
      // The rim of the disk, directly: the field there against the circle.
      if (surface.F.rows() == disk(12).F.rows()) {
        const Field field{.n = n,
                          .u = along.field.u,
                          .frames = std::make_shared<const Frames>(vertex_frames(s.mesh, surface.V, s.connection))};
        for (Index v = 0; v < s.mesh.vertices(); ++v) {
          if (!s.mesh.boundary_vertex(v)) continue;
          const Eigen::RowVector3d x = surface.V.row(v);
          const C tangent = field.frames->component(v, Eigen::RowVector3d(-x[1], x[0], 0));
          CHECK(std::abs(wrap(std::arg(field.u[v]) - n * std::arg(tangent))) / n < 0.05);
        }
      }
    }
  }
  const Case closed(icosphere(2));
  auto designer = closed.designer({.n = 1});
  CHECK_THROWS_AS(designer.add(BoundaryAlignment{}), OptionError);
}

TEST_CASE("a footprint draws a band along, weighs as much as the line, and narrows to it") {
  const Case s(bumpy_sphere(4, 0.1, 3));
  const SurfacePolyline line = s.arc();
  for (const int n : {1, 4}) {
    auto designer = s.designer({.n = n});
    const auto id = designer.add(Stroke{.line = line});
    const DesignResult thin = designer.solve();
    designer.set(id, Stroke{.line = line, .radius = 0.15});
    const DesignResult band = designer.solve();
    CHECK(thin.controls[0].met);
    CHECK(band.controls[0].met);
    CHECK(band.rows > 30);
    // Along the line itself the band does nearly as well.
    double worst = 0;
    for (const SurfaceSegment& segment : line.segments) {
      const C u = face_field(s.mesh, s.geometry, s.connection, n, band.field.u, segment.face).at(segment.at(0.5)).u;
      worst = std::max(worst, std::abs(wrap(std::arg(u) - n * std::arg(segment.tangent))) / n);
    }
    CHECK(worst < 0.35);
    // The same surface ten times as large, with a radius ten times as large: the same field.
    MeshData large = s.surface;
    large.V *= 10;
    const Case l(large);
    SurfacePolyline scaled = line;
    for (SurfaceSegment& segment : scaled.segments) segment.length *= 10;
    auto other = l.designer({.n = n});
    other.add(Stroke{.line = scaled, .radius = 1.5});
    CHECK(relative(other.solve().field.u, band.field.u) < 1e-7);
  }
  auto designer = s.designer({.n = 1});
  CHECK_THROWS_AS(designer.add(Stroke{.line = line, .radius = 1e-9}), OptionError);
  CHECK_THROWS_AS(designer.add(Stroke{.line = line, .radius = -1}), OptionError);
}

TEST_CASE(
    "the form with lambda_t: t = -w is guidance weight w, t towards lambda_1 the smoothest field, above it an error") {
  const Case s(bumpy_sphere(3, 0.3, 2.3));
  for (const int n : {1, 2, 4}) {
    const ComplexVectorX<double> u0 = s.random_field(3);
    auto by_weight = s.designer({.n = n, .guidance_weight = 1});
    auto by_t = s.designer({.n = n, .t = -1.0});
    by_weight.set_guidance(u0);
    by_t.set_guidance(u0);
    CHECK(relative(by_t.solve().field.u, by_weight.solve().field.u) < 1e-10);

    const auto smooth = smoothest_field(s.mesh, s.geometry, s.connection, nullptr, {.n = n});
    const double limit = 2 * smooth.components[0].lambda / s.unit(n);
    CHECK_THROWS_AS((void)s.designer({.n = n, .t = 1.01 * limit}), OptionError);
    auto close = s.designer({.n = n, .t = (1 - 1e-5) * limit});
    close.set_guidance(u0);
    const ComplexVectorX<double> u = close.solve().field.u;
    if (smooth.components[0].next.value_or(0) > 1.1 * smooth.components[0].lambda) {
      const auto M = s.matrices(n).M;
      const C overlap = smooth.field.u.dot(M * u);
      CHECK(std::norm(overlap) / u.dot(M * u).real() > 1 - 1e-4);
    }
    // In between: (S - lambda_t M) u is proportional to M u0.
    const double t = 0.4 * limit;
    auto between = s.designer({.n = n, .t = t});
    between.set_guidance(u0);
    const ComplexVectorX<double> v = between.solve().field.u;
    const auto [S, M] = s.matrices(n);
    CHECK(relative(2.0 * (S * v) - t * s.unit(n) * (M * v), s.unit(n) * (M * u0)) < 1e-9);
  }
  CHECK_THROWS_AS((void)s.designer({.n = 1, .guidance_weight = 1, .t = 0.0}), OptionError);

  // A vertex that no face uses changes nothing, and its value is zero.
  MeshData more = s.surface;
  more.V.conservativeResize(more.V.rows() + 1, 3);
  more.V.bottomRows(1).setConstant(9);
  const Case with_more(more);
  const ComplexVectorX<double> u0 = with_more.random_field(3);
  auto plain = s.designer({.n = 2, .t = 0.1}), other = with_more.designer({.n = 2, .t = 0.1});
  plain.set_guidance(u0.head(u0.size() - 1));
  other.set_guidance(u0);
  const ComplexVectorX<double> u = other.solve().field.u;
  CHECK(u[u.size() - 1] == C(0));
  CHECK(relative(u.head(u.size() - 1), plain.solve().field.u) < 1e-9);
}

TEST_CASE("guidance weights, one or per vertex, change the matrix as a new designer would") {
  const Case s(jittered_sphere(2, 0.2, 9));
  const int n = 2;
  const ComplexVectorX<double> u0 = s.random_field(5);
  auto edited = s.designer({.n = n, .guidance_weight = 0.3});
  edited.set_guidance(u0);
  edited.add(SingularityTarget{.face = 10, .pin = std::array<double, 3>{0.2, 0.5, 0.3}});
  (void)edited.solve();
  edited.set_guidance_weight(2.5);
  auto fresh = s.designer({.n = n, .guidance_weight = 2.5});
  fresh.set_guidance(u0);
  fresh.add(SingularityTarget{.face = 10, .pin = std::array<double, 3>{0.2, 0.5, 0.3}});
  CHECK(relative(edited.solve().field.u, fresh.solve().field.u) < 1e-10);

  // All weights 4 is four times the weight.
  edited.set_guidance_weights(VectorX<double>::Constant(s.mesh.vertices(), 4.0));
  fresh.set_guidance_weight(10);
  CHECK(relative(edited.solve().field.u, fresh.solve().field.u) < 1e-10);
  // Weights on a half: there the field is near u0, elsewhere it is not.
  VectorX<double> half(s.mesh.vertices());
  for (Index v = 0; v < s.mesh.vertices(); ++v) half[v] = s.surface.V(v, 2) > 0 ? 1e4 : 0;
  edited.set_guidance_weights(half);
  const ComplexVectorX<double> u = edited.solve().field.u;
  double inside = 0, outside = 0;
  for (Index v = 0; v < s.mesh.vertices(); ++v)
    (s.surface.V(v, 2) > 0.3 ? inside : outside) +=
        s.surface.V(v, 2) > 0.3 || s.surface.V(v, 2) < -0.3 ? std::norm(u[v] - u0[v]) : 0;
  CHECK(inside < 1e-2 * outside);

  CHECK_THROWS_AS(edited.set_guidance_weight(-1), OptionError);
  CHECK_THROWS_AS(edited.set_guidance_weights(VectorX<double>::Zero(s.mesh.vertices())), OptionError);
  CHECK_THROWS_AS(edited.set_guidance_weights(VectorX<double>::Ones(3)), OptionError);
  CHECK(relative(edited.solve().field.u, u) < 1e-12);  // refused changes change nothing
}

TEST_CASE("turning a target that was changed before takes no solve, and many live targets none too many") {
  const Case s(jittered_sphere(3, 0.2, 4));
  auto designer = s.designer({.n = 4});
  std::vector<ControlId> ids;
  for (Index k = 0; k < 12; ++k)
    ids.push_back(designer.add(SingularityTarget{.face = 100 * k, .sign = k % 2 ? 1 : -1}));
  (void)designer.solve();
  const auto turn = [&](std::size_t k, double angle) {
    designer.set(ids[k],
                 SingularityTarget{.face = static_cast<Index>(100 * k), .sign = k % 2 ? 1 : -1, .orientation = angle});
    return designer.solve();
  };
  CHECK(turn(3, 0.1).solves > 0);
  CHECK(turn(3, 0.2).solves == 0);
  for (std::size_t k = 0; k < 12; ++k) (void)turn(k, 0.3 + 0.01 * double(k));
  const DesignResult edited = turn(11, 0.9);
  CHECK(edited.solves == 0);
  auto fresh = s.designer({.n = 4});
  for (const auto& [id, control] : designer.controls()) fresh.add(control);
  const DesignResult scratch = fresh.solve();
  CHECK(relative(edited.field.u, scratch.field.u) < 1e-9);
  CHECK(edited.residual < 1e-9);
  for (std::size_t k = 0; k < 12; ++k) CHECK(edited.controls[k].met == scratch.controls[k].met);
}

TEST_CASE("turning a pinned target solves nothing either, and few or many pins give the field of a design made once") {
  const Case s(jittered_sphere(3, 0.2, 4));
  const std::array<double, 3> pin{0.2, 0.3, 0.5};
  const auto target = [&](int k, double angle) {
    return SingularityTarget{
        .face = static_cast<Index>(40 * k), .sign = k % 2 ? 1 : -1, .orientation = angle, .pin = pin};
  };
  for (const int pins : {1, 3, 16, 20}) {  // beyond 16 the last rows are kept as half solutions, beside the columns
    CAPTURE(pins);
    auto designer = s.designer({.n = 4, .guidance_weight = 0.1});
    std::vector<ControlId> ids;
    for (int k = 0; k < pins; ++k) {
      ids.push_back(designer.add(target(k, 0)));
      if (k == pins / 2) (void)designer.solve();
    }
    const ControlId fixed = designer.add(VertexConstraint{.vertex = 17, .direction_only = true});
    designer.set(ids[0], target(0, 0.1));
    (void)designer.solve();
    designer.set(ids[0], target(0, 0.2));
    const DesignResult edited = designer.solve();
    CHECK(edited.solves == (pins < 16 ? 0 : 1));
    auto once = s.designer({.n = 4, .guidance_weight = 0.1, .right_hand_sides = pins + 2});
    for (const auto& [id, control] : designer.controls()) once.add(control);
    const DesignResult scratch = once.solve();
    CHECK(relative(edited.field.u, scratch.field.u) < 1e-8);
    for (int k = 0; k < pins; ++k) {
      const ComplexVectorX<double>& u = edited.field.u;
      const FaceField inside = face_field(s.mesh, s.geometry, s.connection, 4, u, static_cast<Index>(40 * k));
      CHECK(std::abs(inside.at(pin).u) < 1e-9 * u.cwiseAbs().maxCoeff());
    }
    designer.remove(fixed);
  }
}

TEST_CASE("the energy family reaches designs: s = 1 and -1 against their matrices") {
  const Case s(bumpy_sphere(2, 0.2, 3));
  const HermitianPattern pattern(s.mesh);
  for (const double family : {-1.0, 0.5, 1.0}) {
    auto designer = s.designer({.n = 2, .guidance_weight = 0.5, .s = family});
    const ComplexVectorX<double> u0 = s.random_field(8);
    designer.set_guidance(u0);
    const ComplexVectorX<double> u = designer.solve().field.u;
    auto [S, M] = s.matrices(2);
    apply_energy_family(s.mesh, pattern, s.geometry, s.connection, 2, family, S);
    CHECK(relative(2.0 * (S * u) + 0.5 * s.unit(2) * (M * u), 0.5 * s.unit(2) * (M * u0)) < 1e-9);
  }
  CHECK_THROWS_AS((void)s.designer({.n = 1, .guidance_weight = 1, .s = 2}), OptionError);
}

TEST_CASE("progress tells the phases; an exception there stops the call and leaves a designer that works") {
  const Case s(bumpy_sphere(3, 0.2, 3));
  std::vector<std::string> phases;
  std::string stop_at;
  DesignerOptions options{.n = 2, .guidance_weight = 0.5, .largest_rank = 5};
  options.progress = [&](std::string_view phase) {
    phases.emplace_back(phase);
    if (phase == stop_at) throw std::runtime_error("stop");
  };
  auto designer = s.designer(options);
  CHECK(phases == std::vector<std::string>{"assembly", "analyse", "factorise"});
  designer.add(SingularityTarget{.face = 10, .pin = std::array<double, 3>{0.2, 0.5, 0.3}});
  auto fresh = s.designer({.n = 2, .guidance_weight = 0.5, .largest_rank = 5});
  fresh.add(SingularityTarget{.face = 10, .pin = std::array<double, 3>{0.2, 0.5, 0.3}});
  for (const char* phase : {"rows", "solve", "analysis", "factorise"}) {
    stop_at = phase;
    const Stroke stroke{.line = s.arc()};  // more rows than the largest rank: folded
    if (stop_at == "factorise") {
      designer.add(stroke);
      fresh.add(stroke);
    }
    CHECK_THROWS_AS((void)designer.solve(), std::runtime_error);
    stop_at.clear();
    CHECK(relative(designer.solve().field.u, fresh.solve().field.u) < 1e-9);
    designer.set_guidance(s.random_field(1));
    fresh.set_guidance(s.random_field(1));
  }
}
