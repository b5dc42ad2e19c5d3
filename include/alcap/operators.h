// SPDX-License-Identifier: MIT
//
// operators.h: first-order derivatives of n-vector fields: integrated divergence and curl (P) and their reflected pair
// (Q) per face, and the field with its covariant derivative at any point (LTGD 2016, Sec. 6.3 and App. A).
//
//   auto ops = alcap::first_order_operators(connected, {.n = 1});
//   auto f = alcap::apply(connected.mesh(), ops.p, u);      // f[t] = integral over t of div u + i curl u
//   auto g = alcap::apply(connected.mesh(), ops.q, u);      // the reflected pair, twice the Cauchy-Riemann derivative
//   auto x = alcap::face_field(connected, 1, u, t).at({0.2, 0.3, 0.5});   // x.div(), x.curl(), ...
//   auto y = alcap::edge_field(connected, 1, u, h).at(0.25);              // y.u, y.along
//
// With covariant derivatives D_1, D_2 along the face frame, P integrates D_1 - i D_2 and Q integrates D_1 + i D_2. P u
// is an (n-1)-vector and Q u an (n+1)-vector in the face frames. The same components on a mesh s times as large
// give s P u.
#pragma once

#include <array>

#include <Eigen/SparseCore>

#include "alcap/connection.h"
#include "alcap/geometry.h"
#include "alcap/mesh.h"

namespace alcap {

class Surface;
class ConnectedSurface;

/// How the integral over a face is taken.
enum class OperatorKind {
  edge,      ///< boundary integral of the field interpolated along the edges (Stokes): sums over patches telescope
  triangle,  ///< area integral of the closed-form basis inside the face: matches FaceField exactly
};
template <>
struct NamesOf<OperatorKind> {
  static constexpr auto table =
      detail::name_table<OperatorKind>({{OperatorKind::edge, "edge"}, {OperatorKind::triangle, "triangle"}});
};

/// Which operators are built.
struct OperatorOptions {
  int n = 1;                               // 1 vector field, 2 line field, 4 cross field; any integer is legal
  OperatorKind kind = OperatorKind::edge;  // sums over patches are exact, and so is E_A - E_H nearly
};

/// The operators P and Q, #F x #V complex with three entries a row. p[3 t + c] is the entry of P in row t and column
/// F(t,c).
/// The kernel of P holds the fields without divergence and curl, that of Q those without reflected pair: constants on
/// flat pieces, usually nothing elsewhere.
struct FirstOrderOperators {
  OperatorOptions options;   ///< what they were built with
  ComplexVectorX<double> p;  ///< 3 #F, units of length
  ComplexVectorX<double> q;  ///< 3 #F, units of length
};

/// Builds P and Q. O(F), parallel, bitwise independent of threads. Edge-based operators of a trivial connection take
/// values from edges to faces by the connection (alpha) and integrate along the edge's true direction. The second form
/// is for those who own the parts, here and below.
[[nodiscard]] FirstOrderOperators first_order_operators(const ConnectedSurface& surface,
                                                        const OperatorOptions& options = {});
[[nodiscard]] FirstOrderOperators first_order_operators(const Mesh& mesh, const Geometry& geometry,
                                                        const Connection& connection,
                                                        const OperatorOptions& options = {});

/// Values per face (#F): sum over the corners c of coefficients[3 t + c] u[F(t,c)]. `coefficients` is p or q.
[[nodiscard]] ComplexVectorX<double> apply(const Mesh& mesh, const ComplexVectorX<double>& coefficients,
                                           const ComplexVectorX<double>& u);

/// The adjoint, values per vertex (#V) from values per face (#F): the right-hand sides of LTGD 2016, Sec. 7.1. Zero at
/// unreferenced vertices.
[[nodiscard]] ComplexVectorX<double> apply_adjoint(const Mesh& mesh, const ComplexVectorX<double>& coefficients,
                                                   const ComplexVectorX<double>& faces);

/// One row per face, one column per vertex.
using FaceVertexMatrix = Eigen::SparseMatrix<Complex<double>, Eigen::RowMajor, Index>;

/// p or q as a sparse matrix, #F x #V, columns sorted in each row.
[[nodiscard]] FaceVertexMatrix face_vertex_matrix(const Mesh& mesh, const ComplexVectorX<double>& coefficients);

/// Energies as sums over faces of squared face means: E_A = 1/2 sum |P u|^2 / A, E_H = 1/2 sum |Q u|^2 / A.
/// They are lower bounds of the exact energies of energies.h when the operators are triangle-based, and E_A - E_H of an
/// edge-based unit field is 2 pi chi nearly exactly on closed surfaces (n = 1).
struct OperatorEnergies {
  double antiholomorphic = 0;  ///< E_A, vanishes where div and curl do
  double holomorphic = 0;      ///< E_H, vanishes where the reflected pair does
  [[nodiscard]] double dirichlet() const { return (antiholomorphic + holomorphic) / 2; }  ///< 1/2 integral |grad u|^2
};
/// The energies of a field from its operators. Throws OptionError for arrays of another mesh.
[[nodiscard]] OperatorEnergies operator_energies(const Surface& surface, const FirstOrderOperators& operators,
                                                 const ComplexVectorX<double>& u);
[[nodiscard]] OperatorEnergies operator_energies(const Mesh& mesh, const Geometry& geometry,
                                                 const FirstOrderOperators& operators, const ComplexVectorX<double>& u);

/// Flux through halfedge h out of its face, plus i times the circulation along it, of a vector field (n = 1) with
/// vertex components u. The twin has the negative. The sum over a face's halfedges is the edge-based (P u)_t unless the
/// connection has adjustment angles (alpha).
[[nodiscard]] Complex<double> flux_and_circulation(const ConnectedSurface& surface, const ComplexVectorX<double>& u,
                                                   Index h);
[[nodiscard]] Complex<double> flux_and_circulation(const Mesh& mesh, const Geometry& geometry,
                                                   const Connection& connection, const ComplexVectorX<double>& u,
                                                   Index h);

/// An n-field and its covariant derivatives at a point, in the frame of the face.
struct FieldValue {
  Complex<double> u;  ///< the n-vector
  /// Derivatives along the axes of the frame, per unit of length.
  Complex<double> d1, d2;  ///< derivatives along the frame's axes, per unit of length

