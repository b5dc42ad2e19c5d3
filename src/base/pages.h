// SPDX-License-Identifier: MIT
//
// pages.h: large pages for large arrays. The system takes longer to provide a new page of 4 KB than most loops take to
// use it, and a mesh of a million triangles touches two hundred thousand of them. Every random access pays once more,
// because the processor remembers where only a few thousand pages are. Some systems give large pages to all programs
// (Debian), others on request (Ubuntu, many servers). Asking for them shortens a whole run by a tenth to an eighth.
#pragma once

#include <cstddef>

namespace alcap::detail {

/// Asks the system to put these bytes into large pages. Call it before they are first written; what they hold does not
/// change. Does nothing for less than 4 MB, or where there are no such pages. Never fails.
void use_large_pages(void* data, std::size_t bytes) noexcept;

/// Gives an Eigen vector or matrix this size, with unset elements, in large pages if it is large.
template <class Dense, class... Size>
void resize_unset(Dense& x, Size... size) {
  x.resize(size...);
  use_large_pages(x.data(), static_cast<std::size_t>(x.size()) * sizeof(*x.data()));
}

}  // namespace alcap::detail
