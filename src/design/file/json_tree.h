// SPDX-License-Identifier: MIT
//
// json_tree.h: JSON values that can be thrown away without memory. nlohmann's lists and objects take some when they are
// destroyed, and end the process where there is none; its reader, its texts and its numbers do not.
#pragma once

#include <concepts>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <ranges>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace alcap::detail {

/// null, true, a number or a text; a list; or an object, with its members in the order in which they were added.
class JsonTree {
 public:
  using Scalar = nlohmann::json;  // neither list nor object

  JsonTree() = default;
  // NOLINTBEGIN(google-explicit-constructor)
  /// What it stands for in JSON. Lists become lists.
  template <class T>
  requires(!std::same_as<T, JsonTree> && std::constructible_from<std::string_view, T>) JsonTree(const T& text)
      : scalar_(std::string(std::string_view(text))) {}
  template <class T>
  requires std::is_arithmetic_v<T> JsonTree(T number) : scalar_(number) {}
  template <std::ranges::input_range T>
  requires(!std::constructible_from<std::string_view, T>) JsonTree(const T& list) : kind_(Kind::list) {
    for (const auto& x : list) values_.emplace_back(x);
  }
  // NOLINTEND(google-explicit-constructor)
  [[nodiscard]] static JsonTree object() { return JsonTree(Kind::object); }
  [[nodiscard]] static JsonTree list() { return JsonTree(Kind::list); }

  [[nodiscard]] bool is_object() const { return kind_ == Kind::object; }
  [[nodiscard]] bool is_list() const { return kind_ == Kind::list; }
  /// Of a list or object.
  [[nodiscard]] std::size_t size() const { return values_.size(); }
  [[nodiscard]] const JsonTree& operator[](std::size_t k) const { return values_[k]; }
  [[nodiscard]] const std::string& key(std::size_t k) const { return keys_[k]; }
  /// The member of an object, or null.
  [[nodiscard]] const JsonTree* find(std::string_view key) const;
  /// What is neither list nor object; null of these.
  [[nodiscard]] const Scalar& scalar() const { return scalar_; }

  /// The member of this name, made if need be. A null becomes an object.
  JsonTree& operator[](std::string_view key);
  /// At the end of a list; a null becomes one. Returns it.
  JsonTree& push_back(JsonTree value);
  /// At the end of an object, which must not have it.
  JsonTree& add(std::string key, JsonTree value);

  /// As text, on lines of their own with an indent, or (-1) on one line. Bytes that are not UTF-8 are replaced.
  [[nodiscard]] std::string text(int indent = -1) const;

 private:
  enum class Kind { scalar, list, object };
  explicit JsonTree(Kind kind) : kind_(kind) {}
  void write(std::string& out, int indent, int depth) const;

  Kind kind_ = Kind::scalar;
  Scalar scalar_;
  std::vector<std::string> keys_;  // of an object, as many as values
  std::vector<JsonTree> values_;
};

/// Reads a text. Throws FileError, with the line, for what is not JSON, for keys given twice in one object and for more
/// than `deepest` levels; `name` stands for the file.
[[nodiscard]] JsonTree parse_json(std::string_view text, const std::string& name, std::size_t deepest);

}  // namespace alcap::detail
