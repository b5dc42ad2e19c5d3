// SPDX-License-Identifier: MIT
//
// intrinsic_trace.h: points, directions and lines of a surface as its intrinsic triangulation sees them. Internal.
//
// A point of a given face lies straight from a corner of it: at an angle of the corner and at a distance. The intrinsic
// triangulation knows that angle (signposts), so the same straight walk there ends at the same point of the surface,
// and a direction keeps its angle to the walk.
#pragma once

#include <array>

#include "alcap/intrinsic.h"
#include "alcap/surface_path.h"

namespace alcap::detail {

/// Keeps references to both.
class IntrinsicTrace {
 public:
  IntrinsicTrace(const Surface& given, const IntrinsicTriangulation& now) : given_(given), now_(now) {}

  /// A point of the triangulation, and how directions there are seen: the angle a in the frame of the given face is
  /// a + turn in that of point.face.
  struct Place {
    SurfacePoint point;
    double turn = 0;
  };
  [[nodiscard]] Place point(const SurfacePoint& given) const;
  /// The same line, in as many segments as it crosses faces of the triangulation.
  [[nodiscard]] SurfacePolyline line(const SurfacePolyline& given) const;

 private:
  /// A straight walk: where it is in the frame of a face, and where it goes.
  struct Walk {
    Index face = none;
    Complex<double> at = 0, direction = 1;
    double left = 0;       // of its length
    Index entered = none;  // the halfedge of `face` it came in by
  };
  [[nodiscard]] Walk leave(Index corner, double angle, double length) const;
  /// To the end, or to the next edge; false: it has ended. `passed` is called with face, start and end in its frame.
  template <class Passed>
  void follow(Walk& walk, Passed&& passed) const;
  [[nodiscard]] std::array<double, 3> barycentric(Index t, Complex<double> at) const;
  [[nodiscard]] std::array<Complex<double>, 3> corners(Index t) const;

  const Surface& given_;
  const IntrinsicTriangulation& now_;
};

}  // namespace alcap::detail
