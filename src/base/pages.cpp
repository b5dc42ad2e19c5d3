// SPDX-License-Identifier: MIT
#include "src/base/pages.h"

#if defined(__linux__) && !defined(ALCAP_PORTABLE)
#include <sys/mman.h>

#include <cerrno>
#include <cstdint>
#endif

namespace alcap::detail {

void use_large_pages([[maybe_unused]] void* data, [[maybe_unused]] std::size_t bytes) noexcept {
#if defined(__linux__) && !defined(ALCAP_PORTABLE) && defined(MADV_HUGEPAGE)
  constexpr std::size_t least = std::size_t{4} << 20;
  constexpr std::uintptr_t page = std::uintptr_t{2}
                                  << 20;  // whole large pages inside, so that no neighbour is concerned
  if (bytes < least) return;
  const auto first = (reinterpret_cast<std::uintptr_t>(data) + page - 1) / page * page;
  const auto stop = (reinterpret_cast<std::uintptr_t>(data) + bytes) / page * page;
  const int saved = errno;
  (void)::madvise(reinterpret_cast<void*>(first), stop - first, MADV_HUGEPAGE);
  errno = saved;
#endif
}

}  // namespace alcap::detail
