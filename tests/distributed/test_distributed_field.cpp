// SPDX-License-Identifier: MIT
//
// Fields over several ranks against the same on one machine: closed and open surfaces, all connections, many
// components, components smaller than the number of ranks, ranks without vertices.
#include <limits>

#include "src/distributed/stages.h"
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

TEST_CASE("large components are proven by one rank, or it is said why not") {
  const MeshData data = side_by_side({noisy_scan(3, 0.3, 11), bumpy_sphere(2, 0.3, 4)});
  const MeshSlice slice = slice_of(data.V, data.F);
  DistributedOptions options = together(2, ConnectionKind::local);
  const OneMachine one(data, ConnectionKind::local, 2);
  for (const Prove prove : {Prove::automatic, Prove::always}) {
    options.prove_smallest = prove;
    const DistributedField all = distributed_field(slice, options);
    for (std::size_t k = 0; k < all.components.size(); ++k) {
      const EigenReport &here = all.components[k].eigen, &there = one.found.components[k];
      CHECK(here.solver.starts_with("LOBPCG, covariant multigrid"));
      CHECK(here.smallest == Smallest::proven);
      REQUIRE(here.lower_bound);
      CHECK(*here.lower_bound <= here.lambda);
      CHECK(*here.lower_bound > 0.99 * here.lambda);
      REQUIRE(here.next);
      REQUIRE(there.next);
      CHECK(*here.next == doctest::Approx(*there.next).epsilon(2e-3));
      CHECK(here.smallest_note.empty());
    }
  }
  options.prove_smallest = Prove::never;
  const DistributedField unproven = distributed_field(slice, options);
  CHECK(unproven.components[0].eigen.smallest == Smallest::not_checked);
  CHECK(unproven.components[0].eigen.smallest_note == "no proof was asked for");
  CHECK_FALSE(unproven.components[0].eigen.next);
  // Too few iterations: nothing to be proven.
  options.prove_smallest = Prove::always;
  options.max_iterations = 1;
  const DistributedField early = distributed_field(slice, options);
  CHECK_FALSE(early.components[0].eigen.converged);
  CHECK(early.components[0].eigen.smallest == Smallest::not_checked);
  REQUIRE(!early.remarks.empty());
  CHECK(early.remarks[0].code == "eigen_not_converged");
  CHECK(early.remarks[0].count == 2);
  CHECK(early.remarks[0].message.find("DistributedOptions::max_iterations") != std::string::npos);
}

