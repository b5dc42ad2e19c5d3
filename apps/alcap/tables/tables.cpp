// SPDX-License-Identifier: MIT
//
// tables.cpp: measures operator and energy errors of smooth fields on spheres. All fields are columns of one matrix; a
// field is complex linear in its coefficients and so are P u and its exact value, div + i curl = -sqrt(l(l+1)) c Y.
#include "apps/alcap/tables/tables.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>

#include "alcap/energies.h"
#include "alcap/frames.h"
#include "alcap/generators.h"
#include "alcap/operators.h"
#include "apps/alcap/tables/tables_harmonics.h"
#include "apps/alcap/tables/tables_published.h"
#include "src/base/clock.h"
#include "src/base/parallel.h"

namespace alcap::app {
namespace {

using Row = Eigen::RowVector3d;
using Fields = Eigen::Matrix<std::complex<double>, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::array connection_names = {"polar", "polar-barycenter", "local", "global"};
constexpr std::array kind_names = {"edge", "triangle"};

void validate(const TablesOptions& o) {
  const auto require = [](bool good, const char* field, auto value, const char* rule) {
    if (!good) throw OptionError(field, value, rule);
  };
  require(!o.levels.empty(), "levels", "{}", "needs at least one level");
  for (std::size_t i = 0; i < o.levels.size(); ++i) {
    require(o.levels[i] >= 1 && o.levels[i] <= 8, "levels", o.levels[i], "must lie in [1, 8]");
    require(i == 0 || o.levels[i] > o.levels[i - 1], "levels", o.levels[i], "must increase");
  }
  require(o.fields >= 2 && o.fields <= 10000, "fields", o.fields, "must lie in [2, 10000]");
  require(o.harmonics >= 1 && o.harmonics <= max_harmonics, "harmonics", o.harmonics, "must lie in [1, 48]");
  require(o.unit_harmonics >= 1 && o.unit_harmonics <= max_harmonics, "unit_harmonics", o.unit_harmonics,
          "must lie in [1, 48]");
  require(o.jitter >= 0 && o.jitter <= 0.25, "jitter", o.jitter, "must lie in [0, 0.25], beyond that faces fold");
}

Connection make_connection(const Mesh& mesh, const Geometry& geometry, std::size_t which) {
  switch (which) {
    case 0:
      return polar(mesh, geometry, {PolarCenter::incenter});
    case 1:
      return polar(mesh, geometry, {PolarCenter::barycenter});
    case 2:
      return locally_optimal(mesh, geometry);
    default:
      return globally_optimal(mesh, geometry);
  }
}

/// Calls body(begin, end) over rows in blocks that do not depend on the number of threads.
template <class Body>
void for_row_blocks(Eigen::Index rows, Body&& body) {
  constexpr Eigen::Index block = 512;
  parallel_for((rows + block - 1) / block, [&](std::int64_t b) { body(b * block, std::min(rows, (b + 1) * block)); },
               1);
}

/// Rows times coefficients.
template <class Matrix>
Fields combine(const Matrix& rows, const Eigen::MatrixXcd& coefficients) {
  Fields out(rows.rows(), coefficients.cols());
  for_row_blocks(rows.rows(), [&](Eigen::Index begin, Eigen::Index end) {
    out.middleRows(begin, end - begin).noalias() = rows.middleRows(begin, end - begin) * coefficients;
  });
  return out;
}

/// Nodes and weights of a rule on the unit triangle, exact for degree 2 points - 2: Gauss-Legendre collapsed at a
/// corner.
struct TriangleRule {
  struct Node {
    double x, y, weight;
  };
  std::vector<Node> nodes;
  explicit TriangleRule(int points) {
    std::vector<std::array<double, 2>> gauss;
    for (int i = 0; i < points; ++i) {
      double x = std::cos(pi<double> * (i + 0.75) / (points + 0.5)), slope = 1;
      for (int step = 0; step < 8; ++step) {  // Newton on the Legendre polynomial
        double before = 1, now = x;
        for (int k = 2; k <= points; ++k) {
          const double next = ((2 * k - 1) * x * now - (k - 1) * before) / k;
          before = now;
          now = next;
        }
        slope = points * (x * now - before) / (x * x - 1);
        x -= now / slope;
      }
      gauss.push_back({(1 + x) / 2, 1 / ((1 - x * x) * slope * slope)});
    }
    for (const auto& [x, wx] : gauss)
      for (const auto& [y, wy] : gauss) nodes.push_back({x, y * (1 - x), wx * wy * (1 - x)});
  }
};

/// One sphere: its mesh, and the exact integrals of div + i curl over the spherical triangle above each face, #F x
/// fields.
struct Sphere {
  std::string name;
  int level;
  MeshData surface;
  Mesh mesh;
  Geometry geometry;
  double mean_edge;
  Fields exact;

