// SPDX-License-Identifier: MIT
#include "apps/alcap/commands/address_space.h"

#include <dlfcn.h>
#include <fmt/core.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdint>
#include <fstream>

#include "apps/alcap/commands/command.h"

namespace alcap::app {
namespace {

// A buffer of 128 MB for OpenBLAS, one thread's stack and heap for every core of a small machine, and a small mesh.
constexpr std::int64_t least_bytes = std::int64_t{320} << 20;

/// What the process takes up of its address space, where the system tells.
std::int64_t used_bytes() {
  std::int64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * ::sysconf(_SC_PAGESIZE);
}

void take_buffer() {
  using Potrf = void (*)(const char*, const int*, double*, const int*, int*);
  void* const found = dlsym(RTLD_DEFAULT, "dpotrf_");
  if (found == nullptr) return;
  const int one = 1;
  int info = 0;
  double matrix = 1;
  reinterpret_cast<Potrf>(found)("U", &one, &matrix, &one, &info);
}

}  // namespace

void check_address_space() {
  rlimit limit = {};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return;
  const std::int64_t used = used_bytes(), least = used + least_bytes;
  if (limit.rlim_cur < static_cast<rlim_t>(least))
    throw Failure(Exit::solver,
                  fmt::format("the address space is limited to {} MB (ulimit -v), and at least {} MB are needed; "
                              "raise the limit",
                              limit.rlim_cur >> 20, least >> 20));
  take_buffer();
}

}  // namespace alcap::app