TEST_CASE("what is not unique or did not converge is said in the words of one machine") {
  const MeshData data = icosphere(3);  // the smallest eigenvalue is multiple
  DistributedOptions options = together(1, ConnectionKind::global);
  const DistributedField round = distributed_field(slice_of(data.V, data.F), options);
  REQUIRE(round.remarks.size() == 1);
  CHECK(round.remarks[0].code == "not_unique");
  CHECK_FALSE(round.remarks[0].warning);
  options.global.max_iterations = 1;
  const MeshData rough = noisy_scan(3, 0.3, 11);
  const DistributedField stopped = distributed_field(slice_of(rough.V, rough.F), options);
  REQUIRE(!stopped.remarks.empty());
  CHECK(stopped.remarks[0].code == "connection_not_converged");
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

TEST_CASE("faces are numbered up to 2^31, with more halfedges than an Index counts") {
  constexpr std::int64_t most = std::numeric_limits<Index>::max();
  std::size_t compared = 0;
  for (const MeshData& data : {noisy_scan(3, 0.3, 11), punctured(bumpy_sphere(3, 0.4, 3), {12, 40, 200, 333, 500})}) {
    const MeshSlice slice = slice_of(data.V, data.F);
    MeshSlice last = slice;  // the same faces, at the end of a file of 2^31 - 1
    const std::int64_t before = most - slice.faces;
    last.faces = most;
    last.first_face += before;
    for (const ConnectionKind kind : {ConnectionKind::global, ConnectionKind::metric}) {
      DistributedOptions options = together(2, kind);
      if (kind == ConnectionKind::metric) {
        options.cones = {{1, 0.3}, {77, 0.2}};
        if (data.F.rows() == 1280) options.cones.push_back({150, 1.5});  // the closed one
      }
      const DistributedField small = distributed_field(slice, options),
                             large = detail::distributed::field_of_slices(last, options);
      // PT-Scotch divides the same mesh in different ways, so iterations end elsewhere within their tolerance.
      const auto size = small.u.size() == 0 ? 0 : small.u.cwiseAbs().maxCoeff();
      CHECK((large.u - small.u).norm() <= 1e-5 * size * static_cast<double>(small.u.size()));
      CHECK((large.frames.X - small.frames.X).norm() <= 1e-5);
      CHECK(large.components[0].first_face == small.components[0].first_face + before);
      REQUIRE(large.singularities.size() == small.singularities.size());
      compared += small.singularities.size();
      for (std::size_t k = 0; k < small.singularities.size(); ++k)
        CHECK(large.singularities[k].face == small.singularities[k].face + before);
    }
    ++last.faces;
    CHECK_THROWS_AS((void)detail::distributed::field_of_slices(last, together(2, ConnectionKind::local)), MeshError);
  }
  CHECK(compared > 4);
}

TEST_CASE("trivial connection") {
  const MeshData bumpy = bumpy_sphere(3, 0.4, 3), holes = punctured(bumpy, {12, 40, 200, 333, 500});
  MeshData data = bumpy;
  DistributedOptions options = together(4, ConnectionKind::trivial);
  SUBCASE("closed") {
    for (const Index v : {1, 70, 150, 220, 300, 301, 450, 600}) options.cones.push_back({v, 0.25});
  }
  SUBCASE("open") {
    data = holes;
    options.cones = {{1, 0.25}, {600, -0.25}};
  }
  SUBCASE("metric, without a parallel field") {
    data = holes;
    options.n = 2;
    options.connection.kind = ConnectionKind::metric;
    options.cones = {{1, 0.3}};
  }
  SUBCASE("many components, one of them small") {
    data = side_by_side({bumpy_sphere(2, 0.3, 4), holes, tetrahedron()});
    const auto last = static_cast<Index>(data.V.rows() - 1);
    options.cones = {{5, 1}, {20, 1}, {last, 2}};
  }
  const MeshSlice slice = slice_of(data.V, data.F);
  const OneMachine one(data, options);
  const DistributedField all = distributed_field(slice, options);
  check_alike(one, all);
  CHECK(all.cones.size() == options.cones.size());
  REQUIRE(all.loop_index.size() == one.connection.loop_index.size());
  for (std::size_t l = 0; l < all.loop_index.size(); ++l)
    CHECK(std::abs(all.loop_index[l] - one.connection.loop_index[l]) <= 1e-9);
  REQUIRE(all.singularities.size() == one.singularities.size());
  const ComplexVectorX<double> u = one.found.field.u.segment(slice.first_vertex, all.u.size());
  CHECK((u.size() == 0 || (all.u - u).cwiseAbs().maxCoeff() <= 1e-7 * one.found.field.u.cwiseAbs().maxCoeff()));
}

TEST_CASE("trivial connections that cannot be are refused as on one machine, handles by name") {
  const MeshData closed = bumpy_sphere(3, 0.4, 3), open = disk(6);
  const auto refused = [](const MeshData& data, const DistributedOptions& options) -> std::string {
    std::string one;
    try {
      (void)OneMachine(data, options);
    } catch (const OptionError& e) {
      one = e.what();
    }
    std::string all;
    try {
      (void)distributed_field(slice_of(data.V, data.F), options);
    } catch (const OptionError& e) {
      all = e.what();
    }
    CHECK(all == one);
    return all;
  };
  DistributedOptions options = together(4, ConnectionKind::trivial);
  CHECK(refused(closed, options).find("2 is missing") != std::string::npos);
  options.cones = {{3, 2}, {9, 0.1}};
  CHECK(refused(closed, options) != "");
  options.cones = {{static_cast<Index>(closed.V.rows()), 2}};
  CHECK(refused(closed, options) != "");
  options.cones = {{static_cast<Index>(open.V.rows()) - 1, 0.5}};  // on the boundary
  CHECK(refused(open, options) != "");
  options.cones = {};
  options.loop_index = {1, 1};
  CHECK(refused(open, options) != "");
  options.loop_index = {0.5};
  CHECK(refused(open, options).find("0.5 is missing") != std::string::npos);
  options.loop_index = {};
  const MeshData torus = torus_random_diagonals(20, 10, 1, 0.4, 2);
  try {
    (void)distributed_field(slice_of(torus.V, torus.F), options);
    CHECK(false);
  } catch (const OptionError& e) {
    CHECK(e.field() == "connection");
    CHECK(std::string(e.what()).find("genus 1") != std::string::npos);
  }
  options.connection.kind = ConnectionKind::polar;
  options.cones = {{3, 2}};
  CHECK_THROWS_AS((void)distributed_field(slice_of(closed.V, closed.F), options), OptionError);
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
