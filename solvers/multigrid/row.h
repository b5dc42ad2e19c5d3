// SPDX-License-Identifier: MIT
//
// row.h: sparse rows that are summed one by one and then laid end to end. Internal to solvers/.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "solvers/multigrid/level.h"

namespace alcap::detail {

/// Sums of complex values by column, in the order of first appearance. A small table remembers where a column was seen
/// last; what it has forgotten is searched for among the about ten columns of a row.
class RowSum {
 public:
  RowSum() : columns_(64), sums_(64) {}

  void clear() { count_ = 0; }

  void add(Index column, double re, double im) {
    std::uint32_t& seen = table_[static_cast<std::uint32_t>(column) % table_size];
    if (seen >= count_ || columns_[seen] != column) {
      seen = 0;
      while (seen < count_ && columns_[seen] != column) ++seen;
      if (seen == count_) {
        append(column, re, im);
        return;
      }
    }
    Sum& sum = sums_[seen];
    sum.re += re;
    sum.im += im;
  }

  /// Multiplies all sums.
  void scale(double factor) {
    for (std::uint32_t k = 0; k < count_; ++k) sums_[k] = {factor * sums_[k].re, factor * sums_[k].im};
  }

  /// Removes a column and returns the real part of its sum, zero when there is none.
  double take(Index column) {
    const auto end = columns_.begin() + count_;
    const auto found = std::find(columns_.begin(), end, column);
    if (found == end) return 0;
    const auto at = sums_.begin() + (found - columns_.begin());
    const double re = at->re;
    std::copy(found + 1, end, found);
    std::copy(at + 1, sums_.begin() + count_, at);
    --count_;
    return re;
  }

  [[nodiscard]] std::uint32_t size() const { return count_; }
  [[nodiscard]] const Index* columns() const { return columns_.data(); }
  [[nodiscard]] ComplexF sum(std::uint32_t k) const {
    return {static_cast<float>(sums_[k].re), static_cast<float>(sums_[k].im)};
  }

 private:
  struct Sum {
    double re, im;
  };

  void append(Index column, double re, double im) {
    if (count_ == columns_.size()) {
      columns_.resize(2 * std::size_t{count_});
      sums_.resize(2 * std::size_t{count_});
    }
    columns_[count_] = column;
    sums_[count_++] = {re, im};
  }

  static constexpr std::uint32_t table_size = 64;
  std::array<std::uint32_t, table_size> table_ = {};
  std::vector<Index> columns_;
  std::vector<Sum> sums_;
  std::uint32_t count_ = 0;
};

/// The matrix of the rows that compute(i, row) fills. Each piece of rows fills its own memory; the pieces are then laid
/// end to end.
template <class Compute>
Rows collect_rows(std::int64_t rows, Compute&& compute) {
  constexpr std::int64_t piece = 512;
  constexpr std::size_t usual = 12;  // entries a row
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
        column.reserve(usual * piece);
        value.reserve(usual * piece);
        for (std::int64_t i = p * piece; i < std::min(rows, (p + 1) * piece); ++i) {
          result.start[i] = static_cast<std::int64_t>(column.size());
          compute(i, row);
          column.insert(column.end(), row.columns(), row.columns() + row.size());
          for (std::uint32_t k = 0; k < row.size(); ++k) value.push_back(row.sum(k));
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
