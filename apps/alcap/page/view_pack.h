// SPDX-License-Identifier: MIT
//
// view_pack.h: named arrays of numbers and a little JSON as one run of bytes, which the page of apps/viewer reads as
// typed arrays without parsing numbers. apps/viewer/src/pack.js is the other side.
//
// Layout, little endian: "ALCAPPK1", the size of the header in bytes (uint32), four zero bytes, the header, the arrays.
// The header is JSON padded with blanks: {"meta": ..., "arrays": [{"name", "type", "offset", "length"}]}, offsets from
// the end of the header. Everything starts at a multiple of 8 bytes.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "apps/alcap/commands/command.h"

namespace alcap::app {

class ViewPack {
 public:
  Json meta = Json::object();

  void add(const std::string& name, std::span<const float> values) { append(name, "f32", values); }
  void add(const std::string& name, std::span<const std::uint32_t> values) { append(name, "u32", values); }
  void add(const std::string& name, std::span<const std::int16_t> values) { append(name, "i16", values); }
  /// The upper halves of the floats ("bf16"): three digits, in half the space.
  void add_short(const std::string& name, std::span<const float> values);

  [[nodiscard]] std::string bytes() const;

 private:
  template <class T>
  void append(const std::string& name, const char* type, std::span<const T> values) {
    append(name, type, {reinterpret_cast<const char*>(values.data()), values.size_bytes()}, values.size());
  }
  void append(const std::string& name, const char* type, std::string_view bytes, std::size_t length);

  Json arrays_ = Json::array();
  std::string data_;
};

/// RFC 4648, with padding.
[[nodiscard]] std::string base64(std::string_view bytes);

}  // namespace alcap::app
