// SPDX-License-Identifier: MIT
//
// mesh_weld.cpp: vertices at exactly the same position, found with one hash table.
#include <bit>

#include "alcap/mesh_check.h"
#include "src/base/array.h"
#include "src/base/cancel.h"

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
detail::Array<Index> first_at_position(const Positions<double>& V) {
  const Eigen::Index n = V.rows();
  detail::Array<Index> first(n);
  detail::Array<Index> table(static_cast<std::int64_t>(std::bit_ceil(2 * detail::at(n) + 1)), none);
  const auto mask = static_cast<std::uint64_t>(table.size() - 1);
  for (Eigen::Index v = 0; v < n; ++v) {
    detail::check_cancelled_at(v);
    const double* const p = V.data() + 3 * v;
    first[v] = static_cast<Index>(v);
    if (p[0] != p[0] || p[1] != p[1] || p[2] != p[2]) continue;
    for (std::uint64_t slot = hash(p) & mask;; slot = (slot + 1) & mask) {
      Index& here = table[static_cast<std::int64_t>(slot)];
      if (here == none) {
        here = static_cast<Index>(v);
        break;
      }
      const double* const q = V.data() + 3 * std::int64_t{here};
      if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2]) {
        first[v] = here;
        break;
      }
    }
  }
  return first;
}

}  // namespace

Faces repair_weld(const Positions<double>& V, const Eigen::Ref<const Faces>& F) {
  const detail::Array<Index> first = first_at_position(V);
  Faces out = F;
  for (Eigen::Index t = 0; t < out.rows(); ++t) {
    for (int c = 0; c < 3; ++c) {
      Index& v = out(t, c);
      if (v >= 0 && v < V.rows()) v = first[v];
    }
  }
  return out;
}

std::int64_t duplicate_positions(const Positions<double>& V) {
  const detail::Array<Index> first = first_at_position(V);
  std::int64_t count = 0;
  for (std::int64_t v = 0; v < first.size(); ++v) count += first[v] != v;
  return count;
}

}  // namespace alcap
