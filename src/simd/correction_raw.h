// SPDX-License-Identifier: MIT
//
// correction_raw.h: the arrays of src/correction_system.h, and the loops over them that are compiled for several
// instruction sets. Only pointers and numbers: these files must not pull in inline functions that the linker could
// share with baseline code.
//
// The exchange has a row of four numbers for each side of an edge: mean, difference, tau, and one without meaning.
#pragma once

#include <cstdint>

namespace alcap::detail::simd {

/// Faces, pairs or edges that are worked on together, one array per quantity.
inline constexpr int block_size = 64;

template <class S>
struct FaceArrays {
  S p[3][block_size], stiffness[block_size], inverse[6][block_size];
};

template <class S>
struct FaceBlock {
  FaceArrays<S> face;
  std::uint32_t row[3][block_size];  // of the exchange, for its halfedges
};

/// Two faces that share their halfedges 0.
template <class S>
struct PairBlock {
  FaceArrays<S> face[2];
  S inverse[6][block_size];             // for the edge between
  std::uint32_t row[2][2][block_size];  // for halfedges 1 and 2 of each
};

template <class S>
struct EdgeBlock {
  S p[3][block_size], s[3][block_size], x[3][block_size], r[3][block_size], u[6][block_size];
  std::uint64_t open;  // bit l: edge l has no second face
};

/// Loops over `count` blocks. They add to sums[0 ... block_size - 1], lane by lane.
template <class S>
struct CorrectionLoops {
  /// Relaxes faces in the state that the exchange shows, writes their answers in its place, and adds z' A z.
  void (*faces)(const FaceBlock<S>* blocks, long long count, S* exchange, S* sums);
  /// The same for pairs.
  void (*pairs)(const PairBlock<S>* blocks, long long count, S* exchange, S* sums);
  /// From a right-hand side in r: x = 0, r in the variables of the iteration, shows P r and adds r' P r. `exchange`
  /// begins with the rows of the first block, in this and the next.
  void (*begin)(EdgeBlock<S>* blocks, long long count, S* exchange, S* sums);
  /// A step of conjugate gradients with the answers in the exchange; shows the new P r and adds r' P r.
  void (*step)(EdgeBlock<S>* blocks, long long count, S* exchange, S alpha, S beta, S* sums);
};

CorrectionLoops<float> correction_loops_sse2(float);
CorrectionLoops<double> correction_loops_sse2(double);
#if defined(__x86_64__)
CorrectionLoops<float> correction_loops_avx2();
CorrectionLoops<float> correction_loops_avx512();
#endif

}  // namespace alcap::detail::simd
