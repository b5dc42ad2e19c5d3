// SPDX-License-Identifier: MIT
//
// source.h: the bytes of a file with the name to use in errors. A place in the file is a pointer into the bytes; line
// numbers are counted only when an error needs one.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "alcap/errors.h"

namespace alcap::detail {

struct Source {
  std::string path;
  std::string_view bytes;
  const char* binary_from = nullptr;  ///< places from here on are reported as byte offsets; null: all text

  [[nodiscard]] const char* begin() const { return bytes.data(); }
  [[nodiscard]] const char* end() const { return bytes.data() + bytes.size(); }
};

/// FileError about the file as a whole: "path: message".
[[noreturn]] void fail(const Source& source, const std::string& message);

/// FileError about a place: "path:line: message" or "path: byte offset: message".
[[noreturn]] void fail_at(const Source& source, const char* where, const std::string& message);

/// Text of a file for a message: quoted, shortened, unprintable bytes as \xNN.
[[nodiscard]] std::string quoted(std::string_view text);

/// Equal but for the case of ASCII letters.
[[nodiscard]] bool equal_ignoring_case(std::string_view a, std::string_view b);

/// Throws unless `count` elements of at least `least` bytes each fit into the bytes from `where` on: a header that lies
/// must not make us allocate. `what` is a plural noun.
void check_count(const Source& source, const char* where, std::int64_t count, std::int64_t least,
                 const std::string& what);

}  // namespace alcap::detail
