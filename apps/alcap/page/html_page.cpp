// SPDX-License-Identifier: MIT
//
// html_page.cpp: fills the embedded page. The page holds three marks: its title, what it is to do ("boot", JSON), and
// its data (base64 text, so that no parser looks at numbers).
#include "apps/alcap/page/html_page.h"

#include <algorithm>

// Put there by apps/alcap/CMakeLists.txt: the bytes of the page, none when npm was missing.
extern "C" {
extern const char alcap_page_begin[];  // NOLINT(modernize-avoid-c-arrays)
extern const char alcap_page_end[];    // NOLINT(modernize-avoid-c-arrays)
}

namespace alcap::app {
namespace {

std::string_view page() { return {alcap_page_begin, static_cast<std::size_t>(alcap_page_end - alcap_page_begin)}; }

void append_until(std::string& out, std::string_view& rest, std::string_view mark) {
  const std::size_t at = rest.find(mark);
  if (at == std::string_view::npos) throw std::logic_error("the page lacks " + std::string(mark));
  out += rest.substr(0, at);
  rest.remove_prefix(at + mark.size());
}

std::string fill(std::string_view title, const Json& boot, std::string_view data) {
  check_page();
  std::string_view rest = page();
  std::string out;
  out.reserve(rest.size() + data.size() + 4096);
  append_until(out, rest, "{{title}}");
  out += html_escaped(title);
  append_until(out, rest, "{{boot}}");
  // "</script>" inside a string must not end the element.
  std::string text = text_of(boot);
  for (std::size_t k = text.find('<'); k != std::string::npos; k = text.find('<', k)) text.replace(k, 1, "\\u003c");
  out += text;
  append_until(out, rest, "{{data}}");
  out += data;
  out += rest;
  return out;
}

}  // namespace

void check_page() {
  if (!page().empty()) return;
  throw Failure(Exit::usage,
                "this alcap was built without its page. The build makes it with npm (Debian: apt-get install npm) and "
                "the packages of apps/viewer/package-lock.json; install npm and build again");
}

std::string html_escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (c == '"') {
      out += "&quot;";
    } else {
      out += c;
    }
  }
  return out;
}

std::string html_page(const ViewPack& scene) {
  return fill(scene.meta.value("title", "field") + " – alcap", {{"mode", "view"}}, base64(scene.bytes()));
}

std::string html_page(const Json& boot) { return fill(boot.value("title", "studio") + " – alcap studio", boot, ""); }

}  // namespace alcap::app
