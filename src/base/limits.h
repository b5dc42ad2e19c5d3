// SPDX-License-Identifier: MIT
//
// limits.h: how large meshes and matrices may be. Everything beyond is refused before an index is computed; below,
// half-edges and places of entries fit.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include "alcap/conventions.h"

namespace alcap::detail {

/// An Index is below 2 to the power of this.
inline constexpr int index_digits = std::numeric_limits<Index>::digits;

/// Faces, and vertices: 3 halfedges per face have numbers.
inline constexpr std::int64_t most_faces = std::numeric_limits<Index>::max() / 3;

/// Vertices or faces of a mesh that no rank holds as a whole: those have numbers, their halfedges only on their rank.
inline constexpr std::int64_t most_numbered = std::numeric_limits<Index>::max();

/// Entries of a sparse matrix, whose places are numbered.
inline constexpr std::int64_t most_entries = std::numeric_limits<Index>::max();

/// For messages about more of them.
[[nodiscard]] inline std::string entries_that_fit() {
  return "at most 2^" + std::to_string(index_digits) + " - 1 fit " + std::to_string(index_digits + 1) +
         "-bit sparse indices";
}

}  // namespace alcap::detail
