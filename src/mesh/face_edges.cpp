// SPDX-License-Identifier: MIT
//
// face_edges.cpp: edges of a bag of triangles by bucketing halfedges at the smaller of their vertices.
#include "src/mesh/face_edges.h"

#include <algorithm>

#include "src/base/parallel.h"

namespace alcap::detail {

Index vertex_limit(const FacesRef& F, const std::vector<char>& usable) {
  Index limit = 0;
  for (Eigen::Index t = 0; t < F.rows(); ++t) {
    if (usable[static_cast<std::size_t>(t)] != 0) limit = std::max(limit, F.row(t).maxCoeff() + 1);
  }
  return limit;
}

FaceEdges::FaceEdges(const FacesRef& F, const std::vector<char>& usable) {
  const auto tail = [&](Index h) { return F(h / 3, h % 3); };
  const auto tip = [&](Index h) { return F(h / 3, (h + 1) % 3); };
  const auto larger = [&](Index h) { return std::max(tail(h), tip(h)); };
  Buckets b = bucket(static_cast<Index>(3 * F.rows()), vertex_limit(F, usable), [&](Index h) {
    return usable[static_cast<std::size_t>(h / 3)] != 0 ? std::min(tail(h), tip(h)) : none;
  });
  parallel_for(static_cast<std::int64_t>(b.start.size()) - 1, [&](std::int64_t v) {
    Index* const items = b.items.data();
    std::sort(items + b.start[static_cast<std::size_t>(v)], items + b.start[static_cast<std::size_t>(v) + 1],
              [&](Index a, Index c) {
                const Index la = larger(a), lc = larger(c);
                return la != lc ? la < lc : a < c;
              });
  });
  sorted_ = std::move(b.items);
  for (std::size_t v = 0; v + 1 < b.start.size(); ++v) {
    for (Index k = b.start[v]; k < b.start[v + 1]; ++k) {
      const auto at = static_cast<std::size_t>(k);
      if (k == b.start[v] || larger(sorted_[at]) != larger(sorted_[at - 1])) begin_.push_back(k);
    }
  }
  begin_.push_back(static_cast<Index>(sorted_.size()));
}

Orientation orient(const FacesRef& F, const std::vector<char>& usable, const FaceEdges& edges) {
  const auto faces = static_cast<std::size_t>(F.rows());
  const auto tail = [&](Index h) { return F(h / 3, h % 3); };
  std::vector<Index> mate(3 * faces, none);
  for (std::size_t e = 0; e < edges.edges(); ++e) {
    const auto h = edges.halfedges(e);
    if (h.size() != 2) continue;
    mate[static_cast<std::size_t>(h[0])] = h[1];
    mate[static_cast<std::size_t>(h[1])] = h[0];
  }
  Orientation result{std::vector<char>(faces, 0), std::vector<Index>(faces, none), {}, {}};
  std::vector<Index> queue;
  for (std::size_t seed = 0; seed < faces; ++seed) {
    if (usable[seed] == 0 || result.piece[seed] != none) continue;
    const auto piece = static_cast<Index>(result.first_face.size());
    result.first_face.push_back(static_cast<Index>(seed));
    result.orientable.push_back(1);
    result.piece[seed] = piece;
    queue.assign(1, static_cast<Index>(seed));
    for (std::size_t q = 0; q < queue.size(); ++q) {
      const Index t = queue[q];
      for (Index h = 3 * t; h < 3 * t + 3; ++h) {
        const Index m = mate[static_cast<std::size_t>(h)];
        if (m == none) continue;
        const auto u = static_cast<std::size_t>(m / 3);
        const auto turned =
            static_cast<char>((result.turned[static_cast<std::size_t>(t)] != 0) != (tail(h) == tail(m)));
        if (result.piece[u] == none) {
          result.piece[u] = piece;
          result.turned[u] = turned;
          queue.push_back(m / 3);
        } else if (result.turned[u] != turned) {
          result.orientable.back() = 0;
        }
      }
    }
  }
  return result;
}

}  // namespace alcap::detail
