// SPDX-License-Identifier: MIT
//
// stroke_band.h: the hat-shaped footprint of a stroke with a radius. Internal to design.
#pragma once

#include <vector>

#include "alcap/connection.h"
#include "alcap/strokes.h"

namespace alcap::detail {

/// A vertex within the radius of a stroke.
struct BandVertex {
  Index vertex = none;
  double distance = 0;  ///< along edges, from the nearest middle of a segment
  /// Radians in the vertex frame: the tangent of that segment, carried along these edges by the connection.
  double angle = 0;
  /// Of the stroke's length: the vertex' area times the hat 1 - distance / radius, over the radius. The sum is the
  /// length of the line wherever the surface is flat and fine: a weight is spread, not multiplied.
  double share = 0;
  double density = 0;  ///< hat / radius: share per area
};

/// In order of distance. Throws OptionError (radius) where no vertex is that close.
[[nodiscard]] std::vector<BandVertex> stroke_band(const Mesh& mesh, const Geometry& geometry,
                                                  const Connection& connection, const SurfacePolyline& line,
                                                  double radius);

}  // namespace alcap::detail
