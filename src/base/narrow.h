// SPDX-License-Identifier: MIT
//
// narrow.h: what file formats with 32-bit numbers cannot say.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>

#include "alcap/errors.h"

namespace alcap::detail {

/// The largest number of such formats.
inline constexpr std::int64_t most_32 = std::numeric_limits<std::int32_t>::max();

/// Throws FileError when there are more `what` ("vertices") than a format with 32-bit numbers can have in `file`.
inline void check_32_bits(const std::filesystem::path& file, std::int64_t count, const char* what) {
  if (count <= most_32) return;
  throw FileError(file.string() + ": " + std::to_string(count) + " " + what + " are more than the " +
                      std::to_string(most_32) + " that this format can number",
                  file.string());
}

}  // namespace alcap::detail
