// SPDX-License-Identifier: MIT
//
// Faces joined to pairs in the globally optimal connection: the closed forms for one face and for two against the
// optimum found by a dense solver, the loops over them against each other on all instruction sets, and the pairing.
#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "alcap/connection.h"
#include "alcap/generators.h"
#include "kernels/connection_energy.h"
#include "kernels/face_relaxation.h"
#include "src/base/parallel.h"
#include "src/connection/global/conjugate_gradients.h"
#include "src/connection/global/pairs.h"
#include "src/connection/global/system.h"

using namespace alcap;
using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

namespace {

struct RandomFace {
  double cot[3], p[3];
  kernels::FaceCoefficients<double> c;
  template <class Random>
  explicit RandomFace(Random& random) {
    std::uniform_real_distribution<double> angle(0.2, 1.2), weight(0.1, 10);
    const double a = angle(random), b = angle(random);
    cot[0] = 1 / std::tan(a);
    cot[1] = 1 / std::tan(b);
    cot[2] = -1 / std::tan(a + b);
    for (double& w : p) w = weight(random);
    kernels::face_coefficients(cot, p, c);
  }

  // The energy in mean, difference and tau of each halfedge (0 to 8) and the corners (9 to 11), as its Hessian / 2.
  [[nodiscard]] Matrix hessian() const {
    Matrix corners = Matrix::Zero(9, 12), middle = Matrix::Zero(9, 9);
    corners.leftCols(9).setIdentity();
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      corners(k, 9 + k) = corners(k, 9 + next) = 0.5;
      corners(3 + k, 9 + next) = corners(6 + k, 9 + next) = 1;
      corners(3 + k, 9 + k) = corners(6 + k, 9 + k) = -1;
      middle(k, k) = p[k];
      middle(3 + k, 3 + k) = p[k] / 12;
      double tau[3] = {}, gradient[3];
      tau[k] = 1;
      kernels::triangle_energy_gradient(cot, tau, gradient);
      for (int j = 0; j < 3; ++j) middle(6 + j, 6 + k) = gradient[j] / 2;
    }
    return corners.transpose() * middle * corners;
  }
};

// What is left of the symmetric A when unknowns from `kept` on have moved to the optimum.
Matrix schur(const Matrix& A, Eigen::Index kept) {
  const Eigen::Index rest = A.rows() - kept;
  return A.topLeftCorner(kept, kept) -
         A.topRightCorner(kept, rest) * A.bottomRightCorner(rest, rest).ldlt().solve(A.bottomLeftCorner(rest, kept));
}

// Entry i of what a face sees or answers, in the order mean, difference, tau of halfedges 0, 1, 2.
double& entry(kernels::FaceState<double>& v, int i) { return (i < 3 ? v.mean : i < 6 ? v.difference : v.tau)[i % 3]; }

// The forces of a relaxed face for units of all it sees.
Matrix relaxed(const RandomFace& f) {
  Matrix out(9, 9);
  for (int unit = 0; unit < 9; ++unit) {
    kernels::FaceState<double> v = {};
    double x[3];
    entry(v, unit) = 1;
    kernels::relax(f.c, v, x);
    for (int i = 0; i < 9; ++i) out(i, unit) = entry(v, i);
  }
  return out;
}

double distance(const Matrix& a, const Matrix& b) { return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff(); }

}  // namespace

TEST_CASE("a relaxed face has its corners at the optimum") {
  std::mt19937_64 random(1);
  for (int repeat = 0; repeat < 20; ++repeat) {
    const RandomFace f(random);
    const Matrix expected = schur(f.hessian(), 9);
    CHECK(distance(relaxed(f), expected) < 1e-12);
    for (int k = 0; k < 3; ++k) {
      double pull[3][3], own[6];
      kernels::unit_pulls(f.c, k, pull);
      kernels::own_block(f.c, k, pull, own);
      for (int u = 0, i = 0; u < 3; ++u)
        for (int w = u; w < 3; ++w, ++i)
          CHECK(own[i] == doctest::Approx(expected(3 * u + k, 3 * w + k)).epsilon(1e-11));
    }
  }
}

