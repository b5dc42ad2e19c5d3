// SPDX-License-Identifier: MIT
//
// mesh_helpers.h: changes of meshes that tests make: relabelling, disjoint union, flips, triangle soup.
#pragma once

#include <algorithm>
#include <array>
#include <initializer_list>
#include <numeric>
#include <vector>

#include "alcap/generators.h"
#include "src/base/random.h"

namespace alcap::test {

inline Faces faces(std::initializer_list<std::array<Index, 3>> rows) {
  Faces F(static_cast<Eigen::Index>(rows.size()), 3);
  Eigen::Index t = 0;
  for (const auto& row : rows) F.row(t++) << row[0], row[1], row[2];
  return F;
}

inline std::vector<Index> random_order(Eigen::Index count, std::uint64_t seed) {
  std::vector<Index> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), Index{0});
  detail::Random random(seed);
  for (std::size_t k = order.size(); k > 1; --k) {
    std::swap(order[k - 1], order[static_cast<std::size_t>(random.below(static_cast<std::int64_t>(k)))]);
  }
  return order;
}

/// Vertex v becomes new_number[v]; face t moves to row new_row[t]; corners keep their order.
inline MeshData relabelled(const MeshData& s, const std::vector<Index>& new_number, const std::vector<Index>& new_row) {
  MeshData out = s;
  for (Eigen::Index v = 0; v < s.V.rows(); ++v) out.V.row(new_number[static_cast<std::size_t>(v)]) = s.V.row(v);
  for (Eigen::Index t = 0; t < s.F.rows(); ++t) {
    for (int c = 0; c < 3; ++c) {
      out.F(new_row[static_cast<std::size_t>(t)], c) = new_number[static_cast<std::size_t>(s.F(t, c))];
    }
  }
  return out;
}

/// b after a, apart from each other.
inline MeshData together(const MeshData& a, const MeshData& b) {
  MeshData out{Positions<double>(a.V.rows() + b.V.rows(), 3), Faces(a.F.rows() + b.F.rows(), 3)};
  out.V << a.V, b.V;
  out.F << a.F, (b.F.array() + static_cast<Index>(a.V.rows())).matrix();
  return out;
}

/// Turns each face with probability 1/2.
inline Faces randomly_turned(const Faces& F, std::uint64_t seed) {
  Faces out = F;
  detail::Random random(seed);
  for (Eigen::Index t = 0; t < F.rows(); ++t) {
    if (random.uniform() < 0.5) std::swap(out(t, 1), out(t, 2));
  }
  return out;
}

/// Every face with vertices of its own.
inline MeshData soup(const MeshData& s) {
  MeshData out{Positions<double>(3 * s.F.rows(), 3), Faces(s.F.rows(), 3)};
  for (Index h = 0; h < 3 * s.F.rows(); ++h) {
    out.V.row(h) = s.V.row(s.F(h / 3, h % 3));
    out.F(h / 3, h % 3) = h;
  }
  return out;
}

/// A strip of `count` quads closed with a half turn: one-sided, one boundary loop.
inline Faces moebius_strip(Index count) {
  Faces F(2 * count, 3);
  for (Index k = 0; k < count; ++k) {
    const Index a = 2 * k, d = 2 * k + 1;
    const Index b = k + 1 < count ? 2 * k + 2 : 1, c = k + 1 < count ? 2 * k + 3 : 0;
    F.row(2 * k) << a, b, c;
    F.row(2 * k + 1) << a, c, d;
  }
  return F;
}

}  // namespace alcap::test
