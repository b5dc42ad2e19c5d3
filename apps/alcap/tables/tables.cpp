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
#include <cstdio>
#include <limits>

#include "alcap/energies.h"
#include "alcap/frames.h"
#include "alcap/generators.h"
#include "alcap/operators.h"
#include "apps/alcap/tables/tables_harmonics.h"
#include "apps/alcap/tables/tables_measure.h"
#include "apps/alcap/tables/tables_published.h"
#include "apps/alcap/tables/tables_shapes.h"
#include "src/base/clock.h"
#include "src/base/parallel.h"

namespace alcap::app {
namespace {

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

/// One sphere: its mesh, and the exact integrals of div + i curl over the spherical triangle above each face, #F x
/// fields.
struct Sphere : Shape {
  Sphere(std::string name_, int level_, MeshData s, const Eigen::MatrixXcd& coefficients)
      : Shape(std::move(name_), level_, std::move(s)) {
    const Eigen::Index count = coefficients.rows();
    Eigen::MatrixXcd integrals(mesh.faces(), count);
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
        const Row n = surface.V.row(v).normalized(), axis = frames.X.row(v);
        const Row x = (axis - axis.dot(n) * n).normalized(), y = n.cross(x);
        harmonic_gradients(n, gradients);
        basis.row(v).real() = gradients.lazyProduct(x.transpose()).transpose();
        basis.row(v).imag() = gradients.lazyProduct(y.transpose()).transpose();
      }
    });
    return combine(basis, coefficients);
  }
};

