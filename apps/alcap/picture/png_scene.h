// SPDX-License-Identifier: MIT
//
// png_scene.h: a picture's geometry as arrays of floats for the graphics card, and its camera. Knows nothing of OpenGL.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "apps/alcap/picture/png_picture.h"

namespace alcap::app {

/// An orthographic camera that frames the mesh.
struct Camera {
  Eigen::Matrix3d to_eye;  ///< rows: right, up, towards the eye
  Eigen::Matrix4f matrix;  ///< world to clip coordinates
  Eigen::Vector3d extent;  ///< half width, half height and depth of the view, world units
  double diagonal = 0;     ///< of the box around the mesh
};
[[nodiscard]] Camera make_camera(const PictureScene& scene, const PictureOptions& options);

/// Position and normal of every corner of every face, six floats each. Normals are smooth but for creases.
[[nodiscard]] std::vector<float> surface_vertices(const PictureScene& scene);

/// Bands along lines: position, normal, tangent, side, width and arc length, twelve floats a vertex, two vertices a
/// point.
struct Bands {
  std::vector<float> vertices;
  std::vector<std::uint32_t> indices;
};
/// Bands get narrow over `taper` at ends that are not at a boundary and not closed.
[[nodiscard]] Bands curve_bands(const PictureScene& scene, double taper);

/// World units.
struct MarkSizes {
  double radius = 0;  ///< of an index of one n-th; larger ones are larger
  double rim = 0;     ///< by how much a rim stands out
  double arm = 0;     ///< length of the straight branches
};
/// The straight branches of the singularities of this sign.
[[nodiscard]] Bands arm_bands(const PictureScene& scene, int sign, const MarkSizes& sizes);
/// Balls at the singularities of sign 1, octahedra at those of -1, or their rims: position and normal, six floats a
/// vertex.
[[nodiscard]] std::vector<float> mark_vertices(const PictureScene& scene, int sign, const MarkSizes& sizes, bool rim);

}  // namespace alcap::app
