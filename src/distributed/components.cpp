// SPDX-License-Identifier: MIT
//
// components.cpp: what is joined on a rank is joined by a forest; labels then wander from rank to rank until they rest.
#include "src/distributed/components.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "src/base/array.h"
#include "src/base/cancel.h"

namespace alcap::detail::distributed {
namespace {

constexpr Index unlabelled = std::numeric_limits<Index>::max();

struct Root {
  Index label;       // the smallest vertex
  Index first_face;  // the smallest face
};

/// All components, in the order of their smallest faces.
std::vector<Root> find_roots(const Patch& patch, const std::vector<Index>& label) {
  std::vector<Root> mine;
  for (Index t = 0; t < patch.mesh.faces(); ++t) {
    if (patch.mine[at(t)] == 0) continue;
    mine.push_back({label[at(patch.mesh.F()(t, 0))], patch.face[at(t)]});
  }
  const auto reduce = [](std::vector<Root>& roots) {
    std::ranges::sort(roots, [](const Root& a, const Root& b) {
      return std::array{a.label, a.first_face} < std::array{b.label, b.first_face};
    });
    const auto same_label = [](const Root& a, const Root& b) { return a.label == b.label; };
    roots.erase(std::unique(roots.begin(), roots.end(), same_label), roots.end());
  };
  reduce(mine);
  std::vector<Root> all = gather_all(mine);
  reduce(all);
  std::ranges::sort(all, {}, &Root::first_face);
  return all;
}

/// The number of each label, by pairs of both; `none` stays.
std::vector<Index> numbered(const std::vector<Index>& label, std::vector<std::array<Index, 2>> number) {
  std::sort(number.begin(), number.end());
  std::vector<Index> out;
  out.reserve(label.size());
  for (const Index l : label)
    out.push_back(l == none ? none
                            : (*std::ranges::lower_bound(number, l, {}, [](const auto& pair) { return pair[0]; }))[1]);
  return out;
}

/// Adds up over the ranks what each rank counts of every component.
void count_elements(const Patch& patch, Components& c) {
  const Mesh& mesh = patch.mesh;
  const std::size_t size = c.list.size();
  std::vector<std::int64_t> counts(3 * size, 0);
  std::vector<double> areas(size, 0);
  const auto of = [&](Index v) { return at(c.of_vertex[at(v)]); };
  for (Index v = 0; v < patch.owned; ++v)
    if (c.of_vertex[at(v)] != none) ++counts[3 * of(v)];
  for (Index e = 0; e < mesh.edges(); ++e) {
    const Index h = mesh.halfedge(e), i = mesh.tail(h), j = mesh.tip(h);
    if ((patch.vertex[at(i)] < patch.vertex[at(j)] ? i : j) < patch.owned) ++counts[3 * of(std::min(i, j)) + 1];
  }
  for (Index t = 0; t < mesh.faces(); ++t) {
    if (patch.mine[at(t)] == 0) continue;
    ++counts[3 * of(mesh.F()(t, 0)) + 2];
    areas[of(mesh.F()(t, 0))] += patch.geometry.area(t);
  }
  sum_all(counts);
  sum_all(areas);
  for (std::size_t k = 0; k < size; ++k) {
    DistributedComponent& d = c.list[k];
    d.vertices = counts[3 * k];
    d.edges = counts[3 * k + 1];
    d.faces = counts[3 * k + 2];
    d.euler = d.vertices - d.edges + d.faces;
    d.area = areas[k];
  }
}

/// The smallest vertex of the boundary loop of each inner vertex, `none` off the boundary.
std::vector<Index> loop_labels(const Patch& patch) {
  const Mesh& mesh = patch.mesh;
  std::vector<char> used(at(patch.inner), 0);
  std::vector<std::array<Index, 2>> edges;
  for (Index v = 0; v < (patch.empty() ? 0 : patch.inner); ++v) used[at(v)] = mesh.boundary_vertex(v) ? 1 : 0;
  for (Index h = 0; h < mesh.halfedges(); ++h) {
    const Index i = mesh.tail(h), j = mesh.tip(h);
    if (!mesh.boundary_halfedge(h) || i >= patch.inner || j >= patch.inner) continue;
    edges.push_back({i, j});
  }
  return smallest_joined(patch, edges, used);
}

/// Every boundary loop is counted at its smallest vertex.
void count_loops(const Patch& patch, Components& c) {
  const std::vector<Index> label = loop_labels(patch);
  std::vector<std::int64_t> loops(c.list.size(), 0);
  for (Index v = 0; v < patch.owned; ++v)
    if (label[at(v)] == patch.vertex[at(v)]) ++loops[at(c.of_vertex[at(v)])];
  sum_all(loops);
  for (std::size_t k = 0; k < loops.size(); ++k) c.list[k].boundary_loops = loops[k];
}

}  // namespace

std::vector<Index> smallest_joined(const Patch& patch, const std::vector<std::array<Index, 2>>& edges,
                                   const std::vector<char>& used) {
  std::vector<Index> parent(at(patch.inner));
  std::iota(parent.begin(), parent.end(), Index{0});
  const auto root = [&](Index v) {
    while (parent[at(v)] != v) v = parent[at(v)] = parent[at(parent[at(v)])];
    return v;
  };
  for (const auto& [i, j] : edges) {
    const Index a = root(i), b = root(j);
    parent[at(std::max(a, b))] = std::min(a, b);
  }
  std::vector<Index> label(at(patch.inner), unlabelled);
  const auto spread_here = [&] {  // whether a label of an owned vertex has changed
    bool changed = false;
    for (Index v = 0; v < patch.inner; ++v) {
      Index& top = label[at(root(v))];
      top = std::min(top, label[at(v)]);
    }
    for (Index v = 0; v < patch.inner; ++v) {
      const Index top = label[at(root(v))];
      changed |= top != label[at(v)];
      label[at(v)] = top;
    }
    return changed;
  };
  for (Index v = 0; v < patch.inner; ++v)
    if (used[at(v)] != 0) label[at(v)] = patch.vertex[at(v)];
  // Every round carries labels through one more rank at least.
  for (bool changed = true; changed;) {
    check_cancelled();
    changed = spread_here();
    patch.ring.reduce(label.data() + patch.owned, label.data(), MPI_MIN);
    changed |= spread_here();
    patch.extend(label.data());
    changed = any(changed);
  }
  for (Index v = 0; v < patch.inner; ++v)
    if (used[at(v)] == 0) label[at(v)] = none;
  return label;
}

BoundaryLoops find_loops(const Patch& patch, const Components& components) {
  struct Start {
    Index face, corner, label, component;  // the first two: of the users' halfedge
    [[nodiscard]] std::array<Index, 2> halfedge() const { return {face, corner}; }
  };
  const std::vector<Index> label = loop_labels(patch);
  std::vector<Start> mine;
  for (Index h = 0; h < patch.mesh.halfedges(); ++h) {
    const Index v = patch.mesh.tail(h);
    if (v < patch.owned && patch.mesh.boundary_halfedge(h))
      mine.push_back({patch.face[at(h / 3)], h % 3, label[at(v)], components.of_vertex[at(v)]});
  }
  const auto first_of_each = [](std::vector<Start>& starts) {
    std::ranges::sort(starts, [](const Start& a, const Start& b) {
      return std::array{a.label, a.face, a.corner} < std::array{b.label, b.face, b.corner};
    });
    const auto same_label = [](const Start& a, const Start& b) { return a.label == b.label; };
    starts.erase(std::unique(starts.begin(), starts.end(), same_label), starts.end());
  };
  first_of_each(mine);
  std::vector<Start> all = gather_all(mine);
  first_of_each(all);
  std::ranges::sort(all, {}, &Start::halfedge);
  BoundaryLoops loops;
  std::vector<std::array<Index, 2>> number;  // label, loop
  for (const Start& start : all) {
    number.push_back({start.label, static_cast<Index>(loops.component.size())});
    loops.component.push_back(start.component);
  }
  loops.of_vertex = numbered(label, std::move(number));
  return loops;
}

Components find_components(const Patch& patch) {
  const Mesh& mesh = patch.mesh;
  std::vector<char> used(at(patch.inner), 0);
  std::vector<std::array<Index, 2>> edges;
  for (Index v = 0; v < (patch.empty() ? 0 : patch.inner); ++v) used[at(v)] = mesh.referenced(v) ? 1 : 0;
  for (Index e = 0; e < mesh.edges(); ++e) {
    const Index h = mesh.halfedge(e), i = mesh.tail(h), j = mesh.tip(h);
    if (i < patch.inner && j < patch.inner) edges.push_back({i, j});
  }
  const std::vector<Index> label = smallest_joined(patch, edges, used);
  Components c;
  const std::vector<Root> roots = find_roots(patch, label);
  std::vector<std::array<Index, 2>> number;  // label, component
  for (const Root& root : roots) {
    number.push_back({root.label, static_cast<Index>(number.size())});
    c.list.emplace_back();
    c.list.back().first_face = root.first_face;
  }
  c.of_vertex = numbered(label, std::move(number));
  count_elements(patch, c);
  count_loops(patch, c);
  return c;
}

}  // namespace alcap::detail::distributed
