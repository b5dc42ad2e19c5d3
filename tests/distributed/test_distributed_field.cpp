// SPDX-License-Identifier: MIT
//
// Fields over several ranks against the same on one machine. Run by mpirun on 1 to 4 ranks.
#include <doctest/doctest.h>

#include <string>

#include "alcap/connected_surface.h"
#include "alcap/distributed.h"
#include "alcap/generators.h"
#include "alcap/smoothest.h"

using namespace alcap;

TEST_CASE("a polar field") {
  const MeshData data = bumpy_sphere(4, 0.3, 5);
  for (const ConnectionKind kind : {ConnectionKind::polar, ConnectionKind::local, ConnectionKind::global}) {
    CAPTURE(std::string(name(kind)));
    const Surface surface(data.V, data.F);
    const Mesh mesh(data.F, data.V.rows());
    const Geometry geometry(mesh, data.V);
    const Connection c = kind == ConnectionKind::polar   ? polar(mesh, geometry)
                         : kind == ConnectionKind::local ? locally_optimal(mesh, geometry)
                                                         : globally_optimal(mesh, geometry);
    const SmoothestResult one = smoothest_field(mesh, geometry, c, nullptr, {.n = 4, .eigen = {.tolerance = 1e-9}});
    const DistributedField all = distributed_field(
        slice_of(data.V, data.F), {.n = 4, .connection = {kind}, .tolerance = 1e-9, .gather_below = 100});
    CHECK(all.connection.D_T == doctest::Approx(c.report.D_T).epsilon(1e-10));
    CHECK(all.connection.D_E == doctest::Approx(c.report.D_E).epsilon(1e-10));
    REQUIRE(all.components.size() == 1);
    MESSAGE(all.components[0].eigen.solver << " " << all.components[0].eigen.iterations << " " << all.components[0].eigen.lambda << " " << one.components[0].lambda << " res "
                                       << all.components[0].eigen.residual << " conn its " << all.connection.iterations << " vs " << c.report.iterations);
    CHECK(all.components[0].eigen.lambda == doctest::Approx(one.components[0].lambda).epsilon(1e-8));
    CHECK(all.components[0].indices.sum == 8);
    CHECK(all.components[0].indices.expected == 8);
    const auto singular = find_singularities(mesh, geometry, c, one.field);
    CHECK(all.singularities.size() == singular.size());
  }
}
