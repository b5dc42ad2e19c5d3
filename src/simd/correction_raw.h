// SPDX-License-Identifier: MIT
//
// correction_raw.h: the arrays of src/connection/global/correction_system.h, and the loops over them that are compiled
// for several instruction sets. Only pointers and numbers: these files must not pull in inline functions that the
// linker could share with baseline code.
//
// The exchange has a row of four numbers for each side of an edge: mean, difference, tau, and one without meaning.
#pragma once

#include <cstdint>

namespace alcap::detail::simd {

/// Faces, pairs or edges that are worked on together, one array per quantity.
inline constexpr int block_size = 64;

template <class S, int size = block_size>
struct FaceArrays {
  S p[3][size], stiffness[size], inverse[6][size];
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

/// Faces or pairs that are worked on together in double, in the setup and in gradients.
inline constexpr int group_size = 8;

using GroupArray = double[group_size];

/// p = factor times the capped tangent of the angle opposite.
struct FaceShapes {
  GroupArray cot[3], factor[3];
};

using FaceGroup = FaceArrays<double, group_size>;

/// The functions of kernels/face_relaxation.h of the same names, for a group.
struct GroupLoops {
  void (*coefficients)(const FaceShapes& shapes, double cap, FaceGroup& c);
  void (*own_blocks)(const FaceGroup& c, GroupArray (&own)[3][6]);
  void (*between)(const FaceGroup (&c)[2], GroupArray (&inverse)[6]);
  void (*outer_blocks)(const FaceGroup (&c)[2], const GroupArray (&inverse)[6], GroupArray (&outer)[2][2][6]);
  void (*relax)(const FaceGroup& c, GroupArray (&v)[3][3], GroupArray (&moved)[3]);
  void (*relax_pair)(const FaceGroup (&c)[2], const GroupArray (&inverse)[6], GroupArray (&v)[2][3][3],
                     GroupArray (&moved)[2][3], GroupArray (&turned)[3]);
};

GroupLoops group_loops_sse2();
CorrectionLoops<float> correction_loops_sse2(float);
CorrectionLoops<double> correction_loops_sse2(double);
#if defined(__x86_64__)
GroupLoops group_loops_avx2();
GroupLoops group_loops_avx512();
CorrectionLoops<float> correction_loops_avx2();
CorrectionLoops<float> correction_loops_avx512();
#endif

}  // namespace alcap::detail::simd
