// SPDX-License-Identifier: MIT
#include "alcap/memory.h"

#include <fstream>
#include <string>
#include <string_view>

namespace alcap {
namespace {

// A line of the status that Linux gives, in kB there.
std::int64_t status_bytes(std::string_view key) {
  std::ifstream status("/proc/self/status");
  std::string line;
  while (std::getline(status, line)) {
    if (line.starts_with(key)) return std::stoll(line.substr(key.size())) * 1024;
  }
  return 0;
}

}  // namespace

std::int64_t peak_memory_bytes() { return status_bytes("VmHWM:"); }
std::int64_t memory_bytes() { return status_bytes("VmRSS:"); }

}  // namespace alcap
