// SPDX-License-Identifier: MIT
//
// unset_array.h: arrays whose elements start unset, also of types whose constructors would set zeros (std::complex), so
// that memory is first touched by the threads that fill it.
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>

namespace alcap::detail {

struct FreeUnset {
  void operator()(void* memory) const noexcept { ::operator delete(memory); }
};

template <class T>
using UnsetArray = std::unique_ptr<T[], FreeUnset>;

/// Throws std::bad_alloc when memory runs out.
template <class T>
[[nodiscard]] UnsetArray<T> unset_array(std::size_t count) {
  static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= __STDCPP_DEFAULT_NEW_ALIGNMENT__);
  return UnsetArray<T>(static_cast<T*>(::operator new(count * sizeof(T))));
}

}  // namespace alcap::detail
