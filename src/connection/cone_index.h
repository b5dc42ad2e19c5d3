// SPDX-License-Identifier: MIT
//
// cone_index.h: indices of cones and loops, multiples of 1/n turn. Internal to src/connection.
#pragma once

#include <cmath>
#include <string>

#include "alcap/errors.h"

namespace alcap::detail {

/// The multiple of 1/n nearest to `turns`.
[[nodiscard]] inline double nearest_multiple(double turns, int n) { return std::nearbyint(turns * n) / n; }

/// How far an index, or a sum of them, may be from a multiple of 1/n, in units of 1/n: typed with six digits, 0.333333
/// is a third.
inline constexpr double multiple_tolerance = 1e-6;

/// Indices and holonomies beyond have no digits left to tell one branch from the next.
inline constexpr double most_turns = 1e6;

/// Throws OptionError unless `turns` is finite and within most_turns.
inline void check_turns(const char* field, double turns) {
  if (!(std::abs(turns) <= most_turns)) throw OptionError(field, turns, "must be in [-1e6, 1e6] turns");
}

/// Throws OptionError unless `turns` is a multiple of 1/n.
inline void check_multiple(const char* field, double turns, int n) {
  check_turns(field, turns);
  if (!(std::abs(turns * n - std::nearbyint(turns * n)) <= multiple_tolerance))
    throw OptionError(field, turns, "must be a multiple of 1/" + std::to_string(n));
}

}  // namespace alcap::detail
