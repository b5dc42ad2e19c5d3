// SPDX-License-Identifier: MIT
//
// memory.h: how much memory the process has used, for reports.
#pragma once

#include <cstdint>

namespace alcap {

/// Largest resident set of the process so far, in bytes (VmHWM on Linux); 0 where the system does not tell.
[[nodiscard]] std::int64_t peak_memory_bytes();

/// Its resident set now (VmRSS); 0 where the system does not tell.
[[nodiscard]] std::int64_t memory_bytes();

}  // namespace alcap
