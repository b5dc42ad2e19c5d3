// SPDX-License-Identifier: MIT
//
// pairs.cpp: a locally heaviest matching. In each round every free face names the best edge to a free neighbour,
// and two that name the same edge are a pair. Edges of about one length are ranked at random, else chains of faces
// would wait for each other.
#include "src/connection/global/pairs.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "src/base/parallel.h"

namespace alcap::detail {
namespace {

// Length to an eighth of an octave, then a number that is different for every edge below 2^32. Two that share one are
// an arbitrary choice of a face, and at worst no pair in this round.
std::uint64_t rank(double length, Index e) {
  constexpr std::uint32_t kept = 0xFFF00000;  // sign, exponent and three more bits
  std::uint32_t mixed = static_cast<std::uint32_t>(e) * 0x9E3779B1U;
  mixed ^= mixed >> 15U;
  mixed *= 0x85EBCA77U;
  return std::uint64_t{std::bit_cast<std::uint32_t>(static_cast<float>(length)) & kept} << 32U | mixed;
}

// Numbers the i for which chosen(i) holds: number[i] of each, none of others, if `number` is given. Returns them.
template <class Chosen>
Array<Index> select(Index n, const Chosen& chosen, Index& count, Index* number) {
  const std::int64_t chunks = (std::int64_t{n} + reduction_chunk - 1) / reduction_chunk;
  Array<Index> first(chunks);
  const auto each = [&](std::int64_t c, const auto& body) {
    for (std::int64_t i = c * reduction_chunk; i < std::min<std::int64_t>(n, (c + 1) * reduction_chunk); ++i)
      body(static_cast<Index>(i));
  };
  parallel_for(
      chunks,
      [&](std::int64_t c) {
        Index sum = 0;
        each(c, [&](Index i) { sum += chosen(i) ? 1 : 0; });
        first[c] = sum;
      },
      1);
  count = 0;
  for (Index& f : first) {
    const Index here = f;
    f = count;
    count += here;
  }
  Array<Index> all(count);
  parallel_for(
      chunks,
      [&](std::int64_t c) {
        Index next = first[c];
        each(c, [&](Index i) {
          const bool yes = chosen(i);
          if (number != nullptr) number[i] = yes ? next : none;
          if (yes) all[next++] = i;
        });
      },
      1);
  return all;
}

}  // namespace

FacePairs pair_faces(const Mesh& mesh, const Geometry& geometry) {
  // A sliver is so stiff in its curvature that what it passes on is the small difference of large forces; on its own it
  // does no harm, because its edges are as stiff. 1000 is a corner of 0.06 degrees; float keeps four digits of
  // such differences.
  constexpr double most_cotangents = 1000;
  constexpr Index barred = -2;
  constexpr int rounds = 4;  // leave about one face in nine alone, with more rounds as many
  // The halfedge that a face names, and later the one that it shares with its mate.
  Array<Index> named(mesh.faces()), shared(mesh.faces());
  parallel_for(mesh.faces(), [&](std::int64_t t) {
    const Index h = static_cast<Index>(3 * t);
    const double stiffness = geometry.cot(h) + geometry.cot(h + 1) + geometry.cot(h + 2);
    shared[t] = stiffness > most_cotangents ? barred : none;
  });
  for (int round = 0; round < rounds; ++round) {
    parallel_for(mesh.faces(), [&](std::int64_t t) {
      Index& best = named[t];
      best = none;
      if (shared[t] != none) return;
      std::uint64_t most = 0;
      for (Index h = static_cast<Index>(3 * t); h < 3 * t + 3; ++h) {
        const Index g = mesh.twin(h);
        if (g == none || Mesh::face(g) == t || shared[Mesh::face(g)] != none) continue;
        const std::uint64_t here = rank(geometry.length(mesh.edge(h)), mesh.edge(h));
        if (best != none && here <= most) continue;
        best = h;
        most = here;
      }
    });
    parallel_for(mesh.faces(), [&](std::int64_t t) {
      const Index h = named[t];
      if (h != none && named[Mesh::face(mesh.twin(h))] == mesh.twin(h)) shared[t] = h;
    });
  }
  const auto between = [&](Index e) { return shared[Mesh::face(mesh.halfedge(e))] == mesh.halfedge(e); };
  FacePairs p;
  p.number = Array<Index>(mesh.edges());
  p.between = select(mesh.edges(), between, p.pairs, nullptr);
  p.single = select(
      mesh.faces(), [&](Index t) { return shared[t] < 0; }, p.singles, nullptr);
  p.edge = select(
      mesh.edges(), [&](Index e) { return !between(e); }, p.outer, p.number.data());
  parallel_for(p.pairs, [&](std::int64_t i) { p.number[p.between[i]] = p.outer + static_cast<Index>(i); });
  return p;
}

FacePairs single_faces(const Mesh& mesh) {
  FacePairs p;
  p.singles = mesh.faces();
  p.outer = mesh.edges();
  p.single = Array<Index>(mesh.faces());
  p.edge = Array<Index>(mesh.edges());
  p.number = Array<Index>(mesh.edges());
  parallel_for(mesh.faces(), [&](std::int64_t t) { p.single[t] = static_cast<Index>(t); });
  parallel_for(mesh.edges(), [&](std::int64_t e) { p.edge[e] = p.number[e] = static_cast<Index>(e); });
  return p;
}

}  // namespace alcap::detail
