// SPDX-License-Identifier: MIT
//
// mg_galerkin.cpp: the coarse operator P^H A P, row by row through a small hash table, summed in double.
#include <algorithm>

#include "solvers/mg_hierarchy.h"

namespace alcap::detail {
namespace {

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

/// Sums of complex values by column; forgets in time proportional to what it holds.
class Accumulator {
 public:
  void add(Index column, double re, double im, double ar, double ai) {
    std::size_t slot = hash(column);
    while (keys_[slot] != column) {
      if (keys_[slot] == none) {
        if (2 * (used_.size() + 1) > keys_.size()) {
          grow();
          add(column, re, im, ar, ai);
          return;
        }
        keys_[slot] = column;
        sums_[slot] = 0;
        used_.push_back(column);
        break;
      }
      slot = (slot + 1) & (keys_.size() - 1);
    }
    sums_[slot] += std::complex<double>(re * ar - im * ai, re * ai + im * ar);
  }
  /// Columns in the order of their first appearance.
  [[nodiscard]] const std::vector<Index>& columns() const { return used_; }
  [[nodiscard]] std::complex<double> sum(Index column) const {
    std::size_t slot = hash(column);
    while (keys_[slot] != column) slot = (slot + 1) & (keys_.size() - 1);
    return sums_[slot];
  }
  void clear() {
    if (8 * used_.size() > keys_.size()) {
      std::fill(keys_.begin(), keys_.end(), none);
    } else {
      // Removal in any order is safe because everything goes.
      for (const Index column : used_) erase(column);
    }
    used_.clear();
  }

 private:
  [[nodiscard]] std::size_t hash(Index column) const {
    return (static_cast<std::uint32_t>(column) * 2654435769U) >> shift_;
  }
  void erase(Index column) {
    // Probe past emptied slots: the run it sits in is at most as long as what was used.
    std::size_t slot = hash(column);
    while (keys_[slot] != column) slot = (slot + 1) & (keys_.size() - 1);
    keys_[slot] = none;
  }
  void grow() {
    std::vector<std::complex<double>> sums;
    for (const Index column : used_) sums.push_back(sum(column));
    keys_.assign(2 * keys_.size(), none);
    sums_.assign(keys_.size(), 0);
    --shift_;
    for (std::size_t u = 0; u < used_.size(); ++u) {
      std::size_t slot = hash(used_[u]);
      while (keys_[slot] != none) slot = (slot + 1) & (keys_.size() - 1);
      keys_[slot] = used_[u];
      sums_[slot] = sums[u];
    }
  }

  std::vector<Index> keys_ = std::vector<Index>(256, none);
  std::vector<std::complex<double>> sums_ = std::vector<std::complex<double>>(256);
  std::vector<Index> used_;
  int shift_ = 32 - 8;
};

void coarse_row(const Level& fine, std::int64_t c, Accumulator& row) {
  const Rows& R = fine.restriction;
  const Rows& P = fine.prolongation;
  const Rows& A = fine.off;
  const auto scatter = [&](std::int64_t j, double re, double im) {
    for (std::int64_t p = P.start[at(j)]; p < P.start[at(j) + 1]; ++p) {
      const ComplexF value = P.value[at(p)];
      row.add(P.column[at(p)], re, im, value.real(), value.imag());
    }
  };
  for (std::int64_t r = R.start[at(c)]; r < R.start[at(c) + 1]; ++r) {
    const Index i = R.column[at(r)];
    const double re = R.value[at(r)].real();
    const double im = R.value[at(r)].imag();
    const double d = fine.diagonal[at(i)];
    scatter(i, re * d, im * d);
    for (std::int64_t e = A.start[at(i)]; e < A.start[at(i) + 1]; ++e) {
      const double ar = A.value[at(e)].real();
      const double ai = A.value[at(e)].imag();
      scatter(A.column[at(e)], re * ar - im * ai, re * ai + im * ar);
    }
  }
}

}  // namespace

Level galerkin(const Level& fine) {
  const Index n = fine.restriction.rows();
  Level coarse;
  coarse.diagonal.resize(at(n));
  // Each chunk of rows fills its own piece; the pieces are then laid end to end.
  constexpr std::int64_t chunk = 512;
  const std::int64_t chunks = (n + chunk - 1) / chunk;
  std::vector<Rows> pieces(at(chunks));
  parallel_for(
      chunks,
      [&](std::int64_t piece) {
        Rows& rows = pieces[at(piece)];
        Accumulator row;
        for (std::int64_t c = piece * chunk; c < std::min<std::int64_t>(n, (piece + 1) * chunk); ++c) {
          coarse_row(fine, c, row);
          for (const Index column : row.columns()) {
            const std::complex<double> sum = row.sum(column);
            if (column == c) {
              coarse.diagonal[at(c)] = static_cast<float>(sum.real());
            } else {
              rows.column.push_back(column);
              rows.value.emplace_back(static_cast<float>(sum.real()), static_cast<float>(sum.imag()));
            }
          }
          rows.start.push_back(static_cast<std::int64_t>(rows.column.size()));
          row.clear();
        }
      },
      1);
  std::vector<std::int64_t> base(at(chunks) + 1, 0);
  for (std::int64_t p = 0; p < chunks; ++p) base[at(p) + 1] = base[at(p)] + pieces[at(p)].start.back();
  coarse.off.start.assign(at(n) + 1, 0);
  coarse.off.column.resize(at(base.back()));
  coarse.off.value.resize(at(base.back()));
  parallel_for(
      chunks,
      [&](std::int64_t p) {
        const Rows& rows = pieces[at(p)];
        std::copy(rows.column.begin(), rows.column.end(), coarse.off.column.begin() + base[at(p)]);
        std::copy(rows.value.begin(), rows.value.end(), coarse.off.value.begin() + base[at(p)]);
        for (std::size_t c = 1; c < rows.start.size(); ++c) {
          coarse.off.start[at(p * chunk) + c] = base[at(p)] + rows.start[c];
        }
      },
      1);
  return coarse;
}

}  // namespace alcap::detail
