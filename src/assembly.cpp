// SPDX-License-Identifier: MIT
#include "alcap/assembly.h"

#include <algorithm>
#include <limits>
#include <string>

#include "alcap/parallel.h"

namespace alcap {

HermitianPattern::HermitianPattern(const Mesh& mesh) {
  const Index vertices = mesh.vertices();
  const std::int64_t nonzeros = std::int64_t{vertices} + 2 * std::int64_t{mesh.edges()};
  if (nonzeros > std::numeric_limits<Index>::max())
    throw OptionError("mesh", std::to_string(nonzeros) + " matrix entries",
                      "at most 2^31 - 1 fit 32-bit sparse indices");

  // A vertex's column holds itself and its neighbours: one per leaving halfedge, one more at a boundary.
  outer_.assign(static_cast<std::size_t>(vertices) + 1, 0);
  parallel_for(vertices, [&](std::int64_t v) {
    Index entries = 1 + (mesh.boundary_vertex(static_cast<Index>(v)) ? 1 : 0);
    mesh.for_each_outgoing(static_cast<Index>(v), [&](Index) { ++entries; });
    outer_[static_cast<std::size_t>(v)] = entries;
  });
  parallel_exclusive_scan(outer_.data(), std::int64_t{vertices} + 1);

  inner_.resize(static_cast<std::size_t>(nonzeros));
  diagonal_.resize(static_cast<std::size_t>(vertices));
  upper_.resize(static_cast<std::size_t>(mesh.edges()));
  lower_.resize(static_cast<std::size_t>(mesh.edges()));
  parallel_for(vertices, [&](std::int64_t i) {
    const Index v = static_cast<Index>(i);
    const Index begin = outer_[static_cast<std::size_t>(v)], end = outer_[static_cast<std::size_t>(v) + 1];
    Index k = begin;
    inner_[static_cast<std::size_t>(k++)] = v;
    Index last = none;
    mesh.for_each_outgoing(v, [&](Index h) {
      inner_[static_cast<std::size_t>(k++)] = mesh.tip(h);
      last = h;
    });
    if (mesh.boundary_vertex(v)) inner_[static_cast<std::size_t>(k++)] = mesh.tail(Mesh::prev(last));
    const auto first = inner_.begin() + begin, stop = inner_.begin() + end;
    std::sort(first, stop);
    const auto slot = [&](Index row) { return begin + static_cast<Index>(std::lower_bound(first, stop, row) - first); };
    diagonal_[static_cast<std::size_t>(v)] = slot(v);
    // Column v holds (i, v) for canonical halfedges i -> v and (j, v), the mirror, for canonical v -> j.
    mesh.for_each_outgoing(v, [&](Index h) {
      const auto e = static_cast<std::size_t>(mesh.edge(h));
      (mesh.canonical(h) ? lower_ : upper_)[e] = slot(mesh.tip(h));
    });
    if (mesh.boundary_vertex(v)) {
      const Index p = Mesh::prev(last);
      upper_[static_cast<std::size_t>(mesh.edge(p))] = slot(mesh.tail(p));
    }
  });
}

template <class T>
SparseMatrix<Complex<T>> HermitianPattern::matrix() const {
  SparseMatrix<Complex<T>> A(rows(), rows());
  A.resizeNonZeros(nonzeros());
  const auto copy = [](const std::vector<Index>& from, Index* to) {
    parallel_ranges(static_cast<std::int64_t>(from.size()), 1 << 14, [&](std::int64_t begin, std::int64_t end) {
      std::copy(from.data() + begin, from.data() + end, to + begin);
    });
  };
  copy(outer_, A.outerIndexPtr());
  copy(inner_, A.innerIndexPtr());
  return A;
}

template <class T>
SparseMatrix<T> real_view(const SparseMatrix<Complex<T>>& A) {
  SparseMatrix<T> R(2 * A.rows(), 2 * A.cols());
  R.resizeNonZeros(4 * A.nonZeros());
  const Index columns = static_cast<Index>(A.cols());
  R.outerIndexPtr()[2 * columns] = 4 * A.outerIndexPtr()[columns];
  parallel_for(columns, [&](std::int64_t j) {
    const Index begin = A.outerIndexPtr()[j], end = A.outerIndexPtr()[j + 1], size = end - begin;
    R.outerIndexPtr()[2 * j] = 4 * begin;
    R.outerIndexPtr()[2 * j + 1] = 4 * begin + 2 * size;
    for (Index k = begin; k < end; ++k) {
      const Complex<T> a = A.valuePtr()[k];
      const Index re = 4 * begin + 2 * (k - begin), im = re + 2 * size;
      const Index row = 2 * A.innerIndexPtr()[k];
      R.innerIndexPtr()[re] = R.innerIndexPtr()[im] = row;
      R.innerIndexPtr()[re + 1] = R.innerIndexPtr()[im + 1] = row + 1;
      R.valuePtr()[re] = R.valuePtr()[im + 1] = a.real();
      R.valuePtr()[re + 1] = a.imag();
      R.valuePtr()[im] = -a.imag();
    }
  });
  return R;
}

template <class T>
SparseMatrix<Complex<T>> diagonal_block(const SparseMatrix<Complex<T>>& A, const std::vector<Index>& vertices,
                                        const std::vector<Index>& local) {
  const Index size = static_cast<Index>(vertices.size());
  SparseMatrix<Complex<T>> B(size, size);
  Index nonzeros = 0;
  for (Index j = 0; j < size; ++j) {
    const Index v = vertices[static_cast<std::size_t>(j)];
    B.outerIndexPtr()[j] = nonzeros;
    nonzeros += A.outerIndexPtr()[v + 1] - A.outerIndexPtr()[v];
  }
  B.outerIndexPtr()[size] = nonzeros;
  B.resizeNonZeros(nonzeros);
  Index k = 0;
  for (const Index v : vertices)
    for (Index a = A.outerIndexPtr()[v]; a < A.outerIndexPtr()[v + 1]; ++a, ++k) {
      B.innerIndexPtr()[k] = local[static_cast<std::size_t>(A.innerIndexPtr()[a])];
      B.valuePtr()[k] = A.valuePtr()[a];
    }
  return B;
}

template SparseMatrix<Complex<float>> HermitianPattern::matrix<float>() const;
template SparseMatrix<Complex<double>> HermitianPattern::matrix<double>() const;
template SparseMatrix<float> real_view(const SparseMatrix<Complex<float>>&);
template SparseMatrix<double> real_view(const SparseMatrix<Complex<double>>&);
template SparseMatrix<Complex<float>> diagonal_block(const SparseMatrix<Complex<float>>&, const std::vector<Index>&,
                                                     const std::vector<Index>&);
template SparseMatrix<Complex<double>> diagonal_block(const SparseMatrix<Complex<double>>&, const std::vector<Index>&,
                                                      const std::vector<Index>&);

}  // namespace alcap
