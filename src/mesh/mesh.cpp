// SPDX-License-Identifier: MIT
//
// mesh.cpp: half-edge construction by bucketing halfedges at their tails: the twin of i -> j is in j's bucket.
#include "alcap/mesh.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <span>
#include <string>
#include <utility>

#include "alcap/mesh_check.h"
#include "src/base/array.h"
#include "src/base/limits.h"
#include "src/base/pages.h"
#include "src/base/parallel.h"

namespace alcap {
namespace {

bool both(bool a, bool b) { return a && b; }

// The halfedges that leave each vertex.
class Leaving {
 public:
  struct Entry {
    Index tip, halfedge;
  };

  Leaving(const Index* F, Index halfedge_count, Index vertex_count) : end_(vertex_count), entries_(halfedge_count) {
    Index* const end = end_.data();
    Entry* const entries = entries_.data();
    const bool shared = thread_limit() > 1;
    const auto increment = [shared](Index& slot) {
      return shared ? std::atomic_ref<Index>(slot).fetch_add(1, std::memory_order_relaxed) : slot++;
    };
    parallel_for(vertex_count, [=](std::int64_t v) { end[v] = 0; });
    parallel_for(halfedge_count, [=](std::int64_t h) { increment(end[F[h]]); });
    // Starts of the buckets, which filling moves to their ends.
    parallel_exclusive_scan(end, vertex_count);
    parallel_for(halfedge_count, [=](std::int64_t i) {
      const auto h = static_cast<Index>(i);
      entries[increment(end[F[h]])] = {F[Mesh::next(h)], h};
    });
  }

  /// In an order that depends on the threads, those of large buckets after sort_large() by tip.
  [[nodiscard]] std::span<const Entry> at(std::int64_t v) const {
    return {entries_.data() + begin(v), detail::at(end_[v] - begin(v))};
  }

  /// Sorts what is too large to be searched from end to end. False if two halfedges run from v to the same vertex.
  [[nodiscard]] bool sort_large(std::int64_t v) {
    const std::span<Entry> here(entries_.data() + begin(v), detail::at(end_[v] - begin(v)));
    bool distinct = true;
    if (here.size() <= searched_linearly) {
      for (std::size_t a = 1; a < here.size(); ++a)
        for (std::size_t b = 0; b < a; ++b) distinct &= here[a].tip != here[b].tip;
      return distinct;
    }
    std::ranges::sort(here, {}, &Entry::tip);
    for (std::size_t a = 1; a < here.size(); ++a) distinct &= here[a].tip != here[a - 1].tip;
    return distinct;
  }

  /// The halfedge from v to w, or `none`.
  [[nodiscard]] Index find(Index v, Index w) const {
    const std::span<const Entry> here = at(v);
    if (here.size() <= searched_linearly) {
      for (const Entry& e : here)
        if (e.tip == w) return e.halfedge;
      return none;
    }
    const auto found = std::ranges::lower_bound(here, w, {}, &Entry::tip);
    return found != here.end() && found->tip == w ? found->halfedge : none;
  }

 private:
  static constexpr std::size_t searched_linearly = 16;  // two cache lines

  [[nodiscard]] Index begin(std::int64_t v) const { return v == 0 ? 0 : end_[v - 1]; }

