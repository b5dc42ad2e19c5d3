// SPDX-License-Identifier: MIT
#include "alcap/surface_path.h"

#include <algorithm>
#include <string>
#include <utility>

#include "src/mesh/position.h"

namespace alcap {

double SurfacePolyline::length() const {
  double sum = 0;
  for (const SurfaceSegment& s : segments) sum += s.length;
  return sum;
}

SurfacePolyline SurfacePolyline::reversed() const {
  SurfacePolyline out{segments, closed};
  std::reverse(out.segments.begin(), out.segments.end());
  for (SurfaceSegment& s : out.segments) {
    std::swap(s.a, s.b);
    s.tangent = -s.tangent;
  }
  return out;
}

Eigen::RowVector3d position(const Surface& surface, const SurfacePoint& point) {
  const Positions<double>& positions = surface.positions();
  const Index faces = surface.mesh().faces();
  if (point.face < 0 || point.face >= faces)
    throw OptionError("point.face", point.face, "there is no such face; the mesh has " + std::to_string(faces));
  return detail::position(surface.mesh(), positions, point);
}

}  // namespace alcap
