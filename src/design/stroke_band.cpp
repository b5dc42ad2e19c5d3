// SPDX-License-Identifier: MIT
#include "src/design/stroke_band.h"

#include <array>
#include <cmath>
#include <functional>
#include <queue>
#include <utility>

#include "alcap/errors.h"
#include "src/base/cancel.h"

namespace alcap::detail {
namespace {

using C = Complex<double>;

struct Reach {
  double distance;
  Index vertex;
  double angle;

  bool operator>(const Reach& other) const {
    return std::pair(distance, vertex) > std::pair(other.distance, other.vertex);
  }
};

using OpenReaches = std::priority_queue<Reach, std::vector<Reach>, std::greater<>>;

/// The corners of the faces that the line crosses, from the middle of each segment.
OpenReaches beside_segments(const Mesh& mesh, const Geometry& geometry, const Connection& connection,
                            const SurfacePolyline& line) {
  OpenReaches open;
  for (const SurfaceSegment& segment : line.segments) {
    const std::array<double, 3> middle = segment.at(0.5);
    // Of the face in its frame.
    const C place[3] = {0, geometry.length(mesh.edge(3 * segment.face)),
                        std::polar(geometry.length(mesh.edge(3 * segment.face + 2)), geometry.angle(3 * segment.face))};
    const C x = middle[1] * place[1] + middle[2] * place[2];
    for (Index c = 0; c < 3; ++c)
      open.push({std::abs(place[c] - x), mesh.F()(segment.face, c),
                 std::arg(segment.tangent) + connection.rho_t[3 * segment.face + c]});
  }
  return open;
}

}  // namespace

std::vector<BandVertex> stroke_band(const Mesh& mesh, const Geometry& geometry, const Connection& connection,
                                    const SurfacePolyline& line, double radius) {
  OpenReaches open = beside_segments(mesh, geometry, connection, line);
  std::vector<BandVertex> band;
  std::vector<bool> reached(static_cast<std::size_t>(mesh.vertices()), false);
  std::int64_t steps = 0;
  while (!open.empty()) {
    check_cancelled_at(steps++);
    const Reach at = open.top();
    open.pop();
    if (at.distance >= radius) break;
    if (reached[static_cast<std::size_t>(at.vertex)]) continue;
    reached[static_cast<std::size_t>(at.vertex)] = true;
    double area = 0;
    const auto step = [&](Index h, double sign) {
      const Index other = sign > 0 ? mesh.tip(h) : mesh.tail(h);
      open.push({at.distance + geometry.length(mesh.edge(h)), other, at.angle - sign * connection.rho_along(mesh, h)});
    };
    mesh.for_each_outgoing(at.vertex, [&](Index h) {
      area += geometry.area(mesh.face(h)) / 3;
      step(h, 1);
      const Index before = mesh.prev(h);
      if (mesh.twin(before) == none) step(before, -1);
    });
    const double density = (1 - at.distance / radius) / radius;
    band.push_back({at.vertex, at.distance, at.angle, area * density, density});
  }
  if (band.empty()) throw OptionError("radius", radius, "is too small: no vertex is that close to the stroke");
  return band;
}

}  // namespace alcap::detail
