// SPDX-License-Identifier: MIT
#include "src/distributed/patch.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "src/base/array.h"
#include "src/base/limits.h"
#include "src/distributed/defects.h"
#include "src/distributed/rings.h"

namespace alcap::detail::distributed {
namespace {

void check_size(const MeshSlice& mesh) {
  const std::int64_t largest = std::max(mesh.vertices, mesh.faces);
  if (largest > most_numbered)
    throw MeshError("the mesh has " + std::to_string(largest) + " vertices or faces, more than the " +
                        std::to_string(most_numbered) + " that can be numbered",
                    Defect::index_out_of_range, mesh.vertices > mesh.faces ? Element::vertex : Element::face, largest,
                    {});
  if (mesh.F.rows() > most_faces)
    throw SolveError("a rank would read more than " + std::to_string(most_faces) + " faces; use more ranks");
}

/// Defects that single faces and points have, before anything is addressed by them.
void check_slice(const MeshSlice& mesh) {
  if (mesh.faces == 0)
    throw MeshError("the mesh has no faces; check that the file is complete", Defect::empty, Element::face, 0, {});
  check_size(mesh);
  NamedDefect out{Defect::index_out_of_range, Element::face, 0, {}};
  NamedDefect repeated{Defect::repeated_vertex_in_face, Element::face, 0, {}};
  const auto add = [](NamedDefect& d, std::int64_t element) {
    constexpr std::int64_t most_named = 8;
    if (d.count++ < most_named) d.first.push_back(static_cast<Index>(element));
  };
  for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
    const auto f = mesh.F.row(t);
    if (f.minCoeff() < 0 || f.maxCoeff() >= mesh.vertices)
      add(out, mesh.first_face + t);
    else if (f(0) == f(1) || f(1) == f(2) || f(2) == f(0))
      add(repeated, mesh.first_face + t);
  }
  if (out.count > 0) throw_first_defect({out});
  if (repeated.count > 0) throw_first_defect({repeated});
}

/// A MeshError about local elements as one about the users'.
[[noreturn]] void throw_in_users_numbers(const MeshError& e, const Patch& patch) {
  NamedDefect d{e.defect(), e.element(), e.count(), {}};
  for (const Index i : e.first())
    d.first.push_back(d.element == Element::face ? patch.face[at(i)] : patch.vertex[at(i)]);
  if (d.element == Element::edge)
    for (std::size_t k = 0; k + 1 < d.first.size(); k += 2)
      if (d.first[k] > d.first[k + 1]) std::swap(d.first[k], d.first[k + 1]);
  throw_first_defect({d});
}

/// What corners say of their faces, each face once.
struct LocalFaces {
  std::vector<Index> number;  // ascending
  Faces F;                    // users' numbers of vertices
};

LocalFaces faces_of(const std::vector<Index>& vertices, const Rings& rings, LocalFaces sofar = {}) {
  struct Entry {
    Index face;
    std::array<Index, 3> f;
  };
  std::vector<Entry> entries;
  entries.reserve(rings.corners.size() + sofar.number.size());
  for (std::size_t t = 0; t < sofar.number.size(); ++t) {
    const auto f = sofar.F.row(static_cast<Eigen::Index>(t));
    entries.push_back({sofar.number[t], {f(0), f(1), f(2)}});
  }
  sofar = {};
  for (std::size_t k = 0; k < vertices.size(); ++k)
    for (Index i = rings.start[k]; i < rings.start[k + 1]; ++i) {
      const Corner& corner = rings.corners[at(i)];
      Entry e{corner[0], {}};
      const auto c = at(corner[1]);
      e.f[c] = vertices[k];
      e.f[(c + 1) % 3] = corner[2];
      e.f[(c + 2) % 3] = corner[3];
      entries.push_back(e);
    }
  std::ranges::sort(entries, {}, &Entry::face);
  const auto same_face = [](const Entry& a, const Entry& b) { return a.face == b.face; };
  entries.erase(std::unique(entries.begin(), entries.end(), same_face), entries.end());
  LocalFaces faces;
  faces.F.resize(static_cast<Eigen::Index>(entries.size()), 3);
  for (std::size_t t = 0; t < entries.size(); ++t) {
    faces.number.push_back(entries[t].face);
    for (int c = 0; c < 3; ++c) faces.F(static_cast<Eigen::Index>(t), c) = entries[t].f[at(c)];
  }
  return faces;
}

/// Vertices of the faces that are not in `known` (sorted), ascending.
std::vector<Index> others(const LocalFaces& faces, const std::vector<Index>& known) {
  std::vector<Index> all(faces.F.data(), faces.F.data() + faces.F.size());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  std::vector<Index> out;
  std::set_difference(all.begin(), all.end(), known.begin(), known.end(), std::back_inserter(out));
  return out;
}

/// Local numbers in place of the users'.
void number_faces(Patch& patch, Faces& F) {
  const auto vertices = static_cast<Index>(patch.vertex.size());
  std::vector<Index> order(at(vertices));
  std::iota(order.begin(), order.end(), Index{0});
  std::ranges::sort(order, {}, [&](Index i) { return patch.vertex[at(i)]; });
  for (Eigen::Index k = 0; k < F.size(); ++k) {
    Index& v = F.data()[k];
    v = *std::ranges::lower_bound(order, v, {}, [&](Index i) { return patch.vertex[at(i)]; });
  }
}

/// Vertices of the rim: not all faces around one are here, and those that are may not hang together.
void split_rim(Patch& patch, Faces& F) {
  for (const Index v : split_fans(F, patch.inner, static_cast<Index>(patch.vertex.size())))
    patch.vertex.push_back(patch.vertex[at(v)]);
}

/// Rows of matrices, and who owns the ring.
void number_rows(Patch& patch, const Slices& slices, const std::vector<Index>& owned, const std::vector<Index>& ring) {
  patch.first_row = static_cast<Index>(sum_before(std::int64_t{patch.owned}));
  patch.home = Exchange(slices.size(rank()), slices.find(owned));
  std::vector<Node> node(at(slices.size(rank())));
  {
    std::vector<std::array<Index, 2>> mine, here(node.size());
    for (Index i = 0; i < patch.owned; ++i) mine.push_back({rank(), i});
    patch.home.reduce(mine.data(), here.data(), MPI_REPLACE);
    const auto found = Exchange(slices.size(rank()), slices.find(ring)).fetch(here);
    for (const auto& place : found) patch.ring_node.push_back({place[0], place[1]});
  }
  patch.ring = Exchange(patch.owned, patch.ring_node);
  patch.row.resize(at(patch.inner));
  std::iota(patch.row.begin(), patch.row.begin() + patch.owned, patch.first_row);
  patch.extend(patch.row.data());
}

void mark_faces(Patch& patch, const Faces& F) {
  const auto owned = [&](Index v) { return v < patch.owned; };
  for (Eigen::Index t = 0; t < F.rows(); ++t) {
    Index smallest = F(t, 0);
    for (int c = 1; c < 3; ++c)
      if (patch.vertex[at(F(t, c))] < patch.vertex[at(smallest)]) smallest = F(t, c);
    patch.core.push_back(owned(F(t, 0)) || owned(F(t, 1)) || owned(F(t, 2)) ? 1 : 0);
    patch.mine.push_back(owned(smallest) ? 1 : 0);
  }
}

/// Points of all local vertices, by way of the slices.
void fetch_points(Patch& patch, const MeshSlice& mesh, const Slices& slices) {
  std::vector<std::array<double, 3>> points(at(mesh.V.rows()));
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) points[at(v)] = {mesh.V(v, 0), mesh.V(v, 1), mesh.V(v, 2)};
  points = Exchange(static_cast<Index>(mesh.V.rows()), slices.find(patch.vertex)).fetch(points);
  patch.V.resize(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t v = 0; v < points.size(); ++v)
    for (int c = 0; c < 3; ++c) patch.V(static_cast<Eigen::Index>(v), c) = points[v][at(c)];
}

