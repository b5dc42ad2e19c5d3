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

/// What the system could still give to processes, in bytes (MemAvailable); 0 where it does not tell.
[[nodiscard]] std::int64_t available_memory_bytes();

}  // namespace alcap
