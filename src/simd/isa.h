// SPDX-License-Identifier: MIT
//
// isa.h: the instruction sets for which hot loops are compiled, and which of them this machine has.
#pragma once

#include <vector>

namespace alcap::detail {

/// Instruction sets with a compiled copy of the loops: one number at a time; 16-, 32- and 64-byte packs.
enum class Isa { scalar, sse2, avx2, avx512 };

/// The sets this machine can run, slowest first; always begins with scalar.
[[nodiscard]] std::vector<Isa> available_isas();

/// The last of available_isas(), found once.
[[nodiscard]] Isa best_isa();

[[nodiscard]] const char* name(Isa isa);

/// Throws OptionError when `isa` is not available here.
void require_isa(Isa isa);

}  // namespace alcap::detail
