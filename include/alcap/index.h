// SPDX-License-Identifier: MIT
//
// index.h: the type of vertex, edge, face and halfedge numbers. It has 32 bits, or 64 where the library was built with
// ALCAP_INDEX_64: its CMake package and its pkg-config file, alcap64, then define that for whoever uses the library.
#pragma once

#include <cstdint>

namespace alcap {

/// Vertex, edge, face and halfedge numbers in bulk arrays. Counts that can pass 2^31 use std::int64_t.
#ifdef ALCAP_INDEX_64
using Index = std::int64_t;
#else
using Index = std::int32_t;
#endif

namespace detail {

// The library defines this function for its own width only, so that a program compiled with the other type does not
// link. Every file has a reference of its own: the linker would keep one of several with a common name.
template <int bits>
void alcap_was_compiled_with_an_index_of_another_width() noexcept;
template <>
void alcap_was_compiled_with_an_index_of_another_width<8 * sizeof(Index)>() noexcept;
[[gnu::used]] static constexpr auto index_width_check =
    &alcap_was_compiled_with_an_index_of_another_width<8 * sizeof(Index)>;

}  // namespace detail

}  // namespace alcap
