// SPDX-License-Identifier: MIT
//
// npy.h: the head of NumPy's .npy files, format 1.0: a dictionary, filled up so that the numbers behind it are aligned.
#pragma once

#include <cstdint>
#include <string>

#include "src/base/bytes.h"

namespace alcap::detail {

/// Of an array in C order: `type` such as "<f8", `shape` such as "(12, 3)".
[[nodiscard]] inline std::string npy_head(const std::string& type, const std::string& shape) {
  std::string text = "{'descr': '" + type + "', 'fortran_order': False, 'shape': " + shape + ", }";
  constexpr std::size_t fixed = 10, alignment = 64;
  while ((fixed + text.size() + 1) % alignment != 0) text += ' ';
  text += '\n';
  std::string head("\x93NUMPY\x01\x00", 8);
  const auto length = little_endian(static_cast<std::uint16_t>(text.size()));
  head.append(length.data(), length.size());
  return head + text;
}

}  // namespace alcap::detail