TEST_CASE("a relaxed pair has the edge between at the optimum too") {
  std::mt19937_64 random(2);
  for (int repeat = 0; repeat < 20; ++repeat) {
    const RandomFace a(random), b(random);
    // Both faces after their corners have moved, in what the outer halfedges see (a: 0 to 5, b: 6 to 11) and in the
    // edge between (12 to 14), of which b sees (m, -d, -t).
    Matrix joint = Matrix::Zero(15, 15);
    for (int side = 0; side < 2; ++side) {
      const Matrix one = schur((side == 0 ? a : b).hessian(), 9);
      Matrix place = Matrix::Zero(9, 15);
      for (int i = 0; i < 3; ++i) {
        place(3 * i, 12 + i) = side == 1 && i > 0 ? -1 : 1;
        for (int k = 1; k < 3; ++k) place(3 * i + k, 6 * side + 2 * i + k - 1) = 1;
      }
      joint += place.transpose() * one * place;
    }
    const Matrix expected = schur(joint, 12);
    double inverse[6];
    kernels::invert_between(a.c, b.c, inverse);
    Matrix got(12, 12);
    for (int unit = 0; unit < 12; ++unit) {
      kernels::FaceState<double> va = {}, vb = {};
      double xa[3], xb[3], between[3];
      const auto outer = [&](int i) -> double& { return entry(i < 6 ? va : vb, 3 * (i % 6 / 2) + 1 + i % 2); };
      outer(unit) = 1;
      kernels::relax_pair(a.c, b.c, inverse, va, vb, xa, xb, between);
      for (int i = 0; i < 12; ++i) got(i, unit) = outer(i);
      const double left[3] = {va.mean[0] + vb.mean[0], va.difference[0] - vb.difference[0], va.tau[0] - vb.tau[0]};
      for (const double force : left) CHECK(std::abs(force) < 1e-12 * expected.cwiseAbs().maxCoeff());
    }
    CHECK(distance(got, expected) < 1e-11);
    for (int side = 0; side < 2; ++side) {
      double outer[2][6];
      kernels::outer_blocks((side == 0 ? a : b).c, inverse, side == 1, outer);
      for (int k = 0; k < 2; ++k)
        for (int u = 0, i = 0; u < 3; ++u)
          for (int w = u; w < 3; ++w, ++i)
            CHECK(outer[k][i] == doctest::Approx(expected(6 * side + 2 * u + k, 6 * side + 2 * w + k)).epsilon(1e-10));
    }
  }
}

TEST_CASE("pairs: every face is in one or alone, and the other edges are the outer ones") {
  const MeshData surfaces[] = {jittered_sphere(4, 0.2, 1),
                               noisy_scan(4, 0.1, 1),
                               disk(12),
                               cad_like(16, 8),
                               icosphere(3),
                               torus_random_diagonals(40, 16, 1, 0.4, 3),
                               tetrahedron(),
                               single_triangle()};
  for (const MeshData& surface : surfaces) {
    const Mesh mesh(surface.F, surface.V.rows());
    const Geometry geometry(mesh, surface.V);
    detail::FacePairs one;
    run_with_threads(1, [&] { one = detail::pair_faces(mesh, geometry); });
    const detail::FacePairs p = detail::pair_faces(mesh, geometry);
    std::vector<int> seen(static_cast<std::size_t>(mesh.faces()), 0);
    std::vector<int> edges(static_cast<std::size_t>(mesh.edges()), 0);
    for (std::size_t i = 0; i < static_cast<std::size_t>(p.pairs); ++i) {
      const Index h = mesh.halfedge(p.between[i]);
      REQUIRE(mesh.twin(h) != none);
      ++seen[static_cast<std::size_t>(Mesh::face(h))];
      ++seen[static_cast<std::size_t>(Mesh::face(mesh.twin(h)))];
      ++edges[static_cast<std::size_t>(p.between[i])];
      CHECK(p.number[static_cast<std::size_t>(p.between[i])] == p.outer + static_cast<Index>(i));
      CHECK(one.between[i] == p.between[i]);
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(p.singles); ++i) ++seen[static_cast<std::size_t>(p.single[i])];
    for (std::size_t i = 0; i < static_cast<std::size_t>(p.outer); ++i) {
      ++edges[static_cast<std::size_t>(p.edge[i])];
      CHECK(p.number[static_cast<std::size_t>(p.edge[i])] == static_cast<Index>(i));
    }
    for (const int times : seen) CHECK(times == 1);
    for (const int times : edges) CHECK(times == 1);
    CHECK(one.pairs == p.pairs);
    if (mesh.faces() > 100) CHECK(p.pairs > 0.4 * mesh.faces());
  }
}

namespace {

using namespace alcap::detail::simd;

// Coefficients of faces with weights that are different everywhere.
struct Weighted {
  const Mesh& mesh;
  const Geometry& geometry;
  const GroupLoops& loops;

