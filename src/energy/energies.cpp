// SPDX-License-Identifier: MIT
//
// energies.cpp: assembly in two passes. First the entries of every triangle without the phases of its edges (SIMD,
// triangle_entries.h), then a gather per edge and per vertex into the slots of the pattern.
#include "alcap/energies.h"

#include <algorithm>
#include <array>
#include <memory>
#include <string>

#include "src/base/array.h"
#include "src/base/parallel.h"
#include "src/simd/angles.h"
#include "src/simd/triangle_entries.h"

namespace alcap {
namespace {

struct TriangleEntries {
  detail::Array<double> stiffness_diagonal;
  detail::Array<Complex<double>> stiffness_off, mass_off;
};

void check_pattern(const Mesh& mesh, const HermitianPattern& pattern) {
  if (pattern.rows() != mesh.vertices())
    throw OptionError("pattern", std::to_string(pattern.rows()) + " rows",
                      "belongs to another mesh; this one has " + std::to_string(mesh.vertices()) + " vertices");
}

TriangleEntries entries_of_triangles(const Mesh& mesh, const Geometry& geometry, const Connection& connection, int n) {
  const std::int64_t faces = mesh.faces();
  TriangleEntries entries{detail::Array<double>(3 * faces), detail::Array<Complex<double>>(3 * faces),
                          detail::Array<Complex<double>>(faces)};
  const detail::TriangleInputs<double> in{.cot = geometry.cots().data(),
                                          .area = geometry.areas().data(),
                                          .curvature = connection.K.data(),
                                          .n = static_cast<double>(n)};
  const detail::TriangleOutputs<double> out{.stiffness_diagonal = entries.stiffness_diagonal.data(),
                                            .stiffness_off = entries.stiffness_off.data(),
                                            .mass_off = entries.mass_off.data()};
  parallel_ranges(mesh.faces(), sequential_below,
                  [&](std::int64_t begin, std::int64_t end) { detail::triangle_entries<double>(begin, end, in, out); });
  return entries;
}

// Calls body(e, exp(i n rho_e)) for every edge; the phases are computed many at a time.
template <class Body>
void for_each_edge(const Mesh& mesh, const Connection& connection, int n, Body&& body) {
  constexpr std::int64_t block = 256;
  parallel_ranges(mesh.edges(), block, [&](std::int64_t begin, std::int64_t end) {
    std::array<Complex<double>, block> phases;
    for (std::int64_t first = begin; first < end; first += block) {
      const std::int64_t count = std::min(block, end - first);
      detail::unit_numbers(count, connection.rho.data() + first, double(n), phases.data());
      for (std::int64_t i = 0; i < count; ++i) body(first + i, phases[static_cast<std::size_t>(i)]);
    }
  });
}

// a b without the check for infinities.
Complex<double> plain_product(const Complex<double>& a, const Complex<double>& b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

// Writes value to (i, j) and its conjugate to (j, i) for the canonical halfedge i -> j of e.
void set_pair(SparseMatrix<Complex<double>>& A, const HermitianPattern& pattern, std::int64_t e,
              Complex<double> value) {
  A.valuePtr()[pattern.upper(static_cast<Index>(e))] = value;
  A.valuePtr()[pattern.lower(static_cast<Index>(e))] = std::conj(value);
}

}  // namespace

StiffnessMass stiffness_and_mass(const Mesh& mesh, const HermitianPattern& pattern, const Geometry& geometry,
                                 const Connection& connection, int n) {
  check_pattern(mesh, pattern);
  StiffnessMass out;
  // Eigen writes zeros into new complex values, one after the other: at least each matrix on a thread of its own.
  parallel_for(
      2,
      [&](std::int64_t k) {
        SparseMatrix<Complex<double>> A = pattern.matrix();
        A.swap(k == 0 ? out.S : out.M);  // assigning would copy
      },
      1);
  const TriangleEntries entries = entries_of_triangles(mesh, geometry, connection, n);
  for_each_edge(mesh, connection, n, [&](std::int64_t e, const Complex<double>& phase) {
    const Index h = mesh.halfedge(static_cast<Index>(e)), g = mesh.twin(h);
    Complex<double> s = entries.stiffness_off[h];
    Complex<double> m = entries.mass_off[h / 3];
    if (g != none) {
      s += std::conj(entries.stiffness_off[g]);
      m += std::conj(entries.mass_off[g / 3]);
    }
    set_pair(out.S, pattern, e, plain_product(phase, s));
    set_pair(out.M, pattern, e, plain_product(phase, m));
  });
  parallel_for(mesh.vertices(), [&](std::int64_t v) {
    double stiffness = 0, area = 0;
    mesh.for_each_outgoing(static_cast<Index>(v), [&](Index h) {
      stiffness += entries.stiffness_diagonal[h];
      area += geometry.area(h / 3);
    });
    const Index slot = pattern.diagonal(static_cast<Index>(v));
    out.S.valuePtr()[slot] = stiffness;
    out.M.valuePtr()[slot] = area / 6;
  });
  return out;
}

SparseMatrix<Complex<double>> curvature_and_boundary(const Mesh& mesh, const HermitianPattern& pattern,
                                                     const Geometry& geometry, const Connection& connection, int n) {
  check_pattern(mesh, pattern);
  SparseMatrix<Complex<double>> A = pattern.matrix();
  const TriangleEntries entries = entries_of_triangles(mesh, geometry, connection, n);
  const auto density = [&](Index t) { return double(n) * connection.K[t] / geometry.area(t); };
  for_each_edge(mesh, connection, n, [&](std::int64_t e, const Complex<double>& phase) {
    const Index h = mesh.halfedge(static_cast<Index>(e)), g = mesh.twin(h);
    Complex<double> c = density(h / 3) * entries.mass_off[h / 3];
    if (g != none)
      c += density(g / 3) * std::conj(entries.mass_off[g / 3]);
    else
      c += Complex<double>(0, double(-0.5));  // Im(conj(u_i) e^{iR} u_j) for the boundary halfedge i -> j
    set_pair(A, pattern, e, plain_product(phase, c));
  });
  parallel_for(mesh.vertices(), [&](std::int64_t v) {
    double curvature = 0;
    mesh.for_each_outgoing(static_cast<Index>(v), [&](Index h) { curvature += connection.K[h / 3]; });
    A.valuePtr()[pattern.diagonal(static_cast<Index>(v))] = double(n) * curvature / 6;
  });
  return A;
}

void apply_energy_family(const Mesh& mesh, const HermitianPattern& pattern, const Geometry& geometry,
                         const Connection& connection, int n, double s, SparseMatrix<Complex<double>>& S) {
  if (!(s >= double(-1) && s <= double(1))) throw OptionError("s", s, "the energy family needs s in [-1, 1]");
  if (s == double(0)) return;
  const SparseMatrix<Complex<double>> difference = curvature_and_boundary(mesh, pattern, geometry, connection, n);
  parallel_for(S.nonZeros(), [&](std::int64_t k) { S.valuePtr()[k] -= s * difference.valuePtr()[k]; });
}

StiffnessMass energy_matrices(const Mesh& mesh, const Geometry& geometry, const Connection& connection, int n,
                              double s) {
  const HermitianPattern pattern(mesh);
  StiffnessMass matrices = stiffness_and_mass(mesh, pattern, geometry, connection, n);
  apply_energy_family(mesh, pattern, geometry, connection, n, s, matrices.S);
  return matrices;
}

FieldEnergies field_energies(const Mesh& mesh, const Geometry& geometry, const Connection& connection, int n,
                             const ComplexVectorX<double>& u) {
  const HermitianPattern pattern(mesh);
  const auto form = [&](const SparseMatrix<Complex<double>>& A) {
    ComplexVectorX<double> Au(u.size());
    hermitian_product(A, u.data(), Au.data());
    return parallel_sum<double>(u.size(), [&](std::int64_t i) { return (std::conj(u[i]) * Au[i]).real(); });
  };
  const double sum = form(stiffness_and_mass(mesh, pattern, geometry, connection, n).S);
  const double difference = form(curvature_and_boundary(mesh, pattern, geometry, connection, n));
  return {sum / 2, (sum + difference) / 2, (sum - difference) / 2};
}

}  // namespace alcap
