// SPDX-License-Identifier: MIT
//
// names.h: the stable names of enumerators, as reports, files and the command line write them, and the way back. The
// names of an enumeration stand beside it, in a specialisation of NamesOf.
//
//   alcap::name(alcap::ConnectionKind::global);                    // "global"
//   alcap::from_name<alcap::ConnectionKind>("polar");              // ConnectionKind::polar
//   for (const auto& [value, text] : alcap::names_of<alcap::Repair>()) ...
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>

namespace alcap {

/// The names of E: specialised with a member `table`, an array of pairs (enumerator, name) in the order of E.
template <class E>
struct NamesOf;

/// Enumerations that have names.
template <class E>
concept Named = std::is_enum_v<E> && requires {
  NamesOf<E>::table.size();
};

/// All enumerators with their names, in order.
template <Named E>
[[nodiscard]] constexpr const auto& names_of() {
  return NamesOf<E>::table;
}

/// The name of an enumerator; "unknown" for a number that is none.
template <Named E>
[[nodiscard]] constexpr std::string_view name(E value) {
  for (const auto& [enumerator, text] : NamesOf<E>::table) {
    if (enumerator == value) return text;
  }
  return "unknown";
}

/// The enumerator of this name, or nothing.
template <Named E>
[[nodiscard]] constexpr std::optional<E> from_name(std::string_view text) {
  for (const auto& [enumerator, known] : NamesOf<E>::table) {
    if (known == text) return enumerator;
  }
  return std::nullopt;
}

namespace detail {

/// For specialisations: static constexpr auto table = detail::name_table<E>({{E::a, "a"}, {E::b, "b"}});
template <class E, std::size_t count>
[[nodiscard]] consteval auto name_table(const std::pair<E, std::string_view> (&rows)[count]) {
  return std::to_array(rows);
}

}  // namespace detail
}  // namespace alcap
