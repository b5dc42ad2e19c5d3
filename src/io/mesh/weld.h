// SPDX-License-Identifier: MIT
//
// weld.h: numbers points by exact position, in order of first appearance.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "alcap/conventions.h"

namespace alcap::detail {

/// Open-addressing hash table from positions to numbers; -0 equals 0.
class Welder {
 public:
  /// Room for about `points` different points.
  explicit Welder(std::int64_t points) {
    slots_.assign(std::bit_ceil(static_cast<std::size_t>(2 * points + 16)), Slot{});
  }

  [[nodiscard]] static std::uint64_t hash(const double* x) {
    std::uint64_t h = 0;
    for (int c = 0; c < 3; ++c) {
      h = (h ^ std::bit_cast<std::uint64_t>(x[c] + 0.0)) * 0x9E3779B97F4A7C15U;  // + 0.0 turns -0 into 0
      h ^= h >> 29;
    }
    return h * 0xBF58476D1CE4E5B9U;
  }

  /// Brings the slot of a hash near, ahead of number().
  void prefetch(std::uint64_t h) const { __builtin_prefetch(&slots_[slot_of(h)]); }

  /// The number of the point; `is_new` says that it has just been given.
  std::int64_t number(const double* x, std::uint64_t h, bool& is_new) {
    for (std::size_t i = slot_of(h);; i = (i + 1) & (slots_.size() - 1)) {
      Slot& slot = slots_[i];
      is_new = slot.number == none;
      if (is_new) {
        slot = {{x[0] + 0.0, x[1] + 0.0, x[2] + 0.0}, static_cast<Index>(size_)};
        if (2 * ++size_ > static_cast<std::int64_t>(slots_.size())) grow();
        return size_ - 1;
      }
      if (slot.x[0] == x[0] && slot.x[1] == x[1] && slot.x[2] == x[2]) return slot.number;
    }
  }

 private:
  struct Slot {
    std::array<double, 3> x = {};
    Index number = none;
  };

  [[nodiscard]] std::size_t slot_of(std::uint64_t h) const { return (h >> 20) & (slots_.size() - 1); }

  void grow() {
    std::vector<Slot> old(2 * slots_.size());
    old.swap(slots_);
    for (const Slot& slot : old) {
      if (slot.number == none) continue;
      std::size_t i = slot_of(hash(slot.x.data()));
      while (slots_[i].number != none) i = (i + 1) & (slots_.size() - 1);
      slots_[i] = slot;
    }
  }

  std::vector<Slot> slots_;
  std::int64_t size_ = 0;
};

}  // namespace alcap::detail