  detail::Array<Index> end_;
  detail::Array<Entry> entries_;
};

// Twins of all halfedges. False where an edge has two halfedges of one direction.
bool find_twins(Leaving& leaving, Index vertex_count, Index halfedge_count, Index* twin) {
  const bool distinct = parallel_reduce(
      std::int64_t{vertex_count}, true,
      [&](std::int64_t begin, std::int64_t end) {
        bool good = true;
        for (std::int64_t v = begin; v < end; ++v) good &= leaving.sort_large(v);
        return good;
      },
      both);
  if (!distinct) return false;
  parallel_for(halfedge_count, [&](std::int64_t h) { twin[h] = none; });
  parallel_for(vertex_count, [&](std::int64_t i) {
    const auto v = static_cast<Index>(i);
    for (const auto& [tip, h] : leaving.at(v)) {
      const Index g = tip > v ? leaving.find(tip, v) : none;
      if (g != none) twin[h] = g, twin[g] = h;
    }
  });
  return true;
}

// The first halfedge of v: the smallest that leaves, or the smallest boundary halfedge where there is one.
Index first_halfedge(const Leaving& leaving, const Index* twin, std::int64_t v) {
  Index inner = none, boundary = none;
  for (const auto& [tip, h] : leaving.at(v)) {
    Index& best = twin[h] == none ? boundary : inner;
    if (best == none || h < best) best = h;
  }
  return boundary != none ? boundary : inner;
}

// Numbers edges in the order of their canonical halfedges.
void number_edges(const VectorX<Index>& twin, VectorX<Index>& edge, VectorX<Index>& edge_halfedge) {
  const std::int64_t n = twin.size();
  const std::int64_t chunks = (n + reduction_chunk - 1) / reduction_chunk;
  const auto limit = [n](std::int64_t c) { return static_cast<Index>(std::min(n, (c + 1) * reduction_chunk)); };
  const auto canonical = [&](Index h) { return twin[h] == none || h < twin[h]; };
  detail::Array<Index> before(chunks);
  parallel_for(
      chunks,
      [&](std::int64_t c) {
        Index count = 0;
        for (auto h = static_cast<Index>(c * reduction_chunk); h < limit(c); ++h) count += canonical(h) ? 1 : 0;
        before[c] = count;
      },
      1);
  detail::resize_unset(edge_halfedge, parallel_exclusive_scan(before.data(), chunks));
  detail::resize_unset(edge, n);
  parallel_for(
      chunks,
      [&](std::int64_t c) {
        Index e = before[c];
        for (auto h = static_cast<Index>(c * reduction_chunk); h < limit(c); ++h) {
          if (!canonical(h)) continue;
          edge_halfedge[e] = h;
          edge[h] = e++;
        }
      },
      1);
  parallel_for(n, [&](std::int64_t h) {
    if (!canonical(static_cast<Index>(h))) edge[h] = edge[twin[h]];
  });
}

[[noreturn]] void throw_first_defect(const Faces& F, std::int64_t vertex_count) {
  const std::vector<DefectReport> defects = find_defects(F, vertex_count);
  if (defects.empty()) throw Error("internal error: the mesh was refused but no defect was found");
  throw_defect(defects.front());
}

bool in_range(const Faces& F, std::int64_t vertex_count) {
  return parallel_reduce(
      F.rows(), true,
      [&](std::int64_t begin, std::int64_t end) {
        bool good = true;
        for (std::int64_t t = begin; t < end; ++t) {
          const Index a = F(t, 0), b = F(t, 1), c = F(t, 2);
          good &= a >= 0 && b >= 0 && c >= 0 && a < vertex_count && b < vertex_count && c < vertex_count;
          good &= a != b && b != c && c != a;
        }
        return good;
      },
      both);
}

}  // namespace

Mesh::Mesh(Faces F, std::int64_t vertex_count) : F_(std::move(F)) {
  constexpr std::int64_t largest = detail::most_faces;
  if (F_.rows() == 0 || F_.rows() > largest || vertex_count > largest) throw_first_defect(F_, vertex_count);
  if (!in_range(F_, vertex_count)) throw_first_defect(F_, vertex_count);
  vertex_count_ = static_cast<Index>(vertex_count);

  Leaving leaving(F_.data(), halfedges(), vertex_count_);
  detail::resize_unset(twin_, halfedges());
  if (!find_twins(leaving, vertex_count_, halfedges(), twin_.data())) throw_first_defect(F_, vertex_count);

  // Every corner of a manifold vertex is met by one walk around it.
  struct Tally {
    bool manifold = true;
    Index referenced = 0;
  };
  detail::resize_unset(first_, vertex_count_);
  const Tally tally = parallel_reduce(
      std::int64_t{vertex_count_}, Tally{},
      [&](std::int64_t begin, std::int64_t end) {
        Tally here;
        for (std::int64_t i = begin; i < end; ++i) {
          const Index v = static_cast<Index>(i);
          const auto all = static_cast<Index>(leaving.at(v).size());
          first_[v] = first_halfedge(leaving, twin_.data(), v);
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
      F_.rows(), true,
      [&](std::int64_t begin, std::int64_t end) {
        bool good = true;
        for (std::int64_t t = begin; t < end; ++t) {
          const Index a = twin(static_cast<Index>(3 * t)), b = twin(static_cast<Index>(3 * t + 1)),
                      c = twin(static_cast<Index>(3 * t + 2));
          good &= a == none || b == none || c == none || a / 3 != b / 3 || b / 3 != c / 3;
        }
        return good;
      },
      both);
  if (!tally.manifold || !distinct) throw_first_defect(F_, vertex_count);

  number_edges(twin_, edge_, edge_halfedge_);
  boundary_edges_ = static_cast<Index>(2 * std::int64_t{edges()} - halfedges());
}

void Mesh::check_vertex(const char* name, Index v) const {
  if (v < 0 || v >= vertices())
    throw OptionError(name, v, "there is no such vertex; the mesh has " + std::to_string(vertices()));
}

Index Mesh::halfedge(Index i, Index j) const {
  check_vertex("i", i);
  check_vertex("j", j);
  for (Index h = first(i); h != none; h = next_around(h, i))
    if (tip(h) == j) return h;
  return none;
}

Index Mesh::edge(Index i, Index j) const {
  const Index h = halfedge(i, j);
  if (h != none) return edge(h);
  const Index g = halfedge(j, i);
  return g == none ? none : edge(g);
}

}  // namespace alcap
