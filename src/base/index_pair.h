// SPDX-License-Identifier: MIT
//
// index_pair.h: two indices as the key of a hash table, such as the ends of a directed edge.
//
//   std::unordered_map<IndexPair, Index, IndexPairHash> halfedge;
#pragma once

#include <cstddef>
#include <cstdint>

#include "alcap/index.h"

namespace alcap::detail {

struct IndexPair {
  Index first, second;
  bool operator==(const IndexPair&) const = default;
};

/// Different for all pairs of numbers below 2^32, which meshes that fit into memory have.
struct IndexPairHash {
  [[nodiscard]] std::size_t operator()(const IndexPair& p) const {
    const auto first = static_cast<std::uint64_t>(p.first), second = static_cast<std::uint64_t>(p.second);
    return static_cast<std::size_t>((first << 32U | first >> 32U) ^ second);
  }
};

}  // namespace alcap::detail
