// SPDX-License-Identifier: MIT
#include "apps/alcap/tables/tables_shapes.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <deque>
#include <map>
#include <utility>

#include "alcap/cones.h"
#include "alcap/connected_surface.h"
#include "alcap/field.h"
#include "alcap/frames.h"
#include "alcap/smoothest.h"
#include "apps/alcap/tables/tables_harmonics.h"
#include "src/base/random.h"

namespace alcap::app {
namespace {

constexpr int monomials = 19;

/// x^i y^j z^k of degree 1 to 3, in a fixed order.
template <class Visit>
void for_each_monomial(Visit&& visit) {
  int number = 0;
  for (int degree = 1; degree <= 3; ++degree)
    for (int i = degree; i >= 0; --i)
      for (int j = degree - i; j >= 0; --j) visit(number++, std::array<int, 3>{i, j, degree - i - j});
}

double power(double x, int n) { return n < 0 ? 0 : n == 0 ? 1 : n == 1 ? x : n == 2 ? x * x : x * x * x; }

/// The derivative of the monomial once along a and once along b; -1: not at all.
double derivative(const Row& p, std::array<int, 3> exponents, int a, int b) {
  double factor = 1;
  for (const int axis : {a, b}) {
    if (axis < 0) continue;
    int& n = exponents[static_cast<std::size_t>(axis)];
    factor *= n--;
  }
  if (factor == 0) return 0;
  return factor * power(p.x(), exponents[0]) * power(p.y(), exponents[1]) * power(p.z(), exponents[2]);
}

Row gradient_of(const Row& p, const std::array<int, 3>& exponents) {
  return {derivative(p, exponents, 0, -1), derivative(p, exponents, 1, -1), derivative(p, exponents, 2, -1)};
}

/// Laplace-Beltrami of every monomial at a point of the body: tr H - n'Hn - (n . grad f) div n.
void laplacians(const Body& body, const Row& p, Eigen::VectorXd& out) {
  const Row g = body.gradient(p);
  const double size = g.norm();
  const Row n = g / size;
  const Eigen::Matrix3d G = body.hessian(p);
  const double div_n = (G.trace() - n.dot(Row(n * G))) / size;
  for_each_monomial([&](int k, const std::array<int, 3>& exponents) {
    Eigen::Matrix3d H;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) H(a, b) = derivative(p, exponents, a, b);
    out[k] = H.trace() - n.dot(Row(n * H)) - n.dot(gradient_of(p, exponents)) * div_n;
  });
}

/// The gradients on the surface as components along x and y = n cross x, one row.
void components(const Body& body, const Row& p, Row x, Eigen::Ref<Eigen::RowVectorXcd> out) {
  const Row n = body.gradient(p).normalized();
  x = (x - x.dot(n) * n).normalized();
  const Row y = n.cross(x);
  for_each_monomial([&](int k, const std::array<int, 3>& exponents) {
    const Row g = gradient_of(p, exponents);
    out[k] = {g.dot(x), g.dot(y)};
  });
}

double six_volumes(const Row& a, const Row& b, const Row& c, const Row& d) { return (b - a).cross(c - a).dot(d - a); }

}  // namespace

MeshData noisy_sphere(int level, double noise, std::uint64_t seed) {
  MeshData out = icosphere(level);
  const Mesh mesh(out.F, out.V.rows());
  const double height = noise * Geometry(mesh, out.V).lengths().mean();
  detail::Random random(seed);
  for (Eigen::Index v = 0; v < out.V.rows(); ++v) out.V.row(v) *= 1 + height * random.uniform(-1, 1);
  return out;
}

