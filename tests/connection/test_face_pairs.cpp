// SPDX-License-Identifier: MIT
//
// Faces joined to pairs in the globally optimal connection: the closed forms for one face and for two against the
// optimum found by a dense solver, the loops over them against each other on all instruction sets, and the pairing.
#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <array>
#include <random>
#include <vector>

#include "alcap/connection.h"
#include "alcap/generators.h"
#include "kernels/connection_energy.h"
#include "kernels/face_relaxation.h"
#include "src/base/parallel.h"
#include "src/connection/global/correction_system.h"
#include "src/connection/global/face_pairs.h"

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

// The forces of a relaxed face for units of all it sees.
Matrix relaxed(const RandomFace& f) {
  Matrix out(9, 9);
  for (int unit = 0; unit < 9; ++unit) {
    double v[3][3] = {}, x[3];
    v[unit / 3][unit % 3] = 1;
    kernels::relax(f.c, v, x);
    for (int i = 0; i < 9; ++i) out(i, unit) = v[i / 3][i % 3];
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
      double va[3][3] = {}, vb[3][3] = {}, xa[3], xb[3], between[3];
      (unit < 6 ? va : vb)[unit % 6 / 2][1 + unit % 2] = 1;
      kernels::relax_pair(a.c, b.c, inverse, va, vb, xa, xb, between);
      for (int i = 0; i < 12; ++i) got(i, unit) = (i < 6 ? va : vb)[i % 6 / 2][1 + i % 2];
      const double left[3] = {va[0][0] + vb[0][0], va[1][0] - vb[1][0], va[2][0] - vb[2][0]};
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

TEST_CASE("all instruction sets give the same bits") {
  const MeshData surface = noisy_scan(3, 0.1, 1);
  const Mesh mesh(surface.F, surface.V.rows());
  const Geometry geometry(mesh, surface.V);
  const detail::FacePairs faces = detail::pair_faces(mesh, geometry);
  REQUIRE(faces.singles > 0);
  std::vector<std::array<float, 3>> first;
  std::vector<double> first_relaxed;
  for (const detail::Isa isa : detail::available_isas()) {
    const auto coefficients = [&](const Index(&some)[detail::simd::group_size], detail::simd::FaceGroup& c) {
      detail::simd::FaceShapes shapes;
      for (int l = 0; l < detail::simd::group_size; ++l) {
        Index h = some[l];
        for (int k = 0; k < 3; ++k, h = Mesh::next(h)) {
          shapes.cot[k][l] = geometry.cot(h);
          shapes.factor[k][l] = mesh.boundary_halfedge(h) ? 0 : 1 + geometry.length(mesh.edge(h));
        }
      }
      detail::simd::group_loops(isa).coefficients(shapes, 10.0, c);
    };
    // The faces 0 to 7 and 8 to 15, for the relaxation alone whether they are neighbours or not.
    detail::simd::FaceGroup group[2];
    for (Index side = 0; side < 2; ++side) {
      Index some[detail::simd::group_size];
      for (Index l = 0; l < detail::simd::group_size; ++l) some[l] = 3 * (detail::simd::group_size * side + l);
      coefficients(some, group[side]);
    }
    const detail::simd::GroupLoops loops = detail::simd::group_loops(isa);
    detail::simd::GroupArray seen[2][3][3], moved[2][3], between[6], turned[3];
    for (int k = 0; k < 2 * 9 * detail::simd::group_size; ++k) (&seen[0][0][0][0])[k] = std::sin(0.7 * k);
    loops.between(group, between);
    loops.relax_pair(group, between, seen, moved, turned);
    loops.relax(group[0], seen[0], moved[0]);
    std::vector<double> relaxed(&seen[0][0][0][0], &seen[0][0][0][0] + 2 * 9 * detail::simd::group_size);
    relaxed.insert(relaxed.end(), &moved[0][0][0], &moved[0][0][0] + 2 * 3 * detail::simd::group_size);
    relaxed.insert(relaxed.end(), &turned[0][0], &turned[0][0] + 3 * detail::simd::group_size);
    if (isa == detail::Isa::scalar) first_relaxed = relaxed;
    CHECK(relaxed == first_relaxed);
    CHECK(std::all_of(relaxed.begin(), relaxed.end(), [](double v) { return std::isfinite(v); }));
    detail::CorrectionSystem<float> system(mesh, faces, coefficients, false, detail::NoVisitor{}, isa);
    const double square = system.start([&](Index i) {
      return std::array<double, 3>{std::sin(1.0 * i), std::sin(2.0 * i), std::sin(3.0 * i)};
    });
    CHECK(conjugate_gradients(system, square, 1e-3, 20) > 2);
    for (Index i = 0; i < faces.outer; ++i) {
      if (isa == detail::Isa::scalar)
        first.push_back(system.solution(i));
      else
        REQUIRE(system.solution(i) == first[static_cast<std::size_t>(i)]);
    }
  }
}
