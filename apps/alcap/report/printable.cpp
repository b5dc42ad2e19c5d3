// SPDX-License-Identifier: MIT
#include "apps/alcap/report/printable.h"

#include "apps/alcap/commands/command.h"

namespace alcap::app {
namespace {

std::string escaped(std::string_view text, std::string_view allowed) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string out;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const auto byte = static_cast<unsigned char>(text[k]);
    // The second set of control characters, U+0080 to U+009F, is C2 80 to C2 9F in UTF-8.
    const bool second_set = byte >= 0x80 && byte < 0xA0 && k > 0 && text[k - 1] == '\xC2';
    if ((byte >= 32 && byte != 127 && !second_set) || allowed.find(text[k]) != std::string_view::npos)
      out += text[k];
    else
      out += {'\\', 'x', digits[byte / 16], digits[byte % 16]};
  }
  return out;
}

}  // namespace

std::string shell_word(std::string_view text) {
  bool utf8 = true;
  try {
    (void)Json(text).dump();
  } catch (const Json::exception&) {
    utf8 = false;
  }
  const bool plain = utf8 && printable_line(text) == text;
  std::string out = plain ? "'" : "$'";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (plain) {
      out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    } else if (byte < 32 || byte >= 127) {
      out += {'\\', static_cast<char>('0' + byte / 64), static_cast<char>('0' + byte / 8 % 8),
              static_cast<char>('0' + byte % 8)};
    } else {
      if (c == '\'' || c == '\\') out += '\\';
      out += c;
    }
  }
  return out + "'";
}

std::string shell_file(const std::filesystem::path& file) {
  const std::string name = file.string();
  return shell_word(name.starts_with('-') ? "./" + name : name);
}

std::string printable(std::string_view text) { return escaped(text, "\n\t"); }
std::string printable_line(std::string_view text) { return escaped(text, {}); }

}  // namespace alcap::app
