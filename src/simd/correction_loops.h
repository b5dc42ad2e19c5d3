// SPDX-License-Identifier: MIT
//
// correction_loops.h: the arrays of src/connection/global/system.h, and the loops over them (part of loops.h). Only
// pointers and numbers.
//
// The exchange has a row of four numbers for each side of an edge: mean, difference, tau, and one without meaning. It
// holds what the face on that side sees, then, in the same place, the forces that the face answers with.
#pragma once

#include <cstdint>
#include <type_traits>

#include "alcap/index.h"
#include "kernels/face_relaxation.h"

namespace alcap::detail::simd {

/// A row of the exchange: there are two for every edge, as many as halfedges and a few more.
using ExchangeRow = std::make_unsigned_t<Index>;

/// Faces, pairs or edges that are worked on together, one array per quantity.
inline constexpr int block_size = 64;

/// kernels::FaceCoefficients of many faces.
template <class S, int size = block_size>
struct FaceArrays {
  S weight[3][size], stiffness[size], inverse[6][size];
};

template <class S>
struct FaceBlock {
  FaceArrays<S> face;
  ExchangeRow row[3][block_size];  // of the exchange, for its halfedges
};

/// Two faces that share their halfedges 0.
template <class S>
struct PairBlock {
  FaceArrays<S> face[2];
  S inverse[6][block_size];           // for the edge between
  ExchangeRow row[2][2][block_size];  // for halfedges 1 and 2 of each
};

/// The vectors of conjugate gradients, in variables in which the 3 x 3 block of every edge is the identity.
template <class S>
struct IterationArrays {
  S direction[3][block_size], image[3][block_size];  // image: of the direction, under the matrix
  S solution[3][block_size], residual[3][block_size];
};

template <class S>
struct EdgeBlock {
  union {
    S own[2][6][block_size];       // during setup: the blocks [mm md mt dd dt tt] of the edges' two faces
    IterationArrays<S> iteration;  // afterwards
  };
  S whitening[6][block_size];  // kernels::whiten_symmetric() of the sum of both
  std::uint64_t open;          // bit l: edge l has no second face
};

/// Loops over `count` blocks. They add to sums[0 ... block_size - 1], lane by lane.
template <class S>
struct CorrectionLoops {
  /// Relaxes faces in the state z that the exchange shows, writes their forces in its place, and adds z' A z.
  void (*faces)(const FaceBlock<S>* blocks, long long count, S* exchange, S* sums);
  /// The same for pairs.
  void (*pairs)(const PairBlock<S>* blocks, long long count, S* exchange, S* sums);
  /// From a right-hand side in the residual: solution 0, residual r in the variables of the iteration, shows P r to the
  /// faces and adds r' P r. `exchange` begins with the rows of the first block, in this and the next.
  void (*begin)(EdgeBlock<S>* blocks, long long count, S* exchange, S* sums);
  /// A step of conjugate gradients with the forces in the exchange; shows the new P r and adds r' P r.
  void (*step)(EdgeBlock<S>* blocks, long long count, S* exchange, S alpha, S beta, S* sums);
};

/// Faces or pairs that are worked on together in double, in the setup and in gradients.
inline constexpr int group_size = 8;

using GroupArray = double[group_size];

/// A halfedge's weight is its factor times the capped tangent of the angle opposite.
struct FaceShapes {
  GroupArray cot[3], factor[3];
};

using FaceGroup = FaceArrays<double, group_size>;
using GroupState = kernels::FaceState<GroupArray>;

/// The functions of kernels/face_relaxation.h of the same names, for a group.
struct GroupLoops {
  void (*coefficients)(const FaceShapes& shapes, double cap, FaceGroup& c);
  void (*own_blocks)(const FaceGroup& c, GroupArray (&own)[3][6]);
  void (*between)(const FaceGroup (&c)[2], GroupArray (&inverse)[6]);
  void (*outer_blocks)(const FaceGroup (&c)[2], const GroupArray (&inverse)[6], GroupArray (&outer)[2][2][6]);
  void (*relax)(const FaceGroup& c, GroupState& v, GroupArray (&moved)[3]);
  void (*relax_pair)(const FaceGroup (&c)[2], const GroupArray (&inverse)[6], GroupState (&v)[2],
                     GroupArray (&moved)[2][3], GroupArray (&between)[3]);
};

}  // namespace alcap::detail::simd
