// SPDX-License-Identifier: MIT
//
// numbers.h: numbers as text, everywhere the shortest that reads back as the same number, numbers of things, and
// floating numbers that become integers.
//
//   number_text(-1e-9);                        // "-1e-09"
//   counted(1, "face has", "faces have");      // "1 face has"
#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>

#include "alcap/errors.h"  // number_text(), which the errors use themselves
#include "src/base/shortest.h"

namespace alcap::detail {

/// Writes the text of a finite number, at most `longest_number` characters; returns its end.
template <class Number>
char* put_text(char* to, Number value) {
  if constexpr (std::is_same_v<Number, double>) return put_shortest(to, value);
  return std::to_chars(to, to + longest_number, value).ptr;
}

template <class Number>
void append_text(std::string& text, Number value) {
  std::array<char, longest_number> digits;
  text.append(digits.data(), put_text(digits.data(), value));
}

/// The number without its fraction, as an integer in [low, high]: below it (and NaN) low, above it high. A cast of a
/// number outside of the range of the integer has no defined result; floating numbers become counts only through here
/// and rounded().
template <class Integer>
[[nodiscard]] constexpr Integer to_integer(double value, Integer low, Integer high) {
  if (!(value > static_cast<double>(low))) return low;
  if (!(value < static_cast<double>(high))) return high;
  return static_cast<Integer>(value);
}

/// The nearest integer (a tie: the even one), or nothing when that is outside of the type, or for NaN.
template <class Integer>
[[nodiscard]] std::optional<Integer> rounded(double value) {
  const double nearest = std::nearbyint(value);
  // Exact in double, unlike the largest value. NOLINTNEXTLINE(bugprone-integer-division)
  constexpr double beyond = 2.0 * static_cast<double>(std::numeric_limits<Integer>::max() / 2 + 1);
  if (!(nearest >= static_cast<double>(std::numeric_limits<Integer>::min()) && nearest < beyond)) return std::nullopt;
  return static_cast<Integer>(nearest);
}

/// At most six significant digits, for numbers that were computed and stand in a sentence.
[[nodiscard]] std::string rounded_text(double value);

/// "1 face", "2 faces".
[[nodiscard]] std::string counted(std::int64_t count, const char* one, const char* many);

}  // namespace alcap::detail