  Sphere(std::string name_, int level_, MeshData s, const Eigen::MatrixXcd& coefficients)
      : name(std::move(name_)),
        level(level_),
        surface(std::move(s)),
        mesh(surface.F, surface.V.rows()),
        geometry(mesh, surface.V),
        mean_edge(geometry.lengths().mean()) {
    const Eigen::Index count = coefficients.rows();
    Eigen::MatrixXd integrals(mesh.faces(), count);
    const TriangleRule rule(6);  // twelfth order: exact to rounding beside the discretisation error
    for_row_blocks(mesh.faces(), [&](Eigen::Index begin, Eigen::Index end) {
      Eigen::VectorXd values(count), sum(count);
      for (Eigen::Index t = begin; t < end; ++t) {
        const Row a = surface.V.row(mesh.F()(t, 0)), b = surface.V.row(mesh.F()(t, 1)) - a;
        const Row c = surface.V.row(mesh.F()(t, 2)) - a;
        const double volume = a.dot(Row(b.cross(c)));  // solid angle: volume / r^3 per parameter area
        sum.setZero();
        for (const auto& node : rule.nodes) {
          const Row p = a + node.x * b + node.y * c;
          const double r = p.norm();
          harmonics(p / r, values);
          sum += node.weight * volume / (r * r * r) * values;
        }
        for (int k = 0; k < count; ++k) {
          const double l = harmonic_degree(k);
          integrals(t, k) = -std::sqrt(l * (l + 1)) * sum[k];
        }
      }
    });
    exact = combine(integrals, coefficients);
  }