MeshData random_points_sphere(int level, std::uint64_t seed) {
  MeshData out;
  out.V.resize(icosphere(level).V.rows(), 3);
  detail::Random random(seed);
  for (Eigen::Index v = 0; v < out.V.rows(); ++v) {
    const double z = random.uniform(-1, 1), a = random.uniform(0, 2 * pi<double>), r = std::sqrt(1 - z * z);
    out.V.row(v) << r * std::cos(a), r * std::sin(a), z;
  }
  const auto at = [&](Index v) -> Row { return out.V.row(v); };
  // The hull grows by one point after the other: faces that see it go, and their rim is joined with it. Points of a
  // sphere are corners of their hull, all of them.
  std::vector<std::array<Index, 3>> faces = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
  if (six_volumes(at(0), at(1), at(2), at(3)) > 0)
    for (auto& f : faces) std::swap(f[1], f[2]);
  for (Index v = 4; v < static_cast<Index>(out.V.rows()); ++v) {
    std::map<std::pair<Index, Index>, bool> rim;
    std::vector<std::array<Index, 3>> kept;
    for (const auto& f : faces) {
      if (!(six_volumes(at(f[0]), at(f[1]), at(f[2]), at(v)) > 0)) {
        kept.push_back(f);
        continue;
      }
      for (std::size_t c = 0; c < 3; ++c) {
        const Index a = f[c], b = f[(c + 1) % 3];
        if (rim.erase({b, a}) == 0) rim[{a, b}] = true;
      }
    }
    for (const auto& [edge, unused] : rim) kept.push_back({edge.first, edge.second, v});
    faces = std::move(kept);
  }
  out.F.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t t = 0; t < faces.size(); ++t)
    out.F.row(static_cast<Eigen::Index>(t)) << faces[t][0], faces[t][1], faces[t][2];
  return out;
}

double Body::value(const Row& p) const {
  if (R > 0) return std::pow(std::hypot(p.x(), p.y()) - R, 2) + p.z() * p.z() - r * r;
  return a * p.x() * p.x() + b * p.y() * p.y() + c * p.z() * p.z() + d * p.x() * p.y() * p.z() +
         e * p.x() * p.x() * p.x() - 1;
}

Row Body::gradient(const Row& p) const {
  if (R > 0) {
    const double q = std::hypot(p.x(), p.y()), s = 2 * (q - R) / q;
    return {s * p.x(), s * p.y(), 2 * p.z()};
  }
  return {2 * a * p.x() + d * p.y() * p.z() + 3 * e * p.x() * p.x(), 2 * b * p.y() + d * p.x() * p.z(),
          2 * c * p.z() + d * p.x() * p.y()};
}

Eigen::Matrix3d Body::hessian(const Row& p) const {
  Eigen::Matrix3d H;
  if (R > 0) {
    const double q2 = p.x() * p.x() + p.y() * p.y(), q = std::sqrt(q2), s = (q - R) / q, t = (1 - s) / q2;
    H << 2 * (s + t * p.x() * p.x()), 2 * t * p.x() * p.y(), 0, 2 * t * p.x() * p.y(), 2 * (s + t * p.y() * p.y()), 0,
        0, 0, 2;
    return H;
  }
  H << 2 * a + 6 * e * p.x(), d * p.z(), d * p.y(), d * p.z(), 2 * b, d * p.x(), d * p.y(), d * p.x(), 2 * c;
  return H;
}

Row Body::on_surface(const Row& p) const {
  if (R > 0) {
    const Row middle = Row(p.x(), p.y(), 0).normalized() * R;
    return middle + r * (p - middle).normalized();
  }
  const Row u = p.normalized();
  double radius = 1 / std::sqrt(a * u.x() * u.x() + b * u.y() * u.y() + c * u.z() * u.z());
  for (int step = 0; step < 30; ++step) radius -= value(radius * u) / gradient(radius * u).dot(u);
  return radius * u;
}

double Body::area_ratio(const Row& p, const Row& normal) const {
  const Row x = on_surface(p), n = gradient(x).normalized();
  if (R > 0) {  // at the distance h outside, areas are (1 + h k1) (1 + h k2) times as large
    const double h = (p - x).dot(n), q = std::hypot(x.x(), x.y());
    return normal.dot(n) / ((1 + h / r) * (1 + h * (q - R) / (r * q)));
  }
  // By the solid angle: normal . p / |p|^3 of the face, n . x / |x|^3 of the surface.
  return normal.dot(p) / std::pow(p.norm(), 3) * std::pow(x.norm(), 3) / n.dot(x);
}

