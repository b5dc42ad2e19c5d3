// SPDX-License-Identifier: MIT
//
// arrays.h: the users' own arrays at the door. Points may be float or double, triangles signed or unsigned integers of
// 32 or 64 bits, both row- or column-major: Eigen matrices, maps and blocks, std::span and std::vector of numbers
// (three a row) or of std::array<T, 3>. They are read once, checked, and copied into the arrays that the library keeps
// (Positions<double>, Faces); only those two, given as rvalues, are moved instead.
//
//   Eigen::MatrixXf V;  std::vector<std::uint32_t> F;
//   alcap::Surface surface(V, F);                                     // see surface.h
//   alcap::Faces faces = alcap::as_faces(F);
//   Eigen::Map<const Eigen::Matrix<double, 3, Eigen::Dynamic>> columns(data, 3, count);
//   alcap::Surface other(columns.transpose(), F);                     // one point a column
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "alcap/conventions.h"

namespace alcap {

namespace detail {

/// An array of three columns wherever it lies: element (i, k) is data[i row_stride + k column_stride].
template <class T>
struct ThreeColumns {
  const T* data = nullptr;
  std::int64_t rows = 0;
  std::int64_t row_stride = 3;
  std::int64_t column_stride = 1;
};

/// Copies; Positions without a check, Faces with one (index_out_of_range, naming the faces).
template <class T>
[[nodiscard]] Positions<double> copy_positions(const ThreeColumns<T>& V);
template <class T>
[[nodiscard]] Faces copy_faces(const ThreeColumns<T>& F);

/// Throws OptionError: `name` has that many columns, or numbers that do not make rows of three.
[[noreturn]] void refuse_columns(const char* name, std::int64_t columns);
[[noreturn]] void refuse_count(const char* name, std::int64_t numbers);

// The view of what users have: a dense Eigen object whose numbers lie in memory, or a contiguous range.
template <class Derived>
requires((Derived::Flags & Eigen::DirectAccessBit) !=
         0) ThreeColumns<typename Derived::Scalar> three_columns(const Eigen::DenseBase<Derived>& dense,
                                                                 const char* name) {
  const Derived& a = dense.derived();
  if (a.cols() != 3) refuse_columns(name, a.cols());
  const std::int64_t inner = a.innerStride(), outer = a.outerStride();
  return {a.data(), a.rows(), Derived::IsRowMajor ? outer : inner, Derived::IsRowMajor ? inner : outer};
}

template <class Range>
requires requires(const Range& r) {
  std::span(r);
} &&(!requires(const Range& r) { r.derived(); }) auto three_columns(const Range& range, const char* name) {
  const std::span numbers(range);
  using Element = std::remove_cv_t<typename decltype(numbers)::element_type>;
  const auto count = static_cast<std::int64_t>(numbers.size());
  if constexpr (std::is_arithmetic_v<Element>) {
    if (count % 3 != 0) refuse_count(name, count);
    return ThreeColumns<Element>{numbers.data(), count / 3};
  } else {
    using Number = std::remove_cvref_t<decltype(numbers[0][0])>;
    static_assert(std::is_same_v<Element, std::array<Number, 3>>, "rows must be std::array<number, 3>");
    return ThreeColumns<Number>{numbers.empty() ? nullptr : numbers[0].data(), count};
  }
}

template <class T>
using FixedWidth =
    std::conditional_t<sizeof(T) == 4, std::conditional_t<std::is_signed_v<T>, std::int32_t, std::uint32_t>,
                       std::conditional_t<std::is_signed_v<T>, std::int64_t, std::uint64_t>>;

}  // namespace detail

/// Points as the library keeps them, #V x 3. Not finite is refused where a mesh is made of them. Throws OptionError
/// when `V` does not have three columns.
template <class Points>
[[nodiscard]] Positions<double> as_positions(Points&& V) {
  if constexpr (std::is_same_v<std::remove_cvref_t<Points>, Positions<double>>) {
    return std::forward<Points>(V);
  } else {
    const auto view = detail::three_columns(V, "V");
    using Number = std::remove_cvref_t<decltype(*view.data)>;
    static_assert(std::is_same_v<Number, float> || std::is_same_v<Number, double>, "points must be float or double");
    return detail::copy_positions<Number>(view);
  }
}

/// Triangles as the library keeps them, #F x 3. Throws OptionError when `F` does not have three columns and MeshError
/// (index_out_of_range, naming the faces) for an index that Index cannot hold, below 0 or not below 2^31 (2^63 in the
/// library of 64 bits); whether an index has a vertex is checked where a mesh is made.
template <class Triangles>
[[nodiscard]] Faces as_faces(Triangles&& F) {
  if constexpr (std::is_same_v<std::remove_cvref_t<Triangles>, Faces>) {
    return std::forward<Triangles>(F);
  } else {
    const auto view = detail::three_columns(F, "F");
    using Number = std::remove_cvref_t<decltype(*view.data)>;
    static_assert(std::is_integral_v<Number> && sizeof(Number) >= 4, "indices must be integers of 32 or 64 bits");
    using Fixed = detail::FixedWidth<Number>;  // `long` and `long long` are one
    return detail::copy_faces<Fixed>(
        {reinterpret_cast<const Fixed*>(view.data), view.rows, view.row_stride, view.column_stride});
  }
}

}  // namespace alcap
