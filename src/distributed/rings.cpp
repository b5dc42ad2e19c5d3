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

void sort_rings(Rings& rings) {
  for (std::size_t k = 0; k + 1 < rings.start.size(); ++k)
    std::sort(rings.corners.begin() + rings.start[k], rings.corners.begin() + rings.start[k + 1]);
}

}  // namespace

Rings rings_of_slice(const MeshSlice& mesh) {
  const Slices slices(mesh.vertices);
  const auto size = static_cast<std::size_t>(mesh.F.size());
  std::vector<Index> tails(mesh.F.data(), mesh.F.data() + size);
  std::vector<Corner> corners(size);
  for (Index t = 0; t < mesh.F.rows(); ++t)
    for (Index c = 0; c < 3; ++c)
      corners[at(3 * t + c)] = {static_cast<Index>(3 * (mesh.first_face + t) + c), mesh.F(t, (c + 1) % 3),
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
  petsc::Owned<IS, ISDestroy> owner;
  constexpr std::int64_t least = 32;  // vertices per rank; for fewer a partition is not worth a message
  const auto size = static_cast<PetscInt>(of_slice.start.size() - 1);
  method = name(wanted);
  if (wanted == PartitionMethod::slices || ranks() == 1 || mesh.vertices < least * ranks()) {
    if (wanted != PartitionMethod::slices)
      method = ranks() == 1 ? "one rank" : "slices, since there are fewer than 32 vertices per rank";
    check(ISCreateStride(PETSC_COMM_WORLD, size, rank(), 0, owner.out()));
    return owner;
  }
  // The matrix takes arrays of PETSc's own.
  PetscInt* start = nullptr;
  PetscInt* neighbour = nullptr;
  check(PetscMalloc1(at(size) + 1, &start));
  check(PetscMalloc1(2 * of_slice.corners.size() + 1, &neighbour));
  std::vector<Index> around;
  start[0] = 0;
  for (PetscInt v = 0; v < size; ++v) {
    around.clear();
    for (Index k = of_slice.start[at(v)]; k < of_slice.start[at(v) + 1]; ++k)
      around.insert(around.end(), {of_slice.corners[at(k)][1], of_slice.corners[at(k)][2]});
    std::sort(around.begin(), around.end());
    around.erase(std::unique(around.begin(), around.end()), around.end());
    std::copy(around.begin(), around.end(), neighbour + start[v]);
    start[v + 1] = start[v] + static_cast<PetscInt>(around.size());
  }
  petsc::OwnedMat graph;
  check(MatCreateMPIAdj(PETSC_COMM_WORLD, size, static_cast<PetscInt>(mesh.vertices), start, neighbour, nullptr,
                        graph.out()));
  petsc::Owned<MatPartitioning, MatPartitioningDestroy> partitioning;
  check(MatPartitioningCreate(PETSC_COMM_WORLD, partitioning.out()));
  check(MatPartitioningSetAdjacency(partitioning.get(), graph.get()));
  check(MatPartitioningSetType(partitioning.get(), MATPARTITIONINGPTSCOTCH));
  check(MatPartitioningApply(partitioning.get(), owner.out()));
  return owner;
}

}  // namespace alcap::detail::distributed