/// Re(u* A u) per field.
Eigen::ArrayXd quadratic_form(const SparseMatrix<std::complex<double>>& A, const Fields& u) {
  const Fields Au = A * u;
  return (u.conjugate().cwiseProduct(Au)).real().colwise().sum().transpose().array();
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

/// One more set of meshes on the unit sphere: the operators alone, for the connections named.
void measure_operators(const Sphere& sphere, const Eigen::MatrixXcd& coefficients, const Eigen::ArrayXd& energy,
                       std::vector<OperatorRow>& rows) {
  for (std::size_t i = 0; i < connection_names.size(); ++i) {
    const Connection connection = make_connection(sphere.mesh, sphere.geometry, i);
    const Fields u = sphere.sample(connection, coefficients);
    for (std::size_t k = 0; k < kind_names.size(); ++k) {
      const auto kind = k == 0 ? OperatorKind::edge : OperatorKind::triangle;
      const auto ops = first_order_operators(sphere.mesh, sphere.geometry, connection, {1, kind});
      add_operator_row(sphere, connection_names[i], kind_names[k],
                       measure(sphere.mesh, sphere.geometry, ops, u, &sphere.exact), energy, rows);
    }
  }
}

/// 1/2 integral |grad u|^2 of every field: (l(l+1) - 1)/2 for a vector harmonic of unit norm.
Eigen::ArrayXd exact_energy(const Eigen::MatrixXcd& coefficients) {
  Eigen::ArrayXd energy = Eigen::ArrayXd::Zero(coefficients.cols());
  for (int k = 0; k < coefficients.rows(); ++k) {
    const double l = harmonic_degree(k);
    energy += (l * (l + 1) - 1) / 2 * coefficients.row(k).cwiseAbs2().transpose().array();
  }
  return energy;
}

void measure_sphere(const Sphere& sphere, const Eigen::MatrixXcd& coefficients, const Eigen::MatrixXcd& unit,
                    TablesResult& result) {
  const Mesh& mesh = sphere.mesh;
  const Geometry& geometry = sphere.geometry;
  const Eigen::ArrayXd energy = exact_energy(coefficients);
  measure_operators(sphere, coefficients, energy, result.operators);
  const HermitianPattern pattern(mesh);
  for (std::size_t i = 0; i < connection_names.size(); ++i) {
    const char* name = connection_names[i];
    const Connection connection = make_connection(mesh, geometry, i);
    const Fields u = sphere.sample(connection, coefficients);
    const auto stiffness = stiffness_and_mass(mesh, pattern, geometry, connection, 1);
    add_stiffness_row(sphere, name, (quadratic_form(stiffness.S, u) / 2 - energy).abs().mean(), result.stiffness);
    measure_euler(sphere.name, sphere.level, mesh, geometry, connection, name, sphere.sample(connection, unit), 4,
                  result.euler);
  }
}

/// The lowest harmonics' gradients in space, projected to a surface around the origin, as smooth random fields of unit
/// length on it.
void measure_any(const std::string& name, int level, const MeshData& surface, const Eigen::MatrixXcd& unit,
                 TablesResult& result) {
  const Mesh mesh(surface.F, surface.V.rows());
  const Geometry geometry(mesh, surface.V);
  const double expected = 2 * static_cast<double>(find_topology(mesh).euler());
  for (std::size_t i = 0; i < connection_names.size(); ++i) {
    const Connection connection = make_connection(mesh, geometry, i);
    const Frames frames = vertex_frames(mesh, surface.V, connection);
    Eigen::MatrixXcd basis(mesh.vertices(), unit.rows());
    Eigen::Matrix<double, Eigen::Dynamic, 3> gradients(unit.rows(), 3);
    for (Index v = 0; v < mesh.vertices(); ++v) {
      harmonic_gradients(surface.V.row(v).normalized(), gradients);
      for (Eigen::Index k = 0; k < unit.rows(); ++k) basis(v, k) = frames.component(v, gradients.row(k));
    }
    measure_euler(name, level, mesh, geometry, connection, connection_names[i], combine(basis, unit), expected,
                  result.euler);
  }
}

/// The caller's mesh, moved so that its middle is the origin.
void measure_mesh(const TablesOptions& options, const Eigen::MatrixXcd& unit, TablesResult& result) {
  MeshData surface = options.mesh;
  const Mesh mesh(surface.F, surface.V.rows());
  if (mesh.boundary_edges() > 0)
    throw OptionError("mesh", options.mesh_name, "has a boundary, where E_A - E_H has a term of its own; close it");
  const Row middle = (surface.V.colwise().minCoeff() + surface.V.colwise().maxCoeff()) / 2;
  surface.V.rowwise() -= middle;
  measure_any(options.mesh_name, 0, surface, unit, result);
}

/// Spheres whose vertices lie off the surface by noise, and spheres through random points.
void measure_other_spheres(const TablesOptions& options, const Eigen::MatrixXcd& coefficients, TablesResult& result) {
  const Eigen::ArrayXd energy = exact_energy(coefficients);
  for (const double noise : noise_levels) {
    const int level = std::min(options.levels.back(), 4);
    char name[32];
    std::snprintf(name, sizeof name, "noise %g", noise);
    measure_operators(Sphere(name, level, noisy_sphere(level, noise, options.seed), coefficients), coefficients, energy,
                      result.operators);
  }
  for (const int level : options.levels)
    if (level <= 5)
      measure_operators(Sphere("random points", level, random_points_sphere(level, options.seed), coefficients),
                        coefficients, energy, result.operators);
}

/// Surfaces that are no spheres: errors of div and curl of projected gradients of random cubic polynomials.
void measure_bodies(const TablesOptions& options, TablesResult& result) {
  const auto rings = [](int level) { return 5 << (level - 1); };
  const auto jittered = [&](int level) { return jittered_sphere(level, options.jitter, options.seed); };
  const auto around = [&](int level) { return torus(2 * rings(level), rings(level), 1, 0.4); };
  const auto uneven = [&](int level) {
    return torus_random_diagonals(2 * rings(level), rings(level), 1, 0.4, options.seed);
  };
  struct Kind {
    const char* name;
    Body body;
    std::function<MeshData(int)> mesh;
  };
  const Body ring{.R = 1, .r = 0.4};
  const Kind kinds[] = {{"ellipsoid", ellipsoid(), &icosphere},
                        {"body", generic_body(), &icosphere},
                        {"jittered body", generic_body(), jittered},
                        {"torus", ring, around},
                        {"torus, random diagonals", ring, uneven}};
  for (const auto& [name, body, mesh] : kinds) {
    for (const int level : options.levels) {
      const BodyShape shape(name, level, mesh(level), body, options.fields, options.seed);
      for (std::size_t i = 0; i < connection_names.size(); ++i) {
        const Connection connection = make_connection(shape.mesh, shape.geometry, i);
        const Fields u = shape.sample(connection);
        for (std::size_t k = 0; k < kind_names.size(); ++k) {
          const auto kind = k == 0 ? OperatorKind::edge : OperatorKind::triangle;
          const auto ops = first_order_operators(shape.mesh, shape.geometry, connection, {1, kind});
          add_operator_row(shape, connection_names[i], kind_names[k],
                           measure(shape.mesh, shape.geometry, ops, u, &shape.exact),
                           Eigen::ArrayXd::Constant(options.fields, nan), result.operators);
        }
      }
    }
  }
}

/// E_A of smooth fields by 1-forms on edges and by our operators, relative errors; and how far our field of a trivial
/// connection is from the one per face.
void measure_baselines(const TablesOptions& options, const Eigen::MatrixXcd& coefficients, TablesResult& result) {
  Eigen::ArrayXd exact = Eigen::ArrayXd::Zero(coefficients.cols());
  for (int k = 0; k < coefficients.rows(); ++k) {
    const double l = harmonic_degree(k);
    exact += l * (l + 1) / 2 * coefficients.row(k).cwiseAbs2().transpose().array();
  }
  const auto relative = [&](const Eigen::ArrayXd& found) { return ((found - exact) / exact).abs().mean(); };
  for (const char* name : {"clean", "jittered"}) {
    for (const int level : options.levels) {
      const bool clean = std::string_view(name) == "clean";
      const Sphere sphere(name, level, clean ? icosphere(level) : jittered_sphere(level, options.jitter, options.seed),
                          coefficients);
      const Mesh& mesh = sphere.mesh;
      const Connection connection = globally_optimal(mesh, sphere.geometry);
      const Fields u = sphere.sample(connection, coefficients);
      BaselineRow row{.sphere = name, .level = level, .vertices = mesh.vertices()};
      row.fisher = relative(one_form_energy(mesh, sphere.geometry, sphere.surface.V, coefficients));
      for (const OperatorKind kind : {OperatorKind::edge, OperatorKind::triangle})
        (kind == OperatorKind::edge ? row.edge : row.triangle) =
            relative(measure(mesh, sphere.geometry, first_order_operators(mesh, sphere.geometry, connection, {1, kind}),
                             u, nullptr)
                         .antiholomorphic);
      const HermitianPattern pattern(mesh);
      const auto S = stiffness_and_mass(mesh, pattern, sphere.geometry, connection, 1).S;
      const auto CB = curvature_and_boundary(mesh, pattern, sphere.geometry, connection, 1);
      row.basis = relative((quadratic_form(S, u) + quadratic_form(CB, u)) / 2);
      row.crane_degrees = face_field_difference(sphere.surface);
      result.baselines.push_back(row);
    }
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
    const int nv = 5 << (level - 1);
    measure_any("torus", level, torus(2 * nv, nv, 1, 0.4), unit, result);
  }
  if (options.mesh.F.rows() > 0) measure_mesh(options, unit, result);
  if (options.more) {
    announce("more surfaces");
    measure_other_spheres(options, coefficients, result);
    measure_bodies(options, result);
    announce("baselines");
    measure_baselines(options, coefficients, result);
  }
  result.seconds = watch.seconds();
  return result;
}

}  // namespace alcap::app
