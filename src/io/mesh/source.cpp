// SPDX-License-Identifier: MIT
//
// source.cpp: error messages of the readers.
#include "src/io/mesh/source.h"

#include <string>

#include "src/base/limits.h"

namespace alcap::detail {
namespace {

// "\n", "\r\n" and a lone "\r" each end a line.
std::int64_t line_of(const Source& source, const char* where) {
  std::int64_t line = 1;
  for (const char* p = source.begin(); p < where; ++p) {
    if (*p == '\n' || (*p == '\r' && (p + 1 == source.end() || p[1] != '\n'))) ++line;
  }
  return line;
}

}  // namespace

void fail(const Source& source, const std::string& message) {
  throw FileError(source.path + ": " + message, source.path);
}

void fail_at(const Source& source, const char* where, const std::string& message) {
  if (source.binary_from != nullptr && where >= source.binary_from) {
    const std::int64_t offset = where - source.begin();
    throw FileError(source.path + ": byte " + std::to_string(offset) + ": " + message, source.path, 0, offset);
  }
  const std::int64_t line = line_of(source, where);
  throw FileError(source.path + ":" + std::to_string(line) + ": " + message, source.path, line, where - source.begin());
}

std::string quoted(std::string_view text) {
  constexpr std::size_t longest = 40;
  constexpr std::string_view digits = "0123456789abcdef";
  std::string out = "'";
  for (const char c : text.substr(0, longest)) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 32 && byte < 127) {
      out += c;
    } else {
      out += {'\\', 'x', digits[byte / 16], digits[byte % 16]};
    }
  }
  return out + (text.size() > longest ? "...'" : "'");
}

bool equal_ignoring_case(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (lower(a[i]) != lower(b[i])) return false;
  }
  return true;
}

void check_count(const Source& source, const char* where, std::int64_t count, std::int64_t least,
                 const std::string& what) {
  const std::int64_t left = source.end() - where;
  const std::int64_t fit = (left + 1) / least;  // + 1: the last line may lack its newline
  if (count < 0) fail(source, "the header says " + std::to_string(count) + " " + what);
  if (count > most_numbered) {
    fail(source, std::to_string(count) + " " + what + " are more than the " + std::to_string(most_numbered) + " that " +
                     std::to_string(index_digits + 1) + "-bit indices can number");
  }
  if (count > fit) {
    fail(source, "the header says " + std::to_string(count) + " " + what + ", but the " + std::to_string(left) +
                     " bytes after it can hold at most " + std::to_string(fit) +
                     "; the file was cut or its header is wrong");
  }
}

}  // namespace alcap::detail