std::vector<Index> owned_vertices(const MeshSlice& mesh, const Rings& of_slice, PartitionMethod wanted,
                                  std::string& method) {
  const auto owner = partition(mesh, of_slice, wanted, method);
  petsc::Owned<IS, ISDestroy> numbers;
  check(ISBuildTwoSided(owner.get(), nullptr, numbers.out()));
  PetscInt size = 0;
  const PetscInt* first = nullptr;
  check(ISGetLocalSize(numbers.get(), &size));
  check(ISGetIndices(numbers.get(), &first));
  std::vector<Index> owned(first, first + size);
  check(ISRestoreIndices(numbers.get(), &first));
  std::sort(owned.begin(), owned.end());
  return owned;
}

std::int64_t edges_to_others(const Patch& patch) {
  std::int64_t count = 0;
  for (Index e = 0; e < patch.mesh.edges(); ++e) {
    const Index h = patch.mesh.halfedge(e), i = patch.mesh.tail(h), j = patch.mesh.tip(h);
    count += (i < patch.owned) != (j < patch.owned) ? 1 : 0;
  }
  return sum(count) / 2;
}

}  // namespace

std::vector<Index> split_fans(Faces& F, Index from, Index count) {
  struct Spoke {  // of a corner: the edges to its neighbours
    Index vertex, neighbour, corner;
  };
  std::vector<Spoke> spokes;
  for (Index t = 0; t < F.rows(); ++t)
    for (Index c = 0; c < 3; ++c) {
      if (F(t, c) < from) continue;
      spokes.push_back({F(t, c), F(t, (c + 1) % 3), 3 * t + c});
      spokes.push_back({F(t, c), F(t, (c + 2) % 3), 3 * t + c});
    }
  std::ranges::sort(spokes, [](const Spoke& a, const Spoke& b) {
    return std::array{a.vertex, a.neighbour, a.corner} < std::array{b.vertex, b.neighbour, b.corner};
  });
  std::vector<Index> parent(at(F.size()));
  std::iota(parent.begin(), parent.end(), Index{0});
  const auto root = [&](Index c) {
    while (parent[at(c)] != c) c = parent[at(c)] = parent[at(parent[at(c)])];
    return c;
  };
  for (std::size_t k = 1; k < spokes.size(); ++k) {
    const Spoke &a = spokes[k - 1], &b = spokes[k];
    if (a.vertex != b.vertex || a.neighbour != b.neighbour) continue;
    const Index i = root(a.corner), j = root(b.corner);
    parent[at(std::max(i, j))] = std::min(i, j);
  }
  std::vector<Index> name(at(F.size()), none);  // of the fan with this root
  std::vector<char> taken(at(count), 0);
  std::vector<Index> original;
  for (Index k = 0; k < F.size(); ++k) {
    const Index v = F.data()[k];
    if (v < from) continue;
    Index& fan = name[at(root(k))];
    if (fan == none) {
      fan = taken[at(v)] == 0 ? v : static_cast<Index>(count + count_of(original));
      if (fan != v) original.push_back(v);
      taken[at(v)] = 1;
    }
  }
  for (Index k = 0; k < F.size(); ++k)
    if (F.data()[k] >= from) F.data()[k] = name[at(root(k))];
  return original;
}