  /// Derivative along the tangent vector w (a complex number in the face frame).
  [[nodiscard]] Complex<double> derivative(Complex<double> w) const { return w.real() * d1 + w.imag() * d2; }
  /// div + i curl, an (n-1)-vector.
  [[nodiscard]] Complex<double> div_curl() const { return d1 + Complex<double>(d2.imag(), -d2.real()); }
  /// Reflected div + i reflected curl, an (n+1)-vector.
  [[nodiscard]] Complex<double> reflected() const { return d1 + Complex<double>(-d2.imag(), d2.real()); }
  /// The Cauchy-Riemann (antiholomorphic) derivative, half of the reflected pair.
  [[nodiscard]] Complex<double> cauchy_riemann() const { return reflected() / double(2); }
  /// Divergence (n = 1).
  [[nodiscard]] double div() const { return div_curl().real(); }
  /// Curl (n = 1), positive for counter-clockwise circulation.
  [[nodiscard]] double curl() const { return div_curl().imag(); }
  /// |grad u|^2, its integral is twice the Dirichlet energy.
  [[nodiscard]] double squared_gradient() const { return std::norm(d1) + std::norm(d2); }
};

/// A field inside one face: everything needed to evaluate it there many times.
struct FaceField {
  double n = 1;                           ///< degree
  std::array<double, 3> rho{};            ///< vertex frame to face frame per corner
  std::array<double, 3> tau{};            ///< lifted rotation per halfedge
  std::array<Complex<double>, 3> grad{};  ///< gradients of the hat functions in the face frame
  std::array<Complex<double>, 3> u{};     ///< values at the corners in vertex frames

  /// The closed-form basis (LTGD 2016, Sec. 4.3) at barycentric coordinates that sum to 1.
  [[nodiscard]] FieldValue at(const std::array<double, 3>& barycentric) const;
};

/// The n-field with vertex components u (#V) inside face t.
[[nodiscard]] FaceField face_field(const ConnectedSurface& surface, int n, const ComplexVectorX<double>& u, Index t);
[[nodiscard]] FaceField face_field(const Mesh& mesh, const Geometry& geometry, const Connection& connection, int n,
                                   const ComplexVectorX<double>& u, Index t);

/// An n-field and its covariant derivative along an edge at one of its points, in the frame of the edge.
struct EdgeValue {
  Complex<double> u;      ///< the n-vector
  Complex<double> along;  ///< derivative in the direction of the halfedge, per unit of length
};

/// A field along one edge, from the tail of a halfedge to its tip: the restriction of the closed-form basis, which both
/// of its faces share. Components are in the frame along the halfedge.
struct EdgeField {
  double n = 1;                ///< degree
  double rho_tail = 0;         ///< frame of the tail to the frame of the halfedge
  double rho_tip = 0;          ///< frame of the tip to the frame of the halfedge
  double eps = 0;              ///< lifted rotation along the halfedge
  double length = 0;           ///< of the edge
  Complex<double> u_tail = 0;  ///< value at the tail, in its frame
  Complex<double> u_tip = 0;   ///< value at the tip, in its frame

  /// The basis of an edge (LTGD 2016, Secs. 4.3 and 6.3), Psi_i = phi_i exp(-i n (rho_{vi->e} + eps_ij phi_j)), at the
  /// fraction s in [0, 1] of the way to the tip. The derivative is (Phi_j u_j - Phi_i u_i) / |e|, with Phi_i the
  /// parallel frame from vertex i.
  [[nodiscard]] EdgeValue at(double s) const;
};

/// The n-field with vertex components u (#V) along halfedge h. Throws OptionError when h is not a halfedge.
[[nodiscard]] EdgeField edge_field(const ConnectedSurface& surface, int n, const ComplexVectorX<double>& u, Index h);
[[nodiscard]] EdgeField edge_field(const Mesh& mesh, const Geometry& geometry, const Connection& connection, int n,
                                   const ComplexVectorX<double>& u, Index h);

/// rho_{e->t} at the fraction s of halfedge h, radians: from the frame along h to the frame of its face (LTGD 2016,
/// eq. 9). A component z of an n-field on the edge is z exp(-i n rho_{e->t}) in the face. Throws OptionError when h
/// is not a halfedge.
[[nodiscard]] double edge_to_face(const ConnectedSurface& surface, Index h, double s);
[[nodiscard]] double edge_to_face(const Mesh& mesh, const Connection& connection, Index h, double s);

}  // namespace alcap
