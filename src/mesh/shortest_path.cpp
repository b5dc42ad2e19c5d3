// SPDX-License-Identifier: MIT
#include "alcap/shortest_path.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>
#include <unordered_map>
#include <utility>

#include "src/base/cancel.h"

namespace alcap {
namespace {

struct Reached {
  double distance = std::numeric_limits<double>::infinity();
  Index from = none;  // the neighbour on the way
};

// The vertices that a search from a meets until it comes to b. Entries of equal distance leave the queue in the order
// of their numbers, and only a shorter way replaces one: that is the rule for ties.
std::unordered_map<Index, Reached> search(const Mesh& mesh, const Geometry& geometry, Index a, Index b) {
  std::unordered_map<Index, Reached> reached;
  using Entry = std::pair<double, Index>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  reached[a] = {0, none};
  queue.emplace(0.0, a);
  while (!queue.empty()) {
    detail::check_cancelled();
    const auto [distance, v] = queue.top();
    queue.pop();
    if (v == b) break;
    if (distance > reached[v].distance) continue;
    const auto reach = [&, from = v, before = distance](Index w, Index e) {
      const double there = before + geometry.length(e);
      Reached& r = reached[w];
      if (!(there < r.distance)) return;
      r = {there, from};
      queue.emplace(there, w);
    };
    Index last = none;
    mesh.for_each_outgoing(v, [&](Index h) {
      reach(mesh.tip(h), mesh.edge(h));
      last = Mesh::prev(h);
    });
    if (mesh.boundary_vertex(v)) reach(mesh.tail(last), mesh.edge(last));
  }
  return reached;
}

}  // namespace

std::vector<Index> shortest_path(const Surface& surface, Index from, Index to) {
  const Mesh& mesh = surface.mesh();
  mesh.check_vertex("from", from);
  mesh.check_vertex("to", to);
  const Index a = std::min(from, to), b = std::max(from, to);
  const auto reached = search(mesh, surface.geometry(), a, b);
  std::vector<Index> path;
  if (!reached.contains(b)) return path;
  for (Index v = b; v != none; v = reached.at(v).from) path.push_back(v);
  if (from == a) std::reverse(path.begin(), path.end());
  return path;
}

}  // namespace alcap
