// SPDX-License-Identifier: MIT
//
// tokenizer.h: words and numbers of a text file, strict and without copies. Shared by every format.
//
// A token ends at a blank, a line end or the end of the file; a number must fill its token. '#' at the start of a token
// starts a comment; inside one it does not, so that 1.#QNAN is not 1.
// "\n", "\r\n" and "\r" end a line; a backslash right before a line end joins it to the next.
#pragma once

#include <fast_float/fast_float.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <system_error>

#include "src/base/array.h"
#include "src/io/mesh/source.h"

namespace alcap::detail {

class Tokenizer {
 public:
  Tokenizer(const Source& source, const char* from) : source_(source), p_(from), end_(source.end()) {}
  explicit Tokenizer(const Source& source) : Tokenizer(source, source.begin()) {
    if (source.bytes.starts_with("\xEF\xBB\xBF")) p_ += 3;  // byte order mark
  }

  [[nodiscard]] const Source& source() const { return source_; }
  [[nodiscard]] const char* where() const { return p_; }
  [[nodiscard]] const char* end() const { return end_; }

  /// Goes back (or forth) to a place where() has given.
  void go(const char* place) { p_ = place; }

  /// Moves to the next token, across line ends and comments. False at the end of the file.
  bool next_token() {
    for (;;) {
      skip_blank();
      if (p_ == end_) return false;
      if (is_newline(*p_)) {
        ++p_;
      } else if (*p_ == '#') {
        skip_line();
      } else {
        return true;
      }
    }
  }

  /// True when nothing but a comment is left on the line. Moves past blanks.
  bool at_line_end() {
    skip_blank();
    return p_ == end_ || is_newline(*p_) || *p_ == '#';
  }

  /// Moves to the end of the line, whatever is on it.
  void skip_line() {
    while (p_ != end_ && !is_newline(*p_)) ++p_;
  }

  /// Moves to the end of the statement: lines joined by a backslash count as one, unless it is in a comment.
  void skip_statement() {
    for (; p_ != end_ && !is_newline(*p_); ++p_) {
      if (*p_ == '#') return skip_line();
      if (*p_ == '\\' && joins(p_)) skip_blank(), --p_;
    }
  }

  /// The next word on the line; empty at its end.
  std::string_view word() {
    if (at_line_end()) return {};
    const char* from = p_;
    while (!ends_token(p_)) ++p_;
    return {from, at(p_ - from)};
  }

  /// A finite number that fills the next token of the line. On false nothing is consumed: fail_number() says why.
  [[nodiscard]] bool real(double& value) {
    skip_blank();
    const char* from = p_;
    if (end_ - from > 1 && *from == '+' && from[1] != '-') ++from;
    if (from == end_) return false;
    const auto [stop, error] = fast_float::from_chars(from, end_, value);
    if (error != std::errc() && !(error == std::errc::result_out_of_range && std::abs(value) < 1)) return false;
    if (!std::isfinite(value) || !ends_token(stop)) return false;
    p_ = stop;
    return true;
  }

  /// A number as real(), or one that is not finite by name (nan, inf, 1.#QNAN), whose value is NaN.
  [[nodiscard]] bool real_or_nan(double& value) {
    if (real(value)) return true;
    const char* const from = p_;
    if (is_not_finite(word())) {
      value = std::numeric_limits<double>::quiet_NaN();
      return true;
    }
    p_ = from;
    return false;
  }

  /// A whole number of at most 18 digits, up to the end of the token or to `also` (OBJ: '/'), which is left in place.
  [[nodiscard]] bool integer(std::int64_t& value, char also = ' ') {
    skip_blank();
    const char* q = p_;
    bool negative = false;
    if (q != end_ && (*q == '-' || *q == '+')) negative = *q++ == '-';
    const char* const digits = q;
    std::int64_t magnitude = 0;
    while (q != end_ && is_digit(*q) && q - digits < 18) magnitude = 10 * magnitude + (*q++ - '0');
    if (q == digits || !(ends_token(q) || *q == also)) return false;
    value = negative ? -magnitude : magnitude;
    p_ = q;
    return true;
  }

  /// Steps over the rest of a corner, "/7/3"; false when it holds anything but digits, signs and slashes.
  [[nodiscard]] bool skip_references() {
    const char* q = p_;
    while (q != end_ && (is_digit(*q) || *q == '/' || *q == '-')) ++q;
    if (!ends_token(q)) return false;
    p_ = q;
    return true;
  }

  [[noreturn]] void fail(const std::string& message) const { fail_at(source_, p_, message); }

  /// Says what the next token is and why it is not the number that `what` needs.
  [[noreturn]] void fail_number(const std::string& what);

 private:
  [[nodiscard]] static bool is_not_finite(std::string_view word);
  static bool is_digit(char c) { return c >= '0' && c <= '9'; }
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
  static bool is_newline(char c) { return c == '\n' || c == '\r'; }

  // A backslash right before a line end.
  [[nodiscard]] bool joins(const char* q) const { return end_ - q > 1 && is_newline(q[1]); }

  [[nodiscard]] bool ends_token(const char* q) const {
    return q == end_ || is_blank(*q) || is_newline(*q) || (*q == '\\' && joins(q));
  }

  void skip_blank() {
    for (;;) {
      while (p_ != end_ && is_blank(*p_)) ++p_;
      if (p_ == end_ || *p_ != '\\' || !joins(p_)) return;
      p_ += end_ - p_ > 2 && p_[1] == '\r' && p_[2] == '\n' ? 3 : 2;
    }
  }

  const Source& source_;
  const char* p_;
  const char* end_;
};

}  // namespace alcap::detail
