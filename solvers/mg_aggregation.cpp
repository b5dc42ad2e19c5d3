// SPDX-License-Identifier: MIT
//
// mg_aggregation.cpp: greedy aggregation and the smoothed prolongation.
#include <algorithm>
#include <cmath>

#include "solvers/mg_hierarchy.h"

namespace alcap::detail {
namespace {

ComplexF unit(ComplexF z) { return z / std::abs(z); }

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

}  // namespace

Aggregates aggregate(const Level& level) {
  const Rows& A = level.off;
  const Index n = level.rows();
  Aggregates result{.aggregate = std::vector<Index>(at(n), none), .transport = std::vector<ComplexF>(at(n), 1.0F)};
  std::vector<Index> size;
  // A vertex whose strong neighbours are all free takes them all.
  for (Index i = 0; i < n; ++i) {
    if (result.aggregate[at(i)] != none) continue;
    bool any = false;
    bool all_free = true;
    for (std::int64_t e = A.start[at(i)]; e < A.start[at(i) + 1] && all_free; ++e) {
      if (!strong(level, i, e)) continue;
      any = true;
      all_free = result.aggregate[at(A.column[at(e)])] == none;
    }
    if (!any || !all_free) continue;
    size.push_back(1);
    result.aggregate[at(i)] = result.count;
    for (std::int64_t e = A.start[at(i)]; e < A.start[at(i) + 1]; ++e) {
      if (!strong(level, i, e)) continue;
      const Index j = A.column[at(e)];
      result.aggregate[at(j)] = result.count;
      result.transport[at(j)] = unit(-std::conj(A.value[at(e)]));  // from i to j
      ++size.back();
    }
    ++result.count;
  }
  // What is left over has a strong neighbour in an aggregate: it joins the one it is most coupled to, smaller ones
  // first.
  const std::vector<Index> first = result.aggregate;
  std::vector<std::pair<Index, ComplexF>> pull;
  for (Index i = 0; i < n; ++i) {
    if (first[at(i)] != none) continue;
    pull.clear();
    for (std::int64_t e = A.start[at(i)]; e < A.start[at(i) + 1]; ++e) {
      const Index j = A.column[at(e)];
      const Index a = first[at(j)];
      if (a == none || !strong(level, i, e)) continue;
      const ComplexF seen = -A.value[at(e)] * result.transport[at(j)];
      const auto known = std::find_if(pull.begin(), pull.end(), [a](const auto& p) { return p.first == a; });
      if (known == pull.end()) {
        pull.emplace_back(a, seen);
      } else {
        known->second += seen;
      }
    }
    float best = 0;
    for (const auto& [a, seen] : pull) {
      const float score = std::abs(seen) / (1 + 0.1F * static_cast<float>(size[at(a)]));
      if (!(score > best)) continue;
      best = score;
      result.aggregate[at(i)] = a;
      result.transport[at(i)] = unit(seen);
    }
    if (result.aggregate[at(i)] != none) ++size[at(result.aggregate[at(i)])];
  }
  return result;
}

namespace {

/// One row of (I - omega D^-1 A_F) P_0: weak entries of A are dropped and taken from the diagonal. Returns its length.
class ProlongationRow {
 public:
  ProlongationRow(const Level& level, const Aggregates& aggregates) : level_(level), aggregates_(aggregates) {}

  void compute(std::int64_t i) {
    // Damping of the smoothing step. 2/3 of the usual range; 0.9 fails on irregular meshes.
    constexpr float omega = 0.75F;
    // Weak entries never take more than this part of the diagonal.
    constexpr float least = 0.25F;
    entries.clear();
    const Rows& A = level_.off;
    float filtered = level_.diagonal[at(i)];
    for (std::int64_t e = A.start[at(i)]; e < A.start[at(i) + 1]; ++e) {
      if (!strong(level_, i, e)) filtered -= std::abs(A.value[at(e)]);
    }
    filtered = std::max(filtered, least * level_.diagonal[at(i)]);
    if (aggregates_.aggregate[at(i)] != none) add(i, 1 - omega);
    for (std::int64_t e = A.start[at(i)]; e < A.start[at(i) + 1]; ++e) {
      const Index j = A.column[at(e)];
      if (aggregates_.aggregate[at(j)] != none && strong(level_, i, e)) add(j, -omega / filtered * A.value[at(e)]);
    }
  }

  std::vector<std::pair<Index, ComplexF>> entries;

 private:
  void add(std::int64_t j, ComplexF weight) {
    const Index a = aggregates_.aggregate[at(j)];
    const ComplexF value = weight * aggregates_.transport[at(j)];
    for (auto& [column, sum] : entries) {
      if (column != a) continue;
      sum += value;
      return;
    }
    entries.emplace_back(a, value);
  }

  const Level& level_;
  const Aggregates& aggregates_;
};

/// Adjoint, rows of P becoming columns in order.
Rows adjoint(const Rows& P, Index columns) {
  Rows R;
  R.start.assign(at(columns) + 1, 0);
  for (const Index c : P.column) ++R.start[at(c) + 1];
  for (Index c = 0; c < columns; ++c) R.start[at(c) + 1] += R.start[at(c)];
  R.column.resize(P.column.size());
  R.value.resize(P.value.size());
  std::vector<std::int64_t> next(R.start.begin(), R.start.end() - 1);
  for (Index i = 0; i < P.rows(); ++i) {
    for (std::int64_t e = P.start[at(i)]; e < P.start[at(i) + 1]; ++e) {
      const std::int64_t to = next[at(P.column[at(e)])]++;
      R.column[at(to)] = i;
      R.value[at(to)] = std::conj(P.value[at(e)]);
    }
  }
  return R;
}

}  // namespace

void smooth_prolongation(Level& level, const Aggregates& aggregates) {
  const Index n = level.rows();
  Rows& P = level.prolongation;
  P.start.assign(at(n) + 1, 0);
  parallel_ranges(n, mg_grain, [&](std::int64_t begin, std::int64_t end) {
    ProlongationRow row(level, aggregates);
    for (std::int64_t i = begin; i < end; ++i) {
      row.compute(i);
      P.start[at(i)] = static_cast<std::int64_t>(row.entries.size());
    }
  });
  P.start[at(n)] = 0;
  const std::int64_t total = parallel_exclusive_scan(P.start.data(), n);
  P.start[at(n)] = total;
  P.column.resize(at(total));
  P.value.resize(at(total));
  parallel_ranges(n, mg_grain, [&](std::int64_t begin, std::int64_t end) {
    ProlongationRow row(level, aggregates);
    for (std::int64_t i = begin; i < end; ++i) {
      row.compute(i);
      std::int64_t to = P.start[at(i)];
      for (const auto& [column, value] : row.entries) {
        P.column[at(to)] = column;
        P.value[at(to++)] = value;
      }
    }
  });
  level.restriction = adjoint(P, aggregates.count);
}

}  // namespace alcap::detail
