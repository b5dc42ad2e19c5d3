// SPDX-License-Identifier: MIT
//
// names.h: the stable names of enumerators, as reports, files and the command line write them, and the way back. The
// names of an enumeration stand beside it, in a specialisation of NamesOf.
//
//   alcap::name(alcap::ConnectionKind::global);                    // "global"
//   alcap::from_name<alcap::ConnectionKind>("polar");              // ConnectionKind::polar
//   for (const auto& [value, text] : alcap::names_of<alcap::Repair>()) ...
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <type_traits>

namespace alcap {

/// The names of E: specialised with a member `table`, rows of enumerator and name in the order of E.
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

template <class E>
struct EnumName {
  E value;
  std::string_view text;
};

/// Names in the order of E. A plain array: every file that includes alcap pays for what is instantiated here.
template <class E, std::size_t count>
struct EnumNames {
  EnumName<E> rows[count];
  [[nodiscard]] constexpr const EnumName<E>* begin() const { return rows; }
  [[nodiscard]] constexpr const EnumName<E>* end() const { return rows + count; }
  [[nodiscard]] static constexpr std::size_t size() { return count; }
};

/// For specialisations: static constexpr auto table = detail::name_table<E>({{E::a, "a"}, {E::b, "b"}});
template <class E, std::size_t count>
[[nodiscard]] consteval EnumNames<E, count> name_table(const EnumName<E> (&rows)[count]) {
  EnumNames<E, count> table{};
  for (std::size_t i = 0; i < count; ++i) table.rows[i] = rows[i];
  return table;
}

}  // namespace detail
}  // namespace alcap
