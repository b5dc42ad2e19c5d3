// SPDX-License-Identifier: MIT
//
// mg_row.h: sparse rows that are summed one by one and then laid end to end. Internal to solvers/.
#pragma once

#include <algorithm>
#include <vector>

#include "solvers/mg_level.h"

namespace alcap::detail {

/// Sums of complex values by column, in the order of first appearance. Rows have about ten columns, where a search
/// through all of them is faster than a hash table.
class RowSum {
 public:
  void clear() { columns_.clear(); }

  void add(Index column, double re, double im) {
    const std::size_t count = columns_.size();
    std::size_t k = 0;
    while (k < count && columns_[k] != column) ++k;
    if (k == count) {
      columns_.push_back(column);
      if (sums_.size() < columns_.size()) sums_.resize(2 * columns_.size());
      sums_[k] = {re, im};
      return;
    }
    sums_[k] += std::complex<double>(re, im);
  }

  /// Removes a column and returns its sum, zero when there is none.
  std::complex<double> take(Index column) {
    const auto found = std::find(columns_.begin(), columns_.end(), column);
    if (found == columns_.end()) return 0;
    const auto k = static_cast<std::size_t>(found - columns_.begin());
    const std::complex<double> sum = sums_[k];
    std::copy(sums_.begin() + k + 1, sums_.begin() + columns_.size(), sums_.begin() + k);
    columns_.erase(found);
    return sum;
  }

  [[nodiscard]] std::size_t size() const { return columns_.size(); }
  [[nodiscard]] Index column(std::size_t k) const { return columns_[k]; }
  [[nodiscard]] std::complex<double> sum(std::size_t k) const { return sums_[k]; }

 private:
  std::vector<Index> columns_;
  std::vector<std::complex<double>> sums_;
};

/// The matrix of the rows that compute(i, row) fills. Each piece of rows fills its own memory; the pieces are then laid
/// end to end.
template <class Compute>
Rows collect_rows(std::int64_t rows, Compute&& compute) {
  constexpr std::int64_t piece = 1024;
  const std::int64_t pieces = (rows + piece - 1) / piece;
  struct Part {
    std::vector<Index> column;
    std::vector<ComplexF> value;
  };
  std::vector<Part> parts(static_cast<std::size_t>(pieces));
  Rows result;
  result.start = Buffer<std::int64_t>(rows + 1);
  parallel_for(
      pieces,
      [&](std::int64_t p) {
        RowSum row;
        std::vector<Index> column;
        std::vector<ComplexF> value;
        for (std::int64_t i = p * piece; i < std::min(rows, (p + 1) * piece); ++i) {
          result.start[i] = static_cast<std::int64_t>(column.size());
          compute(i, row);
          for (std::size_t k = 0; k < row.size(); ++k) {
            column.push_back(row.column(k));
            value.emplace_back(static_cast<float>(row.sum(k).real()), static_cast<float>(row.sum(k).imag()));
          }
        }
        parts[static_cast<std::size_t>(p)] = {std::move(column), std::move(value)};
      },
      1);
  std::vector<std::int64_t> base(static_cast<std::size_t>(pieces) + 1, 0);
  for (std::size_t p = 0; p < parts.size(); ++p)
    base[p + 1] = base[p] + static_cast<std::int64_t>(parts[p].column.size());
  result.start[rows] = base.back();
  result.column = Buffer<Index>(base.back());
  result.value = Buffer<ComplexF>(base.back());
  parallel_for(
      pieces,
      [&](std::int64_t p) {
        Part& part = parts[static_cast<std::size_t>(p)];
        const std::int64_t to = base[static_cast<std::size_t>(p)];
        std::copy(part.column.begin(), part.column.end(), result.column.data() + to);
        std::copy(part.value.begin(), part.value.end(), result.value.data() + to);
        for (std::int64_t i = p * piece; i < std::min(rows, (p + 1) * piece); ++i) result.start[i] += to;
        part = {};
      },
      1);
  return result;
}

}  // namespace alcap::detail