  /// The fields in the vertex frames of a connection, #V x fields. The frames of frames.h, tilted to the tangent planes
  /// of the sphere itself, whose normals are known.
  [[nodiscard]] Fields sample(const Connection& connection, const Eigen::MatrixXcd& coefficients) const {
    const Frames frames = vertex_frames(mesh, surface.V, connection);
    Eigen::MatrixXcd basis(mesh.vertices(), coefficients.rows());
    for_row_blocks(mesh.vertices(), [&](Eigen::Index begin, Eigen::Index end) {
      Eigen::Matrix<double, Eigen::Dynamic, 3> gradients(coefficients.rows(), 3);
      for (Eigen::Index v = begin; v < end; ++v) {
        const Row n = surface.V.row(v), axis = frames.X.row(v);
        const Row x = (axis - axis.dot(n) * n).normalized(), y = n.cross(x);
        harmonic_gradients(n, gradients);
        basis.row(v).real() = (gradients * x.transpose()).transpose();
        basis.row(v).imag() = (gradients * y.transpose()).transpose();
      }
    });
    return combine(basis, coefficients);
  }
};

/// Per field, over some faces.
struct Sums {
  Eigen::ArrayXd div2, curl2, max_div, max_curl, antiholomorphic, holomorphic;
  explicit Sums(Eigen::Index fields)
      : div2(Eigen::ArrayXd::Zero(fields)),
        curl2(div2),
        max_div(div2),
        max_curl(div2),
        antiholomorphic(div2),
        holomorphic(div2) {}
  static Sums join(Sums a, const Sums& b) {
    a.div2 += b.div2;
    a.curl2 += b.curl2;
    a.max_div = a.max_div.max(b.max_div);
    a.max_curl = a.max_curl.max(b.max_curl);
    a.antiholomorphic += b.antiholomorphic;
    a.holomorphic += b.holomorphic;
    return a;
  }
};

/// P u and Q u of all fields at once; against `exact` where it is given (P only).
Sums measure(const Mesh& mesh, const Geometry& geometry, const FirstOrderOperators& ops, const Fields& u,
             const Fields* exact) {
  return parallel_reduce(
      mesh.faces(), Sums(u.cols()),
      [&](std::int64_t begin, std::int64_t end) {
        Sums s(u.cols());
        Eigen::Array<std::complex<double>, 1, Eigen::Dynamic> p(u.cols()), q(u.cols());
        for (std::int64_t t = begin; t < end; ++t) {
          p.setZero();
          q.setZero();
          for (Index h = static_cast<Index>(3 * t); h < 3 * t + 3; ++h) {
            p += ops.p[h] * u.row(mesh.tail(h)).array();
            q += ops.q[h] * u.row(mesh.tail(h)).array();
          }
          const double area = geometry.area(static_cast<Index>(t));
          s.antiholomorphic += p.abs2().transpose() / (2 * area);
          s.holomorphic += q.abs2().transpose() / (2 * area);
          if (!exact) continue;
          p -= exact->row(t).array();
          s.div2 += p.real().square().transpose();
          s.curl2 += p.imag().square().transpose();
          s.max_div = s.max_div.max(p.real().abs().transpose() / area);
          s.max_curl = s.max_curl.max(p.imag().abs().transpose() / area);
        }
        return s;
      },
      Sums::join);
}

/// Re(u* A u) per field.
Eigen::ArrayXd quadratic_form(const SparseMatrix<std::complex<double>>& A, const Fields& u) {
  const Fields Au = A * u;
  return (u.conjugate().cwiseProduct(Au)).real().colwise().sum().transpose().array();
}

double order(double coarse, double fine, double lengths) {
  return coarse > 0 && fine > 0 ? std::log(coarse / fine) / std::log(lengths) : nan;
}

/// Fills the orders of the last row from the previous one of the same sphere, connection and kind.
template <class R, class Same>
const R* coarser(const std::vector<R>& rows, Same&& same) {
  for (auto r = rows.rbegin(); r != rows.rend(); ++r)
    if (same(*r)) return &*r;
  return nullptr;
}

void add_operator_row(const Sphere& sphere, const char* connection, const char* kind, const Sums& s,
                      const Eigen::ArrayXd& exact_energy, std::vector<OperatorRow>& rows) {
  OperatorRow row{.sphere = sphere.name,
                  .level = sphere.level,
                  .vertices = sphere.mesh.vertices(),
                  .mean_edge = sphere.mean_edge,
                  .connection = connection,
                  .kind = kind,
                  .l2_div = s.div2.sqrt().mean(),
                  .l2_curl = s.curl2.sqrt().mean(),
                  .linf_div = s.max_div.mean(),
                  .linf_curl = s.max_curl.mean(),
                  .energy = ((s.antiholomorphic + s.holomorphic) / 2 - exact_energy).abs().mean()};
  const published::Operators paper = published::operators(row.sphere, row.vertices, row.connection, row.kind);
  row.paper_l2_div = paper.l2_div;
  row.paper_l2_curl = paper.l2_curl;
  row.paper_linf_div = paper.linf_div;
  row.paper_linf_curl = paper.linf_curl;
  row.paper_energy = paper.energy;
  const OperatorRow* before = coarser(rows, [&](const OperatorRow& r) {
    return r.sphere == row.sphere && r.connection == row.connection && r.kind == row.kind;
  });
  const auto observed = [&](double OperatorRow::*error) {
    return before ? order(before->*error, row.*error, before->mean_edge / row.mean_edge) : nan;
  };
  row.order_l2_div = observed(&OperatorRow::l2_div);
  row.order_l2_curl = observed(&OperatorRow::l2_curl);
  row.order_linf_div = observed(&OperatorRow::linf_div);
  row.order_linf_curl = observed(&OperatorRow::linf_curl);
  row.order_energy = observed(&OperatorRow::energy);
  rows.push_back(row);
}

void add_stiffness_row(const Sphere& sphere, const char* connection, double error, std::vector<StiffnessRow>& rows) {
  StiffnessRow row{.sphere = sphere.name,
                   .level = sphere.level,
                   .vertices = sphere.mesh.vertices(),
                   .mean_edge = sphere.mean_edge,
                   .connection = connection,
                   .energy = error};
  row.paper_energy = published::stiffness_energy(row.sphere, row.vertices, row.connection);
  const StiffnessRow* before =
      coarser(rows, [&](const StiffnessRow& r) { return r.sphere == row.sphere && r.connection == row.connection; });
  row.order_energy = before ? order(before->energy, row.energy, before->mean_edge / row.mean_edge) : nan;
  rows.push_back(row);
}

void add_euler_row(const std::string& surface, int level, std::int64_t vertices, const char* connection,
                   const char* kind, const Eigen::ArrayXd& difference, double expected, std::vector<EulerRow>& rows) {
  const Eigen::ArrayXd x = difference / pi<double>;
  EulerRow row{.surface = surface,
               .level = level,
               .vertices = vertices,
               .connection = connection,
               .kind = kind,
               .mean = x.mean(),
               .deviation = std::sqrt((x - x.mean()).square().sum() / static_cast<double>(x.size() - 1)),
               .expected = expected};
  const published::Euler paper = published::euler(row.surface, row.vertices, row.connection, row.kind);
  row.paper_mean = paper.mean;
  row.paper_deviation = paper.deviation;
  rows.push_back(row);
}

/// All kinds of E_A - E_H of the fields, scaled to unit length at every vertex.
void measure_euler(const std::string& surface, int level, const Mesh& mesh, const Geometry& geometry,
                   const Connection& connection, const char* name, Fields u, double expected,
                   std::vector<EulerRow>& rows) {
  for_row_blocks(u.rows(), [&](Eigen::Index begin, Eigen::Index end) {
    auto block = u.middleRows(begin, end - begin).array();
    block /= block.abs().max(std::numeric_limits<double>::min());
  });
  for (std::size_t k = 0; k < kind_names.size(); ++k) {
    const auto kind = k == 0 ? OperatorKind::edge : OperatorKind::triangle;
    const Sums s = measure(mesh, geometry, first_order_operators(mesh, geometry, connection, {1, kind}), u, nullptr);
    add_euler_row(surface, level, mesh.vertices(), name, kind_names[k], s.antiholomorphic - s.holomorphic, expected,
                  rows);
  }
  const HermitianPattern pattern(mesh);
  add_euler_row(surface, level, mesh.vertices(), name, "basis",
                quadratic_form(curvature_and_boundary(mesh, pattern, geometry, connection, 1), u), expected, rows);
}

void measure_sphere(const Sphere& sphere, const Eigen::MatrixXcd& coefficients, const Eigen::MatrixXcd& unit,
                    TablesResult& result) {
  const Mesh& mesh = sphere.mesh;
  const Geometry& geometry = sphere.geometry;
  // 1/2 integral |grad u|^2 of a vector harmonic of unit norm is (l(l+1) - 1)/2.
  Eigen::ArrayXd energy = Eigen::ArrayXd::Zero(coefficients.cols());
  for (int k = 0; k < coefficients.rows(); ++k) {
    const double l = harmonic_degree(k);
    energy += (l * (l + 1) - 1) / 2 * coefficients.row(k).cwiseAbs2().transpose().array();
  }
  const HermitianPattern pattern(mesh);
  for (std::size_t i = 0; i < connection_names.size(); ++i) {
    const char* name = connection_names[i];
    const Connection connection = make_connection(mesh, geometry, i);
    const Fields u = sphere.sample(connection, coefficients);
    for (std::size_t k = 0; k < kind_names.size(); ++k) {
      const auto kind = k == 0 ? OperatorKind::edge : OperatorKind::triangle;
      const auto ops = first_order_operators(mesh, geometry, connection, {1, kind});
      add_operator_row(sphere, name, kind_names[k], measure(mesh, geometry, ops, u, &sphere.exact), energy,
                       result.operators);
    }
    const auto stiffness = stiffness_and_mass(mesh, pattern, geometry, connection, 1);
    add_stiffness_row(sphere, name, (quadratic_form(stiffness.S, u) / 2 - energy).abs().mean(), result.stiffness);
    measure_euler(sphere.name, sphere.level, mesh, geometry, connection, name, sphere.sample(connection, unit), 4,
                  result.euler);
  }
}

/// A torus in steps of the same refinement, with the harmonics' ambient gradients as smooth random fields.
void measure_torus(int level, const Eigen::MatrixXcd& unit, TablesResult& result) {
  const int nv = 5 << (level - 1);
  const MeshData surface = torus(2 * nv, nv, 1, 0.4);
  const Mesh mesh(surface.F, surface.V.rows());
  const Geometry geometry(mesh, surface.V);
  for (std::size_t i = 0; i < connection_names.size(); ++i) {
    const Connection connection = make_connection(mesh, geometry, i);
    const Frames frames = vertex_frames(mesh, surface.V, connection);
    Eigen::MatrixXcd basis(mesh.vertices(), unit.rows());
    Eigen::Matrix<double, Eigen::Dynamic, 3> gradients(unit.rows(), 3);
    for (Index v = 0; v < mesh.vertices(); ++v) {
      harmonic_gradients(surface.V.row(v).normalized(), gradients);
      for (Eigen::Index k = 0; k < unit.rows(); ++k) basis(v, k) = frames.component(v, gradients.row(k));
    }
    measure_euler("torus", level, mesh, geometry, connection, connection_names[i], combine(basis, unit), 0,
                  result.euler);
  }
}

}  // namespace

TablesResult compute_tables(const TablesOptions& options) {
  validate(options);
  const detail::Stopwatch watch;
  TablesResult result;
  result.options = options;
  result.options.progress = nullptr;
  const Eigen::MatrixXcd coefficients = random_coefficients(options.harmonics, options.fields, options.seed);
  const Eigen::MatrixXcd unit = random_coefficients(options.unit_harmonics, options.fields, options.seed + 1);
  const auto announce = [&](const std::string& name) {
    if (options.progress) options.progress(name);
  };
  for (const char* name : {"clean", "jittered"}) {
    const bool clean = std::string_view(name) == "clean";
    for (const int level : options.levels) {
      MeshData surface = clean ? icosphere(level) : jittered_sphere(level, options.jitter, options.seed);
      announce(name + (" sphere, " + std::to_string(surface.V.rows())) + " vertices");
      measure_sphere(Sphere(name, level, std::move(surface), coefficients), coefficients, unit, result);
    }
  }
  for (const int level : options.levels) {
    announce("torus " + std::to_string(level));
    measure_torus(level, unit, result);
  }
  result.seconds = watch.seconds();
  return result;
}

}  // namespace alcap::app
