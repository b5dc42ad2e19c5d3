// SPDX-License-Identifier: MIT
//
// mesh.cpp: half-edge construction by bucketing halfedges at the smaller of their two vertices.
#include "alcap/mesh.h"

#include <algorithm>
#include <atomic>
#include <memory>

#include "alcap/mesh_check.h"
#include "alcap/parallel.h"

namespace alcap {
namespace {

// Halfedges sorted by (smaller vertex, larger vertex, halfedge): the halfedges of one edge are neighbours.
struct SortedHalfedges {
  std::vector<Index> start;  // #V + 1, first entry of each smaller vertex
  std::unique_ptr<Index[]> halfedge;
};

Index next_of(Index h) { return Mesh::next(h); }

SortedHalfedges sort_halfedges(const Index* F, Index halfedge_count, Index vertex_count) {
  SortedHalfedges sorted;
  sorted.start.assign(static_cast<std::size_t>(vertex_count) + 1, 0);
  Index* const start = sorted.start.data();
  const auto smaller = [F](Index h) { return std::min(F[h], F[next_of(h)]); };
  const auto larger = [F](Index h) { return std::max(F[h], F[next_of(h)]); };
  parallel_for(halfedge_count, [&](std::int64_t h) {
    std::atomic_ref<Index>(start[smaller(static_cast<Index>(h))]).fetch_add(1, std::memory_order_relaxed);
  });
  parallel_exclusive_scan(start, std::int64_t{vertex_count} + 1);
  // Entries land in any order and are sorted below, so the result does not depend on the threads. Filling moves
  // each start to the next bucket's, which the shift afterwards undoes.
  sorted.halfedge = std::make_unique_for_overwrite<Index[]>(static_cast<std::size_t>(halfedge_count));
  Index* const entries = sorted.halfedge.get();
  parallel_for(halfedge_count, [&](std::int64_t h) {
    const Index v = smaller(static_cast<Index>(h));
    entries[std::atomic_ref<Index>(start[v]).fetch_add(1, std::memory_order_relaxed)] = static_cast<Index>(h);
  });
  std::copy_backward(start, start + vertex_count, start + vertex_count + 1);
  start[0] = 0;
  parallel_for(vertex_count, [&](std::int64_t v) {
    std::sort(entries + start[v], entries + start[v + 1], [&](Index a, Index b) {
      const Index la = larger(a), lb = larger(b);
      return la != lb ? la < lb : a < b;
    });
  });
  return sorted;
}

[[noreturn]] void throw_first_defect(const Eigen::Ref<const Faces>& F, std::int64_t vertex_count) {
  const std::vector<DefectReport> defects = find_defects(F, vertex_count);
  if (defects.empty()) throw Error("internal error: the mesh was refused but no defect was found");
  throw_defect(defects.front());
}

}  // namespace

Mesh::Mesh(const Eigen::Ref<const Faces>& F, std::int64_t vertex_count) {
  constexpr std::int64_t largest = std::numeric_limits<Index>::max() / 3;
  if (F.rows() == 0 || F.rows() > largest || vertex_count > largest) throw_first_defect(F, vertex_count);
  const std::int64_t n_faces = F.rows();
  const bool in_range = parallel_reduce(
      n_faces, true,
      [&](std::int64_t begin, std::int64_t end) {
        bool good = true;
        for (std::int64_t t = begin; t < end; ++t) {
          const Index a = F(t, 0), b = F(t, 1), c = F(t, 2);
          good &= a >= 0 && b >= 0 && c >= 0 && a < vertex_count && b < vertex_count && c < vertex_count;
          good &= a != b && b != c && c != a;
        }
        return good;
      },
      [](bool a, bool b) { return a && b; });
  if (!in_range) throw_first_defect(F, vertex_count);

  F_ = F;
  vertex_count_ = static_cast<Index>(vertex_count);
  const Index n_halfedges = static_cast<Index>(3 * n_faces);
  const auto n = static_cast<std::size_t>(n_halfedges);
  twin_.resize(n);
  edge_.resize(n);

  // Twins: an edge has one halfedge (boundary) or two that run against each other.
  bool manifold = true;
  {
    const SortedHalfedges sorted = sort_halfedges(F_.data(), n_halfedges, vertex_count_);
    const Index* const entries = sorted.halfedge.get();
    manifold = parallel_reduce(
        std::int64_t{vertex_count_}, true,
        [&](std::int64_t begin, std::int64_t end) {
          bool good = true;
          for (std::int64_t v = begin; v < end; ++v) {
            const Index stop = sorted.start[static_cast<std::size_t>(v) + 1];
            Index k = sorted.start[static_cast<std::size_t>(v)];
            while (k < stop) {
              const Index a = entries[k];
              const Index sum = tail(a) + tip(a);  // with v in common, equal sums mean equal edges
              Index same = 1;
              while (k + same < stop && tail(entries[k + same]) + tip(entries[k + same]) == sum) ++same;
              if (same == 1) {
                twin_[static_cast<std::size_t>(a)] = none;
              } else {
                const Index b = entries[k + 1];
                twin_[static_cast<std::size_t>(a)] = b;
                twin_[static_cast<std::size_t>(b)] = a;
                good &= same == 2 && tail(a) != tail(b);
              }
              k += same;
            }
          }
          return good;
        },
        [](bool a, bool b) { return a && b; });
  }
  if (!manifold) throw_first_defect(F, vertex_count);

  // Edges in the order of their smaller halfedge.
  parallel_for(n_halfedges, [&](std::int64_t h) {
    const Index t = twin_[static_cast<std::size_t>(h)];
    edge_[static_cast<std::size_t>(h)] = t == none || h < t;
  });
  std::vector<Index> number(edge_);
  const Index edge_count = parallel_exclusive_scan(number.data(), n_halfedges);
  edge_halfedge_.resize(static_cast<std::size_t>(edge_count));
  parallel_for(n_halfedges, [&](std::int64_t h) {
    if (edge_[static_cast<std::size_t>(h)] == 0) return;
    const Index e = number[static_cast<std::size_t>(h)];
    edge_halfedge_[static_cast<std::size_t>(e)] = static_cast<Index>(h);
  });
  parallel_for(n_halfedges, [&](std::int64_t h) {
    const Index t = twin_[static_cast<std::size_t>(h)];
    const bool is_canonical = t == none || h < t;
    edge_[static_cast<std::size_t>(h)] = number[static_cast<std::size_t>(is_canonical ? h : t)];
  });
  boundary_edges_ = 2 * edge_count - n_halfedges;

  // First halfedges: the smallest that leaves, or the boundary halfedge where there is one.
  first_.assign(static_cast<std::size_t>(vertex_count_), none);
  std::vector<Index> corners(static_cast<std::size_t>(vertex_count_), 0);
  constexpr Index boundary_bit = std::numeric_limits<Index>::min();  // sorts boundary halfedges before all others
  for (Index& f : first_) f = std::numeric_limits<Index>::max();
  parallel_for(n_halfedges, [&](std::int64_t i) {
    const Index h = static_cast<Index>(i);
    const auto v = static_cast<std::size_t>(tail(h));
    const Index key = twin(h) == none ? h + boundary_bit : h;
    std::atomic_ref<Index> slot(first_[v]);
    Index seen = slot.load(std::memory_order_relaxed);
    while (key < seen && !slot.compare_exchange_weak(seen, key, std::memory_order_relaxed)) {
    }
    std::atomic_ref<Index>(corners[v]).fetch_add(1, std::memory_order_relaxed);
  });
  parallel_for(vertex_count_, [&](std::int64_t v) {
    Index& f = first_[static_cast<std::size_t>(v)];
    if (f == std::numeric_limits<Index>::max()) f = none;
    if (f < none) f -= boundary_bit;
  });

  // Every corner of a manifold vertex is met by one walk around it.
  struct Tally {
    bool manifold = true;
    Index referenced = 0;
  };
  const Tally tally = parallel_reduce(
      std::int64_t{vertex_count_}, Tally{},
      [&](std::int64_t begin, std::int64_t end) {
        Tally here;
        for (std::int64_t i = begin; i < end; ++i) {
          const Index v = static_cast<Index>(i);
          const Index all = corners[static_cast<std::size_t>(v)];
          Index met = 0;
          for (Index h = first(v); h != none && met <= all; h = next_around(h, v)) ++met;
          here.manifold &= met == all;
          here.referenced += all > 0;
        }
        return here;
      },
      [](const Tally& a, const Tally& b) {
        return Tally{a.manifold && b.manifold, a.referenced + b.referenced};
      });
  referenced_ = tally.referenced;

  // Two faces glued along all three edges are the same triangle twice.
  const bool distinct = parallel_reduce(
      n_faces, true,
      [&](std::int64_t begin, std::int64_t end) {
        bool good = true;
        for (std::int64_t t = begin; t < end; ++t) {
          const Index a = twin(static_cast<Index>(3 * t)), b = twin(static_cast<Index>(3 * t + 1)),
                      c = twin(static_cast<Index>(3 * t + 2));
          good &= a == none || b == none || c == none || a / 3 != b / 3 || b / 3 != c / 3;
        }
        return good;
      },
      [](bool a, bool b) { return a && b; });
  if (!tally.manifold || !distinct) throw_first_defect(F, vertex_count);
}

}  // namespace alcap
