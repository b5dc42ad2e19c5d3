// SPDX-License-Identifier: MIT
#include "src/distributed/region.h"

#include <algorithm>
#include <array>

#include "src/base/array.h"
#include "src/distributed/design_place.h"

namespace alcap::detail::distributed {
namespace {

/// A face on its way to all ranks.
struct PlainFace {
  Index face;
  std::array<Index, 3> vertex;  // the user's
  std::array<double, 9> point;
  int open;  // bit k: halfedge k lies on the boundary of the surface
};

std::vector<PlainFace> faces_of_all(const Patch& patch, const std::vector<char>& chosen) {
  std::vector<PlainFace> mine;
  for (Index t = 0; t < patch.mesh.faces(); ++t) {
    if (chosen[at(t)] == 0 || patch.mine[at(t)] == 0) continue;
    PlainFace f{.face = patch.face[at(t)], .vertex = {}, .point = {}, .open = 0};
    for (Index c = 0; c < 3; ++c) {
      const Index v = patch.mesh.F()(t, c);
      f.vertex[at(c)] = patch.vertex[at(v)];
      for (Index k = 0; k < 3; ++k) f.point[at(3 * c + k)] = patch.V(v, k);
      if (patch.mesh.boundary_halfedge(3 * t + c)) f.open |= 1 << c;
    }
    mine.push_back(f);
  }
  std::vector<PlainFace> all = gather_all(mine);
  std::ranges::sort(all, {}, &PlainFace::face);
  return all;
}

}  // namespace

Index Region::find(Index users) const {
  return static_cast<Index>(std::ranges::lower_bound(face, users) - face.begin());
}

Region gather_region(const Patch& patch, const std::vector<char>& chosen) {
  const std::vector<PlainFace> all = faces_of_all(patch, chosen);
  Region region;
  std::vector<Index> vertex;  // the user's of each
  for (const PlainFace& f : all) {
    region.face.push_back(f.face);
    vertex.insert(vertex.end(), f.vertex.begin(), f.vertex.end());
  }
  std::sort(vertex.begin(), vertex.end());
  vertex.erase(std::unique(vertex.begin(), vertex.end()), vertex.end());
  Faces F(count_of(all), 3);
  for (std::size_t t = 0; t < all.size(); ++t)
    for (std::size_t c = 0; c < 3; ++c)
      F(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(c)) =
          static_cast<Index>(std::ranges::lower_bound(vertex, all[t].vertex[c]) - vertex.begin());
  const auto copies = split_fans(F, 0, static_cast<Index>(vertex.size()));
  region.V.resize(count_of(vertex) + count_of(copies), 3);
  for (std::size_t t = 0; t < all.size(); ++t)
    for (Index c = 0; c < 3; ++c)
      for (Index k = 0; k < 3; ++k) region.V(F(static_cast<Eigen::Index>(t), c), k) = all[t].point[at(3 * c + k)];
  region.mesh = Mesh(std::move(F), region.V.rows());
  region.geometry = Geometry(region.mesh, region.V);
  for (std::size_t t = 0; t < all.size(); ++t) {
    bool torn = false;
    for (Index k = 0; k < 3; ++k)
      torn = torn || (region.mesh.boundary_halfedge(static_cast<Index>(3 * t) + k) && (all[t].open >> k & 1) == 0);
    region.torn.push_back(torn ? 1 : 0);
  }
  return region;
}

std::vector<char> faces_near(const Patch& patch, const std::vector<Index>& faces, int rings) {
  std::vector<Index> near(at(patch.inner), 0);  // 1 at vertices reached so far
  const auto reach = [&](Index t) {
    for (Index c = 0; c < 3; ++c)
      if (const Index v = patch.mesh.F()(t, c); v < patch.inner) near[at(v)] = 1;
  };
  const auto touched = [&](Index t) {
    for (Index c = 0; c < 3; ++c)
      if (const Index v = patch.mesh.F()(t, c); v < patch.inner && near[at(v)] != 0) return true;
    return false;
  };
  const auto agree = [&] {
    patch.ring.reduce(near.data() + patch.owned, near.data(), MPI_MAX);
    patch.extend(near.data());
  };
  std::vector<char> chosen(at(patch.mesh.faces()), 0);
  const auto choose = [&] {
    for (Index t = 0; t < patch.mesh.faces(); ++t) chosen[at(t)] = touched(t) ? 1 : 0;
  };
  for (const Index face : faces)
    if (const Index t = own_face(patch, face); t != none) reach(t);
  agree();
  for (int ring = 0; ring < rings; ++ring) {
    choose();
    for (Index t = 0; t < patch.mesh.faces(); ++t)
      if (chosen[at(t)] != 0) reach(t);
    agree();
  }
  choose();
  return chosen;
}

}  // namespace alcap::detail::distributed
