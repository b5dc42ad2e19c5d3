// SPDX-License-Identifier: MIT
#include "src/mesh/near_vertices.h"

#include <array>
#include <cmath>
#include <unordered_map>

#include "src/base/cancel.h"
#include "src/base/numbers.h"

namespace alcap::detail {
namespace {

using Cell = std::array<std::int64_t, 3>;

struct CellHash {
  std::size_t operator()(const Cell& cell) const {
    std::uint64_t h = 0;
    for (const std::int64_t x : cell) {
      h = (h ^ static_cast<std::uint64_t>(x)) * 0xbf58476d1ce4e5b9ULL;
      h ^= h >> 29;
    }
    return static_cast<std::size_t>(h);
  }
};

// A grid finer than this would have numbers that 64 bits, and the coordinates, cannot tell apart.
constexpr double finest = 1e-15;

}  // namespace

double box_diagonal(const Positions<double>& V) {
  Eigen::RowVector3d low, high;
  bool any = false;
  for (Eigen::Index v = 0; v < V.rows(); ++v) {
    if (!V.row(v).allFinite()) continue;
    low = any ? low.cwiseMin(V.row(v)).eval() : V.row(v).eval();
    high = any ? high.cwiseMax(V.row(v)).eval() : V.row(v).eval();
    any = true;
  }
  return any ? (high - low).stableNorm() : 0;
}

std::vector<Index> first_near(const Positions<double>& V, double distance) {
  std::vector<Index> first(static_cast<std::size_t>(V.rows()));
  const double cell = std::max(distance, finest * box_diagonal(V));
  Eigen::RowVector3d corner = Eigen::RowVector3d::Zero();
  for (Eigen::Index v = 0, any = 0; v < V.rows(); ++v) {
    if (!V.row(v).allFinite()) continue;
    corner = any++ == 0 ? V.row(v).eval() : corner.cwiseMin(V.row(v)).eval();
  }
  std::unordered_map<Cell, std::vector<Index>, CellHash> grid;
  for (Eigen::Index v = 0; v < V.rows(); ++v) {
    check_cancelled_at(v);
    Index& here = first[static_cast<std::size_t>(v)];
    here = static_cast<Index>(v);
    if (!V.row(v).allFinite() || !(cell > 0)) continue;
    constexpr std::int64_t most = std::int64_t{1} << 52;  // places beyond share a cell
    Cell at{};
    for (int d = 0; d < 3; ++d)
      at[static_cast<std::size_t>(d)] = to_integer(std::floor((V(v, d) - corner[d]) / cell), -most, most);
    for (int k = 0; k < 27; ++k) {
      const auto found = grid.find({at[0] + k % 3 - 1, at[1] + k / 3 % 3 - 1, at[2] + k / 9 - 1});
      if (found == grid.end()) continue;
      for (const Index w : found->second)
        if (w < here && (V.row(v) - V.row(w)).stableNorm() <= distance) here = w;
    }
    if (here == static_cast<Index>(v)) grid[at].push_back(here);
  }
  return first;
}

}  // namespace alcap::detail
