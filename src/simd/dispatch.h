// SPDX-License-Identifier: MIT
//
// dispatch.h: the table of loops for an instruction set, picked at run time. A new set is a file like avx2.cpp, its
// flags in cmake/simd.cmake, a name in isa.h and a line in dispatch.cpp.
#pragma once

#include "src/simd/isa.h"
#include "src/simd/loops.h"

namespace alcap::detail::simd {

/// Every table gives the same bits. Throws OptionError when `isa` is not available here.
[[nodiscard]] const Loops& loops(Isa isa = best_isa());

/// Those over triangles and angles in float or double.
template <class T>
[[nodiscard]] const ElementLoops<T>& element_loops(Isa isa) {
  if constexpr (sizeof(T) == sizeof(float))
    return loops(isa).elements_float;
  else
    return loops(isa).elements_double;
}

/// Those of the globally optimal connection's conjugate gradients in float or double.
template <class T>
[[nodiscard]] const CorrectionLoops<T>& correction_loops(Isa isa) {
  if constexpr (sizeof(T) == sizeof(float))
    return loops(isa).correction_float;
  else
    return loops(isa).correction_double;
}

}  // namespace alcap::detail::simd
