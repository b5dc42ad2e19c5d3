// SPDX-License-Identifier: MIT
//
// mesh_weld.cpp: vertices at exactly the same position, found with one hash table.
#include <bit>

#include "alcap/mesh_check.h"

namespace alcap {
namespace {

std::uint64_t hash(const double* p) {
  std::uint64_t h = 0;
  for (int d = 0; d < 3; ++d) {
    const double x = static_cast<double>(p[d]) + 0.0;  // -0 and 0 are the same place
    h = (h ^ std::bit_cast<std::uint64_t>(x)) * 0xbf58476d1ce4e5b9ULL;
    h ^= h >> 29;
  }
  h *= 0x94d049bb133111ebULL;
  return h ^ (h >> 32);
}

/// Per vertex the first vertex at the same position. Positions with NaN equal no other.
std::vector<Index> first_at_position(const Positions<double>& V) {
  const auto n = static_cast<std::size_t>(V.rows());
  std::vector<Index> first(n);
  std::vector<Index> table(std::bit_ceil(2 * n + 1), none);
  const std::size_t mask = table.size() - 1;
  for (std::size_t v = 0; v < n; ++v) {
    const double* const p = V.data() + 3 * v;
    first[v] = static_cast<Index>(v);
    if (p[0] != p[0] || p[1] != p[1] || p[2] != p[2]) continue;
    for (std::size_t slot = hash(p) & mask;; slot = (slot + 1) & mask) {
      if (table[slot] == none) {
        table[slot] = static_cast<Index>(v);
        break;
      }
      const double* const q = V.data() + 3 * static_cast<std::size_t>(table[slot]);
      if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2]) {
        first[v] = table[slot];
        break;
      }
    }
  }
  return first;
}

}  // namespace

Faces repair_weld(const Positions<double>& V, const Eigen::Ref<const Faces>& F) {
  const std::vector<Index> first = first_at_position(V);
  Faces out = F;
  for (Eigen::Index t = 0; t < out.rows(); ++t) {
    for (int c = 0; c < 3; ++c) {
      Index& v = out(t, c);
      if (v >= 0 && v < V.rows()) v = first[static_cast<std::size_t>(v)];
    }
  }
  return out;
}

std::int64_t duplicate_positions(const Positions<double>& V) {
  const std::vector<Index> first = first_at_position(V);
  std::int64_t count = 0;
  for (std::size_t v = 0; v < first.size(); ++v) count += first[v] != static_cast<Index>(v);
  return count;
}

}  // namespace alcap