  void operator()(const Index (&first)[group_size], FaceGroup& c) const {
    FaceShapes shapes;
    for (int l = 0; l < group_size; ++l) {
      Index h = first[l];
      for (int k = 0; k < 3; ++k, h = Mesh::next(h)) {
        shapes.cot[k][l] = geometry.cot(h);
        shapes.factor[k][l] = mesh.boundary_halfedge(h) ? 0 : 1 + geometry.length(mesh.edge(h));
      }
    }
    loops.coefficients(shapes, 10.0, c);
  }
};

void append(const GroupArray* from, int count, std::vector<double>& to) {
  for (int g = 0; g < count; ++g) to.insert(to.end(), from[g], from[g] + group_size);
}

// What relaxing the faces 0 to 7 and 8 to 15, whether they are neighbours or not, leaves everywhere.
std::vector<double> relaxed_groups(const Weighted& coefficients) {
  FaceGroup group[2];
  GroupState seen[2];
  for (Index side = 0; side < 2; ++side) {
    Index first[group_size];
    for (Index l = 0; l < group_size; ++l) first[l] = 3 * (group_size * side + l);
    coefficients(first, group[side]);
    int i = 0;
    for (auto* const part : {&seen[side].mean, &seen[side].difference, &seen[side].tau})
      for (auto& lanes : *part)
        for (double& value : lanes) value = std::sin(0.7 * (i++ + 72 * side));
  }
  GroupArray moved[2][3], between[6], turned[3];
  coefficients.loops.between(group, between);
  coefficients.loops.relax_pair(group, between, seen, moved, turned);
  coefficients.loops.relax(group[0], seen[0], moved[0]);
  std::vector<double> out;
  for (const GroupState& v : seen)
    for (const auto* const part : {&v.mean, &v.difference, &v.tau}) append(*part, 3, out);
  for (const auto& m : moved) append(m, 3, out);
  append(turned, 3, out);
  return out;
}

// The solution of twenty steps of conjugate gradients in S.
template <class S>
std::vector<detail::EdgeCorrection> solved(const detail::FacePairs& faces, const Weighted& coefficients,
                                           detail::Isa isa) {
  detail::CorrectionSystem<S> system(coefficients.mesh, faces, coefficients, detail::Rotations::free,
                                     detail::NoVisitor{}, isa);
  const double square = system.start([&](Index i) {
    return detail::EdgeCorrection{std::sin(1.0 * i), std::sin(2.0 * i), std::sin(3.0 * i)};
  });
  CHECK(conjugate_gradients(system, square, 1e-3, 20) > 2);
  std::vector<detail::EdgeCorrection> solution;
  for (Index i = 0; i < faces.outer; ++i) solution.push_back(system.solution(i));
  return solution;
}

}  // namespace

TEST_CASE("all instruction sets give the same bits") {
  const MeshData surface = noisy_scan(3, 0.1, 1);
  const Mesh mesh(surface.F, surface.V.rows());
  const Geometry geometry(mesh, surface.V);
  const detail::FacePairs faces = detail::pair_faces(mesh, geometry);
  REQUIRE(faces.singles > 0);
  const Weighted reference{mesh, geometry, loops(detail::Isa::portable).group};
  const std::vector<double> relaxed = relaxed_groups(reference);
  CHECK(std::all_of(relaxed.begin(), relaxed.end(), [](double v) { return std::isfinite(v); }));
  const auto in_float = solved<float>(faces, reference, detail::Isa::portable);
  const auto in_double = solved<double>(faces, reference, detail::Isa::portable);
  for (const detail::Isa isa : detail::available_isas()) {
    CAPTURE(std::string(name(isa)));
    const Weighted coefficients{mesh, geometry, loops(isa).group};
    CHECK(relaxed_groups(coefficients) == relaxed);
    CHECK(solved<float>(faces, coefficients, isa) == in_float);
    CHECK(solved<double>(faces, coefficients, isa) == in_double);
  }
}

TEST_CASE("whitening and inverting agree on what has energy") {
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  for (int rank = 0; rank <= 3; ++rank)
    for (int repeat = 0; repeat < 20; ++repeat) {
      // The first `rank` directions have energy, the others none: their rows are zero.
      Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
      const auto some = Eigen::Matrix3d::NullaryExpr([&] { return normal(random); }).eval();
      A.topLeftCorner(rank, rank) = (some * some.transpose()).topLeftCorner(rank, rank);
      const double a[6] = {A(0, 0), A(0, 1), A(0, 2), A(1, 1), A(1, 2), A(2, 2)};
      double inverse[6], u[6];
      kernels::invert_symmetric(a, inverse);
      kernels::whiten_symmetric(a, u);
      Eigen::Matrix3d U, B;
      U << u[0], 0, 0, u[1], u[2], 0, u[3], u[4], u[5];
      B << inverse[0], inverse[1], inverse[2], inverse[1], inverse[3], inverse[4], inverse[2], inverse[4], inverse[5];
      const double size = 1 + B.cwiseAbs().maxCoeff();
      CHECK((U.transpose() * U - B).cwiseAbs().maxCoeff() < 1e-9 * size);
      CHECK((A * B * A - A).cwiseAbs().maxCoeff() < 1e-9 * size);
      CHECK((B.diagonal().array() > 0).count() == rank);
    }
}
