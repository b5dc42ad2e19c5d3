// SPDX-License-Identifier: MIT
//
// ply_header.h: the header of a PLY file: encoding, elements and their properties in file order.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "src/io/mesh/source.h"

namespace alcap::detail {

enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

[[nodiscard]] constexpr std::size_t size_of(PlyType type) {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

struct PlyProperty {
  std::string_view name;
  PlyType type = PlyType::int32;  // of the value, or of the items of the list
  bool is_list = false;
  PlyType count_type = PlyType::uint8;  // of the number of items
};

struct PlyElement {
  std::string_view name;
  std::int64_t count = 0;
  std::vector<PlyProperty> properties;

  /// Position of the first property that has one of two names; -1 when there is none.
  [[nodiscard]] int find(std::string_view name_a, std::string_view name_b) const;
};

enum class PlyEncoding { ascii, little_endian, big_endian };

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements;
  const char* body = nullptr;  // the first byte behind the line "end_header"
  std::vector<std::string> remarks = {};
};

/// Throws FileError naming the line. The names point into the source.
[[nodiscard]] PlyHeader read_ply_header(const Source& source);

}  // namespace alcap::detail
