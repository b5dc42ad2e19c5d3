// SPDX-License-Identifier: MIT
//
// galerkin.cpp: the coarse operator P^H A P in two products, A P and then P^H (A P), each summed in double. A P is
// small where P is near-null, so it keeps its digits in single precision.
#include <cmath>

#include "solvers/multigrid/hierarchy.h"
#include "solvers/multigrid/row.h"

namespace alcap::detail {
namespace {

/// row += weight times row i of B.
void add_row(const Rows& B, std::int64_t i, double re, double im, RowSum& row) {
  for (std::int64_t e = B.start[i]; e < B.start[i + 1]; ++e) {
    const double br = B.value[e].real(), bi = B.value[e].imag();
    row.add(B.column[e], re * br - im * bi, re * bi + im * br);
  }
}

}  // namespace

Level galerkin(Level& fine) {
  const Rows AP = collect_rows(fine.rows(), [&](std::int64_t i, RowSum& row) {
    row.clear();
    add_row(fine.prolongation, i, 1, 0, row);
    for (std::int64_t e = fine.off.start[i]; e < fine.off.start[i + 1]; ++e)
      add_row(fine.prolongation, fine.off.column[e], double{fine.off.value[e].real()}, double{fine.off.value[e].imag()},
              row);
  });
  const Index n = fine.restriction.rows();
  Level coarse;
  coarse.near = Buffer<float>(n);
  coarse.off = collect_rows(n, [&](std::int64_t c, RowSum& row) {
    row.clear();
    for (std::int64_t e = fine.restriction.start[c]; e < fine.restriction.start[c + 1]; ++e)
      add_row(AP, fine.restriction.column[e], double{fine.restriction.value[e].real()},
              double{fine.restriction.value[e].imag()}, row);
    coarse.near[c] = static_cast<float>(std::sqrt(std::max(0.0, row.take(static_cast<Index>(c)))));
  });
  const float* const near = coarse.near.data();
  const bool positive = parallel_reduce(
      std::int64_t{n}, true,
      [=](std::int64_t begin, std::int64_t end) {
        return std::all_of(near + begin, near + end, [](float d) { return d > 0 && std::isfinite(d); });
      },
      [](bool a, bool b) { return a && b; });
  if (!positive) return {};
  const auto scale = [near](Rows& A, auto&& row_scale) {
    parallel_for(A.rows(), [&](std::int64_t i) {
      const float own = row_scale(i);
      for (std::int64_t e = A.start[i]; e < A.start[i + 1]; ++e) A.value[e] *= own / near[A.column[e]];
    });
  };
  scale(coarse.off, [near](std::int64_t c) { return 1 / near[c]; });
  scale(fine.prolongation, [](std::int64_t) { return 1.0F; });
  parallel_for(n, [&](std::int64_t c) {
    for (std::int64_t e = fine.restriction.start[c]; e < fine.restriction.start[c + 1]; ++e)
      fine.restriction.value[e] *= 1 / near[c];
  });
  return coarse;
}

}  // namespace alcap::detail
