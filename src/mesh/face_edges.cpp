// SPDX-License-Identifier: MIT
//
// face_edges.cpp: edges of a bag of triangles by bucketing halfedges at the smaller of their vertices.
#include "src/mesh/face_edges.h"

#include <algorithm>

#include "src/base/array.h"
#include "src/base/cancel.h"
#include "src/base/parallel.h"

namespace alcap::detail {

Index vertex_limit(const FacesRef& F, const Array<char>& usable) {
  Index limit = 0;
  for (Eigen::Index t = 0; t < F.rows(); ++t) {
    if (usable[t] != 0) limit = std::max(limit, F.row(t).maxCoeff() + 1);
  }
  return limit;
}

FaceEdges::FaceEdges(const FacesRef& F, const Array<char>& usable) {
  const auto tail = [&](Index h) { return F(h / 3, h % 3); };
  const auto tip = [&](Index h) { return F(h / 3, (h + 1) % 3); };
  const auto larger = [&](Index h) { return std::max(tail(h), tip(h)); };
  Buckets b = bucket(static_cast<Index>(3 * F.rows()), vertex_limit(F, usable),
                     [&](Index h) { return usable[h / 3] != 0 ? std::min(tail(h), tip(h)) : none; });
  check_cancelled();
  parallel_for(static_cast<std::int64_t>(b.start.size()) - 1, [&](std::int64_t v) {
    Index* const items = b.items.data();
    std::sort(items + b.start[at(v)], items + b.start[at(v) + 1], [&](Index a, Index c) {
      const Index la = larger(a), lc = larger(c);
      return la != lc ? la < lc : a < c;
    });
  });
  sorted_ = std::move(b.items);
  for (std::size_t v = 0; v + 1 < b.start.size(); ++v) {
    check_cancelled_at(static_cast<std::int64_t>(v));
    for (Index k = b.start[v]; k < b.start[v + 1]; ++k) {
      if (k == b.start[v] || larger(sorted_[at(k)]) != larger(sorted_[at(k - 1)])) begin_.push_back(k);
    }
  }
  begin_.push_back(static_cast<Index>(sorted_.size()));
}

Orientation orient(const FacesRef& F, const Array<char>& usable, const FaceEdges& edges) {
  const auto faces = static_cast<Index>(F.rows());
  const auto tail = [&](Index h) { return F(h / 3, h % 3); };
  Array<Index> mate(3 * F.rows(), none);
  for (std::size_t e = 0; e < edges.edges(); ++e) {
    const auto h = edges.halfedges(e);
    if (h.size() != 2) continue;
    mate[h[0]] = h[1];
    mate[h[1]] = h[0];
  }
  Orientation result{Array<char>(faces, 0), Array<Index>(faces, none), {}, {}};
  std::vector<Index> queue;
  for (Index seed = 0; seed < faces; ++seed) {
    if (usable[seed] == 0 || result.piece[seed] != none) continue;
    const auto piece = static_cast<Index>(result.first_face.size());
    result.first_face.push_back(seed);
    result.orientable.push_back(1);
    result.piece[seed] = piece;
    queue.assign(1, seed);
    for (std::size_t q = 0; q < queue.size(); ++q) {
      check_cancelled_at(static_cast<std::int64_t>(q));
      const Index t = queue[q];
      for (Index h = 3 * t; h < 3 * t + 3; ++h) {
        const Index m = mate[h];
        if (m == none) continue;
        const Index u = m / 3;
        const auto turned = static_cast<char>((result.turned[t] != 0) != (tail(h) == tail(m)));
        if (result.piece[u] == none) {
          result.piece[u] = piece;
          result.turned[u] = turned;
          queue.push_back(u);
        } else if (result.turned[u] != turned) {
          result.orientable.back() = 0;
        }
      }
    }
  }
  return result;
}

}  // namespace alcap::detail