VectorX<double> at_local_vertices(const Patch& patch, const VectorX<double>& owned) {
  const Slices slices(sum(std::int64_t{patch.owned}));
  const auto size = slices.size(rank());
  std::vector<double> of_slice(at(size), 0);
  patch.home.reduce(owned.data(), of_slice.data(), MPI_REPLACE);
  VectorX<double> local(count_of(patch.vertex));
  Exchange(size, slices.find(patch.vertex)).fetch(of_slice.data(), local.data());
  return local;
}

Partitioned make_patch(const MeshSlice& mesh, PartitionMethod method) {
  agreed([&] { check_slice(mesh); });
  const Slices slices(mesh.vertices);
  Partitioned out;
  Patch& patch = out.patch;
  Rings of_slice = rings_of_slice(mesh);
  const std::vector<Index> owned = owned_vertices(mesh, of_slice, method, out.method);
  LocalFaces faces = faces_of(owned, fetch_rings(of_slice, slices, owned));
  const std::vector<Index> ring = others(faces, owned);
  faces = faces_of(ring, fetch_rings(of_slice, slices, ring), std::move(faces));
  of_slice = {};
  patch.owned = static_cast<Index>(owned.size());
  patch.inner = patch.owned + static_cast<Index>(ring.size());
  patch.vertex = owned;
  patch.vertex.insert(patch.vertex.end(), ring.begin(), ring.end());
  std::vector<Index> sorted = patch.vertex;
  std::sort(sorted.begin(), sorted.end());
  const std::vector<Index> rim = others(faces, sorted);
  patch.vertex.insert(patch.vertex.end(), rim.begin(), rim.end());
  patch.face = std::move(faces.number);
  number_faces(patch, faces.F);
  split_rim(patch, faces.F);
  number_rows(patch, slices, owned, ring);
  mark_faces(patch, faces.F);
  fetch_points(patch, mesh, slices);
  agreed([&] {
    if (patch.empty()) return;
    try {
      patch.mesh = Mesh(std::move(faces.F), count_of(patch.vertex));
    } catch (const MeshError& e) {
      throw_in_users_numbers(e, patch);
    }
  });
  out.cut_edges = edges_to_others(patch);
  return out;
}

void measure(Patch& patch) {
  agreed([&] {
    if (patch.empty()) return;
    try {
      patch.geometry = Geometry(patch.mesh, patch.V);
    } catch (const MeshError& e) {
      throw_in_users_numbers(e, patch);
    }
  });
}

}  // namespace alcap::detail::distributed
