// SPDX-License-Identifier: MIT
//
// bytes.h: numbers in binary files.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>

namespace alcap::detail {

/// The number of type T at `from`, stored in the given byte order; no alignment needed.
template <class T, std::endian order>
[[nodiscard]] T load(const char* from) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), from, sizeof(T));
  if constexpr (order != std::endian::native) std::ranges::reverse(bytes);
  return std::bit_cast<T>(bytes);
}

/// The bytes of a number, little end first.
template <class T>
[[nodiscard]] std::array<char, sizeof(T)> little_endian(T value) {
  auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if constexpr (std::endian::native != std::endian::little) std::ranges::reverse(bytes);
  return bytes;
}

}  // namespace alcap::detail
