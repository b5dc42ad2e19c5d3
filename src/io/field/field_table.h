// SPDX-License-Identifier: MIT
//
// field_table.h: where a .ply that write_field() wrote has its field. Internal to src/io/field and src/distributed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace alcap::detail {

/// Where the doubles of one vertex are.
struct FieldColumns {
  std::size_t stride = 0;           ///< bytes of a row
  std::array<std::size_t, 8> at{};  ///< in bytes: u_re, u_im, the axis, the normal
};

/// Of a field file.
struct FieldTable {
  int n = 1;
  std::int64_t body = 0;  ///< where the first vertex's row begins
  FieldColumns columns;
};

/// From the beginning of a file, which has all of the header. Throws FileError.
[[nodiscard]] FieldTable find_field_table(const std::string& path, std::string_view beginning);

}  // namespace alcap::detail
