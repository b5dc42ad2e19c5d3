// SPDX-License-Identifier: MIT
//
// geometry.cpp: measures of triangles.
#include "alcap/geometry.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>
#include <string>

#include "alcap/mesh_check.h"
#include "src/base/array.h"
#include "src/base/pages.h"
#include "src/base/parallel.h"
#include "src/simd/angles.h"

namespace alcap {

Geometry::Geometry(const Mesh& mesh, const Eigen::Ref<const Positions<double>>& V) {
  if (V.rows() != mesh.vertices())
    throw OptionError("V", std::to_string(V.rows()) + " rows",
                      "needs one row per vertex of the mesh, " + std::to_string(mesh.vertices()));
  using Row = Eigen::Matrix<double, 1, 3>;
  const std::int64_t faces = mesh.faces();
  detail::resize_unset(angle_, 3 * faces);
  detail::resize_unset(cot_, 3 * faces);
  detail::resize_unset(area_, faces);
  detail::resize_unset(length_, mesh.edges());
  const bool good = parallel_reduce(
      faces, true,
      [&](std::int64_t begin, std::int64_t end) {
        bool all_good = true;
        // Angles are taken of many corners at a time.
        constexpr std::int64_t block = 256;
        std::array<double, 3 * block> height, width;
        for (std::int64_t first = begin; first < end; first += block) {
          const std::int64_t count = std::min(block, end - first);
          for (std::int64_t i = 0; i < count; ++i) {
            const std::int64_t t = first + i;
            const Row p[3] = {V.row(mesh.F()(t, 0)), V.row(mesh.F()(t, 1)), V.row(mesh.F()(t, 2))};
            // The comparison in degenerate() is false for NaN as well; infinite points give NaN areas.
            all_good &= !degenerate(p[0], p[1], p[2]) && measurable(p[0], p[1], p[2]);
            const Row side[3] = {p[1] - p[0], p[2] - p[1], p[0] - p[2]};
            const double twice_area = side[0].cross(side[1]).norm();
            area_[t] = twice_area / double(2);
            for (Index c = 0; c < 3; ++c) {
              const double dot = -side[c].dot(side[(c + 2) % 3]);
              height[detail::at(3 * i + c)] = twice_area;
              width[detail::at(3 * i + c)] = dot;
              cot_[3 * t + c] = dot / twice_area;
              const Index h = static_cast<Index>(3 * t + c);
              if (mesh.canonical(h)) length_[mesh.edge(h)] = side[c].norm();
            }
          }
          detail::upper_angles(3 * count, height.data(), width.data(), angle_.data() + 3 * first);
        }
        return all_good;
      },
      [](bool a, bool b) { return a && b; });
  if (!good) {
    const std::vector<DefectReport> defects = find_defects(V, mesh.F());
    if (defects.empty()) throw Error("internal error: a face was refused but no defect was found");
    throw_defect(defects.front());
  }
  sum_angles(mesh);
}

namespace {

void check_lengths(const Mesh& mesh, const VectorX<double>& lengths) {
  if (lengths.size() != mesh.edges())
    throw OptionError("lengths", std::to_string(lengths.size()) + " entries",
                      "needs one per edge of the mesh, " + std::to_string(mesh.edges()));
  for (Index e = 0; e < mesh.edges(); ++e)
    if (lengths[e] > largest_length || (lengths[e] > 0 && lengths[e] < 1 / largest_length))
      throw MeshError("edge " + std::to_string(e) + " has the length " + detail::number_text(lengths[e]) +
                          "; lengths must be within 1e-60 and 1e60, so scale the mesh",
                      Defect::scale_out_of_range, Element::edge, 1,
                      {mesh.tail(mesh.halfedge(e)), mesh.tip(mesh.halfedge(e))});
}

void check_areas(const VectorX<double>& areas) {
  for (Index t = 0; t < areas.size(); ++t)
    if (!(areas[t] > double(0)))
      throw MeshError("face " + std::to_string(t) +
                          " has edge lengths that make no triangle; every two sides must be longer than the third",
                      Defect::zero_area_face, Element::face, 1, {t});
}

}  // namespace

Geometry Geometry::from_lengths(const Mesh& mesh, const VectorX<double>& lengths) {
  check_lengths(mesh, lengths);
  Geometry g;
  g.length_ = lengths;
  detail::resize_unset(g.angle_, mesh.halfedges());
  detail::resize_unset(g.cot_, mesh.halfedges());
  detail::resize_unset(g.area_, mesh.faces());
  parallel_for(mesh.faces(), [&](std::int64_t t) {
    double l[3];
    for (Index c = 0; c < 3; ++c) l[c] = lengths[mesh.edge(static_cast<Index>(3 * t + c))];
    // Kahan's stable form of Heron's formula: sides sorted a >= b >= c.
    double a = l[0], b = l[1], c = l[2];
    if (a < b) std::swap(a, b);
    if (b < c) std::swap(b, c);
    if (a < b) std::swap(a, b);
    const double product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
    const double twice_area = std::sqrt(product) / double(2);
    g.area_[t] = twice_area / double(2);
    for (Index k = 0; k < 3; ++k) {
      const double before = l[(k + 2) % 3], after = l[k], opposite = l[(k + 1) % 3];
      const double dot = (before * before + after * after - opposite * opposite) / double(2);
      g.angle_[3 * t + k] = std::atan2(twice_area, dot);
      g.cot_[3 * t + k] = dot / twice_area;
    }
  });
  check_areas(g.area_);
  g.sum_angles(mesh);
  return g;
}

Geometry Geometry::from_measures(const Mesh& mesh, VectorX<double> lengths, VectorX<double> cots,
                                 VectorX<double> areas) {
  check_lengths(mesh, lengths);
  if (cots.size() != mesh.halfedges())
    throw OptionError("cots", std::to_string(cots.size()) + " entries",
                      "needs one per corner of the mesh, " + std::to_string(mesh.halfedges()));
  if (areas.size() != mesh.faces())
    throw OptionError("areas", std::to_string(areas.size()) + " entries",
                      "needs one per face of the mesh, " + std::to_string(mesh.faces()));
  check_areas(areas);
  Geometry g;
  g.length_ = std::move(lengths);
  g.cot_ = std::move(cots);
  g.area_ = std::move(areas);
  detail::resize_unset(g.angle_, mesh.halfedges());
  parallel_for(mesh.halfedges(), [&](std::int64_t c) { g.angle_[c] = std::atan2(1.0, g.cot_[c]); });
  g.sum_angles(mesh);
  return g;
}

void Geometry::sum_angles(const Mesh& mesh) {
  detail::resize_unset(angle_sum_, mesh.vertices());
  parallel_for(mesh.vertices(), [&](std::int64_t v) {
    double sum = 0;
    mesh.for_each_outgoing(static_cast<Index>(v), [&](Index h) { sum += angle_[h]; });
    angle_sum_[v] = sum;
  });
  total_area_ = parallel_sum<double>(mesh.faces(), [&](std::int64_t t) { return area_[t]; });
}

}  // namespace alcap
