// SPDX-License-Identifier: MIT
//
// The globally optimal connection against the whole problem as the paper states it (LTGD 2016, Sec. 5.3): least squares
// in every rho_{v->t}, rho_{v->e} and rho_ij, one rho_{v->t} of each vertex held, solved directly. Whitney forms are
// written with gradients of hat functions, and squares along edges integrated by Simpson's rule.
#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "alcap/connection.h"
#include "alcap/generators.h"

using namespace alcap;

namespace {

// A linear function of the unknowns.
struct Affine {
  double constant = 0;
  std::vector<std::pair<Index, double>> terms;

  void add(double factor, const Affine& other) {
    constant += factor * other.constant;
    for (const auto& [unknown, value] : other.terms) terms.emplace_back(unknown, factor * value);
  }
};

class WholeProblem {
 public:
  WholeProblem(const Mesh& mesh, const Geometry& geometry, const GlobalOptions& options)
      : mesh_(mesh), geometry_(geometry), options_(options), start_(polar(mesh, geometry)) {
    double sum = 0;
    for (Index e = 0; e < mesh.edges(); ++e) sum += geometry.length(e);
    mean_length_ = sum / mesh.edges();
    gauge_.assign(static_cast<std::size_t>(mesh.vertices()), none);
    for (Index h = 0; h < mesh.halfedges(); ++h) gauge_[static_cast<std::size_t>(mesh.tail(h))] = h;
    for (Index t = 0; t < mesh.faces(); ++t) add_face(t);
    face_rows_ = static_cast<Eigen::Index>(rows_.size());
    for (Index h = 0; h < mesh.halfedges(); ++h) add_halfedge(h);
    solve();
  }

  double D_T = 0, D_E = 0;
  VectorX<double> K;

 private:
  // rho_{v->t} of corner h, rho_{v->e} at the tail of h, and rho_ij along h, as corrections of the polar map.
  [[nodiscard]] Affine corner(Index h) const {
    if (gauge_[static_cast<std::size_t>(mesh_.tail(h))] == h) return {};  // the gauge of its vertex
    return {0, {{h, 1.0}}};
  }
  [[nodiscard]] Affine edge_end(Index h, bool tip) const {
    const Index e = mesh_.edge(h);
    return {0, {{mesh_.halfedges() + 2 * e + (mesh_.canonical(h) == tip ? 1 : 0), 1.0}}};
  }
  [[nodiscard]] Affine rotation(Index h) const {
    return {0, {{mesh_.halfedges() + 2 * mesh_.edges() + mesh_.edge(h), mesh_.canonical(h) ? 1.0 : -1.0}}};
  }

  [[nodiscard]] Affine tau(Index h) const {  // eq. 8
    Affine out{start_.tau[h], {}};
    out.add(-1, corner(h));
    out.add(1, rotation(h));
    out.add(1, corner(Mesh::next(h)));
    return out;
  }

  // The difference of eqs. 9 and 10 at the tail or the tip of h.
  [[nodiscard]] Affine residual(Index h, bool tip) const {
    const Index c = tip ? Mesh::next(h) : h;
    const double to_edge = tip ? start_.rho_end(mesh_, h) : start_.rho_start(mesh_, h);
    Affine out{wrap(start_.rho_t[c] - to_edge + geometry_.direction(h)), {}};
    out.add(1, corner(c));
    out.add(-1, edge_end(h, tip));
    return out;
  }

  // int_t omega ^ *omega as a sum of squares: W = L L'.
  void add_face(Index t) {
    const double A = geometry_.area(t);
    Eigen::Matrix3d dot, W;  // of gradients of the hat functions
    for (Index i = 0; i < 3; ++i) {
      const double opposite = geometry_.length(mesh_.edge(3 * t + (i + 1) % 3));
      dot(i, i) = opposite * opposite / (4 * A * A);
      const Index j = (i + 1) % 3, k = (i + 2) % 3;
      dot(i, j) = dot(j, i) = -1 / std::tan(geometry_.angle(3 * t + k)) / (2 * A);
    }
    const auto mass = [](Index i, Index j) { return i == j ? 1.0 / 6 : 1.0 / 12; };
    for (Index i = 0; i < 3; ++i)
      for (Index k = 0; k < 3; ++k) {
        const Index j = (i + 1) % 3, l = (k + 1) % 3;
        W(i, k) =
            A * (mass(i, k) * dot(j, l) - mass(i, l) * dot(j, k) - mass(j, k) * dot(i, l) + mass(j, l) * dot(i, k));
      }
    const Eigen::Matrix3d L = Eigen::LLT<Eigen::Matrix3d>(W).matrixL();
    for (Index row = 0; row < 3; ++row) {
      Affine form;
      for (Index k = 0; k < 3; ++k) form.add(L(k, row), tau(3 * t + k));
      rows_.push_back(form);
    }
  }

