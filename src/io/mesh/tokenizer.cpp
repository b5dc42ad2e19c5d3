// SPDX-License-Identifier: MIT
//
// tokenizer.cpp: why a token is no number.
#include "src/io/mesh/tokenizer.h"

#include <algorithm>

namespace alcap::detail {

bool Tokenizer::is_not_finite(std::string_view word) {
  word.remove_prefix(std::min(word.size(), word.find_first_not_of("+-")));
  for (const std::string_view name : {"nan", "inf", "infinity", "nan(ind)", "1.#qnan", "1.#snan", "1.#ind", "1.#inf"})
    if (equal_ignoring_case(word, name)) return true;
  return false;
}

void Tokenizer::fail_number(const std::string& what) {
  const bool line_ends = at_line_end();
  const char* const at = p_;
  const std::string_view token = word();
  p_ = at;
  if (line_ends) fail(p_ == end_ ? "the file ends before " + what + "; it was cut" : "the line ends before " + what);

  std::string lower(token);
  std::ranges::transform(lower, lower.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? char(c + 32) : c; });
  const auto body = lower.substr(std::min(lower.size(), lower.find_first_not_of("+-")));
  double value = 0;
  const auto [stop, error] = fast_float::from_chars(lower.data(), lower.data() + lower.size(), value);
  const bool whole = stop == lower.data() + lower.size();

  std::string why = " is not a number";
  if (body.starts_with("nan") || body.starts_with("inf") || body.starts_with("1.#")) {
    why = " is not finite; remove or repair what uses it";
  } else if (whole && !std::isfinite(value)) {
    why = " is too large for a double";
  } else if (whole) {
    why = " is not a whole number that fits";
  } else if (token.find(',') != std::string_view::npos) {
    why += "; write a decimal point, no comma";
  }
  fail(quoted(token) + why + " (" + what + ")");
}

}  // namespace alcap::detail
