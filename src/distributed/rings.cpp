// SPDX-License-Identifier: MIT
#include "src/distributed/rings.h"

#include <petscmat.h>

#include <algorithm>
#include <climits>

#include "src/base/array.h"

namespace alcap::detail::distributed {
namespace {

/// Where rows of so many entries start, and their sum.
std::vector<Index> starts_of(const std::vector<Index>& sizes) {
  std::vector<Index> start(sizes.size() + 1, 0);
  std::int64_t sum = 0;
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    sum += sizes[k];
    if (sum > INT_MAX) throw SolveError("a rank would get more than 2^31 corners; use more ranks");
    start[k + 1] = static_cast<Index>(sum);
  }
  return start;
}

/// Vertices joined by edges, ascending, by vertex of the slice.
struct Neighbours {
  std::vector<Index> start, vertex;
};

Neighbours neighbours_of(const Rings& rings) {
  Neighbours out;
  std::vector<Index> around, sizes;
  out.vertex.reserve(rings.corners.size());  // all of a closed mesh
  for (std::size_t v = 0; v + 1 < rings.start.size(); ++v) {
    around.clear();
    for (Index k = rings.start[v]; k < rings.start[v + 1]; ++k)
      around.insert(around.end(), {rings.corners[at(k)][2], rings.corners[at(k)][3]});
    std::sort(around.begin(), around.end());
    around.erase(std::unique(around.begin(), around.end()), around.end());
    out.vertex.insert(out.vertex.end(), around.begin(), around.end());
    sizes.push_back(static_cast<Index>(around.size()));
  }
  agreed([&] { out.start = starts_of(sizes); });
  return out;
}

/// Every rank owns the vertices of its slice.
petsc::Owned<IS, ISDestroy> as_sliced(const Rings& of_slice) {
  petsc::Owned<IS, ISDestroy> owner;
  check(ISCreateStride(PETSC_COMM_WORLD, static_cast<PetscInt>(of_slice.start.size() - 1), rank(), 0, owner.out()));
  return owner;
}

void sort_rings(Rings& rings) {
  for (std::size_t k = 0; k + 1 < rings.start.size(); ++k)
    std::sort(rings.corners.begin() + rings.start[k], rings.corners.begin() + rings.start[k + 1]);
}

}  // namespace

// PT-Scotch numbers the ends of all edges in the type of PETSc's numbers.
bool scotch_can_number(std::int64_t ends_of_edges) { return ends_of_edges <= PETSC_MAX_INT; }

Rings rings_of_slice(const MeshSlice& mesh) {
  const Slices slices(mesh.vertices);
  const auto size = static_cast<std::size_t>(mesh.F.size());
  std::vector<Index> tails(mesh.F.data(), mesh.F.data() + size);
  std::vector<Corner> corners(size);
  for (Index t = 0; t < mesh.F.rows(); ++t)
    for (Index c = 0; c < 3; ++c)
      corners[at(3 * t + c)] = {static_cast<Index>(mesh.first_face + t), c, mesh.F(t, (c + 1) % 3),
                                mesh.F(t, (c + 2) % 3)};
  const Exchange exchange(static_cast<Index>(mesh.V.rows()), slices.find(tails));
  Rings rings;
  const std::vector<Index> degrees = exchange.degrees();
  agreed([&] { rings.start = starts_of(degrees); });
  rings.corners = exchange.gather(corners, at(rings.start.back()));
  sort_rings(rings);
  return rings;
}

Rings fetch_rings(const Rings& of_slice, const Slices& slices, const std::vector<Index>& vertices) {
  const std::vector<Node> nodes = slices.find(vertices);
  const auto roots = static_cast<Index>(of_slice.start.size() - 1);
  std::vector<std::array<Index, 2>> places(at(roots));  // first corner and how many
  for (Index v = 0; v < roots; ++v)
    places[at(v)] = {of_slice.start[at(v)], of_slice.start[at(v) + 1] - of_slice.start[at(v)]};
  places = Exchange(roots, nodes).fetch(places);
  Rings rings;
  std::vector<Index> sizes;
  for (const auto& place : places) sizes.push_back(place[1]);
  agreed([&] { rings.start = starts_of(sizes); });
  std::vector<Node> corners;
  corners.reserve(at(rings.start.back()));
  for (std::size_t k = 0; k < places.size(); ++k)
    for (Index i = 0; i < places[k][1]; ++i) corners.push_back({nodes[k].rank, places[k][0] + i});
  rings.corners = Exchange(static_cast<Index>(of_slice.corners.size()), corners).fetch(of_slice.corners);
  return rings;
}

petsc::Owned<IS, ISDestroy> partition(const MeshSlice& mesh, const Rings& of_slice, PartitionMethod wanted,
                                      std::string& method) {
  constexpr std::int64_t least = 32;  // vertices per rank; for fewer a partition is not worth a message
  method = name(wanted);
  if (wanted == PartitionMethod::slices) return as_sliced(of_slice);
  if (ranks() == 1 || mesh.vertices < least * ranks()) {
    method = ranks() == 1 ? "one rank" : "slices, since there are fewer than 32 vertices per rank";
    return as_sliced(of_slice);
  }
  const Neighbours around = neighbours_of(of_slice);
  if (!scotch_can_number(sum(count_of(around.vertex)))) {
    method = "slices, since PT-Scotch cannot number so many edges";
    return as_sliced(of_slice);
  }
  // The matrix takes arrays of PETSc's own.
  PetscInt* start = nullptr;
  PetscInt* neighbour = nullptr;
  check(PetscMalloc1(around.start.size(), &start));
  check(PetscMalloc1(around.vertex.size() + 1, &neighbour));
  std::ranges::copy(around.start, start);
  std::ranges::copy(around.vertex, neighbour);
  petsc::Owned<IS, ISDestroy> owner;
  petsc::OwnedMat graph;
  check(MatCreateMPIAdj(PETSC_COMM_WORLD, static_cast<PetscInt>(around.start.size() - 1),
                        static_cast<PetscInt>(mesh.vertices), start, neighbour, nullptr, graph.out()));
  petsc::Owned<MatPartitioning, MatPartitioningDestroy> partitioning;
  check(MatPartitioningCreate(PETSC_COMM_WORLD, partitioning.out()));
  check(MatPartitioningSetAdjacency(partitioning.get(), graph.get()));
  check(MatPartitioningSetType(partitioning.get(), MATPARTITIONINGPTSCOTCH));
  check(MatPartitioningApply(partitioning.get(), owner.out()));
  return owner;
}

}  // namespace alcap::detail::distributed
