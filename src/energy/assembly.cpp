// SPDX-License-Identifier: MIT
#include "alcap/assembly.h"

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "src/base/limits.h"
#include "src/base/pages.h"
#include "src/base/parallel.h"
#include "src/energy/real_places.h"

namespace alcap {

HermitianPattern::HermitianPattern(const Mesh& mesh) {
  const Index vertices = mesh.vertices();
  const std::int64_t nonzeros = std::int64_t{vertices} + 2 * std::int64_t{mesh.edges()};
  if (nonzeros > detail::most_entries)
    throw OptionError("mesh", std::to_string(nonzeros) + " matrix entries", detail::entries_that_fit());

  // A vertex's column holds itself and its neighbours: one per leaving halfedge, one more at a boundary.
  detail::resize_unset(outer_, std::int64_t{vertices} + 1);
  outer_[vertices] = 0;
  parallel_for(vertices, [&](std::int64_t v) {
    Index entries = 1 + (mesh.boundary_vertex(static_cast<Index>(v)) ? 1 : 0);
    mesh.for_each_outgoing(static_cast<Index>(v), [&](Index) { ++entries; });
    outer_[v] = entries;
  });
  parallel_exclusive_scan(outer_.data(), std::int64_t{vertices} + 1);

  detail::resize_unset(inner_, nonzeros);
  detail::resize_unset(diagonal_, vertices);
  detail::resize_unset(upper_, mesh.edges());
  detail::resize_unset(lower_, mesh.edges());
  struct Entry {
    Index row;
    Index halfedge;  // between the row's vertex and the column's; `none` on the diagonal
  };
  parallel_ranges(vertices, sequential_below, [&](std::int64_t first, std::int64_t stop) {
    std::vector<Entry> column;
    for (auto v = static_cast<Index>(first); v < stop; ++v) {
      column.assign(1, {v, none});
      Index last = none;
      mesh.for_each_outgoing(v, [&](Index h) {
        column.push_back({mesh.tip(h), h});
        last = h;
      });
      if (mesh.boundary_vertex(v)) column.push_back({mesh.tail(Mesh::prev(last)), Mesh::prev(last)});
      std::sort(column.begin(), column.end(), [](const Entry& a, const Entry& b) { return a.row < b.row; });
      Index slot = outer_[v];
      for (const auto& [row, h] : column) {
        inner_[slot] = row;
        if (h == none)
          diagonal_[v] = slot;
        else  // column v holds (i, v) for canonical halfedges i -> v and (j, v), the mirror, for canonical v -> j
          ((mesh.tail(h) == v) == mesh.canonical(h) ? lower_ : upper_)[mesh.edge(h)] = slot;
        ++slot;
      }
    }
  });
}

SparseMatrix<Complex<double>> HermitianPattern::matrix() const {
  SparseMatrix<Complex<double>> A(rows(), rows());
  A.resizeNonZeros(nonzeros());
  const auto copy = [](const VectorX<Index>& from, Index* to) {
    parallel_ranges(from.size(), 1 << 14, [&](std::int64_t begin, std::int64_t end) {
      std::copy(from.data() + begin, from.data() + end, to + begin);
    });
  };
  copy(outer_, A.outerIndexPtr());
  copy(inner_, A.innerIndexPtr());
  return A;
}

SparseMatrix<double> real_view(const SparseMatrix<Complex<double>>& A) {
  if (A.nonZeros() > detail::most_entries / 4)
    throw OptionError("A", std::to_string(A.nonZeros()) + " entries",
                      "its real view has four times as many, and " + detail::entries_that_fit());
  SparseMatrix<double> R(2 * A.rows(), 2 * A.cols());
  R.resizeNonZeros(4 * A.nonZeros());
  const Index columns = static_cast<Index>(A.cols());
  R.outerIndexPtr()[2 * columns] = 4 * A.outerIndexPtr()[columns];
  parallel_for(columns, [&](std::int64_t j) {
    const Index begin = A.outerIndexPtr()[j], end = A.outerIndexPtr()[j + 1];
    const detail::RealPlaces<Index> places{begin, end - begin};
    R.outerIndexPtr()[2 * j] = places.first_column();
    R.outerIndexPtr()[2 * j + 1] = places.second_column();
    for (Index k = begin; k < end; ++k) {
      const Complex<double> a = A.valuePtr()[k];
      const Index re = places.first(k - begin), im = places.second(k - begin);
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

SparseMatrix<Complex<double>> diagonal_block(const SparseMatrix<Complex<double>>& A, const std::vector<Index>& vertices,
                                             const std::vector<Index>& local) {
  const Index size = static_cast<Index>(vertices.size());
  SparseMatrix<Complex<double>> B(size, size);
  const Index* const start = A.outerIndexPtr();
  Index* const first = B.outerIndexPtr();
  parallel_for(size, [&](std::int64_t j) {
    const Index v = vertices[static_cast<std::size_t>(j)];
    first[j] = start[v + 1] - start[v];
  });
  first[size] = 0;
  B.resizeNonZeros(parallel_exclusive_scan(first, std::int64_t{size} + 1));
  Index* const row = B.innerIndexPtr();
  Complex<double>* const value = B.valuePtr();
  parallel_for(size, [&](std::int64_t j) {
    const Index v = vertices[static_cast<std::size_t>(j)];
    for (Index a = start[v], b = first[j]; a < start[v + 1]; ++a, ++b) {
      row[b] = local[static_cast<std::size_t>(A.innerIndexPtr()[a])];
      value[b] = A.valuePtr()[a];
    }
  });
  return B;
}

}  // namespace alcap
