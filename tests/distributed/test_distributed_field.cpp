// SPDX-License-Identifier: MIT
//
// Fields over several ranks against the same on one machine: closed and open surfaces, all connections, many
// components, components smaller than the number of ranks, ranks without vertices.
#include "tests/distributed/ranks_fixture.h"

using namespace alcap;
using namespace alcap::test;

namespace {

// Least gather_below: what has more vertices is solved by all ranks together.
DistributedOptions together(int n, ConnectionKind kind) {
  return {.n = n, .connection = {kind}, .tolerance = 1e-9, .gather_below = 100};
}

}  // namespace

TEST_CASE("a closed surface, all connections") {
  const MeshData data = noisy_scan(3, 0.3, 11);
  const MeshSlice slice = slice_of(data.V, data.F);
  for (const ConnectionKind kind : {ConnectionKind::polar, ConnectionKind::local, ConnectionKind::global}) {
    CAPTURE(std::string(name(kind)));
    const OneMachine one(data, kind, 2);
    const DistributedField all = distributed_field(slice, together(2, kind));
    check_alike(one, all);
    check_same_field(one, slice, all);
  }
}

TEST_CASE("polar frames are those of one machine to the last bit") {
  const MeshData data = jittered_sphere(3, 0.2, 3);
  const MeshSlice slice = slice_of(data.V, data.F);
  const OneMachine one(data, ConnectionKind::polar, 1);
  const DistributedField all = distributed_field(slice, together(1, ConnectionKind::polar));
  const auto rows = all.u.size();
  CHECK(all.frames.X == Positions<double>(one.frames.X.middleRows(slice.first_vertex, rows)));
  CHECK(all.frames.N == Positions<double>(one.frames.N.middleRows(slice.first_vertex, rows)));
}

TEST_CASE("degrees and energies") {
  const MeshData data = bumpy_sphere(3, 0.4, 3);
  const MeshSlice slice = slice_of(data.V, data.F);
  for (const int n : {1, 4}) {
    for (const double s : {0.0, 0.5}) {
      CAPTURE(n);
      CAPTURE(s);
      DistributedOptions options = together(n, ConnectionKind::global);
      options.s = s;
      const DistributedField all = distributed_field(slice, options);
      check_alike(OneMachine(data, ConnectionKind::global, n, s), all);
      CHECK(all.components[0].indices.sum == 2 * n);
    }
  }
}

TEST_CASE("open surfaces, handles, slivers") {
  for (const MeshData& data :
       {disk(12), cylinder(20, 20), torus_random_diagonals(30, 16, 1, 0.4, 2), genus_surface(2, 3), cad_like(24, 6)}) {
    const MeshSlice slice = slice_of(data.V, data.F);
    const OneMachine one(data, ConnectionKind::global, 4);
    const DistributedField all = distributed_field(slice, together(4, ConnectionKind::global));
    check_alike(one, all);
  }
}

TEST_CASE("many components, and vertices that no face uses") {
  MeshData data = side_by_side({noisy_scan(3, 0.2, 5), tetrahedron(), single_triangle(), icosphere(0),
                                bumpy_sphere(3, 0.3, 4), disk(3), cube()});
  data.V.conservativeResize(data.V.rows() + 3, 3);
  data.V.bottomRows(3).setOnes();
  const MeshSlice slice = slice_of(data.V, data.F);
  for (const PartitionMethod method : {PartitionMethod::scotch, PartitionMethod::slices}) {
    DistributedOptions options = together(1, ConnectionKind::global);
    options.partition = method;
    const OneMachine one(data, ConnectionKind::global, 1);
    const DistributedField all = distributed_field(slice, options);
    check_alike(one, all);
    CHECK(all.components[1].eigen.smallest == one.found.components[1].smallest);
    for (Eigen::Index v = 0; v < all.u.size(); ++v)
      if (slice.first_vertex + v >= data.V.rows() - 3) CHECK(all.u[v] == 0.0);
  }
}

TEST_CASE("fewer vertices than ranks, ranks without any") {
  for (const MeshData& data : {single_triangle(), tetrahedron(), side_by_side({tetrahedron(), single_triangle()})}) {
    const MeshSlice slice = slice_of(data.V, data.F);
    const OneMachine one(data, ConnectionKind::global, 2);
    check_alike(one, distributed_field(slice, together(2, ConnectionKind::global)));
  }
  // All of the surface in the last slice.
  MeshData far = icosphere(1);
  MeshData data{Positions<double>::Zero(far.V.rows() * 8, 3), far.F};
  data.V.bottomRows(far.V.rows()) = far.V;
  data.F.array() += static_cast<Index>(7 * far.V.rows());
  DistributedOptions options = together(1, ConnectionKind::global);
  options.partition = PartitionMethod::slices;
  check_alike(OneMachine(data, ConnectionKind::global, 1), distributed_field(slice_of(data.V, data.F), options));
}

TEST_CASE("a shuffled mesh gives the same field") {
  const MeshData data = noisy_scan(3, 0.3, 11);
  const auto n = static_cast<Index>(data.V.rows());
  MeshData shuffled{Positions<double>(n, 3), data.F};
  const auto to = [n](Index v) { return static_cast<Index>((std::int64_t{v} * 7919 + 13) % n); };
  REQUIRE(n % 7919 != 0);
  for (Index v = 0; v < n; ++v) shuffled.V.row(to(v)) = data.V.row(v);
  for (Eigen::Index k = 0; k < data.F.size(); ++k) shuffled.F.data()[k] = to(data.F.data()[k]);
  const MeshSlice slice = slice_of(shuffled.V, shuffled.F);
  for (const PartitionMethod method : {PartitionMethod::scotch, PartitionMethod::slices}) {
    DistributedOptions options = together(2, ConnectionKind::global);
    options.partition = method;
    const OneMachine one(shuffled, ConnectionKind::global, 2);
    const DistributedField all = distributed_field(slice, options);
    check_alike(one, all);
    check_same_field(one, slice, all);
  }
}
