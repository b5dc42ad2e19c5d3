// SPDX-License-Identifier: MIT
//
// operators_fixture.h: meshes with geometry, random fields and connections, and quadrature, for the tests of operators.
#pragma once

#include "alcap/operators.h"

#include <Eigen/Geometry>
#include <functional>
#include <vector>

#include "alcap/frames.h"
#include "alcap/generators.h"
#include "src/base/random.h"
#include "tests/support/mesh_case.h"

namespace alcap::test {

using C = std::complex<double>;
using Vec = ComplexVectorX<double>;
using Row = Eigen::RowVector3d;
inline constexpr C I(0, 1);

using Case = MeshCase;

inline Vec random_field(const Mesh& mesh, detail::Random& random) {
  Vec u(mesh.vertices());
  for (C& z : u) z = C(random.uniform(-1, 1), random.uniform(-1, 1));
  return u;
}

/// Any connection at all: every angle moved by up to `size`, lifts kept consistent.
inline Connection scrambled(const Mesh& mesh, Connection c, double size, detail::Random& random) {
  const auto any = [&] { return random.uniform(-size, size); };
  for (Index e = 0; e < mesh.edges(); ++e) {
    const double at_tail = any(), at_tip = any(), along = any();
    c.rho_e[2 * e] += at_tail;
    c.rho_e[2 * e + 1] += at_tip;
    c.rho[e] += along;
    c.eps[e] += along - at_tail + at_tip;
    const Index h = mesh.halfedge(e), g = mesh.twin(h);
    c.tau[h] += along;
    if (g != none) c.tau[g] -= along;
  }
  for (Index h = 0; h < mesh.halfedges(); ++h) {
    const double turn = any();
    c.rho_t[h] += turn;
    c.tau[h] -= turn;
    c.tau[Mesh::prev(h)] += turn;
  }
  for (Index t = 0; t < mesh.faces(); ++t) c.K[t] = -(c.tau[3 * t] + c.tau[3 * t + 1] + c.tau[3 * t + 2]);
  return c;
}

/// Gauss-Legendre nodes and weights on [0, 1], by Newton's method.
inline std::vector<std::pair<double, double>> gauss(int count) {
  std::vector<std::pair<double, double>> rule;
  for (int i = 0; i < count; ++i) {
    double x = std::cos(pi<double> * (i + 0.75) / (count + 0.5)), slope = 1;
    for (int step = 0; step < 8; ++step) {
      double before = 1, now = x;
      for (int k = 2; k <= count; ++k) {
        const double next = ((2 * k - 1) * x * now - (k - 1) * before) / k;
        before = now;
        now = next;
      }
      slope = count * (x * now - before) / (x * x - 1);
      x -= now / slope;
    }
    rule.emplace_back((1 + x) / 2, 1 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

/// Integral over a triangle of the given area of f(barycentric).
inline C over_triangle(double area, const std::function<C(const std::array<double, 3>&)>& f) {
  static const auto rule = gauss(20);
  C sum = 0;
  for (const auto& [x, wx] : rule)
    for (const auto& [y, wy] : rule) sum += wx * wy * (1 - x) * f({x, y * (1 - x), (1 - x) * (1 - y)});
  return 2 * area * sum;
}

/// The largest deviation over the largest value.
inline double relative(const Vec& a, const Vec& b) { return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff(); }

/// Components of tangential vectors in space as an n-field: (component)^n.
inline Vec components(const Frames& frames, const std::function<Row(Index)>& vector, int n = 1) {
  Vec u(frames.X.rows());
  for (Index v = 0; v < u.size(); ++v) u[v] = std::pow(frames.component(v, vector(v)), n);
  return u;
}

/// A smooth random field in space: polynomials of degree two.
struct Smooth {
  Eigen::Matrix<double, 3, 9> A;
  explicit Smooth(detail::Random& random) {
    for (double& a : A.reshaped()) a = random.uniform(-1, 1);
  }
  Row operator()(const Row& p) const {
    Eigen::Matrix<double, 9, 1> m;
    m << 0, p.x(), p.y(), p.z(), p.x() * p.y(), p.y() * p.z(), p.z() * p.x(), p.x() * p.x(), p.y() * p.y();
    m[0] = 1;
    return (A * m).transpose();
  }
};

}  // namespace alcap::test
