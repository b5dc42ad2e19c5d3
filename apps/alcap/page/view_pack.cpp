// SPDX-License-Identifier: MIT
//
// view_pack.cpp: arrays and JSON as one run of bytes, and those bytes as text.
#include "apps/alcap/page/view_pack.h"

#include <bit>
#include <vector>

namespace alcap::app {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are copied as they lie in memory");

void pad(std::string& text, char with) { text.append((8 - text.size() % 8) % 8, with); }

}  // namespace

void ViewPack::add_short(const std::string& name, std::span<const float> values) {
  std::vector<std::uint16_t> upper(values.size());
  for (std::size_t k = 0; k < values.size(); ++k) {
    const auto bits = std::bit_cast<std::uint32_t>(values[k]);
    upper[k] = static_cast<std::uint16_t>((bits + 0x7fffU + ((bits >> 16) & 1U)) >> 16);  // to nearest, ties to even
  }
  append<std::uint16_t>(name, "bf16", upper);
}

void ViewPack::append(const std::string& name, const char* type, std::string_view bytes, std::size_t length) {
  arrays_.push_back({{"name", name}, {"type", type}, {"offset", data_.size()}, {"length", length}});
  data_.append(bytes);
  pad(data_, '\0');
}

std::string ViewPack::bytes() const {
  std::string header = text_of(Json{{"meta", meta}, {"arrays", arrays_}});
  pad(header, ' ');
  std::string out = "ALCAPPK1";
  const auto size = static_cast<std::uint32_t>(header.size());
  for (int k = 0; k < 8; ++k) out.push_back(k < 4 ? static_cast<char>((size >> (8 * k)) & 0xff) : '\0');
  out.reserve(out.size() + header.size() + data_.size());
  out += header;
  out += data_;
  return out;
}

std::string base64(std::string_view bytes) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  const auto at = [&](std::size_t k) { return k < bytes.size() ? static_cast<unsigned char>(bytes[k]) : 0U; };
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    const unsigned group = at(k) << 16 | at(k + 1) << 8 | at(k + 2);
    out += digits[group >> 18];
    out += digits[group >> 12 & 63];
    out += k + 1 < bytes.size() ? digits[group >> 6 & 63] : '=';
    out += k + 2 < bytes.size() ? digits[group & 63] : '=';
  }
  return out;
}

}  // namespace alcap::app
