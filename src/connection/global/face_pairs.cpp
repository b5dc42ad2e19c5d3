// SPDX-License-Identifier: MIT
//
// face_pairs.cpp: a locally heaviest matching. In each round every free face names the best edge to a free neighbour,
// and two that name the same edge are a pair. Edges of about one length are ranked at random, else chains of faces
// would wait for each other.
#include "src/connection/global/face_pairs.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "src/base/parallel.h"

namespace alcap::detail {
namespace {

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

// Length to an eighth of an octave, then a number that is different for every edge.
std::uint64_t rank(double length, Index e) {
  constexpr std::uint32_t kept = 0xFFF00000;  // sign, exponent and three more bits
  std::uint32_t mixed = static_cast<std::uint32_t>(e) * 0x9E3779B1U;
  mixed ^= mixed >> 15U;
  mixed *= 0x85EBCA77U;
  return std::uint64_t{std::bit_cast<std::uint32_t>(static_cast<float>(length)) & kept} << 32U | mixed;
}

// Numbers the i for which chosen(i) holds: number[i] of each, none of others, if `number` is given. Returns them.
template <class Chosen>
LargeArray<Index> select(Index n, const Chosen& chosen, Index& count, Index* number) {
  const std::int64_t chunks = (std::int64_t{n} + reduction_chunk - 1) / reduction_chunk;
  std::vector<Index> first(at(chunks));
  const auto each = [&](std::int64_t c, const auto& body) {
    for (std::int64_t i = c * reduction_chunk; i < std::min<std::int64_t>(n, (c + 1) * reduction_chunk); ++i)
      body(static_cast<Index>(i));
  };
  parallel_for(
      chunks,
      [&](std::int64_t c) {
        Index sum = 0;
        each(c, [&](Index i) { sum += chosen(i) ? 1 : 0; });
        first[at(c)] = sum;
      },
      1);
  count = 0;
  for (Index& f : first) {
    const Index here = f;
    f = count;
    count += here;
  }
  LargeArray<Index> all(at(count));
  parallel_for(
      chunks,
      [&](std::int64_t c) {
        Index next = first[at(c)];
        each(c, [&](Index i) {
          const bool yes = chosen(i);
          if (number != nullptr) number[i] = yes ? next : none;
          if (yes) all[at(next++)] = i;
        });
      },
      1);
  return all;
}

}  // namespace

FacePairs pair_faces(const Mesh& mesh, const Geometry& geometry) {
  // A sliver is so stiff in its curvature that what it passes on is the small difference of large forces; on its own it
  // does no harm, because its edges are as stiff.
  constexpr double most_cotangents = 1000;
  constexpr Index barred = -2;
  constexpr int rounds = 4;  // leave about one face in nine alone, with more rounds as many
  // The halfedge that a face names, and later the one that it shares with its mate.
  const LargeArray<Index> named(at(mesh.faces())), shared(at(mesh.faces()));
  parallel_for(mesh.faces(), [&](std::int64_t t) {
    const Index h = static_cast<Index>(3 * t);
    const double stiffness = double(geometry.cot(h)) + double(geometry.cot(h + 1)) + double(geometry.cot(h + 2));
    shared[at(t)] = stiffness > most_cotangents ? barred : none;
  });
  for (int round = 0; round < rounds; ++round) {
    parallel_for(mesh.faces(), [&](std::int64_t t) {
      Index& best = named[at(t)];
      best = none;
      if (shared[at(t)] != none) return;
      std::uint64_t most = 0;
      for (Index h = static_cast<Index>(3 * t); h < 3 * t + 3; ++h) {
        const Index g = mesh.twin(h);
        if (g == none || Mesh::face(g) == t || shared[at(Mesh::face(g))] != none) continue;
        const std::uint64_t here = rank(double(geometry.length(mesh.edge(h))), mesh.edge(h));
        if (best != none && here <= most) continue;
        best = h;
        most = here;
      }
    });
    parallel_for(mesh.faces(), [&](std::int64_t t) {
      const Index h = named[at(t)];
      if (h != none && named[at(Mesh::face(mesh.twin(h)))] == mesh.twin(h)) shared[at(t)] = h;
    });
  }
  const auto between = [&](Index e) { return shared[at(Mesh::face(mesh.halfedge(e)))] == mesh.halfedge(e); };
  FacePairs p;
  p.number = LargeArray<Index>(at(mesh.edges()));
  p.between = select(mesh.edges(), between, p.pairs, nullptr);
  p.single = select(
      mesh.faces(), [&](Index t) { return shared[at(t)] < 0; }, p.singles, nullptr);
  p.edge = select(
      mesh.edges(), [&](Index e) { return !between(e); }, p.outer, p.number.data());
  parallel_for(p.pairs, [&](std::int64_t i) { p.number[at(p.between[at(i)])] = p.outer + static_cast<Index>(i); });
  return p;
}

FacePairs single_faces(const Mesh& mesh) {
  FacePairs p;
  p.singles = mesh.faces();
  p.outer = mesh.edges();
  p.single = LargeArray<Index>(at(mesh.faces()));
  p.edge = LargeArray<Index>(at(mesh.edges()));
  p.number = LargeArray<Index>(at(mesh.edges()));
  parallel_for(mesh.faces(), [&](std::int64_t t) { p.single[at(t)] = static_cast<Index>(t); });
  parallel_for(mesh.edges(), [&](std::int64_t e) { p.edge[at(e)] = p.number[at(e)] = static_cast<Index>(e); });
  return p;
}

}  // namespace alcap::detail
