// SPDX-License-Identifier: MIT
//
// tables_shapes.h: surfaces that the tables are measured on besides regular spheres, with fields whose divergence and
// curl are known on them, and the other ways to the same numbers that ours are compared with.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "apps/alcap/tables/tables_measure.h"

namespace alcap::app {

/// Heights of noise, in mean edge lengths.
inline constexpr std::array noise_levels = {0.01, 0.03, 0.1};

/// An icosphere whose vertices are moved along their normals by up to `noise` mean edge lengths, evenly distributed.
[[nodiscard]] MeshData noisy_sphere(int level, double noise, std::uint64_t seed);

/// The convex hull of as many random points of the unit sphere as icosphere(level) has vertices, evenly distributed:
/// every valence, and slivers.
[[nodiscard]] MeshData random_points_sphere(int level, std::uint64_t seed);

/// a x^2 + b y^2 + c z^2 + d x y z + e x^3 = 1, star-shaped around the origin; or, with R > 0, the torus of radii R and
/// r around the z axis.
struct Body {
  double a = 0, b = 0, c = 0, d = 0, e = 0;
  double R = 0, r = 0;

  [[nodiscard]] double value(const Row& p) const;
  [[nodiscard]] Row gradient(const Row& p) const;
  [[nodiscard]] Eigen::Matrix3d hessian(const Row& p) const;
  /// The point of the surface in the direction of p, by Newton's method; of a torus the nearest one.
  [[nodiscard]] Row on_surface(const Row& p) const;
  /// Area of the surface over area of a flat face, around on_surface(p), for p in the face with this unit normal.
  [[nodiscard]] double area_ratio(const Row& p, const Row& normal) const;
};
[[nodiscard]] Body ellipsoid();     ///< half axes 1, 0.8 and 0.65
[[nodiscard]] Body generic_body();  ///< without any symmetry but one plane, curvature varies fourfold

/// A mesh moved to a body. The fields are c grad f, with f the monomials of degree 1 to 3 of space and c complex:
/// the imaginary part turns the gradient by a right angle. div + i curl of such a field is c times the Laplacian of f
/// on the surface.
class BodyShape : public Shape {
 public:
  BodyShape(std::string name, int level, MeshData data, const Body& body, int fields, std::uint64_t seed);
  /// The fields in the vertex frames of a connection, #V x fields, each of unit L2 norm.
  [[nodiscard]] Fields sample(const Connection& connection) const;

 private:
  Body body_;
  Eigen::MatrixXcd coefficients_;
};

/// E_A of fields of vector harmonics (#harmonics x fields coefficients) by discrete 1-forms on edges (Fisher,
/// Schroeder, Desbrun, Hoppe 2007): 1/2 sum A_v (delta omega)^2 + 1/2 sum (d omega)^2 / A_t, with the field integrated
/// along edges by the midpoint rule.
[[nodiscard]] Eigen::ArrayXd one_form_energy(const Mesh& mesh, const Geometry& geometry, const Positions<double>& V,
                                             const Eigen::MatrixXcd& coefficients);

/// The same energy of 1-forms, #E x fields: integrals along the edges.
[[nodiscard]] Eigen::ArrayXd div_curl_energy(const Mesh& mesh, const Geometry& geometry, const Eigen::MatrixXd& omega);

/// The n-direction field per face that a trivial connection carries from face 0 over its component (Crane, Desbrun,
/// Schroeder 2010); zero elsewhere.
[[nodiscard]] ComplexVectorX<double> carried_directions(const Mesh& mesh, const Geometry& geometry,
                                                        const Connection& connection, int n);

/// The mean angle, in degrees, between the cross field per face of a trivial connection (Crane, Desbrun, Schroeder
/// 2010: one direction carried from face to face) and our smoothest field for it, at the faces that touch no cone.
[[nodiscard]] double face_field_difference(const MeshData& data);

}  // namespace alcap::app
