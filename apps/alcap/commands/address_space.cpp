// SPDX-License-Identifier: MIT
#include "apps/alcap/commands/address_space.h"

#include <fmt/core.h>

#include <cstdint>

#include "apps/alcap/commands/command.h"
#include "apps/alcap/system/system.h"

namespace alcap::app {
namespace {

// A buffer of 128 MB for OpenBLAS, one thread's stack and heap for every core of a small machine, and a small mesh.
constexpr std::int64_t least_bytes = std::int64_t{320} << 20;

}  // namespace

void check_address_space() {
  const AddressSpace space = address_space();
  if (space.limit == 0) return;
  const std::int64_t least = space.used + least_bytes;
  if (space.limit < least)
    throw Failure(Exit::solver,
                  fmt::format("the address space is limited to {} MB (ulimit -v), and at least {} MB are needed; "
                              "raise the limit",
                              space.limit >> 20, least >> 20));
  take_blas_buffer();
}

}  // namespace alcap::app
