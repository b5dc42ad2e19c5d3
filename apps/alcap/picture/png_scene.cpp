// SPDX-License-Identifier: MIT
//
// png_scene.cpp: meshes, curves and singularities as triangles.
#include "apps/alcap/picture/png_scene.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "alcap/generators.h"
#include "src/base/parallel.h"

namespace alcap::app {
namespace {

using Point = Eigen::RowVector3d;

// Edges sharper than this stay sharp: smoothing over them shows as dents in CAD models.
constexpr double crease = 0.71;  // cosine of 45 degrees

Positions<double> face_normals(const PictureScene& scene) {
  Positions<double> normals(scene.mesh.faces(), 3);
  parallel_for(scene.mesh.faces(), [&](std::int64_t t) {
    const auto& F = scene.mesh.F();
    const Point a = scene.V.row(F(t, 0)), b = scene.V.row(F(t, 1)), c = scene.V.row(F(t, 2));
    normals.row(t) = (b - a).cross(c - a).stableNormalized();
  });
  return normals;
}

void put(float* to, const Point& x) {
  for (int c = 0; c < 3; ++c) to[c] = static_cast<float>(x[c]);
}

Point at(const PictureScene& scene, Index face, const double* b) {
  const auto& F = scene.mesh.F();
  return b[0] * scene.V.row(F(face, 0)) + b[1] * scene.V.row(F(face, 1)) + b[2] * scene.V.row(F(face, 2));
}

constexpr std::size_t band_floats = 12;

/// Both vertices of a band at one point of its line.
void put_band(float* to, const Point& x, const Point& normal, const Point& tangent, double width, double arc) {
  for (const float side : {-1.0F, 1.0F}) {
    put(to, x);
    put(to + 3, normal);
    put(to + 6, tangent);
    to[9] = side;
    to[10] = static_cast<float>(width);
    to[11] = static_cast<float>(arc);
    to += band_floats;
  }
}

/// Corners around the faces of an octahedron around the origin.
std::vector<Point> octahedron() {
  std::vector<Point> corners;
  for (const double x : {1.0, -1.0})
    for (const double y : {1.0, -1.0})
      for (const double z : {1.0, -1.0}) {
        const bool turned = x * y * z < 0;  // counter-clockwise from outside
        for (const Point& p :
             {Point(x, 0, 0), turned ? Point(0, 0, z) : Point(0, y, 0), turned ? Point(0, y, 0) : Point(0, 0, z)})
          corners.push_back(p);
      }
  return corners;
}

}  // namespace

Camera make_camera(const PictureScene& scene, const PictureOptions& options) {
  const double azimuth = options.view[0] * pi<double> / 180, elevation = options.view[1] * pi<double> / 180;
  Eigen::Vector3d eye(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                      std::cos(azimuth) * std::cos(elevation));
  Eigen::Vector3d right(std::cos(azimuth), 0, -std::sin(azimuth));
  if (options.up == 'z') {
    eye = Eigen::Vector3d(eye[0], -eye[2], eye[1]);
    right = Eigen::Vector3d(right[0], -right[2], 0);
  }
  Camera camera;
  camera.to_eye.row(0) = right;
  camera.to_eye.row(1) = eye.cross(right);
  camera.to_eye.row(2) = eye;
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  Point box_low = low.transpose(), box_high = high.transpose();
  for (Index v = 0; v < scene.mesh.vertices(); ++v) {
    if (!scene.mesh.referenced(v)) continue;
    const Eigen::Vector3d x = camera.to_eye * scene.V.row(v).transpose();
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
    box_low = box_low.cwiseMin(scene.V.row(v));
    box_high = box_high.cwiseMax(scene.V.row(v));
  }
  camera.diagonal = (box_high - box_low).norm();
  constexpr double margin = 1.12;
  const double aspect = double(options.size[0]) / options.size[1];
  const Eigen::Vector3d half = (high - low) / 2, centre = (high + low) / 2;
  const double height = margin * std::max({half[1], half[0] / aspect, 1e-6 * camera.diagonal});
  const double depth = half[2] + 0.1 * camera.diagonal;
  camera.extent = {height * aspect, height, 2 * depth};
  Eigen::Matrix4d m = Eigen::Matrix4d::Zero();
  const double scale[] = {1 / camera.extent[0], 1 / camera.extent[1], -1 / depth};
  for (int r = 0; r < 3; ++r) {
    m.block<1, 3>(r, 0) = scale[r] * camera.to_eye.row(r);
    m(r, 3) = -scale[r] * centre[r];
  }
  m(3, 3) = 1;
  camera.matrix = m.cast<float>();
  return camera;
}

std::vector<float> surface_vertices(const PictureScene& scene) {
  const Positions<double> normals = face_normals(scene);
  std::vector<float> out(static_cast<std::size_t>(scene.mesh.halfedges()) * 6);
  parallel_for(scene.mesh.halfedges(), [&](std::int64_t corner) {
    const auto h = static_cast<Index>(corner);
    const Point own = normals.row(Mesh::face(h));
    Point sum = Point::Zero();
    scene.mesh.for_each_outgoing(scene.mesh.tail(h), [&](Index g) {
      const Point other = normals.row(Mesh::face(g));
      if (own.dot(other) < crease) return;
      const Point x = scene.V.row(scene.mesh.tail(g)), a = Point(scene.V.row(scene.mesh.tip(g))) - x,
                  b = Point(scene.V.row(scene.mesh.tail(Mesh::prev(g)))) - x;
      sum += std::atan2(a.cross(b).norm(), a.dot(b)) * other;
    });
    put(&out[6 * static_cast<std::size_t>(h)], scene.V.row(scene.mesh.tail(h)));
    put(&out[6 * static_cast<std::size_t>(h) + 3], sum.isZero(0) ? own : Point(sum.stableNormalized()));
  });
  return out;
}

Bands curve_bands(const PictureScene& scene, double taper) {
  const CurveSet& curves = scene.curves;
  const Positions<double> normals = face_normals(scene);
  Bands bands;
  bands.vertices.resize(static_cast<std::size_t>(curves.points.rows()) * 2 * band_floats);
  for (std::int64_t k = 0; k < curves.size(); ++k) {
    const std::int64_t begin = curves.offsets[static_cast<std::size_t>(k)],
                       end = curves.offsets[static_cast<std::size_t>(k) + 1];
    const double length = curves.length(k);
    const auto tapers = [](CurveEnd e) {
      return e == CurveEnd::separation || e == CurveEnd::length || e == CurveEnd::stuck || e == CurveEnd::budget;
    };
    const bool at_start = tapers(curves.start_reason[static_cast<std::size_t>(k)]),
               at_end = tapers(curves.end_reason[static_cast<std::size_t>(k)]);
    double arc = 0;
    for (std::int64_t i = begin; i < end; ++i) {
      if (i > begin) arc += (curves.points.row(i) - curves.points.row(i - 1)).norm();
      const Point tangent = curves.points.row(std::min(i + 1, end - 1)) - curves.points.row(std::max(i - 1, begin));
      const Point normal = normals.row(curves.faces[static_cast<std::size_t>(i)]) +
                           normals.row(curves.faces[static_cast<std::size_t>(std::min(i + 1, end - 1))]);
      double width = 1;
      if (at_start) width = std::min(width, 0.25 + arc / taper);
      if (at_end) width = std::min(width, 0.25 + (length - arc) / taper);
      put_band(&bands.vertices[static_cast<std::size_t>(2 * i) * band_floats], curves.points.row(i),
               normal.stableNormalized(), tangent.stableNormalized(), std::max(width, 0.0), arc);
      if (i == begin) continue;
      const auto a = static_cast<std::uint32_t>(2 * i - 2);
      for (const std::uint32_t corner : {0U, 1U, 2U, 2U, 1U, 3U}) bands.indices.push_back(a + corner);
    }
  }
  return bands;
}

Bands arm_bands(const PictureScene& scene, int sign, const MarkSizes& sizes) {
  Bands bands;
  const auto& F = scene.mesh.F();
  for (const Singularity& s : scene.singularities) {
    if (scene.n == 0 || (s.index > 0) != (sign > 0)) continue;
    const Point a = scene.V.row(F(s.face, 0)), b = scene.V.row(F(s.face, 1)), c = scene.V.row(F(s.face, 2));
    const Point x = (b - a).stableNormalized(), normal = (b - a).cross(c - a).stableNormalized(), y = normal.cross(x);
    const Point centre = at(scene, s.face, s.barycentric.data());
    const int count = scene.n - sign;  // of a zero of one n-th
    for (int k = 0; k < count; ++k) {
      const double angle = s.orientation + 2 * pi<double> * k / count;
      const Point along = std::cos(angle) * x + std::sin(angle) * y;
      const auto first = static_cast<std::uint32_t>(bands.vertices.size() / band_floats);
      bands.vertices.resize(bands.vertices.size() + 4 * band_floats);
      float* const to = &bands.vertices[first * band_floats];
      put_band(to, centre, normal, along, 1, 0);
      put_band(to + 2 * band_floats, centre + sizes.arm * along, normal, along, 1, sizes.arm);
      for (const std::uint32_t corner : {0U, 1U, 2U, 2U, 1U, 3U}) bands.indices.push_back(first + corner);
    }
  }
  return bands;
}

std::vector<float> mark_vertices(const PictureScene& scene, int sign, const MarkSizes& sizes, bool rim) {
  std::vector<Point> corners, normals;
  if (sign > 0) {
    const MeshData ball = icosphere(3);
    for (Eigen::Index t = 0; t < ball.F.rows(); ++t)
      for (int c = 0; c < 3; ++c) corners.emplace_back(ball.V.row(ball.F(t, c)));
    normals = corners;
  } else {
    corners = octahedron();
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const std::size_t t = k - k % 3;
      normals.push_back(Point(corners[t] + corners[t + 1] + corners[t + 2]).normalized());
    }
  }
  std::vector<float> out;
  for (const Singularity& s : scene.singularities) {
    if ((s.index > 0) != (sign > 0)) continue;
    const Point centre = at(scene, s.face, s.barycentric.data());
    const double large = std::abs(s.index) > 1 ? 1.45 : 1, shape = sign > 0 ? 1 : 1.25;
    const double radius = shape * (large * sizes.radius + (rim ? sizes.rim : 0));
    for (std::size_t k = 0; k < corners.size(); ++k) {
      out.resize(out.size() + 6);
      put(&out[out.size() - 6], centre + radius * corners[k]);
      put(&out[out.size() - 3], normals[k]);
    }
  }
  return out;
}

}  // namespace alcap::app
