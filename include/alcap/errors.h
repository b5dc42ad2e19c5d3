// SPDX-License-Identifier: MIT
//
// errors.h: the typed exceptions of the library. Misuse and bad input throw one of these; numerical
// outcomes (iterations, residuals, non-convergence) are returned in reports instead.
#pragma once

#include <concepts>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "alcap/index.h"
#include "alcap/names.h"

namespace alcap {

namespace detail {

/// Texts of files and callers may hold bytes of value 0, at which what() would end.
[[nodiscard]] inline std::string without_null_bytes(std::string text) {
  for (std::size_t at = 0; (at = text.find('\0', at)) != std::string::npos;) text.replace(at, 1, "\\x00");
  return text;
}

}  // namespace detail

/// Base of everything the library throws on purpose.
class Error : public std::runtime_error {
 public:
  /// Bytes of value 0 become "\x00".
  explicit Error(const std::string& what) : std::runtime_error(detail::without_null_bytes(what)) {}
};

/// A file could not be read or written. `line()` is the 1-based line, or 0 when lines mean nothing (binary formats,
/// a missing file); `offset()` the byte offset where that helps more, or -1.
class FileError : public Error {
 public:
  /// See the accessors.
  FileError(const std::string& what, std::string path, std::int64_t line = 0, std::int64_t offset = -1)
      : Error(what), path_(std::move(path)), line_(line), offset_(offset) {}
  /// The file.
  [[nodiscard]] const std::string& path() const { return path_; }
  /// 1-based, or 0.
  [[nodiscard]] std::int64_t line() const { return line_; }
  /// In bytes, or -1.
  [[nodiscard]] std::int64_t offset() const { return offset_; }

 private:
  std::string path_;
  std::int64_t line_;
  std::int64_t offset_;
};

/// What is wrong with a mesh. Checks run in the order given in mesh_check.h.
enum class Defect {
  empty,
  index_out_of_range,
  not_finite,
  repeated_vertex_in_face,
  non_manifold_edge,
  inconsistent_orientation,
  duplicate_face,
  non_manifold_vertex,
  zero_length_edge,
  zero_area_face,
  not_orientable,
  scale_out_of_range,
};

/// Which kind of element a list of numbers refers to. An edge is named by its two vertices (two entries).
enum class Element { vertex, edge, face };

template <>
struct NamesOf<Defect> {
  static constexpr auto table =
      detail::name_table<Defect>({{Defect::empty, "empty"},
                                  {Defect::index_out_of_range, "index_out_of_range"},
                                  {Defect::not_finite, "not_finite"},
                                  {Defect::repeated_vertex_in_face, "repeated_vertex_in_face"},
                                  {Defect::non_manifold_edge, "non_manifold_edge"},
                                  {Defect::inconsistent_orientation, "inconsistent_orientation"},
                                  {Defect::duplicate_face, "duplicate_face"},
                                  {Defect::non_manifold_vertex, "non_manifold_vertex"},
                                  {Defect::zero_length_edge, "zero_length_edge"},
                                  {Defect::zero_area_face, "zero_area_face"},
                                  {Defect::not_orientable, "not_orientable"},
                                  {Defect::scale_out_of_range, "scale_out_of_range"}});
};
template <>
struct NamesOf<Element> {
  static constexpr auto table =
      detail::name_table<Element>({{Element::vertex, "vertex"}, {Element::edge, "edge"}, {Element::face, "face"}});
};

/// A mesh cannot be used. Names the offending elements (the first few; `count()` says how many there are).
class MeshError : public Error {
 public:
  /// See the accessors.
  MeshError(const std::string& what, Defect defect, Element element, std::int64_t count, std::vector<Index> first)
      : Error(what), defect_(defect), element_(element), count_(count), first_(std::move(first)) {}
  /// What is wrong.
  [[nodiscard]] Defect defect() const { return defect_; }
  /// What first() lists.
  [[nodiscard]] Element element() const { return element_; }
  /// How many elements are concerned.
  [[nodiscard]] std::int64_t count() const { return count_; }
  /// The first offenders: vertex or face numbers, or pairs of vertices for edges.
  [[nodiscard]] const std::vector<Index>& first() const { return first_; }

 private:
  Defect defect_;
  Element element_;
  std::int64_t count_;
  std::vector<Index> first_;
};

namespace detail {
/// The shortest text that reads back as the same number; NaN and infinities by name.
[[nodiscard]] std::string number_text(double value);
[[nodiscard]] std::string number_text(std::integral auto value) { return std::to_string(value); }
}  // namespace detail

/// An option or argument has a value it must not have: says which, the value, and the rule that it breaks. Numbers are
/// given in the shortest form that reads back.
class OptionError : public Error {
 public:
  /// See the accessors.
  OptionError(std::string field, std::string value, std::string rule)
      : Error("option '" + field + "' = " + value + ": " + rule),
        field_(std::move(field)),
        value_(std::move(value)),
        rule_(std::move(rule)) {}
  /// See the accessors.
  template <class Number>
  requires std::is_arithmetic_v<Number> OptionError(std::string field, Number value, std::string rule)
      : OptionError(std::move(field), detail::number_text(value), std::move(rule)) {}
  /// Which option.
  [[nodiscard]] const std::string& field() const { return field_; }
  /// Its value, as text.
  [[nodiscard]] const std::string& value() const { return value_; }
  /// What the value must be.
  [[nodiscard]] const std::string& rule() const { return rule_; }

 private:
  std::string field_;
  std::string value_;
  std::string rule_;
};

/// A solver could not do its work (not positive definite, out of memory, unknown backend).
class SolveError : public Error {
 public:
  using Error::Error;
};

/// A call was stopped because its caller asked for it, see control.h.
class Cancelled : public Error {
 public:
  Cancelled() : Error("the call was cancelled") {}
};

}  // namespace alcap
