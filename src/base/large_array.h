// SPDX-License-Identifier: MIT
//
// large_array.h: uninitialised memory for arrays of many megabytes that live for one computation: std::vector would
// fill them first, on one thread.
#pragma once

#include <cstddef>

#include "src/base/unset_array.h"

namespace alcap::detail {

template <class T>
class LargeArray {
 public:
  explicit LargeArray(std::size_t count) : data_(unset_array<T>(count)) {}
  T& operator[](std::size_t i) const { return data_[i]; }
  [[nodiscard]] T* data() const { return data_.get(); }

 private:
  UnsetArray<T> data_;
};

}  // namespace alcap::detail
