// SPDX-License-Identifier: MIT
#include "src/mesh/intrinsic_trace.h"

#include <algorithm>
#include <cmath>

#include "src/base/array.h"
#include "src/base/cancel.h"
#include "src/mesh/surface_points.h"

namespace alcap::detail {
namespace {

using C = Complex<double>;

// A walk crosses a few faces per length of an edge; many more than this means lengths too far apart for rounding.
constexpr int longest_trace = 1000000;
// Coordinates below this are those of a corner: lines through it leave in their own direction.
constexpr double at_corner = 1e-12;

double cross(C a, C b) { return a.real() * b.imag() - a.imag() * b.real(); }

/// Corners of a face in its frame: halfedge 3 t runs along the x axis from 0.
std::array<C, 3> face_corners(const Surface& surface, Index t) {
  const Geometry& geometry = surface.geometry();
  const Mesh& mesh = surface.mesh();
  return {0, geometry.length(mesh.edge(3 * t)),
          std::polar(geometry.length(mesh.edge(3 * t + 2)), geometry.angle(3 * t))};
}

C place_of(const std::array<C, 3>& corners, const std::array<double, 3>& b) {
  return b[0] * corners[0] + b[1] * corners[1] + b[2] * corners[2];
}

}  // namespace

std::array<C, 3> IntrinsicTrace::corners(Index t) const { return face_corners(now_.surface, t); }

std::array<double, 3> IntrinsicTrace::barycentric(Index t, C at) const {
  const std::array<C, 3> p = corners(t);
  std::array<double, 3> b{};
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    b[k] = std::max(0.0, cross(p[(k + 1) % 3] - at, p[(k + 2) % 3] - at));
    sum += b[k];
  }
  for (double& x : b) x /= sum;
  return b;
}

/// A walk from the tail of the given halfedge `corner`, at the angle from it, counter-clockwise.
IntrinsicTrace::Walk IntrinsicTrace::leave(Index corner, double angle, double length) const {
  const Mesh& mesh = given_.mesh();
  const Index v = mesh.tail(corner);
  double direction = angle;
  bool before = true;
  mesh.for_each_outgoing(v, [&](Index h) {
    before = before && h != corner;
    if (before) direction += given_.geometry().angle(h);
  });
  const double all = given_.geometry().angle_sum(v);
  // Of a boundary vertex both start along the boundary.
  direction -= now_.turn[v] * all / (2 * pi<double>);
  if (!mesh.boundary_vertex(v)) direction -= all * std::floor(direction / all);
  const Mesh& there = now_.surface.mesh();
  const Geometry& geometry = now_.surface.geometry();
  Index found = there.first(v);
  double passed = 0, sum = 0;
  there.for_each_outgoing(v, [&](Index h) {
    if (sum <= direction || h == found) {
      found = h;
      passed = sum;
    }
    sum += geometry.angle(h);
  });
  const double inside = std::clamp(direction - passed, 0.0, geometry.angle(found));
  return {.face = Mesh::face(found),
          .at = corners(Mesh::face(found))[at(found % 3)],
          .direction = std::polar(1.0, geometry.direction(found) + inside),
          .left = length,
          .entered = none};
}

template <class Passed>
void IntrinsicTrace::follow(Walk& walk, Passed&& passed) const {
  const Mesh& mesh = now_.surface.mesh();
  for (int step = 0; step < longest_trace; ++step) {
    check_cancelled_at(step);
    const std::array<C, 3> p = corners(walk.face);
    Index out = none;
    double nearest = walk.left;
    for (std::size_t k = 0; k < 3; ++k) {
      const Index h = 3 * walk.face + static_cast<Index>(k);
      const C edge = p[(k + 1) % 3] - p[k];
      const double outwards = -cross(edge, walk.direction);  // its interior is on the left
      // A boundary is left by rounding only, and lines along it run in it.
      if (h == walk.entered || mesh.twin(h) == none || !(outwards > 0)) continue;
      const double distance = std::max(0.0, cross(edge, walk.at - p[k]) / outwards);
      if (distance < nearest) nearest = distance, out = h;
    }
    const C end = walk.at + nearest * walk.direction;
    passed(walk.face, walk.at, end);
    walk.at = end;
    walk.left -= nearest;
    if (out == none) return;
    const Index in = mesh.twin(out);
    const std::array<C, 3> q = corners(Mesh::face(in));
    const std::size_t i = at(out % 3), j = at(in % 3);
    const C edge = p[(i + 1) % 3] - p[i], same = q[j] - q[(j + 1) % 3];
    const C turn = same / edge * (std::abs(edge) / std::abs(same));
    walk.at = q[(j + 1) % 3] + (walk.at - p[i]) * turn;
    walk.direction *= turn;
    walk.face = Mesh::face(in);
    walk.entered = in;
  }
  throw SolveError("a line crosses too many triangles of the intrinsic triangulation");
}

IntrinsicTrace::Place IntrinsicTrace::point(const SurfacePoint& given) const {
  const std::array<C, 3> p = face_corners(given_, given.face);
  const C x = place_of(p, given.barycentric);
  std::size_t k = 0;
  for (std::size_t i = 1; i < 3; ++i)
    if (std::abs(x - p[i]) < std::abs(x - p[k])) k = i;
  const Index corner = 3 * given.face + static_cast<Index>(k);
  const double whole = given_.geometry().angle(corner), along = given_.geometry().direction(corner);
  // At a corner itself, straight into the face.
  const bool there = given.barycentric[k] >= 1 - at_corner;
  const double angle =
      there ? whole / 2 : std::clamp(std::remainder(std::arg(x - p[k]) - along, 2 * pi<double>), 0.0, whole);
  Walk walk = leave(corner, angle, there ? 0.0 : std::abs(x - p[k]));
  follow(walk, [](Index, C, C) {});
  return {{walk.face, barycentric(walk.face, walk.at)}, wrap(std::arg(walk.direction) - (along + angle))};
}

SurfacePolyline IntrinsicTrace::line(const SurfacePolyline& given) const {
  SurfacePolyline out;
  out.closed = given.closed;
  const Mesh& mesh = now_.surface.mesh();
  for (const SurfaceSegment& segment : given.segments) {
    Walk walk;
    std::size_t k = 0;
    for (std::size_t i = 1; i < 3; ++i)
      if (segment.a[i] > segment.a[k]) k = i;
    const Index corner = 3 * segment.face + static_cast<Index>(k);
    if (segment.a[k] >= 1 - at_corner) {
      const double whole = given_.geometry().angle(corner);
      const double angle =
          std::remainder(std::arg(segment.tangent) - given_.geometry().direction(corner), 2 * pi<double>);
      walk = leave(corner, std::clamp(angle, 0.0, whole), segment.length);
    } else {
      const Place start = point({segment.face, segment.a});
      walk = {.face = start.point.face,
              .at = place_of(corners(start.point.face), start.point.barycentric),
              .direction = segment.tangent * std::polar(1.0, start.turn),
              .left = segment.length,
              .entered = none};
    }
    follow(walk, [&](Index t, C from, C to) {
      append_segment(out, mesh, now_.surface.geometry(), t, barycentric(t, from), barycentric(t, to));
    });
  }
  return out;
}

}  // namespace alcap::detail
