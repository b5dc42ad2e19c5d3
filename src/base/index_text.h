// SPDX-License-Identifier: MIT
//
// index_text.h: indices as text, in turns.
#pragma once

#include <cstdint>
#include <string>

namespace alcap::detail {

/// A count of n-ths in turns: "2", "-3/4".
[[nodiscard]] inline std::string turns_text(std::int64_t count, int n) {
  return count % n == 0 ? std::to_string(count / n) : std::to_string(count) + "/" + std::to_string(n);
}

}  // namespace alcap::detail
