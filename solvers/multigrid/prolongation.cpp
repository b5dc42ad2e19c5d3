// SPDX-License-Identifier: MIT
//
// prolongation.cpp: the smoothed prolongation P = (I - omega D^-1 A_F) P_0 and its adjoint.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>

#include "solvers/multigrid/hierarchy.h"
#include "solvers/multigrid/row.h"

namespace alcap::detail {
namespace {

/// Row i of P. A_F is A without its weak entries, which are taken from the diagonal so that near-null vectors stay.
void prolongation_row(const Level& level, const Aggregates& aggregates, std::int64_t i, RowSum& row) {
  // Damping of the smoothing step. 2/3 of the usual range; 0.9 fails on irregular meshes.
  constexpr float omega = 0.75F;
  // Weak entries never take more than this part of the diagonal.
  constexpr float least = 0.25F;
  const Rows& A = level.off;
  const Buffer<ComplexF>& g = level.guided();
  const Buffer<float>& near = level.guided_near();
  row.clear();
  const auto add = [&](std::int64_t j, ComplexF weight) {
    const ComplexF t = aggregates.transport[j];
    const double length = near[j];
    row.add(aggregates.aggregate[j], length * double{weight.real() * t.real() - weight.imag() * t.imag()},
            length * double{weight.real() * t.imag() + weight.imag() * t.real()});
  };
  float weak = 0;
  for (std::int64_t e = A.start[i]; e < A.start[i + 1]; ++e) {
    const Index j = A.column[e];
    if (!strong(g[e])) {
      weak += std::sqrt(std::norm(g[e])) * near[j];
    } else if (aggregates.aggregate[j] != none) {
      add(j, g[e]);
    }
  }
  row.scale(-omega / std::max(1 - weak / near[i], least));
  if (aggregates.aggregate[i] != none) add(i, 1 - omega);
  if (level.guide.size() > 0) row.scale(double{level.near[i]} / double{near[i]});
}

/// Adjoint: fine rows in ascending order in every coarse row.
Rows adjoint(const Rows& P, Index columns) {
  Rows R;
  R.start = Buffer<std::int64_t>(std::int64_t{columns} + 1);
  std::int64_t* const start = R.start.data();
  parallel_for(std::int64_t{columns} + 1, [=](std::int64_t c) { start[c] = 0; });
  parallel_for(P.nonzeros(), [&](std::int64_t e) {
    std::atomic_ref<std::int64_t>(start[P.column[e]]).fetch_add(1, std::memory_order_relaxed);
  });
  parallel_exclusive_scan(start, std::int64_t{columns} + 1);
  R.column = Buffer<Index>(P.nonzeros());
  R.value = Buffer<ComplexF>(P.nonzeros());
  // Entries land in any order and are sorted below. Filling moves each start to the next row's.
  parallel_for(P.rows(), [&](std::int64_t i) {
    for (std::int64_t e = P.start[i]; e < P.start[i + 1]; ++e) {
      const std::int64_t to = std::atomic_ref<std::int64_t>(start[P.column[e]]).fetch_add(1, std::memory_order_relaxed);
      R.column[to] = static_cast<Index>(i);
    }
  });
  std::copy_backward(start, start + columns, start + columns + 1);
  start[0] = 0;
  parallel_for(
      columns,
      [&](std::int64_t c) {
        std::sort(R.column.data() + start[c], R.column.data() + start[c + 1]);
        for (std::int64_t e = start[c]; e < start[c + 1]; ++e) {
          const Index i = R.column[e];
          std::int64_t p = P.start[i];
          while (P.column[p] != c) ++p;
          R.value[e] = std::conj(P.value[p]);
        }
      },
      256);
  return R;
}

}  // namespace

void smooth_prolongation(Level& level, const Aggregates& aggregates) {
  level.prolongation =
      collect_rows(level.rows(), [&](std::int64_t i, RowSum& row) { prolongation_row(level, aggregates, i, row); });
  level.restriction = adjoint(level.prolongation, aggregates.count);
}

}  // namespace alcap::detail
