// SPDX-License-Identifier: MIT
//
// limits.h: how large meshes and matrices may be while Index has 32 bits. Everything beyond is refused before an
// index is computed; below, half-edges and places of entries fit.
#pragma once

#include <cstdint>
#include <limits>

#include "alcap/conventions.h"

namespace alcap::detail {

/// Faces, and vertices: 3 halfedges per face have numbers.
inline constexpr std::int64_t most_faces = std::numeric_limits<Index>::max() / 3;

/// Vertices or faces of a mesh that no rank holds as a whole: those have numbers, their halfedges only on their rank.
inline constexpr std::int64_t most_numbered = std::numeric_limits<Index>::max();

/// Entries of a sparse matrix, whose places are numbered.
inline constexpr std::int64_t most_entries = std::numeric_limits<Index>::max();

}  // namespace alcap::detail
