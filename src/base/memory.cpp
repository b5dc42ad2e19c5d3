// SPDX-License-Identifier: MIT
#include "alcap/memory.h"

#include <fstream>
#include <string>
#include <string_view>

namespace alcap {
namespace {

// A line of what Linux tells in a file, in kB there.
std::int64_t line_bytes(const char* file, std::string_view key) {
  std::ifstream status(file);
  std::string line;
  while (std::getline(status, line)) {
    if (line.starts_with(key)) return std::stoll(line.substr(key.size())) * 1024;
  }
  return 0;
}

}  // namespace

std::int64_t peak_memory_bytes() { return line_bytes("/proc/self/status", "VmHWM:"); }
std::int64_t memory_bytes() { return line_bytes("/proc/self/status", "VmRSS:"); }
std::int64_t available_memory_bytes() { return line_bytes("/proc/meminfo", "MemAvailable:"); }

}  // namespace alcap
