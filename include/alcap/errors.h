// SPDX-License-Identifier: MIT
//
// errors.h: the typed exceptions of the library. Misuse and bad input throw one of these; numerical
// outcomes (iterations, residuals, non-convergence) are returned in reports instead.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace alcap {

/// Base of everything the library throws on purpose.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A file could not be read or written. `line()` is the 1-based line, or 0 when lines mean nothing (binary formats,
/// a missing file); `offset()` the byte offset where that helps more, or -1.
class FileError : public Error {
 public:
  FileError(const std::string& what, std::string path, std::int64_t line = 0, std::int64_t offset = -1)
      : Error(what), path_(std::move(path)), line_(line), offset_(offset) {}
  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] std::int64_t line() const { return line_; }
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
};

/// Which kind of element a list of numbers refers to. An edge is named by its two vertices (two entries).
enum class Element { vertex, edge, face };

/// A mesh cannot be used. Names the offending elements (the first few; `count()` says how many there are).
class MeshError : public Error {
 public:
  MeshError(const std::string& what, Defect defect, Element element, std::int64_t count,
            std::vector<std::int32_t> first)
      : Error(what), defect_(defect), element_(element), count_(count), first_(std::move(first)) {}
  [[nodiscard]] Defect defect() const { return defect_; }
  [[nodiscard]] Element element() const { return element_; }
  [[nodiscard]] std::int64_t count() const { return count_; }
  /// The first offenders: vertex or face numbers, or pairs of vertices for edges.
  [[nodiscard]] const std::vector<std::int32_t>& first() const { return first_; }

 private:
  Defect defect_;
  Element element_;
  std::int64_t count_;
  std::vector<std::int32_t> first_;
};

/// An option has a value it must not have; names the field and the value.
class OptionError : public Error {
 public:
  OptionError(std::string field, std::string value, const std::string& rule)
      : Error("option '" + field + "' = " + value + ": " + rule), field_(std::move(field)), value_(std::move(value)) {}
  [[nodiscard]] const std::string& field() const { return field_; }
  [[nodiscard]] const std::string& value() const { return value_; }

 private:
  std::string field_;
  std::string value_;
};

/// A solver could not do its work (not positive definite, out of memory, unknown backend).
class SolveError : public Error {
 public:
  using Error::Error;
};

/// A solve was stopped because its caller asked for it, see SolverOptions::cancel.
class Cancelled : public Error {
 public:
  Cancelled() : Error("the solve was cancelled") {}
};

}  // namespace alcap
