// SPDX-License-Identifier: MIT
//
// rows.cpp: stroke terms from the closed-form basis.
//
// p = Im(conj(c^n) u) is a number without a frame, so its derivative along the stroke is that of a function. Inside a
// face the polyline's c is constant; all its turning happens at edges. Differentiating face by face would therefore
// miss the turning, and constant fields would follow every curve for free. Differences of p between the middles of
// faces, where the chord's direction is the curve's to second order, contain it.
#include "src/design/eigen/rows.h"

#include <cmath>
#include <tuple>

#include "src/connection/triangle_frame.h"

namespace alcap::detail {
namespace {

using C = Complex<double>;

// Segments are joined until a piece is this long, relative to the square root of its face's area: tiny segments at
// corners would otherwise turn their share of a bend into a steep derivative.
constexpr double shortest_piece = 0.6;

struct Node {
  double at = 0;  // arc length
  StrokeSample sample;
};

// The middles of the pieces, and both ends of an open stroke.
std::vector<Node> nodes_along(const Mesh& mesh, const Geometry& geometry, const Connection& connection, int n,
                              const SurfacePolyline& line) {
  const auto sample = [&](std::size_t k, double s) {
    return sample_at(mesh, geometry, connection, n, line.segments[k], s);
  };
  const std::size_t count = line.segments.size();
  std::vector<double> start(count + 1, 0.0);
  for (std::size_t k = 0; k < count; ++k) start[k + 1] = start[k] + line.segments[k].length;
  std::vector<std::size_t> ends;  // of pieces
  double wanted = 0;
  for (std::size_t k = 0, first = 0; k < count; ++k) {
    wanted = shortest_piece * std::sqrt(geometry.area(line.segments[k].face));
    if (start[k + 1] - start[first] < wanted && k + 1 < count) continue;
    // A short rest joins the piece before.
    if (start[k + 1] - start[first] < wanted && !ends.empty()) ends.pop_back();
    ends.push_back(k + 1);
    first = k + 1;
  }
  std::vector<Node> nodes;
  if (!line.closed) nodes.push_back({0, sample(0, 0)});
  std::size_t k = 0, first = 0;
  for (const std::size_t end : ends) {
    const double middle = (start[first] + start[end]) / 2;
    while (k + 1 < count && start[k + 1] < middle) ++k;
    nodes.push_back({middle, sample(k, (middle - start[k]) / line.segments[k].length)});
    first = end;
  }
  if (!line.closed) nodes.push_back({start[count], sample(count - 1, 1)});
  return nodes;
}

}  // namespace

StrokeSample sample_at(const Mesh& mesh, const Geometry& geometry, const Connection& connection, int n,
                       const SurfaceSegment& segment, double s) {
  const kernels::TriangleFrame<double> frame = triangle_frame(mesh, geometry, connection, segment.face);
  const std::array<double, 3> b = segment.at(s);
  const double point[3] = {b[0], b[1], b[2]};
  const kernels::BasisAt<double> basis = kernels::basis_at(frame, point, double(n));
  const C turn = std::polar(1.0, -n * std::arg(segment.tangent));
  StrokeSample sample;
  for (Index c = 0; c < 3; ++c) {
    sample.vertex[static_cast<std::size_t>(c)] = mesh.F()(segment.face, c);
    sample.coefficient[static_cast<std::size_t>(c)] = turn * C(basis.value[c].re, basis.value[c].im);
  }
  return sample;
}

std::vector<StrokeSample> samples_along(const Mesh& mesh, const Geometry& geometry, const Connection& connection, int n,
                                        const SurfacePolyline& line) {
  const double offset = std::sqrt(0.15);
  const double at[3] = {0.5 - offset, 0.5, 0.5 + offset}, weight[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
  std::vector<StrokeSample> samples;
  for (const SurfaceSegment& segment : line.segments)
    for (int g = 0; g < 3; ++g) {
      samples.push_back(sample_at(mesh, geometry, connection, n, segment, at[g]));
      samples.back().ds = weight[g] * segment.length;
    }
  return samples;
}

DesignRows stroke_rows(const Mesh& mesh, const Geometry& geometry, const Connection& connection, int n,
                       const SurfacePolyline& given, double offset) {
  // Pieces are counted from one end, always the same, so that a stroke drawn backwards has the same rows.
  const SurfaceSegment &front = given.segments.front(), &back = given.segments.back();
  const bool turn = std::tie(back.face, back.b, back.a) < std::tie(front.face, front.a, front.b);
  const SurfacePolyline line = turn ? given.reversed() : given;
  DesignRows rows;
  for (const StrokeSample& sample : samples_along(mesh, geometry, connection, n, line)) {
    // Re(g u) = Re(conj(conj(g)) u).
    RealRow row;
    for (std::size_t c = 0; c < 3; ++c)
      row.add(sample.vertex[c], std::sqrt(sample.ds) * std::conj(sample.coefficient[c]));
    rows.along.push_back(row);
  }
  const std::vector<Node> nodes = nodes_along(mesh, geometry, connection, n, line);
  const double length = line.length();
  // Im(g u) = Re(-i g u) = Re(conj(i conj(g)) u).
  const auto add = [](RealRow& row, const Node& node, double scale) {
    for (std::size_t c = 0; c < 3; ++c)
      row.add(node.sample.vertex[c], C(0, scale) * std::conj(node.sample.coefficient[c]));
  };
  const auto interval = [&](const Node& a, const Node& b, double ds) {
    if (!(ds > 0)) return;
    RealRow difference;
    add(difference, b, 1 / std::sqrt(ds));
    add(difference, a, -1 / std::sqrt(ds));
    rows.across.push_back(difference);
  };
  const std::size_t count = nodes.size();
  for (std::size_t k = 0; k + 1 < count; ++k) interval(nodes[k], nodes[k + 1], nodes[k + 1].at - nodes[k].at);
  if (line.closed && count > 1) interval(nodes.back(), nodes.front(), length - nodes.back().at + nodes.front().at);
  for (std::size_t k = 0; offset > 0 && k < count; ++k) {
    // Every node speaks for half the way to its neighbours.
    const double before = k > 0 ? nodes[k - 1].at : line.closed ? nodes.back().at - length : nodes[k].at;
    const double after = k + 1 < count ? nodes[k + 1].at : line.closed ? nodes.front().at + length : nodes[k].at;
    RealRow row;
    add(row, nodes[k], std::sqrt(offset * (after - before) / 2));
    rows.across.push_back(row);
  }
  return rows;
}

std::vector<StrokeSample> samples_of_band(const std::vector<BandVertex>& band, int n) {
  std::vector<StrokeSample> samples;
  for (const BandVertex& at : band)
    samples.push_back({.ds = at.share,
                       .vertex = {at.vertex, at.vertex, at.vertex},
                       .coefficient = {std::polar(1.0, -n * at.angle), 0, 0}});
  return samples;
}

DesignRows band_rows(const ConnectedSurface& surface, int n, const std::vector<BandVertex>& band, double offset,
                     bool quarter) {
  const Mesh& mesh = surface.mesh();
  std::vector<const BandVertex*> member(static_cast<std::size_t>(mesh.vertices()), nullptr);
  DesignRows rows;
  for (const BandVertex& at : band) {
    member[static_cast<std::size_t>(at.vertex)] = &at;
    const C direction = std::polar(1.0, n * at.angle);
    rows.along.emplace_back().add(at.vertex, std::sqrt(at.share) * direction);
    // Im(conj(d) u) = Re(conj(i d) u)
    if (offset > 0) rows.across.emplace_back().add(at.vertex, std::sqrt(offset * at.share) * C(0, 1) * direction);
  }
  const auto add_face = [&](Index t) {
    std::array<const BandVertex*, 3> corner{};
    for (Index c = 0; c < 3; ++c) {
      corner[static_cast<std::size_t>(c)] = member[static_cast<std::size_t>(mesh.F()(t, c))];
      if (corner[static_cast<std::size_t>(c)] == nullptr) return;
    }
    const kernels::TriangleFrame<double> frame = triangle_frame(mesh, surface.geometry(), surface.connection(), t);
    C tangent = 0;
    double density = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      tangent += std::polar(1.0, corner[c]->angle - frame.rho[c] - (quarter ? pi<double> / 2 : 0));
      density += corner[c]->density / 3;
    }
    if (!(std::abs(tangent) > 1e-6)) return;  // the line turns back
    tangent /= std::abs(tangent);
    const double scale = std::sqrt(density * surface.geometry().area(t));
    RealRow& row = rows.across.emplace_back();
    for (std::size_t c = 0; c < 3; ++c) {
      const double slope = frame.grad[c].re * tangent.real() + frame.grad[c].im * tangent.imag();
      row.add(corner[c]->vertex, scale * slope * C(0, 1) * std::polar(1.0, n * corner[c]->angle));
    }
  };
  for (Index t = 0; t < mesh.faces(); ++t) add_face(t);
  return rows;
}

}  // namespace alcap::detail
