// SPDX-License-Identifier: MIT
//
// region.h: some faces of all ranks on every rank, for what walks from face to face: strokes through points, targets
// with several zeros. Internal to src/distributed.
#pragma once

#include <vector>

#include "src/distributed/patch.h"

namespace alcap::detail::distributed {

/// The same on all ranks. Faces keep their order, so that walks take the same ways as on one machine.
struct Region {
  std::vector<Index> face;  ///< the user's number of each face, ascending
  std::vector<char> torn;   ///< per face: a neighbour of it is not here
  Mesh mesh;
  Positions<double> V;
  Geometry geometry;

  /// The number here of a user's face, which is here.
  [[nodiscard]] Index find(Index users) const;
};

/// The faces with chosen[t] != 0, per local face, of the rank whose each is (Patch::mine). Throws MeshError.
[[nodiscard]] Region gather_region(const Patch& patch, const std::vector<char>& chosen);

/// Per local face: whether it has a vertex that is at most `rings` edges from a corner of one of these faces of the
/// user's.
[[nodiscard]] std::vector<char> faces_near(const Patch& patch, const std::vector<Index>& faces, int rings);

}  // namespace alcap::detail::distributed
