// SPDX-License-Identifier: MIT
//
// real_places.h: where the real view of a matrix has its entries. Internal to src/energy/.
#pragma once

namespace alcap::detail {

/// Of a column whose entries begin at `begin` and are `size`: the places of columns and entries in the view, in which
/// each entry a is the block [re -im; im re]. Columns 2 j and 2 j + 1 of the view lie behind each other.
template <class Int>
struct RealPlaces {
  Int begin, size;
  [[nodiscard]] constexpr Int first_column() const { return 4 * begin; }
  [[nodiscard]] constexpr Int second_column() const { return 4 * begin + 2 * size; }
  /// Of the upper number of entry begin + k in the first column, and in the second; the lower one is behind it.
  [[nodiscard]] constexpr Int first(Int k) const { return first_column() + 2 * k; }
  [[nodiscard]] constexpr Int second(Int k) const { return second_column() + 2 * k; }
};

}  // namespace alcap::detail
