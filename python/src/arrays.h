// SPDX-License-Identifier: MIT
//
// arrays.h: NumPy arrays to and from the library's. What the library made is handed out without a copy: an array over
// its memory, kept alive by the array. What comes in is copied once where the library keeps it.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "alcap/conventions.h"
#include "alcap/solve.h"

namespace alcap::python {

namespace py = pybind11;
using namespace pybind11::literals;  // "name"_a = value

/// What Python prints of a value, shortened.
[[nodiscard]] std::string short_repr(const py::handle& value);

/// Lengths of an array along its dimensions.
using Shape = std::vector<py::ssize_t>;

/// An array, rows contiguous, over memory that `owner` keeps alive.
[[nodiscard]] py::array over(const py::dtype& type, Shape shape, const void* data, const py::object& owner,
                             bool writeable);

/// A capsule that owns `value`.
template <class T>
[[nodiscard]] py::capsule keep(T value) {
  auto owned = std::make_unique<T>(std::move(value));
  py::capsule capsule(owned.get(), [](void* p) { delete static_cast<T*>(p); });
  owned.release();  // NOLINT(bugprone-unused-return-value): the capsule has it
  return capsule;
}

/// A read-only array over a part of something immutable. `handle` is a copy of the handle that shares it.
template <class T, class Handle>
[[nodiscard]] py::array shared(const T* data, Shape shape, Handle handle) {
  return over(py::dtype::of<T>(), std::move(shape), data, keep(std::move(handle)), false);
}

/// The array that a vector or a matrix with contiguous rows becomes; it may be written to.
template <class Array>
[[nodiscard]] py::array moved(Array values, Shape shape) {
  using T = std::remove_cvref_t<decltype(*values.data())>;
  auto owned = std::make_unique<Array>(std::move(values));
  const T* data = owned->data();
  py::capsule capsule(owned.get(), [](void* p) { delete static_cast<Array*>(p); });
  owned.release();  // NOLINT(bugprone-unused-return-value): the capsule has it
  return over(py::dtype::of<T>(), std::move(shape), data, capsule, true);
}
template <class Array>
[[nodiscard]] py::array moved(Array values) {
  const auto count = static_cast<py::ssize_t>(values.size());
  return moved(std::move(values), {count});
}
/// #rows x 3.
[[nodiscard]] py::array moved_rows(Positions<double> rows);

/// (#V, 3) of floats in any memory order. Throws OptionError that names the argument.
[[nodiscard]] Positions<double> positions_of(const py::object& V, const char* name = "V");
/// (#F, 3) of integers in any memory order. Throws OptionError, MeshError.
[[nodiscard]] Faces faces_of(const py::object& F, const char* name = "F");
/// (count,) of complex numbers; any count where `count` is negative.
[[nodiscard]] ComplexVectorX<double> complex_of(const py::object& values, const char* name, std::int64_t count = -1);
/// (count,) of reals.
[[nodiscard]] VectorX<double> reals_of(const py::object& values, const char* name, std::int64_t count = -1);
/// (count,) of integers.
[[nodiscard]] std::vector<Index> indices_of(const py::object& values, const char* name, std::int64_t count = -1);

/// (k, 2) of integers.
[[nodiscard]] std::vector<std::array<Index, 2>> pairs_of(const py::object& values, const char* name);
/// #rows x 3, and the array that faces become.
[[nodiscard]] py::array moved_faces(Faces rows);

/// (data, indices, indptr) of a compressed matrix, without a copy.
template <class Matrix>
[[nodiscard]] py::tuple sparse(Matrix matrix) {
  matrix.makeCompressed();
  using Scalar = typename Matrix::Scalar;
  auto owned = std::make_unique<Matrix>(std::move(matrix));
  const Matrix& a = *owned;
  const py::capsule capsule(owned.get(), [](void* p) { delete static_cast<Matrix*>(p); });
  owned.release();  // NOLINT(bugprone-unused-return-value): the capsule has it
  const auto part = [&](const auto* data, py::ssize_t count) {
    return over(py::dtype::of<std::remove_cvref_t<decltype(*data)>>(), {count}, data, capsule, true);
  };
  return py::make_tuple(part(static_cast<const Scalar*>(a.valuePtr()), a.nonZeros()),
                        part(a.innerIndexPtr(), a.nonZeros()), part(a.outerIndexPtr(), a.outerSize() + 1),
                        py::make_tuple(a.rows(), a.cols()));
}
/// The square complex matrix of (data, indices, indptr), columns compressed and sorted; copies.
[[nodiscard]] SparseMatrix<Complex<double>> sparse_of(const py::tuple& parts, const char* name);

/// A Python value as an option or an attribute of this type. Throws OptionError that names it.
template <class T>
[[nodiscard]] T as(const py::handle& value, const std::string& name) {
  using Plain = std::remove_cvref_t<T>;
  try {
    return value.cast<T>();
  } catch (const py::cast_error&) {
    std::string rule = "has the wrong type";
    if constexpr (std::is_same_v<Plain, bool>)
      rule = "must be True or False";
    else if constexpr (std::is_integral_v<Plain>)
      rule = std::string("must be a whole number") + (std::is_unsigned_v<Plain> ? " that is not negative" : "") +
             ", of at most " + std::to_string(8 * sizeof(Plain)) + " bits";
    else if constexpr (std::is_floating_point_v<Plain> || std::is_same_v<Plain, Complex<double>>)
      rule = "must be a number";
    else if constexpr (std::is_same_v<Plain, std::string>)
      rule = "must be a str";
    throw OptionError(name, short_repr(value), rule);
  }
}

/// The enumerator of a name. Throws OptionError that lists the names.
template <class E>
[[nodiscard]] E named(const std::string& text, const char* option) {
  if (const auto value = from_name<E>(text)) return *value;
  std::string rule = "must be one of";
  for (const auto& [value, known] : names_of<E>()) rule += " " + std::string(known);
  throw OptionError(option, text, rule);
}

}  // namespace alcap::python
