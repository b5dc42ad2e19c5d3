// SPDX-License-Identifier: MIT
#include "alcap/sizing.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <utility>
#include <vector>

#include "src/base/array.h"
#include "src/base/cancel.h"
#include "src/base/parallel.h"

namespace alcap {
namespace {

using detail::at;
using Bending = Eigen::Matrix3d;
using Point = Eigen::RowVector3d;

void check_sizing(const SizingOptions& o) {
  const auto positive = [](const char* field, double value) {
    if (!(value > 0 && std::isfinite(value))) throw OptionError(field, value, "must be above 0 and finite");
  };
  positive("error", o.error);
  positive("smallest", o.smallest);
  positive("largest", o.largest);
  if (o.largest < o.smallest) throw OptionError("largest", o.largest, "must not be below smallest");
  if (!(o.growth >= 0 && std::isfinite(o.growth))) throw OptionError("growth", o.growth, "must not be negative");
  if (o.rings < 0) throw OptionError("rings", o.rings, "must not be negative");
}

double box_diagonal(const Surface& surface) {
  const Positions<double>& V = surface.V();
  Point low = Point::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (Index v = 0; v < surface.mesh().vertices(); ++v) {
    if (!surface.mesh().referenced(v)) continue;
    low = low.cwiseMin(V.row(v));
    high = high.cwiseMax(V.row(v));
  }
  return (high - low).stableNorm();
}

/// The chord whose middle is `error` away from a circle of this curvature; of circles no larger than that, their
/// diameter is the most there is.
double chord(double curvature, double error) {
  const double radius = 1 / curvature;
  return 2 * std::sqrt(error * std::max(2 * radius - error, radius));
}

/// Integral of the curvature tensor over each vertex's share, and that share. Edge e bends by its angle across itself;
/// the tensor of a symmetric bend b e e' has the same eigenvalues as that of the direction across, exchanged.
struct Shares {
  std::vector<Bending> bending;
  VectorX<double> area;
};

Shares vertex_shares(const Surface& surface, const std::vector<bool>& is_feature) {
  const Mesh& mesh = surface.mesh();
  const Positions<double>& V = surface.V();
  VectorX<double> angle(mesh.edges());
  parallel_for(mesh.edges(), [&](std::int64_t e) {
    angle[e] = is_feature[at(e)] ? 0.0 : dihedral_angle(surface, static_cast<Index>(e));
  });
  Shares shares{std::vector<Bending>(at(mesh.vertices())), VectorX<double>::Zero(mesh.vertices())};
  parallel_for(mesh.vertices(), [&](std::int64_t i) {
    Bending sum = Bending::Zero();
    const auto add = [&](Index h) {
      const Point along = V.row(mesh.tip(h)) - V.row(mesh.tail(h));
      const double length = along.stableNorm();
      sum += angle[mesh.edge(h)] / (2 * length) * along.transpose() * along;
    };
    mesh.for_each_outgoing(static_cast<Index>(i), [&](Index h) {
      shares.area[i] += surface.geometry().area(Mesh::face(h)) / 3;
      add(h);
      if (mesh.boundary_halfedge(Mesh::prev(h))) add(Mesh::prev(h));
    });
    shares.bending[at(i)] = sum;
  });
  return shares;
}

/// Sums over the neighbours, so that the quotient is a mean over one more ring. Not over vertices on features, whose
/// share lies on both sides: what is behind a crease bends in its own way.
void add_ring(const Surface& surface, const std::vector<bool>& on_feature, Shares& shares) {
  const Mesh& mesh = surface.mesh();
  const Shares before = shares;
  parallel_for(mesh.vertices(), [&](std::int64_t i) {
    const auto add = [&](Index other) {
      if (on_feature[at(other)]) return;
      shares.bending[at(i)] += before.bending[at(other)];
      shares.area[i] += before.area[other];
    };
    mesh.for_each_outgoing(static_cast<Index>(i), [&](Index h) {
      add(mesh.tip(h));
      if (const Index back = Mesh::prev(h); mesh.boundary_halfedge(back)) add(mesh.tail(back));
    });
  });
}

/// The largest curvature by magnitude, of every vertex.
VectorX<double> largest_curvature(const Surface& surface, const std::vector<bool>& is_feature, int rings) {
  Shares shares = vertex_shares(surface, is_feature);
  std::vector<bool> on_feature(at(surface.mesh().vertices()), false);
  for (Index e = 0; e < surface.mesh().edges(); ++e) {
    const Index h = surface.mesh().halfedge(e);
    if (is_feature[at(e)]) on_feature[at(surface.mesh().tail(h))] = on_feature[at(surface.mesh().tip(h))] = true;
  }
  for (int ring = 0; ring < rings; ++ring) add_ring(surface, on_feature, shares);
  VectorX<double> k = VectorX<double>::Zero(surface.mesh().vertices());
  parallel_for(surface.mesh().vertices(), [&](std::int64_t i) {
    if (!(shares.area[i] > 0)) return;
    const Bending mean = shares.bending[at(i)] / shares.area[i];
    if (!mean.allFinite()) return;
    k[i] = Eigen::SelfAdjointEigenSolver<Bending>(mean, Eigen::EigenvaluesOnly).eigenvalues().cwiseAbs().maxCoeff();
  });
  return k;
}

/// A line has at least one edge, a closed one three; where it bends, chords of its own curvature.
void limit_along(const Surface& surface, const FeatureLine& line, double error, VectorX<double>& h) {
  const auto step = [&](std::size_t k) -> Point {
    return surface.V().row(line.vertices[k + 1]) - surface.V().row(line.vertices[k]);
  };
  const std::size_t edges = line.edges.size();
  double length = 0;
  for (std::size_t k = 0; k < edges; ++k) length += step(k).stableNorm();
  for (const Index v : line.vertices) h[v] = std::min(h[v], line.closed ? length / 3 : length);
  for (std::size_t k = 0; k < edges; ++k) {
    if (k + 1 == edges && !line.closed) break;
    const Point in = step(k), out = step((k + 1) % edges);
    const double turn = std::atan2(in.cross(out).stableNorm(), in.dot(out));
    const double curvature = 2 * turn / (in.stableNorm() + out.stableNorm());
    const Index v = line.vertices[k + 1];
    if (curvature > 0) h[v] = std::min(h[v], chord(curvature, error));
  }
}

/// The largest function below h that changes by at most `growth` times the length along each edge.
void limit_growth(const Surface& surface, double growth, VectorX<double>& h) {
  using Entry = std::pair<double, Index>;
  std::vector<Entry> entries;
  for (Index v = 0; v < surface.mesh().vertices(); ++v)
    if (surface.mesh().referenced(v)) entries.emplace_back(h[v], v);
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open(std::greater<>(), std::move(entries));
  for (std::int64_t step = 0; !open.empty(); ++step) {
    detail::check_cancelled_at(step);
    const double value = open.top().first;
    const Index v = open.top().second;
    open.pop();
    if (value > h[v]) continue;
    const auto reach = [&](Index e, Index other) {
      const double most = value + growth * surface.geometry().length(e);
      if (most >= h[other]) return;
      h[other] = most;
      open.emplace(most, other);
    };
    const Mesh& mesh = surface.mesh();
    mesh.for_each_outgoing(v, [&](Index out) {
      reach(mesh.edge(out), mesh.tip(out));
      if (const Index back = Mesh::prev(out); mesh.boundary_halfedge(back)) reach(mesh.edge(back), mesh.tail(back));
    });
  }
}

}  // namespace

VectorX<double> target_edge_lengths(const Surface& surface, const FeatureGraph& features,
                                    const SizingOptions& options) {
  check_sizing(options);
  (void)surface.positions();
  const Mesh& mesh = surface.mesh();
  std::vector<bool> is_feature(at(mesh.edges()), false);
  for (const Index e : features.edges) {
    if (e < 0 || e >= mesh.edges()) throw OptionError("features", e, "must be a graph of this surface");
    is_feature[at(e)] = true;
  }
  const double unit = box_diagonal(surface), error = options.error * unit;
  const VectorX<double> k = largest_curvature(surface, is_feature, options.rings);
  VectorX<double> h = VectorX<double>::Constant(mesh.vertices(), options.largest * unit);
  for (Index v = 0; v < mesh.vertices(); ++v)
    if (k[v] > 0) h[v] = std::min(h[v], chord(k[v], error));
  for (const FeatureLine& line : features.lines) limit_along(surface, line, error, h);
  h = h.cwiseMax(options.smallest * unit);
  limit_growth(surface, options.growth, h);
  return h;
}

}  // namespace alcap
