// SPDX-License-Identifier: MIT
//
// face_edges.h (internal): the edges of a bag of triangles that need not be a mesh, for finding and repairing defects.
// Works for any in-range indices; edges may have any number of faces, run in any direction.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "alcap/conventions.h"
#include "src/base/array.h"
#include "src/base/cancel.h"

namespace alcap::detail {

using FacesRef = Eigen::Ref<const Faces>;

/// Items with equal keys, in the order of the keys: group g is items[start[g]] ... items[start[g+1]-1], ascending.
/// There may be empty groups.
struct Buckets {
  std::vector<Index> start, items;
};

/// The halfedges 3 t + c of the faces with usable[t] != 0, grouped by edge; edges in order of their (smaller, larger)
/// vertex, halfedges of an edge in order of their number. Usable faces must have three different in-range vertices.
class FaceEdges {
 public:
  FaceEdges(const FacesRef& F, const Array<char>& usable);

  [[nodiscard]] std::size_t edges() const { return begin_.size() - 1; }
  /// The halfedges of an edge.
  [[nodiscard]] std::span<const Index> halfedges(std::size_t edge) const {
    return std::span(sorted_).subspan(at(begin_[edge]), at(begin_[edge + 1] - begin_[edge]));
  }

 private:
  std::vector<Index> sorted_, begin_;
};

/// How faces must be turned for neighbours to agree. Neighbours are the two faces of an edge that has exactly two.
struct Orientation {
  Array<char> turned;             // per face: against the smallest face of its piece
  Array<Index> piece;             // per face, `none` where not usable
  std::vector<Index> first_face;  // per piece
  std::vector<char> orientable;   // per piece
};
[[nodiscard]] Orientation orient(const FacesRef& F, const Array<char>& usable, const FaceEdges& edges);

/// Groups 0, 1, ..., count - 1 by key(i), which is in [0, keys) or `none` to leave i out. Memory O(count), however many
/// keys there could be.
template <class Key>
Buckets bucket(Index count, Index keys, Key&& key) {
  Buckets b;
  if (keys / 8 > count) {  // few of the keys occur: sort instead of counting
    for (Index i = 0; i < count; ++i) {
      if (key(i) != none) b.items.push_back(i);
    }
    std::stable_sort(b.items.begin(), b.items.end(), [&](Index i, Index j) { return key(i) < key(j); });
    for (std::size_t k = 0; k < b.items.size(); ++k) {
      if (k == 0 || key(b.items[k]) != key(b.items[k - 1])) b.start.push_back(static_cast<Index>(k));
    }
    b.start.push_back(static_cast<Index>(b.items.size()));
    return b;
  }
  b.start.assign(at(keys) + 1, 0);
  for (Index i = 0; i < count; ++i) {
    check_cancelled_at(i);
    const Index k = key(i);
    if (k != none) ++b.start[at(k) + 1];
  }
  for (std::size_t k = 1; k < b.start.size(); ++k) b.start[k] += b.start[k - 1];
  b.items.resize(at(b.start.back()));
  std::vector<Index> next(b.start.begin(), b.start.end() - 1);
  for (Index i = 0; i < count; ++i) {
    check_cancelled_at(i);
    const Index k = key(i);
    if (k != none) b.items[at(next[at(k)]++)] = i;
  }
  return b;
}

/// One more than the largest vertex of the usable faces.
[[nodiscard]] Index vertex_limit(const FacesRef& F, const Array<char>& usable);

}  // namespace alcap::detail