Body ellipsoid() { return {.a = 1, .b = 1 / (0.8 * 0.8), .c = 1 / (0.65 * 0.65)}; }
Body generic_body() { return {.a = 1, .b = 1.4, .c = 2, .d = 0.3, .e = 0.2}; }

BodyShape::BodyShape(std::string name_, int level_, MeshData data, const Body& body, int fields, std::uint64_t seed)
    : Shape(std::move(name_), level_,
            [&] {
              for (Eigen::Index v = 0; v < data.V.rows(); ++v) data.V.row(v) = body.on_surface(data.V.row(v));
              return std::move(data);
            }()),
      body_(body),
      coefficients_(random_coefficients(monomials, fields, seed + 2)) {
  Eigen::VectorXd share = Eigen::VectorXd::Zero(mesh.vertices());
  for (Index h = 0; h < mesh.halfedges(); ++h) share[mesh.tail(h)] += geometry.area(Mesh::face(h)) / 3;
  Eigen::MatrixXcd basis(mesh.vertices(), monomials);
  Eigen::RowVectorXcd row(monomials);
  for (Index v = 0; v < mesh.vertices(); ++v) {
    const Row p = surface.V.row(v);
    components(body_, p, std::abs(p.x()) < 0.5 ? Row::UnitX() : Row::UnitY(), row);
    basis.row(v) = row;
  }
  const Fields u = combine(basis, coefficients_);
  for (Eigen::Index f = 0; f < fields; ++f)
    coefficients_.col(f) /= std::sqrt((u.col(f).cwiseAbs2().array() * share.array()).sum());
  Eigen::MatrixXcd integrals(mesh.faces(), monomials);
  const TriangleRule rule(5);
  for_row_blocks(mesh.faces(), [&](Eigen::Index begin, Eigen::Index end) {
    Eigen::VectorXd values(monomials);
    for (Eigen::Index t = begin; t < end; ++t) {
      const Row a = surface.V.row(mesh.F()(t, 0)), b = surface.V.row(mesh.F()(t, 1)) - a;
      const Row c = surface.V.row(mesh.F()(t, 2)) - a;
      const Row normal = b.cross(c);
      const double twice = normal.norm();
      integrals.row(t).setZero();
      for (const auto& node : rule.nodes) {
        const Row p = a + node.x * b + node.y * c;
        laplacians(body_, body_.on_surface(p), values);
        integrals.row(t).real() += node.weight * twice * body_.area_ratio(p, normal / twice) * values.transpose();
      }
    }
  });
  exact = combine(integrals, coefficients_);
}

Fields BodyShape::sample(const Connection& connection) const {
  const Frames frames = vertex_frames(mesh, surface.V, connection);
  Eigen::MatrixXcd basis(mesh.vertices(), monomials);
  for_row_blocks(mesh.vertices(), [&](Eigen::Index begin, Eigen::Index end) {
    Eigen::RowVectorXcd row(monomials);
    for (Eigen::Index v = begin; v < end; ++v) {
      components(body_, surface.V.row(v), frames.X.row(v), row);
      basis.row(v) = row;
    }
  });
  return combine(basis, coefficients_);
}

Eigen::ArrayXd one_form_energy(const Mesh& mesh, const Geometry& geometry, const Positions<double>& V,
                               const Eigen::MatrixXcd& coefficients) {
  Eigen::MatrixXcd integrals(mesh.edges(), coefficients.rows());
  for_row_blocks(mesh.edges(), [&](Eigen::Index begin, Eigen::Index end) {
    Eigen::Matrix<double, Eigen::Dynamic, 3> gradients(coefficients.rows(), 3);
    for (Eigen::Index e = begin; e < end; ++e) {
      const Index h = mesh.halfedge(static_cast<Index>(e));
      const Row along = V.row(mesh.tip(h)) - V.row(mesh.tail(h));
      const Row middle = Row(V.row(mesh.tip(h)) + V.row(mesh.tail(h))).normalized();
      harmonic_gradients(middle, gradients);
      const Row turned = along.cross(middle);  // (n x g) . along = g . (along x n)
      for (Eigen::Index k = 0; k < coefficients.rows(); ++k)
        integrals(e, k) = {gradients.row(k).dot(along), -gradients.row(k).dot(turned)};
    }
  });
  return div_curl_energy(mesh, geometry, combine(integrals, coefficients).real());
}