  void add_halfedge(Index h) {
    const double angle = geometry_.angle(Mesh::prev(h)), length = geometry_.length(mesh_.edge(h));
    const double tangent = angle < pi<double> / 2 ? std::min(std::tan(angle), options_.tan_cap) : options_.tan_cap;
    const double factor = options_.length_factor == LengthFactor::mean_edge ? length / mean_length_
                          : options_.length_factor == LengthFactor::metric  ? length
                                                                            : 1;
    const double lambda = options_.detail;
    for (int point = 0; point < 3; ++point) {
      const double weight = lambda * tangent * factor * (point == 1 ? 4.0 : 1.0) / 6;
      Affine form;
      form.add((1 - point / 2.0) * std::sqrt(weight), residual(h, false));
      form.add(point / 2.0 * std::sqrt(weight), residual(h, true));
      rows_.push_back(form);
    }
  }

  void solve() {
    const Index unknowns = mesh_.halfedges() + 3 * mesh_.edges();
    std::vector<Eigen::Triplet<double, Index>> entries;
    VectorX<double> b(static_cast<Eigen::Index>(rows_.size()));
    for (Index row = 0; row < b.size(); ++row) {
      const Affine& form = rows_[static_cast<std::size_t>(row)];
      b[row] = form.constant;
      for (const auto& [unknown, value] : form.terms) entries.emplace_back(row, unknown, value);
    }
    Eigen::SparseMatrix<double> J(b.size(), unknowns);
    J.setFromTriplets(entries.begin(), entries.end());
    Eigen::SparseMatrix<double> normal = J.transpose() * J;
    for (const Index h : gauge_)
      if (h != none) normal.coeffRef(h, h) = 1;
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(normal);
    REQUIRE(factor.info() == Eigen::Success);
    VectorX<double> x = -factor.solve(J.transpose() * b);
    x -= factor.solve(J.transpose() * (J * x + b));  // a step of refinement: the normal equations square the condition
    const VectorX<double> at_optimum = J * x + b;
    D_T = at_optimum.head(face_rows_).squaredNorm();
    D_E = at_optimum.tail(b.size() - face_rows_).squaredNorm() / options_.detail;
    K.resize(mesh_.faces());
    for (Index t = 0; t < mesh_.faces(); ++t) {
      K[t] = 0;
      for (Index h = 3 * t; h < 3 * t + 3; ++h) {
        const Affine form = tau(h);
        K[t] -= form.constant;
        for (const auto& [unknown, value] : form.terms) K[t] -= value * x[unknown];
      }
    }
  }

  const Mesh& mesh_;
  const Geometry& geometry_;
  GlobalOptions options_;
  Connection start_;
  double mean_length_ = 0;
  std::vector<Index> gauge_;  // per vertex, the corner whose angle is held
  Eigen::Index face_rows_ = 0;
  std::vector<Affine> rows_;
};

void check(const MeshData& surface, const GlobalOptions& options) {
  const Mesh mesh(surface.F, surface.V.rows());
  const Geometry geometry(mesh, surface.V);
  const WholeProblem expected(mesh, geometry, options);
  const Connection c = globally_optimal(mesh, geometry, options);
  CHECK(c.report.converged);
  CHECK(c.report.D_T == doctest::Approx(expected.D_T).epsilon(1e-9));
  CHECK(c.report.D_E == doctest::Approx(expected.D_E).epsilon(1e-9));
  // A cylinder is flat: its K is the rounding of angles.
  CHECK((c.K - expected.K).cwiseAbs().maxCoeff() < 1e-9 * std::max(1e-3, expected.K.cwiseAbs().maxCoeff()));
}

}  // namespace

TEST_CASE("the optimum is that of the whole problem, solved directly") {
  for (const LengthFactor factor : {LengthFactor::mean_edge, LengthFactor::metric, LengthFactor::per_edge})
    check(icosphere(3), {.length_factor = factor, .tolerance = 1e-10});
  check(torus(40, 20, 1.0, 0.4), {.tolerance = 1e-10});
}

TEST_CASE("so it is with boundaries, uneven triangles and any detail") {
  for (const double detail : {0.1, 1.0, 3.0}) {
    check(jittered_sphere(3, 0.2, 5), {.detail = detail, .tolerance = 1e-12});
    check(noisy_scan(3, 0.1, 5), {.detail = detail, .tolerance = 1e-12});
  }
  check(cylinder(16, 8), {.tolerance = 1e-10});
}
