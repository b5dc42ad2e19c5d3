// SPDX-License-Identifier: MIT
//
// triangulate.h: one polygon to triangles on its own corners.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "alcap/conventions.h"

namespace alcap::detail {

/// Most corners of a polygon that is no fan: ear cutting takes quadratic time, and a broken file must not hang us.
inline constexpr std::size_t most_corners = 10000;

/// Appends k - 2 triangles of corner numbers (0 ... k-1, three per triangle) for the polygon with corners
/// V(corners[i]). The fan from corner 0 when none of its triangles is flipped or flat in the plane across the polygon's
/// area vector; otherwise ears are cut in that plane, flat ears last. A polygon without area, or one that crosses
/// itself, still gives k - 2 triangles; checking them is the mesh's business. Returns false, with nothing appended, for
/// a polygon that is no fan and has more than `most_corners` corners, or takes too long.
bool triangulate(const Positions<double>& V, std::span<const Index> corners, std::vector<Index>& triangles);

}  // namespace alcap::detail
