// SPDX-License-Identifier: MIT
#include "apps/alcap/report/printable.h"

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

std::string printable(std::string_view text) { return escaped(text, "\n\t"); }
std::string printable_line(std::string_view text) { return escaped(text, {}); }

}  // namespace alcap::app
