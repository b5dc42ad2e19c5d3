// SPDX-License-Identifier: MIT
#include "src/base/numbers.h"

#include <cmath>

namespace alcap::detail {

std::string number_text(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "infinity" : "-infinity";
  std::string text;
  append_text(text, value);
  return text;
}

std::string rounded_text(double value) {
  if (!std::isfinite(value)) return number_text(value);
  std::array<char, 32> text;
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 6);
  static_cast<void>(error);  // six digits, a sign, a point and an exponent always fit
  return {text.data(), end};
}

std::string counted(std::int64_t count, const char* one, const char* many) {
  return number_text(count) + " " + (count == 1 ? one : many);
}

}  // namespace alcap::detail
