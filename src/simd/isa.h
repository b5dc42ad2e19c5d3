// SPDX-License-Identifier: MIT
//
// isa.h: the instruction sets for which hot loops are compiled, and which of them this machine has.
#pragma once

#include <vector>

namespace alcap::detail {

/// Instruction sets with a compiled copy of the loops. `scalar` computes one triangle and one angle at a time, for
/// comparison; `portable` in 16-byte packs on any processor; avx2 and avx512 in 32- and 64-byte packs.
enum class Isa { scalar, portable, avx2, avx512 };

/// The sets this machine can run, slowest first; always begins with scalar and portable.
[[nodiscard]] std::vector<Isa> available_isas();

/// The last of available_isas(), found once.
[[nodiscard]] Isa best_isa();

/// "scalar", "portable", "avx2" or "avx512".
[[nodiscard]] const char* name(Isa isa);

}  // namespace alcap::detail
