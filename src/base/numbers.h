// SPDX-License-Identifier: MIT
//
// numbers.h: numbers as text, everywhere the shortest that reads back as the same number, and numbers of things.
//
//   number_text(-1e-9);                        // "-1e-09"
//   counted(1, "face has", "faces have");      // "1 face has"
#pragma once

#include <array>
#include <charconv>
#include <cstdint>
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

/// At most six significant digits, for numbers that were computed and stand in a sentence.
[[nodiscard]] std::string rounded_text(double value);

/// "1 face", "2 faces".
[[nodiscard]] std::string counted(std::int64_t count, const char* one, const char* many);

}  // namespace alcap::detail
