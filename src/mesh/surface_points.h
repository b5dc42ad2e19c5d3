// SPDX-License-Identifier: MIT
//
// surface_points.h: points of a surface as the faces around them see them, and the segments between them. Internal.
#pragma once

#include <cstddef>
#include <vector>

#include "alcap/surface_path.h"

namespace alcap::detail {

/// points[k] of an argument `points`: on an edge or a vertex where it is closer than 1e-9 of its face to it, with
/// coordinates that sum to 1. Throws OptionError naming it when it is not a point of the mesh.
[[nodiscard]] SurfacePoint checked_point(const Mesh& mesh, const SurfacePoint& p, std::size_t k);

/// Every face that holds the point, which lies on an edge or a vertex where coordinates are exactly zero, with its
/// coordinates there. The point's own face comes first.
[[nodiscard]] std::vector<SurfacePoint> representations(const Mesh& mesh, const SurfacePoint& p);

/// Whether both are the same point, to rounding, though perhaps in different faces.
[[nodiscard]] bool same_point(const Mesh& mesh, const SurfacePoint& p, const SurfacePoint& q);

/// Appends the straight segment from a to b in face t, unless it is so short that it is rounding.
void append_segment(SurfacePolyline& line, const Mesh& mesh, const Geometry& geometry, Index t,
                    const std::array<double, 3>& a, const std::array<double, 3>& b);

}  // namespace alcap::detail
