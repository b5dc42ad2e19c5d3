// SPDX-License-Identifier: MIT
//
// ply_body.h: the values behind a PLY header, one class per encoding with the same interface:
//   begin(e)           before an element            end_of(e)     after it
//   real(type, x)      next value as a double, NaN and infinities too; false when there is none
//   integer(type, i)   next value as a whole number; false when there is none or it is not whole
//   skip(type, n)      n values unseen; false when they are not there
//   fail(what)         says what is wrong where `what` was wanted
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <string>

#include "src/base/bytes.h"
#include "src/io/mesh/ply_header.h"
#include "src/io/mesh/tokenizer.h"

namespace alcap::detail {

/// Text: one element per line. Free: line ends mean nothing.
class PlyText {
 public:
  PlyText(const Source& source, const char* body, bool free = false) : in_(source, body), free_(free) {}

  /// The least bytes a value takes: a digit and a blank.
  static constexpr std::int64_t least_bytes(PlyType) { return 2; }

  [[nodiscard]] const char* where() const { return in_.where(); }
  void begin() { in_.next_token(); }
  void end_of(const PlyElement& element) {
    if (!free_ && !in_.at_line_end()) {
      in_.fail("more values on the line than element " + quoted(element.name) + " has properties");
    }
  }
  /// NaN where the file says so.
  [[nodiscard]] bool real(PlyType, double& x) {
    if (free_) in_.next_token();
    return in_.real_or_nan(x);
  }
  [[nodiscard]] bool integer(PlyType, std::int64_t& i) {
    if (free_) in_.next_token();
    return in_.integer(i);
  }
  [[nodiscard]] bool skip(PlyType, std::int64_t count) {
    for (; count > 0; --count) {
      if (free_) in_.next_token();
      if (in_.word().empty()) return false;
    }
    return true;
  }
  [[nodiscard]] bool at_end() { return !in_.next_token(); }
  [[noreturn]] void fail(const std::string& what) { in_.fail_number(what); }

 private:
  Tokenizer in_;
  bool free_;
};

template <std::endian order>
class PlyBinary {
 public:
  PlyBinary(const Source& source, const char* body, bool /*free*/ = false)
      : source_(source), p_(body), end_(source.end()) {}

  static constexpr std::int64_t least_bytes(PlyType type) { return static_cast<std::int64_t>(size_of(type)); }

  [[nodiscard]] const char* where() const { return p_; }
  void begin() {}
  void end_of(const PlyElement&) {}
  [[nodiscard]] bool real(PlyType type, double& x) {
    return with(type, [&](auto value) {
      x = static_cast<double>(value);
      return true;
    });
  }
  [[nodiscard]] bool integer(PlyType type, std::int64_t& i) {
    return with(type, [&](auto value) {
      if constexpr (std::is_floating_point_v<decltype(value)>) {
        if (!(std::abs(value) < 1e15F) || value != std::floor(value)) return false;
      }
      i = static_cast<std::int64_t>(value);
      return true;
    });
  }
  [[nodiscard]] bool skip(PlyType type, std::int64_t count) {
    const auto size = least_bytes(type);
    if (count > (end_ - p_) / size) return false;
    p_ += count * size;
    return true;
  }
  [[nodiscard]] bool at_end() const { return p_ == end_; }
  [[noreturn]] void fail(const std::string& what) {
    fail_at(source_, p_,
            failed_on_value_ ? what + " is not a finite number (or not whole where it must be)"
                             : "the file ends before " + what + "; it was cut");
  }

 private:
  template <class Use>
  bool with(PlyType type, Use use) {
    switch (type) {
      case PlyType::int8:
        return take<std::int8_t>(use);
      case PlyType::uint8:
        return take<std::uint8_t>(use);
      case PlyType::int16:
        return take<std::int16_t>(use);
      case PlyType::uint16:
        return take<std::uint16_t>(use);
      case PlyType::int32:
        return take<std::int32_t>(use);
      case PlyType::uint32:
        return take<std::uint32_t>(use);
      case PlyType::float32:
        return take<float>(use);
      case PlyType::float64:
        return take<double>(use);
    }
    return false;
  }
  template <class T, class Use>
  bool take(Use use) {
    if (end_ - p_ < static_cast<std::ptrdiff_t>(sizeof(T))) return false;
    failed_on_value_ = !use(load<T, order>(p_));
    if (!failed_on_value_) p_ += sizeof(T);
    return !failed_on_value_;
  }

  const Source& source_;
  const char* p_;
  const char* end_;
  bool failed_on_value_ = false;
};

}  // namespace alcap::detail
