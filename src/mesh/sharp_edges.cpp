// SPDX-License-Identifier: MIT
#include "alcap/sharp_edges.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "src/base/cancel.h"
#include "src/base/parallel.h"

namespace alcap {
namespace {

using Row = Eigen::RowVector3d;

// An angle this little below a threshold is the threshold: right angles are found at 90 degrees wherever the model
// lies.
constexpr double angle_rounding = 1e-12;

void check_space(const Surface& surface) {
  if (!surface.in_space()) throw OptionError("surface", "edge lengths alone", "sharp edges need a surface in space");
}

void check_angle(const char* name, double angle) {
  if (!(angle > 0 && angle <= pi<double>))
    throw OptionError(name, angle, "an angle in radians, above 0 and at most pi");
}

bool is_edge(const Surface& surface, Index e) { return e >= 0 && e < surface.mesh().edges(); }

[[noreturn]] void refuse_edge(const Surface& surface, const std::string& name, Index e) {
  throw OptionError(name, e, "there is no such edge; the mesh has " + std::to_string(surface.mesh().edges()));
}

Row direction(const Surface& surface, Index from, Index to) {
  return (surface.V().row(to) - surface.V().row(from)).stableNormalized();
}

Row normal(const Surface& surface, Index t) {
  const auto& F = surface.F();
  return direction(surface, F(t, 0), F(t, 1)).cross(direction(surface, F(t, 0), F(t, 2))).stableNormalized();
}

double fold(const Surface& surface, Index e) {
  const Mesh& mesh = surface.mesh();
  const Index h = mesh.halfedge(e), g = mesh.twin(h);
  if (g == none) return 0;
  const Row m = normal(surface, Mesh::face(h)), n = normal(surface, Mesh::face(g));
  return std::atan2(direction(surface, mesh.tail(h), mesh.tip(h)).dot(m.cross(n)), m.dot(n));
}

/// The feature edges at each vertex, in ascending order.
class Incidence {
 public:
  Incidence(const Mesh& mesh, const std::vector<Index>& edges)
      : mesh_(mesh), offset_(static_cast<std::size_t>(mesh.vertices()) + 1, 0), edge_(2 * edges.size()) {
    for (const Index e : edges)
      for (const Index v : ends(e)) ++offset_[static_cast<std::size_t>(v) + 1];
    for (std::size_t v = 1; v < offset_.size(); ++v) offset_[v] += offset_[v - 1];
    std::vector<std::size_t> next(offset_.begin(), offset_.end() - 1);
    for (const Index e : edges)
      for (const Index v : ends(e)) edge_[next[static_cast<std::size_t>(v)]++] = e;
  }
  [[nodiscard]] std::span<const Index> at(Index v) const {
    const auto i = static_cast<std::size_t>(v);
    return std::span(edge_).subspan(offset_[i], offset_[i + 1] - offset_[i]);
  }
  [[nodiscard]] Index other_end(Index e, Index v) const {
    const auto [a, b] = ends(e);
    return a == v ? b : a;
  }

 private:
  [[nodiscard]] std::array<Index, 2> ends(Index e) const {
    const Index h = mesh_.halfedge(e);
    return {mesh_.tail(h), mesh_.tip(h)};
  }

  const Mesh& mesh_;
  std::vector<std::size_t> offset_;
  std::vector<Index> edge_;
};

FeatureVertex kind(const Surface& surface, const Incidence& incidence, Index v, double corner_angle) {
  const auto edges = incidence.at(v);
  if (edges.empty()) return FeatureVertex::smooth;
  if (edges.size() == 1) return FeatureVertex::end;
  if (edges.size() > 2) return FeatureVertex::corner;
  const Row in = -direction(surface, v, incidence.other_end(edges[0], v));
  const Row out = direction(surface, v, incidence.other_end(edges[1], v));
  const double turn = std::atan2(in.cross(out).norm(), in.dot(out));
  return turn >= corner_angle - angle_rounding ? FeatureVertex::corner : FeatureVertex::crease;
}

/// Chains, each edge in one.
class Chains {
 public:
  Chains(const Mesh& mesh, const Incidence& incidence, FeatureGraph& graph)
      : mesh_(mesh), incidence_(incidence), graph_(graph), used_(static_cast<std::size_t>(mesh.edges()), false) {}

  void collect() {
    for (Index v = 0; v < mesh_.vertices(); ++v) {
      detail::check_cancelled_at(v);
      if (passes(v)) continue;
      for (const Index e : incidence_.at(v)) follow(v, e);
    }
    for (const Index e : graph_.edges) follow(mesh_.tail(mesh_.halfedge(e)), e);
  }

 private:
  [[nodiscard]] bool passes(Index v) const {
    return graph_.vertices[static_cast<std::size_t>(v)] == FeatureVertex::crease;
  }

