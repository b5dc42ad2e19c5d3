// SPDX-License-Identifier: MIT
#include "alcap/memory.h"

#include <fstream>
#include <string>

namespace alcap {

std::int64_t peak_memory_bytes() {
  std::ifstream status("/proc/self/status");
  std::string line;
  while (std::getline(status, line)) {
    if (line.rfind("VmHWM:", 0) == 0) return std::stoll(line.substr(6)) * 1024;
  }
  return 0;
}

}  // namespace alcap