Eigen::ArrayXd div_curl_energy(const Mesh& mesh, const Geometry& geometry, const Eigen::MatrixXd& omega) {
  Eigen::MatrixXd flux = Eigen::MatrixXd::Zero(mesh.vertices(), omega.cols());
  Eigen::VectorXd share = Eigen::VectorXd::Zero(mesh.vertices());
  Eigen::ArrayXd energy = Eigen::ArrayXd::Zero(omega.cols());
  for (Index e = 0; e < mesh.edges(); ++e) {
    const Index h = mesh.halfedge(e), g = mesh.twin(h);
    const double w = (geometry.cot(Mesh::prev(h)) + geometry.cot(Mesh::prev(g))) / 2;
    flux.row(mesh.tail(h)) += w * omega.row(e);
    flux.row(mesh.tip(h)) -= w * omega.row(e);
  }
  for (Index t = 0; t < mesh.faces(); ++t) {
    Eigen::RowVectorXd around = Eigen::RowVectorXd::Zero(omega.cols());
    for (Index h = 3 * t; h < 3 * t + 3; ++h) {
      around += (mesh.canonical(h) ? 1.0 : -1.0) * omega.row(mesh.edge(h));
      share[mesh.tail(h)] += geometry.area(t) / 3;
    }
    energy += around.transpose().array().square() / (2 * geometry.area(t));
  }
  for (Index v = 0; v < mesh.vertices(); ++v) energy += flux.row(v).transpose().array().square() / (2 * share[v]);
  return energy;
}

ComplexVectorX<double> carried_directions(const Mesh& mesh, const Geometry& geometry, const Connection& connection,
                                          int n) {
  ComplexVectorX<double> directions = ComplexVectorX<double>::Zero(mesh.faces());
  std::deque<Index> open{0};
  directions[0] = 1;
  while (!open.empty()) {
    const Index t = open.front();
    open.pop_front();
    for (Index h = 3 * t; h < 3 * t + 3; ++h) {
      const Index g = mesh.twin(h);
      if (g == none || directions[Mesh::face(g)] != Complex<double>(0)) continue;
      const double turn = pi<double> + connection.edge_to_face(geometry, h) - connection.edge_to_face(geometry, g);
      directions[Mesh::face(g)] = directions[t] * std::polar(1.0, n * turn);
      open.push_back(Mesh::face(g));
    }
  }
  return directions;
}

double face_field_difference(const MeshData& data) {
  constexpr int n = 4;
  const ConnectedSurface s =
      connect(Surface(data.V, data.F), {.kind = ConnectionKind::trivial, .balance_cones = true, .n = n});
  const Mesh& mesh = s.mesh();
  const Field ours = at_faces(s, smoothest_field(s, {.n = n}).field);
  const ComplexVectorX<double> theirs = carried_directions(mesh, s.geometry(), s.connection(), n);
  std::vector<Index> away;
  Complex<double> common = 0;
  for (Index t = 0; t < mesh.faces(); ++t) {
    bool touches = false;
    for (const Cone& cone : s.connection().cones)
      for (Index c = 0; c < 3; ++c) touches = touches || mesh.F()(t, c) == cone.vertex;
    if (touches) continue;
    away.push_back(t);
    common += ours.u[t] * std::conj(theirs[t]) / std::abs(ours.u[t]);
  }
  double sum = 0;
  for (const Index t : away) sum += std::abs(std::arg(ours.u[t] * std::conj(theirs[t] * common))) / n;
  return sum / static_cast<double>(away.size()) * 180 / pi<double>;
}

}  // namespace alcap::app
