// SPDX-License-Identifier: MIT
//
// loops_impl.h: the loops of loops.h for one instruction set. Included once by one file per set, each compiled with its
// own flags, which names a namespace ALCAP_SIMD for its copy and the size of its packs, ALCAP_SIMD_BYTES. The kernels
// are templates over packs with a tag of that namespace, so that no copy shares a function with another. Every lane
// does the same operations in the same order whatever the width: all machines get the same bits.
#pragma once

#if !defined(ALCAP_SIMD) || !defined(ALCAP_SIMD_BYTES)
#error "define ALCAP_SIMD and ALCAP_SIMD_BYTES; see portable.cpp"
#endif

#include "kernels/pack.h"
#include "src/simd/loops.h"

namespace alcap::detail::simd::ALCAP_SIMD {

struct Tag;

/// How many T fit into a register, and a pack of `lanes` of them.
template <class T>
inline constexpr int lanes_of = ALCAP_SIMD_BYTES / static_cast<int>(sizeof(T));
template <class T, int lanes = lanes_of<T>>
using Pack = kernels::Pack<T, lanes, Tag>;

}  // namespace alcap::detail::simd::ALCAP_SIMD

#include "src/simd/block_impl.h"
#include "src/simd/correction_impl.h"
#include "src/simd/element_impl.h"
#include "src/simd/front_impl.h"
#include "src/simd/vector_impl.h"

namespace alcap::detail::simd::ALCAP_SIMD {

const Loops& loops() {
  static constexpr Loops table = {
      .elements_float = element_loops<float>,
      .elements_double = element_loops<double>,
      .correction_float = correction_loops<float>,
      .correction_double = correction_loops<double>,
      .group = group_loops,
      .block_1 = {rows_single, nullptr, nullptr, nullptr},
      .block_4 = block_kernels<4>,
      .block_8 = block_kernels<8>,
      .block_16 = block_kernels<16>,
      .vector_4 = vector_kernels<4>,
      .vector_8 = vector_kernels<8>,
      .vector_16 = vector_kernels<16>,
      .front = front_loops,
  };
  return table;
}

}  // namespace alcap::detail::simd::ALCAP_SIMD
