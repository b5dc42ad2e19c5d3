// SPDX-License-Identifier: MIT
//
// test_names.cpp: every enumerator has one name, and the name leads back to it.
#include "alcap/names.h"

#include <doctest/doctest.h>

#include <set>
#include <string>

#include "alcap/alcap.h"

using namespace alcap;

namespace {

// GCC and Clang print a value that is an enumerator by its name, any other one as a cast, "(alcap::Defect)11".
template <auto value>
constexpr bool is_enumerator() {
  const std::string_view text = __PRETTY_FUNCTION__;
  return text.find("= (") == std::string_view::npos;
}
static_assert(is_enumerator<Defect::empty>() && !is_enumerator<static_cast<Defect>(99)>());

template <class E>
constexpr int enumerators() {
  return []<int... k>(std::integer_sequence<int, k...>) { return (int{is_enumerator<static_cast<E>(k)>()} + ...); }
  (std::make_integer_sequence<int, 64>());
}

template <class E>
void check() {
  std::set<std::string_view> seen;
  for (const auto& [value, text] : names_of<E>()) {
    const std::string_view shown = text;
    CAPTURE(shown);
    CHECK(!text.empty());
    CHECK(seen.insert(text).second);
    CHECK(name(value) == text);
    CHECK(from_name<E>(text) == value);
  }
  CHECK(static_cast<int>(seen.size()) == enumerators<E>());
  CHECK(name(static_cast<E>(63)) == "unknown");
  CHECK_FALSE(from_name<E>("unknown").has_value());
  CHECK_FALSE(from_name<E>("").has_value());
}

}  // namespace

TEST_CASE_TEMPLATE("names: one for every enumerator, and back", E, Defect, Element, ConnectionKind, PolarCenter,
                   LengthFactor, Repair, CurveEnd, CurveSides, EigenPath, OperatorKind, SingularityKind,
                   DesignGuidance::Source, DesignMethod, ReadOptions::Polygons) {
  check<E>();
}

TEST_CASE("the names that files and reports hold stay what they are") {
  CHECK(name(ConnectionKind::global) == "global");
  CHECK(name(Defect::non_manifold_edge) == "non_manifold_edge");
  CHECK(name(CurveEnd::separation) == "separation");
  CHECK(name(DesignGuidance::Source::least_curvature) == "least-curvature");
  CHECK(name(SingularityKind::trisector) == "trisector");
}

TEST_CASE("a connection and its center have one name together") {
  CHECK(name(ConnectionChoice{ConnectionKind::polar, PolarCenter::barycenter}) == "polar-barycenter");
  CHECK(name(ConnectionChoice{ConnectionKind::local, PolarCenter::barycenter}) == "local");
  for (const char* text : {"polar", "polar-barycenter", "local", "global", "trivial"}) {
    const auto choice = connection_choice(text);
    REQUIRE(choice.has_value());
    CHECK(name(*choice) == text);
  }
  CHECK_FALSE(connection_choice("barycenter").has_value());
}
