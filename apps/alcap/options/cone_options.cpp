// SPDX-License-Identifier: MIT
#include "apps/alcap/options/cone_options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

namespace alcap::app {
namespace {

/// A whole number, or a decimal one, that is all of `text`. Throws cli::ValidationError.
template <class T>
T parse_number(const std::string& whole, const std::string& text, const char* option = "--cone",
               const char* form = "VERTEX:INDEX, such as 12:1/4 or 7:-0.5") {
  T value{};
  const char* const end = text.data() + text.size();
  const char* const begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (error != std::errc() || stop != end) {
    throw cli::ValidationError(option, whole + " should be " + form);
  }
  return value;
}

/// "12:1/4", "12:+1", "12:-0.25"
Cone parse_cone(const std::string& text) {
  const std::size_t colon = std::min(text.find(':'), text.size());
  const std::string index = colon < text.size() ? text.substr(colon + 1) : "";
  const std::size_t slash = std::min(index.find('/'), index.size());
  Cone cone{.vertex = parse_number<Index>(text, text.substr(0, colon)),
            .index = parse_number<double>(text, index.substr(0, slash))};
  if (slash < index.size()) cone.index /= static_cast<double>(parse_number<Index>(text, index.substr(slash + 1)));
  if (!std::isfinite(cone.index)) throw cli::ValidationError("--cone", text + " has no finite index");
  return cone;
}

/// "0.25", "-1/4"
double parse_turns(const char* option, const std::string& text) {
  const std::size_t slash = std::min(text.find('/'), text.size());
  double turns = parse_number<double>(text, text.substr(0, slash), option, "a number of turns, such as 0.25 or -1/4");
  if (slash < text.size())
    turns /= static_cast<double>(
        parse_number<Index>(text, text.substr(slash + 1), option, "a number of turns, such as 0.25 or -1/4"));
  if (!std::isfinite(turns)) throw cli::ValidationError(option, text + " is not finite");
  return turns;
}

/// Cones make a connection trivial unless it is metric.
void imply_cones(ConnectionKind& kind) {
  if (kind != ConnectionKind::metric) kind = ConnectionKind::trivial;
}

}  // namespace

void add_cone_option(cli::App& app, ConnectionKind& kind, std::vector<Cone>& cones) {
  app.add_option_function<std::vector<std::string>>(
         "--cone",
         [&kind, &cones](const std::vector<std::string>& texts) {
           for (const std::string& c : texts) cones.push_back(parse_cone(c));
           imply_cones(kind);
         },
         "Of the trivial connection (which it implies) and of metric: the field's index at a vertex, as VERTEX:1/4. "
         "Repeat it; on a closed surface the indices must sum to the Euler characteristic")
      ->type_name("CONE")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->group("Connection");
}

void add_turns_option(cli::App& app, const char* option, ConnectionKind& kind, std::vector<double>& turns,
                      const char* help) {
  app.add_option_function<std::vector<std::string>>(
         option,
         [option, &kind, &turns](const std::vector<std::string>& texts) {
           for (const std::string& t : texts) turns.push_back(parse_turns(option, t));
           imply_cones(kind);
         },
         help)
      ->type_name("TURNS")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->group("Connection");
}

}  // namespace alcap::app
