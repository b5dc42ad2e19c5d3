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

detail::StrokePoints detail::distinct_points(const Mesh& mesh, const std::vector<SurfacePoint>& points) {
  StrokePoints out;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const SurfacePoint p = checked_point(mesh, points[k], k);
    if (!out.at.empty() && same_point(mesh, out.at.back(), p)) continue;
    out.at.push_back(p);
    out.number.push_back(k);
  }
  if (out.at.size() < 2)
    throw OptionError("points", std::to_string(points.size()) + " points", "a stroke has at least two different ones");
  return out;
}

bool detail::traced_backwards(const SurfacePoint& p, const SurfacePoint& q) {
  return q.face != p.face ? q.face < p.face : q.barycentric < p.barycentric;
}

SurfacePolyline detail::stroke_through(const Mesh& mesh, const Positions<double>& V, const Geometry& geometry,
                                       const StrokePoints& points,
                                       const std::function<bool(std::size_t k)>& connected) {
  SurfacePolyline line;
  const std::vector<SurfacePoint>& at = points.at;
  for (std::size_t k = 0; k + 1 < at.size(); ++k) {
    const bool turn = traced_backwards(at[k], at[k + 1]);
    auto steps = trace(mesh, V, at[turn ? k + 1 : k], at[turn ? k : k + 1]);
    if (!steps)
      throw OptionError("points", std::to_string(points.number[k]) + " and " + std::to_string(points.number[k + 1]),
                        connected(k)
                            ? "the stroke leaves the surface between these points; points between them may help"
                            : "these points lie on different components of the mesh");
    if (turn) {
      std::reverse(steps->begin(), steps->end());
      for (Step& step : *steps) std::swap(step.a, step.b);
    }
    for (const Step& step : *steps) append(line, mesh, geometry, step);
  }
  if (line.segments.empty()) throw OptionError("points", "all at one place", "a stroke needs some length");
  line.closed = at.size() > 2 && same_point(mesh, at.front(), at.back());
  return line;
}

SurfacePolyline stroke_through_points(const Surface& surface, const std::vector<SurfacePoint>& points) {
  const Mesh& mesh = surface.mesh();
  const detail::StrokePoints distinct = detail::distinct_points(mesh, points);
  return detail::stroke_through(mesh, surface.positions(), surface.geometry(), distinct, [&](std::size_t k) {
    return connected(mesh, distinct.at[k].face, distinct.at[k + 1].face);
  });
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