  /// The chain that leaves `start` by edge e, unless e is in a chain already.
  void follow(Index start, Index e) {
    if (used_[static_cast<std::size_t>(e)]) return;
    FeatureLine line{{start}, {}, false};
    for (Index v = start; e != none;) {
      used_[static_cast<std::size_t>(e)] = true;
      v = incidence_.other_end(e, v);
      line.edges.push_back(e);
      line.vertices.push_back(v);
      if (!passes(v) || v == start) break;
      const auto here = incidence_.at(v);
      e = here[0] == e ? here[1] : here[0];
    }
    line.closed = line.vertices.back() == start;
    graph_.lines.push_back(std::move(line));
  }

  const Mesh& mesh_;
  const Incidence& incidence_;
  FeatureGraph& graph_;
  std::vector<bool> used_;
};

void check_options(const SharpEdgeOptions& options) {
  check_angle("angle", options.angle);
  check_angle("corner_angle", options.corner_angle);
  if (!(options.low_angle >= 0 && options.low_angle <= options.angle))
    throw OptionError("low_angle", options.low_angle, "must be 0 (off) or in (0, angle]");
  const auto check_length = [](const char* name, double length) {
    if (!(length >= 0) || !std::isfinite(length)) throw OptionError(name, length, "must be finite and not negative");
  };
  check_length("gap", options.gap);
  check_length("spur", options.spur);
}

/// Edges marked 2 become features where they are joined to a crease (3), and nothing elsewhere.
void spread_low(const Mesh& mesh, std::vector<char>& sharp) {
  std::vector<Index> marked, open;
  for (Index e = 0; e < mesh.edges(); ++e) {
    const char mark = sharp[static_cast<std::size_t>(e)];
    if (mark >= 2) marked.push_back(e);
    if (mark == 3) open.push_back(e);
  }
  const Incidence incidence(mesh, marked);
  for (std::size_t k = 0; k < open.size(); ++k) {
    detail::check_cancelled_at(static_cast<std::int64_t>(k));
    const Index h = mesh.halfedge(open[k]);
    for (const Index v : {mesh.tail(h), mesh.tip(h)})
      for (const Index e : incidence.at(v))
        if (std::exchange(sharp[static_cast<std::size_t>(e)], char{3}) == 2) open.push_back(e);
  }
  for (char& mark : sharp)
    if (mark == 2) mark = 0;
}

/// The shortest path of edges from the end `start`, whose line arrives along `in`, to another feature vertex.
class GapSearch {
 public:
  GapSearch(const Surface& surface, const SharpEdgeOptions& options, const std::vector<Index>& degree)
      : surface_(surface), options_(options), degree_(degree) {}

  [[nodiscard]] std::vector<Index> path(Index start, const Row& in) const {
    std::map<Index, std::pair<double, Index>> reached{{start, {0, none}}};  // distance, edge it came by
    std::set<std::pair<double, Index>> open{{0, start}};
    while (!open.empty()) {
      const double distance = open.begin()->first;  // not a binding: clang 14 lets no lambda use those
      const Index v = open.begin()->second;
      open.erase(open.begin());
      if (v != start && degree_[static_cast<std::size_t>(v)] > 0) return back(reached, v);
      const auto step = [&](Index w, Index e) {
        if (v == start && direction(surface_, v, w).dot(in) <= std::cos(options_.corner_angle)) return;
        const double there = distance + surface_.geometry().length(e);
        if (!(there <= options_.gap)) return;
        const auto [at, fresh] = reached.emplace(w, std::pair(there, e));
        if (!fresh && !(there < at->second.first)) return;
        open.erase({at->second.first, w});
        at->second = {there, e};
        open.insert({there, w});
      };
      const Mesh& mesh = surface_.mesh();
      mesh.for_each_outgoing(v, [&](Index h) {
        step(mesh.tip(h), mesh.edge(h));
        if (mesh.twin(Mesh::prev(h)) == none) step(mesh.tail(Mesh::prev(h)), mesh.edge(Mesh::prev(h)));
      });
    }
    return {};
  }

 private:
  [[nodiscard]] std::vector<Index> back(const std::map<Index, std::pair<double, Index>>& reached, Index v) const {
    std::vector<Index> edges;
    for (Index e = reached.at(v).second; e != none; e = reached.at(v).second) {
      edges.push_back(e);
      const Index h = surface_.mesh().halfedge(e);
      v = surface_.mesh().tail(h) == v ? surface_.mesh().tip(h) : surface_.mesh().tail(h);
    }
    return edges;
  }

