// SPDX-License-Identifier: MIT
//
// alignment.h: fields of the surface itself to align designs with.
//
//   auto q = alcap::curvature_field(connected, {.n = 4});
//   alcap::Designer designer(connected, {.n = 4, .t = 0.0});
//   designer.set_guidance(q.u / rms);   // Knoeppel et al. 2013, Sec. 6.3: (S - lambda_t M) u = M q
#pragma once

#include <memory>

#include "alcap/field.h"
#include "alcap/geometry.h"

namespace alcap {

class Surface;
class ConnectedSurface;

/// How directions of curvature are estimated.
struct CurvatureOptions {
  int n = 4;              // even: principal directions are lines. 4 asks for both
  bool smallest = false;  // n = 2, 6, ...: along the direction of least curvature instead of the largest
  /// Largest and least by magnitude instead of by sign: along the bend of a cylinder from inside and from outside
  /// alike. By sign, a cylinder whose normals point inwards has its largest curvature, zero, along its axis.
  bool by_magnitude = false;
  int rings = 1;  // means over so many rings of neighbours: 0 is raw, one takes most of a scan's noise
};

/// Directions of principal curvature, as an n-vector field whose length is half the difference of the principal
/// curvatures: long where the surface knows a direction, zero on spheres and planes. From the normal cycle
/// (Cohen-Steiner, Morvan 2003): every edge bends the surface by its dihedral angle across itself. Curvature is
/// positive where the surface is convex as seen along its normals, so that turning all faces over exchanges largest and
/// least (see by_magnitude). O(F). Zero at unreferenced vertices. Throws
/// OptionError for odd n, rings < 0, and on a surface that lies in no space.
[[nodiscard]] Field curvature_field(const ConnectedSurface& surface, const CurvatureOptions& options = {});

/// Root mean square of |u| over the surface, with every vertex weighed by a third of its faces' area.
[[nodiscard]] double root_mean_square(const Surface& surface, const ComplexVectorX<double>& u);
[[nodiscard]] double root_mean_square(const Mesh& mesh, const Geometry& geometry, const ComplexVectorX<double>& u);

}  // namespace alcap
