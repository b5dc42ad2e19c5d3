// SPDX-License-Identifier: MIT
//
// trace.h: from one point of a mesh to another along a cutting plane. Internal to strokes.
#pragma once

#include <optional>
#include <vector>

#include "alcap/strokes.h"

namespace alcap::detail {

/// A straight step inside a face.
struct Step {
  Index face = none;
  std::array<double, 3> a{}, b{};
};

/// The steps from `from` to `to`, or nothing when no plane leads there. Steps may have no length. Never loops: the
/// plane crosses each face at most once.
[[nodiscard]] std::optional<std::vector<Step>> trace(const Mesh& mesh, const Positions<double>& V,
                                                     const SurfacePoint& from, const SurfacePoint& to);

}  // namespace alcap::detail