  const Surface& surface_;
  const SharpEdgeOptions& options_;
  const std::vector<Index>& degree_;
};

void close_gaps(const Surface& surface, const SharpEdgeOptions& options, std::vector<Index>& edges) {
  const Mesh& mesh = surface.mesh();
  std::vector<Index> degree(static_cast<std::size_t>(mesh.vertices()), 0);
  const auto count = [&](Index e) {
    ++degree[static_cast<std::size_t>(mesh.tail(mesh.halfedge(e)))];
    ++degree[static_cast<std::size_t>(mesh.tip(mesh.halfedge(e)))];
  };
  for (const Index e : edges) count(e);
  const std::vector<Index> found = edges;
  const Incidence incidence(mesh, found);
  const GapSearch search(surface, options, degree);
  for (Index v = 0; v < mesh.vertices(); ++v) {
    detail::check_cancelled_at(v);
    if (degree[static_cast<std::size_t>(v)] != 1 || incidence.at(v).size() != 1) continue;
    const Index before = incidence.other_end(incidence.at(v)[0], v);
    for (const Index e : search.path(v, direction(surface, before, v))) {
      edges.push_back(e);
      count(e);
    }
  }
}

void remove_spurs(const Surface& surface, const SharpEdgeOptions& options, std::vector<Index>& edges) {
  for (bool removed = true; removed;) {
    detail::check_cancelled();
    const FeatureGraph graph = feature_graph(surface, edges, options.corner_angle);
    std::vector<Index> kept;
    for (const FeatureLine& line : graph.lines) {
      const auto ends = [&](Index v) { return graph.vertices[static_cast<std::size_t>(v)] == FeatureVertex::end; };
      double length = 0;
      for (const Index e : line.edges) length += surface.geometry().length(e);
      const bool spur = (ends(line.vertices.front()) || ends(line.vertices.back())) && length < options.spur;
      if (!spur) kept.insert(kept.end(), line.edges.begin(), line.edges.end());
    }
    removed = kept.size() < graph.edges.size();
    edges = std::move(kept);
  }
}

}  // namespace

double dihedral_angle(const Surface& surface, Index e) {
  check_space(surface);
  if (!is_edge(surface, e)) refuse_edge(surface, "e", e);
  return fold(surface, e);
}

FeatureGraph feature_graph(const Surface& surface, std::vector<Index> edges, double corner_angle) {
  check_space(surface);
  check_angle("corner_angle", corner_angle);
  for (std::size_t k = 0; k < edges.size(); ++k)
    if (!is_edge(surface, edges[k])) refuse_edge(surface, "edges[" + std::to_string(k) + "]", edges[k]);
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());

  const Mesh& mesh = surface.mesh();
  FeatureGraph graph{.edges = std::move(edges), .angles = {}, .vertices = {}, .lines = {}};
  for (const Index e : graph.edges) graph.angles.push_back(fold(surface, e));
  const Incidence incidence(mesh, graph.edges);
  for (Index v = 0; v < mesh.vertices(); ++v) {
    detail::check_cancelled_at(v);
    graph.vertices.push_back(kind(surface, incidence, v, corner_angle));
  }
  Chains(mesh, incidence, graph).collect();
  return graph;
}

FeatureGraph feature_graph(const Surface& surface, std::vector<Index> edges, const SharpEdgeOptions& options) {
  check_options(options);
  if (options.gap > 0 || options.spur > 0)
    edges = feature_graph(surface, std::move(edges)).edges;  // checked, once each
  if (options.gap > 0) close_gaps(surface, options, edges);
  if (options.spur > 0) remove_spurs(surface, options, edges);
  return feature_graph(surface, std::move(edges), options.corner_angle);
}

std::vector<Index> edges_between(const Surface& surface, const std::vector<std::array<Index, 2>>& pairs) {
  std::vector<Index> edges;
  for (const auto& [i, j] : pairs) {
    edges.push_back(surface.mesh().edge(i, j));
    if (edges.back() == none)
      throw OptionError("pairs", std::to_string(i) + "-" + std::to_string(j), "no edge joins these vertices");
  }
  return edges;
}

FeatureGraph sharp_edges(const Surface& surface, const SharpEdgeOptions& options) {
  check_space(surface);
  check_options(options);
  const Mesh& mesh = surface.mesh();
  std::vector<char> sharp(static_cast<std::size_t>(mesh.edges()));
  // 1: a feature; 2: one if it is joined to a crease; 3: a crease.
  parallel_for(mesh.edges(), [&](std::int64_t i) {
    const auto e = static_cast<Index>(i);
    const bool rim = mesh.boundary_halfedge(mesh.halfedge(e));
    const double angle = rim || !options.creases ? 0 : std::abs(fold(surface, e));
    const bool crease = !rim && options.creases && angle >= options.angle - angle_rounding;
    const bool low = options.low_angle > 0 && angle >= options.low_angle - angle_rounding;
    sharp[static_cast<std::size_t>(i)] = crease ? 3 : rim && options.boundary ? 1 : low ? 2 : 0;
  });
  if (options.low_angle > 0) spread_low(mesh, sharp);
  std::vector<Index> edges;
  for (Index e = 0; e < mesh.edges(); ++e)
    if (sharp[static_cast<std::size_t>(e)] != 0) edges.push_back(e);
  return feature_graph(surface, std::move(edges), options);
}

}  // namespace alcap
