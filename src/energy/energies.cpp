// SPDX-License-Identifier: MIT
//
// energies.cpp: assembly in two passes. First the entries of every triangle without the phases of its edges (SIMD,
// triangle_entries.h), then a gather per edge and per vertex into the slots of the pattern.
#include "alcap/energies.h"

#include <algorithm>
#include <array>
#include <memory>
#include <string>

#include "src/simd/angles.h"
#include "src/simd/triangle_entries.h"
#include "src/base/parallel.h"
#include "src/base/large_array.h"

namespace alcap {
namespace {

template <class T>
struct TriangleEntries {
  detail::LargeArray<T> stiffness_diagonal;
  detail::LargeArray<Complex<T>> stiffness_off, mass_off;
};

void check_pattern(const Mesh& mesh, const HermitianPattern& pattern) {
  if (pattern.rows() != mesh.vertices())
    throw OptionError("pattern", std::to_string(pattern.rows()) + " rows",
                      "belongs to another mesh; this one has " + std::to_string(mesh.vertices()) + " vertices");
}

template <class T>
TriangleEntries<T> entries_of_triangles(const Mesh& mesh, const Geometry<T>& geometry, const Connection<T>& connection,
                                        int n) {
  const auto faces = static_cast<std::size_t>(mesh.faces());
  TriangleEntries<T> entries{detail::LargeArray<T>(3 * faces), detail::LargeArray<Complex<T>>(3 * faces),
                             detail::LargeArray<Complex<T>>(faces)};
  const detail::TriangleInputs<T> in{.cot = geometry.cots().data(),
                                     .area = geometry.areas().data(),
                                     .curvature = connection.K.data(),
                                     .n = static_cast<T>(n)};
  const detail::TriangleOutputs<T> out{.stiffness_diagonal = entries.stiffness_diagonal.data(),
                                       .stiffness_off = entries.stiffness_off.data(),
                                       .mass_off = entries.mass_off.data()};
  parallel_ranges(mesh.faces(), sequential_below,
                  [&](std::int64_t begin, std::int64_t end) { detail::triangle_entries<T>(begin, end, in, out); });
  return entries;
}

// Calls body(e, exp(i n rho_e)) for every edge; the phases are computed many at a time.
template <class T, class Body>
void for_each_edge(const Mesh& mesh, const Connection<T>& connection, int n, Body&& body) {
  constexpr std::int64_t block = 256;
  parallel_ranges(mesh.edges(), block, [&](std::int64_t begin, std::int64_t end) {
    std::array<Complex<T>, block> phases;
    for (std::int64_t first = begin; first < end; first += block) {
      const std::int64_t count = std::min(block, end - first);
      detail::unit_numbers(count, connection.rho.data() + first, T(n), phases.data());
      for (std::int64_t i = 0; i < count; ++i) body(first + i, phases[static_cast<std::size_t>(i)]);
    }
  });
}

// a b without the check for infinities.
template <class T>
Complex<T> product(const Complex<T>& a, const Complex<T>& b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

// Writes value to (i, j) and its conjugate to (j, i) for the canonical halfedge i -> j of e.
template <class T>
void set_pair(SparseMatrix<Complex<T>>& A, const HermitianPattern& pattern, std::int64_t e, Complex<T> value) {
  A.valuePtr()[pattern.upper(static_cast<Index>(e))] = value;
  A.valuePtr()[pattern.lower(static_cast<Index>(e))] = std::conj(value);
}

}  // namespace

template <class T>
StiffnessMass<T> stiffness_and_mass(const Mesh& mesh, const HermitianPattern& pattern, const Geometry<T>& geometry,
                                    const Connection<T>& connection, int n) {
  check_pattern(mesh, pattern);
  StiffnessMass<T> out;
  // Eigen writes zeros into new complex values, one after the other: at least each matrix on a thread of its own.
  parallel_for(
      2,
      [&](std::int64_t k) {
        SparseMatrix<Complex<T>> A = pattern.matrix<T>();
        A.swap(k == 0 ? out.S : out.M);  // assigning would copy
      },
      1);
  const TriangleEntries<T> entries = entries_of_triangles(mesh, geometry, connection, n);
  for_each_edge(mesh, connection, n, [&](std::int64_t e, const Complex<T>& phase) {
    const Index h = mesh.halfedge(static_cast<Index>(e)), g = mesh.twin(h);
    Complex<T> s = entries.stiffness_off[static_cast<std::size_t>(h)];
    Complex<T> m = entries.mass_off[static_cast<std::size_t>(h / 3)];
    if (g != none) {
      s += std::conj(entries.stiffness_off[static_cast<std::size_t>(g)]);
      m += std::conj(entries.mass_off[static_cast<std::size_t>(g / 3)]);
    }
    set_pair(out.S, pattern, e, product(phase, s));
    set_pair(out.M, pattern, e, product(phase, m));
  });
  parallel_for(mesh.vertices(), [&](std::int64_t v) {
    T stiffness = 0, area = 0;
    mesh.for_each_outgoing(static_cast<Index>(v), [&](Index h) {
      stiffness += entries.stiffness_diagonal[static_cast<std::size_t>(h)];
      area += geometry.area(h / 3);
    });
    const Index slot = pattern.diagonal(static_cast<Index>(v));
    out.S.valuePtr()[slot] = stiffness;
    out.M.valuePtr()[slot] = area / 6;
  });
  return out;
}

template <class T>
SparseMatrix<Complex<T>> curvature_and_boundary(const Mesh& mesh, const HermitianPattern& pattern,
                                                const Geometry<T>& geometry, const Connection<T>& connection, int n) {
  check_pattern(mesh, pattern);
  SparseMatrix<Complex<T>> A = pattern.matrix<T>();
  const TriangleEntries<T> entries = entries_of_triangles(mesh, geometry, connection, n);
  const auto density = [&](Index t) { return T(n) * connection.K[t] / geometry.area(t); };
  for_each_edge(mesh, connection, n, [&](std::int64_t e, const Complex<T>& phase) {
    const Index h = mesh.halfedge(static_cast<Index>(e)), g = mesh.twin(h);
    Complex<T> c = density(h / 3) * entries.mass_off[static_cast<std::size_t>(h / 3)];
    if (g != none)
      c += density(g / 3) * std::conj(entries.mass_off[static_cast<std::size_t>(g / 3)]);
    else
      c += Complex<T>(0, T(-0.5));  // Im(conj(u_i) e^{iR} u_j) for the boundary halfedge i -> j
    set_pair(A, pattern, e, product(phase, c));
  });
  parallel_for(mesh.vertices(), [&](std::int64_t v) {
    T curvature = 0;
    mesh.for_each_outgoing(static_cast<Index>(v), [&](Index h) { curvature += connection.K[h / 3]; });
    A.valuePtr()[pattern.diagonal(static_cast<Index>(v))] = T(n) * curvature / 6;
  });
  return A;
}

template <class T>
void apply_energy_family(const Mesh& mesh, const HermitianPattern& pattern, const Geometry<T>& geometry,
                         const Connection<T>& connection, int n, T s, SparseMatrix<Complex<T>>& S) {
  if (!(s >= T(-1) && s <= T(1))) throw OptionError("s", std::to_string(s), "the energy family needs s in [-1, 1]");
  if (s == T(0)) return;
  const SparseMatrix<Complex<T>> difference = curvature_and_boundary(mesh, pattern, geometry, connection, n);
  parallel_for(S.nonZeros(), [&](std::int64_t k) { S.valuePtr()[k] -= s * difference.valuePtr()[k]; });
}

FieldEnergies field_energies(const Mesh& mesh, const Geometry<double>& geometry, const Connection<double>& connection,
                             int n, const ComplexVectorX<double>& u) {
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

#define ALCAP_INSTANTIATE(T)                                                                                         \
  template StiffnessMass<T> stiffness_and_mass(const Mesh&, const HermitianPattern&, const Geometry<T>&,             \
                                               const Connection<T>&, int);                                           \
  template SparseMatrix<Complex<T>> curvature_and_boundary(const Mesh&, const HermitianPattern&, const Geometry<T>&, \
                                                           const Connection<T>&, int);                               \
  template void apply_energy_family(const Mesh&, const HermitianPattern&, const Geometry<T>&, const Connection<T>&,  \
                                    int, T, SparseMatrix<Complex<T>>&);
ALCAP_INSTANTIATE(float)
ALCAP_INSTANTIATE(double)
#undef ALCAP_INSTANTIATE

}  // namespace alcap
