// SPDX-License-Identifier: MIT
//
// array.h: the owning array of the library: elements of trivial types that start unset, signed indices. std::vector
// would fill its elements first, on one thread, which for arrays of many megabytes costs more than most loops over
// them.
//
//   Array<Index> number(mesh.faces());
//   parallel_for(number.size(), [&](std::int64_t t) { number[t] = ...; });
//   Array<char> seen(mesh.faces(), 0);
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <new>
#include <span>
#include <type_traits>
#include <utility>

#include "src/base/pages.h"

namespace alcap::detail {

/// A signed number as an index of the standard library's containers.
[[nodiscard]] constexpr std::size_t at(std::integral auto i) { return static_cast<std::size_t>(i); }

/// The number of elements of a container, signed.
template <class Container>
[[nodiscard]] constexpr std::int64_t count_of(const Container& container) {
  return static_cast<std::int64_t>(container.size());
}

template <class T>
class Array {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);
  static_assert(alignof(T) <= __STDCPP_DEFAULT_NEW_ALIGNMENT__);

 public:
  Array() = default;
  /// Unset elements, also of types whose constructors would set zeros (std::complex).
  explicit Array(std::int64_t size)
      : data_(size > 0 ? static_cast<T*>(::operator new(at(size) * sizeof(T))) : nullptr), size_(size) {
    if (size > 0) use_large_pages(data_, at(size) * sizeof(T));
  }
  Array(std::int64_t size, const T& value) : Array(size) { std::fill_n(data_, size, value); }
  Array(Array&& other) noexcept : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}
  Array& operator=(Array&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    return *this;
  }
  ~Array() { ::operator delete(data_); }

  [[nodiscard]] std::int64_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  T& operator[](std::int64_t i) { return data_[i]; }
  const T& operator[](std::int64_t i) const { return data_[i]; }
  [[nodiscard]] T* data() { return data_; }
  [[nodiscard]] const T* data() const { return data_; }
  [[nodiscard]] T* begin() { return data_; }
  [[nodiscard]] T* end() { return data_ + size_; }
  [[nodiscard]] const T* begin() const { return data_; }
  [[nodiscard]] const T* end() const { return data_ + size_; }

 private:
  T* data_ = nullptr;
  std::int64_t size_ = 0;
};

}  // namespace alcap::detail
