// SPDX-License-Identifier: MIT
//
// correction_loops.h: picks the loops of correction_raw.h for this machine.
#pragma once

#include "src/simd/correction_raw.h"
#include "src/simd/isa.h"

namespace alcap::detail::simd {

/// The same bits for every instruction set. Throws OptionError when `isa` is not available here.
template <class S>
[[nodiscard]] CorrectionLoops<S> correction_loops(Isa isa);
[[nodiscard]] GroupLoops group_loops(Isa isa);

}  // namespace alcap::detail::simd
