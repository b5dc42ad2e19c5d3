// SPDX-License-Identifier: MIT
#include "alcap/strokes.h"

#include <algorithm>
#include <string>

#include "alcap/shortest_path.h"
#include "alcap/surface.h"
#include "src/base/array.h"
#include "src/base/cancel.h"
#include "src/curves/strokes/trace.h"
#include "src/mesh/surface_points.h"

namespace alcap {
namespace {

void append(SurfacePolyline& line, const Mesh& mesh, const Geometry& geometry, const detail::Step& step) {
  detail::append_segment(line, mesh, geometry, step.face, step.a, step.b);
}

bool before(const SurfacePoint& p, const SurfacePoint& q) {
  return p.face != q.face ? p.face < q.face : p.barycentric < q.barycentric;
}

bool connected(const Mesh& mesh, Index from, Index to) {
  std::vector<bool> seen(detail::at(mesh.faces()), false);
  std::vector<Index> stack{from};
  seen[detail::at(from)] = true;
  while (!stack.empty()) {
    const Index t = stack.back();
    stack.pop_back();
    if (t == to) return true;
    for (Index h = 3 * t; h < 3 * t + 3; ++h) {
      const Index g = mesh.twin(h);
      if (g == none || seen[detail::at(g / 3)]) continue;
      seen[detail::at(g / 3)] = true;
      stack.push_back(g / 3);
    }
  }
  return false;
}

}  // namespace

SurfacePolyline stroke_through_points(const Surface& surface, const std::vector<SurfacePoint>& points) {
  const Mesh& mesh = surface.mesh();
  const Positions<double>& V = surface.positions();
  const Geometry& geometry = surface.geometry();
  SurfacePolyline line;
  std::vector<SurfacePoint> at;
  std::vector<std::size_t> number;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const SurfacePoint p = detail::checked_point(mesh, points[k], k);
    if (!at.empty() && detail::same_point(mesh, at.back(), p)) continue;
    at.push_back(p);
    number.push_back(k);
  }
  if (at.size() < 2)
    throw OptionError("points", std::to_string(points.size()) + " points", "a stroke has at least two different ones");
  for (std::size_t k = 0; k + 1 < at.size(); ++k) {
    // Always from the smaller to the larger one, so that a reversed stroke is the same.
    const bool turn = before(at[k + 1], at[k]);
    auto steps = detail::trace(mesh, V, at[turn ? k + 1 : k], at[turn ? k : k + 1]);
    if (!steps)
      throw OptionError("points", std::to_string(number[k]) + " and " + std::to_string(number[k + 1]),
                        connected(mesh, at[k].face, at[k + 1].face)
                            ? "the stroke leaves the surface between these points; points between them may help"
                            : "these points lie on different components of the mesh");
    if (turn) {
      std::reverse(steps->begin(), steps->end());
      for (detail::Step& step : *steps) std::swap(step.a, step.b);
    }
    for (const detail::Step& step : *steps) append(line, mesh, geometry, step);
  }
  if (line.segments.empty()) throw OptionError("points", "all at one place", "a stroke needs some length");
  line.closed = at.size() > 2 && detail::same_point(mesh, at.front(), at.back());
  return line;
}

SurfacePolyline stroke_along_vertices(const Surface& surface, const std::vector<Index>& vertices) {
  const Mesh& mesh = surface.mesh();
  const Geometry& geometry = surface.geometry();
  for (std::size_t k = 0; k < vertices.size(); ++k)
    if (vertices[k] < 0 || vertices[k] >= mesh.vertices() || !mesh.referenced(vertices[k]))
      throw OptionError("vertices[" + std::to_string(k) + "]", vertices[k], "must be a vertex that a face uses");
  SurfacePolyline line;
  for (std::size_t k = 0; k + 1 < vertices.size(); ++k) {
    const Index a = vertices[k], b = vertices[k + 1];
    if (a == b) continue;
    const std::vector<Index> path = mesh.edge(a, b) != none ? std::vector<Index>{a, b} : shortest_path(surface, a, b);
    if (path.empty())
      throw OptionError("vertices", std::to_string(a) + " and " + std::to_string(b),
                        "these vertices lie on different components of the mesh");
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      const Index h = mesh.halfedge(mesh.edge(path[i], path[i + 1]));
      detail::Step step{h / 3, detail::on_halfedge(h, 0).barycentric, detail::on_halfedge(h, 1).barycentric};
      if (mesh.tail(h) != path[i]) std::swap(step.a, step.b);
      append(line, mesh, geometry, step);
    }
  }
  if (line.segments.empty())
    throw OptionError("vertices", std::to_string(vertices.size()) + " vertices",
                      "a stroke has at least two different ones");
  line.closed = vertices.size() > 2 && vertices.front() == vertices.back();
  return line;
}

SurfacePolyline stroke_from_space(const Surface& surface, const SurfaceLocator& locator,
                                  const Positions<double>& points) {
  std::vector<SurfacePoint> on_surface;
  for (Eigen::Index k = 0; k < points.rows(); ++k) on_surface.push_back(locator.closest(points.row(k)));
  return stroke_through_points(surface, on_surface);
}

SurfacePolyline stroke_from_space(const Surface& surface, const Positions<double>& points) {
  return stroke_from_space(surface, SurfaceLocator(surface), points);
}

}  // namespace alcap
