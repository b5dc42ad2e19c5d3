// SPDX-License-Identifier: MIT
//
// large_array.h: uninitialised memory for arrays of many megabytes that live for one computation. On Linux it asks for
// huge pages: the first touch of ordinary pages costs as much as several passes over the data.
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace alcap::detail {

template <class T>
class LargeArray {
  static_assert(std::is_trivially_destructible_v<T>);

 public:
  explicit LargeArray(std::size_t count) {
    const std::size_t bytes = count * sizeof(T);
    data_.reset(static_cast<T*>(::operator new (bytes, std::align_val_t{alignment})));
    std::uninitialized_default_construct_n(data_.get(), count);  // no code for plain numbers
#if defined(__linux__) && defined(MADV_HUGEPAGE)
    if (bytes >= 2 * alignment) (void)madvise(data_.get(), bytes & ~(alignment - 1), MADV_HUGEPAGE);  // a wish only
#endif
  }
  T& operator[](std::size_t i) const { return data_.get()[i]; }
  [[nodiscard]] T* data() const { return data_.get(); }

 private:
  static constexpr std::size_t alignment = std::size_t{1} << 21;  // of a huge page
  struct Free {
    void operator()(T* data) const { ::operator delete (data, std::align_val_t{alignment}); }
  };
  std::unique_ptr<T, Free> data_;
};

}  // namespace alcap::detail
