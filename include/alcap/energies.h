// SPDX-License-Identifier: MIT
//
// energies.h: quadratic energies of n-vector fields as Hermitian matrices (LTGD 2016, Sec. 6.2), exact integrals of the
// closed-form basis, any n and any connection. All are #V x #V, complex, both triangles stored.
//
//   const auto [S, M] = alcap::energy_matrices(connected, 4);
//   E_D = 0.5 * real(u.dot(S * u));          // |u|^2 integral = real(u.dot(M * u))
//
// S (connection Laplacian): positive semidefinite, u* S u = integral of |grad u|^2, invariant to scale.
// M: positive definite on referenced vertices, u* M u = integral of |u|^2, scales with area.
// E_A + E_H = u* S u, and E_A - E_H = u* (C + B) u with C the curvature term and B the boundary term.
#pragma once

#include "alcap/assembly.h"
#include "alcap/connection.h"

namespace alcap {

class ConnectedSurface;

/// The two matrices of one degree and connection.
struct StiffnessMass {
  SparseMatrix<Complex<double>> S;  ///< stiffness
  SparseMatrix<Complex<double>> M;  ///< mass
};

/// What a solver of your own starts from: S of the energy E_s (see apply_energy_family; s = 0: the Dirichlet energy)
/// and M, of degree n. Rows of vertices that no face uses are zero. Throws OptionError for s outside [-1, 1].
[[nodiscard]] StiffnessMass energy_matrices(const ConnectedSurface& surface, int n, double s = 0);
[[nodiscard]] StiffnessMass energy_matrices(const Mesh& mesh, const Geometry& geometry, const Connection& connection,
                                            int n, double s = 0);

/// C + B of degree n, see curvature_and_boundary() below.
[[nodiscard]] SparseMatrix<Complex<double>> curvature_and_boundary(const ConnectedSurface& surface, int n);

/// Stiffness S and mass M of degree n (any integer except that |n K| should stay below a few hundred). Parallel,
/// bitwise independent of threads. Rows of unreferenced vertices are zero.
[[nodiscard]] StiffnessMass stiffness_and_mass(const Mesh& mesh, const HermitianPattern& pattern,
                                               const Geometry& geometry, const Connection& connection, int n);

/// C + B: u* (C + B) u = E_A(u) - E_H(u). C sums n K_t / A_t times the face masses, B is the boundary integral of
/// Im(conj(u) du/ds), the surface on the left (LTGD 2016, eq. 5).
[[nodiscard]] SparseMatrix<Complex<double>> curvature_and_boundary(const Mesh& mesh, const HermitianPattern& pattern,
                                                                   const Geometry& geometry,
                                                                   const Connection& connection, int n);

/// Knoeppel et al. 2013: E_s = (1+s) E_H + (1-s) E_A = S - s (C + B), positive semidefinite for s in [-1, 1].
/// Adds -s (C + B) to S.
void apply_energy_family(const Mesh& mesh, const HermitianPattern& pattern, const Geometry& geometry,
                         const Connection& connection, int n, double s, SparseMatrix<Complex<double>>& S);

/// E_D, E_A and E_H of an n-field with values u in vertex frames.
struct FieldEnergies {
  double dirichlet = 0;        ///< E_D = (E_A + E_H) / 2
  double antiholomorphic = 0;  ///< E_A
  double holomorphic = 0;      ///< E_H
};
/// The energies of a field with vertex components u (#V), exact integrals of the closed-form basis.
[[nodiscard]] FieldEnergies field_energies(const ConnectedSurface& surface, int n, const ComplexVectorX<double>& u);
[[nodiscard]] FieldEnergies field_energies(const Mesh& mesh, const Geometry& geometry, const Connection& connection,
                                           int n, const ComplexVectorX<double>& u);

}  // namespace alcap
