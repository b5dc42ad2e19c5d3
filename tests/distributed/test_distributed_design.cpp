// SPDX-License-Identifier: MIT
//
// Designs over several ranks against the same on one machine: every control that is there, singular systems, many
// components, and what is refused.
#include <algorithm>
#include <filesystem>

#include "alcap/alignment.h"
#include "alcap/connected_surface.h"
#include "alcap/distributed_design.h"
#include "src/run/design_stages.h"
#include "tests/distributed/ranks_fixture.h"

using namespace alcap;
using namespace alcap::test;

namespace {

using Source = DesignGuidance::Source;

/// run_design() with the tolerances of the ranks: of the connection and of the eigenvector.
struct OneDesign {
  OneDesign(const MeshData& data, const DesignFile& design) : surface(data.V, data.F) {
    placed = place_design(design, surface);
    ConnectionOptions connection = connection_options(placed);
    connection.global.tolerance = 1e-10;
    connected = connect(surface, connection);
    const DesignGuidance& g = placed.guidance;
    const bool guided = g.source != Source::nothing;
    Designer designer(connected,
                      {.n = placed.n, .guidance_weight = guided && !g.t ? g.weight : 0.0, .t = g.t, .s = placed.s});
    if (g.source == Source::smoothest) {
      const ComplexVectorX<double> u =
          smoothest_field(connected, {.n = placed.n, .s = placed.s, .eigen = {.tolerance = 1e-12}}).field.u;
      designer.set_guidance(u / root_mean_square(surface, u));
    } else if (guided && g.source != Source::zero) {
      designer.set_guidance(*detail::find_guidance(connected, placed, g.source, "auto").u);
    }
    if (!g.weights.empty())
      designer.set_guidance_weights(
          Eigen::Map<const VectorX<double>>(g.weights.data(), static_cast<Eigen::Index>(g.weights.size())));
    for (const DesignControl& c : design_controls(placed, connected)) (void)designer.add(c.control);
    result = designer.solve();
  }
  Surface surface;
  DesignFile placed;
  ConnectedSurface connected;
  DesignResult result;
};

DistributedDesignOptions together() { return {.eigen_tolerance = 1e-11, .gather_below = 100}; }

/// How far the ranks' field is from one machine's, relative to its longest vector.
double error_of(const ComplexVectorX<double>& one, const MeshSlice& slice, const DistributedField& all) {
  double most = 0;
  for (Eigen::Index v = 0; v < all.u.size(); ++v)
    most = std::max(most, std::abs(all.u[v] - one[slice.first_vertex + v]));
  return most / one.cwiseAbs().maxCoeff();
}

/// The field and what became of the controls.
void check_alike(const MeshData& data, const DesignFile& design, double digits = 1e-8,
                 const DistributedDesignOptions& options = together()) {
  const OneDesign one(data, design);
  const MeshSlice slice = slice_of(data.V, data.F);
  const DistributedDesign all = distributed_design(slice, design, options);
  // Nothing decides a turn that all frames of a flat connection have in common.
  if (one.connected.connection().flat && all.u.size() > 0) {
    const auto rows = all.u.size();
    const Frames& frames = *one.connected.frames();
    const Field there =
        on_frames({all.n, all.u, std::make_shared<const Frames>(all.frames)},
                  std::make_shared<const Frames>(Frames{frames.X.middleRows(slice.first_vertex, rows),
                                                        frames.N.middleRows(slice.first_vertex, rows)}));
    DistributedField moved;
    moved.u = there.u;
    CHECK(error_of(one.result.field.u, slice, moved) <= digits);
  } else {
    CHECK(error_of(one.result.field.u, slice, all) <= digits);
  }
  CHECK(all.residual <= 1e-11);
  CHECK(all.certificate.holds());
  REQUIRE(all.outcomes.size() == one.result.controls.size() + one.placed.connection.cones.size());
  for (std::size_t k = one.result.controls.size(); k < all.outcomes.size(); ++k) CHECK(all.outcomes[k].met);
  for (std::size_t k = 0; k < one.result.controls.size(); ++k) {
    CAPTURE(k);
    CHECK(all.outcomes[k].met == one.result.controls[k].met);
    CHECK(all.outcomes[k].index == one.result.controls[k].index);
    CHECK(std::abs(all.outcomes[k].error_degrees - one.result.controls[k].error_degrees) <= 1e-5);
  }
  CHECK(all.design.singularities.size() == one.placed.singularities.size());
  for (std::size_t k = 0; k < all.design.singularities.size(); ++k)
    CHECK(all.design.singularities[k].face == one.placed.singularities[k].face);
  for (std::size_t k = 0; k < all.design.fixed.size(); ++k)
    CHECK(all.design.fixed[k].vertex == one.placed.fixed[k].vertex);
}

/// A walk along edges, from the first vertex of a face on, always to the neighbour that is largest by number.
std::vector<Index> walk(const MeshData& data, Index from, int steps) {
  const Mesh mesh(data.F, data.V.rows());
  std::vector<Index> path{from};
  for (int k = 0; k < steps; ++k) {
    Index best = none;
    mesh.for_each_outgoing(path.back(), [&](Index h) {
      if (std::ranges::find(path, mesh.tip(h)) == path.end()) best = std::max(best, mesh.tip(h));
    });
    if (best == none) break;
    path.push_back(best);
  }
  return path;
}

DesignFile crosses() {
  DesignFile d{.n = 4};
  d.singularities = {{.face = 17, .kind = SingularityKind::saddle, .angle = 20},
                     {.face = 400, .kind = SingularityKind::source, .relative_to = Vector3{0, 0, 1}},
                     {.face = 801, .kind = SingularityKind::saddle, .angle = -50, .strength = 3, .pin = true}};
  d.fixed = {{.vertex = 5, .direction = Vector3{1, 2, 3}}, {.vertex = 200, .angle = 12.0, .free_length = true}};
  return d;
}

}  // namespace

TEST_CASE("targets, pins and fixed vertices, all connections") {
  const MeshData data = noisy_scan(3, 0.2, 11);
  for (const ConnectionKind kind : {ConnectionKind::polar, ConnectionKind::local, ConnectionKind::global}) {
    CAPTURE(std::string(name(kind)));
    DesignFile design = crosses();
    design.connection.kind = kind;
    check_alike(data, design);
  }
}

TEST_CASE("strokes along edges, guidance towards zero, energies") {
  const MeshData data = noisy_scan(3, 0.2, 11);
  DesignFile design = crosses();
  design.strokes = {{.vertices = walk(data, 30, 12)}, {.vertices = walk(data, 333, 5), .weight = 20}};
  design.guidance = {.source = Source::zero, .weight = 0.5};
  design.s = 0.5;
  DistributedDesignOptions slices = together();
  slices.partition = PartitionMethod::slices;
  check_alike(data, design, 1e-8, slices);
}

TEST_CASE("vector fields: sources, sinks, vortices") {
  const MeshData data = bumpy_sphere(3, 0.3, 4);
  DesignFile design;
  design.connection.kind = ConnectionKind::polar;
  design.singularities = {{.face = 3, .kind = SingularityKind::source},
                          {.face = 600, .kind = SingularityKind::vortex, .pin = true},
                          {.face = 900, .kind = SingularityKind::sink, .strength = 2}};
  check_alike(data, design);
}

TEST_CASE("smoothest guidance, with a weight, weights per vertex, and t") {
  const MeshData data = bumpy_sphere(2, 0.3, 3);
  DesignFile design{.n = 4};
  design.singularities = {{.face = 17, .kind = SingularityKind::saddle, .pin = true}};
  design.fixed = {{.vertex = 5, .direction = Vector3{1, 2, 3}}};
  design.guidance = {.source = Source::smoothest, .weight = 2};
  check_alike(data, design);
  for (Eigen::Index v = 0; v < data.V.rows(); ++v) design.guidance.weights.push_back(0.1 + static_cast<double>(v % 7));
  check_alike(data, design);
  design.guidance = {.source = Source::smoothest, .t = -0.5};
  check_alike(data, design);
  design.guidance.t = 0.5;
  check_alike(data, design);
  design.guidance.t = 1e3;
  CHECK_THROWS_AS(check_alike(data, design), OptionError);
  CHECK_THROWS_AS((void)distributed_design(slice_of(data.V, data.F), design, together()), OptionError);
}

TEST_CASE("targets of several zeros, whose faces may be those of several ranks") {
  const MeshData data = noisy_scan(3, 0.2, 11);
  DesignFile design = crosses();
  design.singularities[0].count = 2;
  design.singularities[1].count = 4;  // index 1: its angle is a swirl
  design.singularities[1].relative_to = std::nullopt;
  design.singularities[2].count = 3;  // pinned
  check_alike(data, design);
  // On a small component the walk sees all of it; eight zeros do not fit.
  DesignFile many{.n = 4};
  many.singularities = {{.face = 1, .kind = SingularityKind::source, .count = 2}};
  check_alike(bumpy_sphere(1, 0.3, 5), many);
  many.singularities[0].count = 8;
  const MeshData small = icosphere(0);
  try {
    (void)distributed_design(slice_of(small.V, small.F), many, together());
    CHECK(false);
  } catch (const OptionError& e) {
    CHECK(e.field() == "/singularities/0");
    CHECK(e.rule().find("has room for") != std::string::npos);
  }
}

TEST_CASE("strokes through points and along paths in space") {
  const MeshData data = noisy_scan(3, 0.2, 11);
  DesignFile design = crosses();
  const std::array<double, 3> middle{0.2, 0.3, 0.5};
  design.strokes = {// Far apart, so that they cross many faces; one twice, one at a vertex, one on an edge.
                    {.points = {{.face = 100, .barycentric = middle},
                                {.face = 700, .barycentric = {1, 0, 0}},
                                {.face = 700, .barycentric = {1, 0, 0}},
                                {.face = 1200, .barycentric = {0, 0.25, 0.75}}},
                     .weight = 2},
                    {.path = {{1, 0, 0.2}, {0.3, 1, 0.4}, {-0.5, 0.6, 0.7}, {1, 0, 0.2}}},
                    {.points = {{.face = 60, .barycentric = middle}, {.at = Vector3{0, 0, 2}}}}};
  check_alike(data, design);
  // Refused as on one machine.
  const MeshData apart = side_by_side({data, bumpy_sphere(2, 0.3, 3)});
  for (const std::vector<DesignPoint>& points :
       {std::vector<DesignPoint>{{.face = 100, .barycentric = middle},
                                 {.face = static_cast<Index>(apart.F.rows()) - 1, .barycentric = middle}},
        std::vector<DesignPoint>{{.face = 100, .barycentric = middle}, {.face = 100, .barycentric = middle}}}) {
    design.strokes = {{.points = points}};
    std::string one, all;
    try {
      (void)OneDesign(apart, design);
    } catch (const OptionError& e) {
      one = e.what();
    }
    try {
      (void)distributed_design(slice_of(apart.V, apart.F), design, together());
    } catch (const OptionError& e) {
      all = e.what();
    }
    CHECK(one != "");
    CHECK(all == one);
  }
}

TEST_CASE("guidance by curvature") {
  const MeshData data = noisy_scan(3, 0.2, 11);
  DesignFile design = crosses();
  design.guidance = {.source = Source::curvature, .weight = 2};
  check_alike(data, design);
  design = {.n = 2, .guidance = {.source = Source::strongest_curvature, .t = -1.0}};
  check_alike(data, design);
  design.guidance = {.source = Source::least_curvature, .weight = 0.5};
  design.boundary.wanted = true;
  check_alike(cylinder(16, 14), design);
}

TEST_CASE("guidance from a file, of which every rank reads its slice") {
  const MeshData data = noisy_scan(3, 0.2, 11);
  const MeshSlice slice = slice_of(data.V, data.F);
  const std::string path =
      (std::filesystem::temp_directory_path() / ("alcap_guidance_" + std::to_string(distributed_ranks()) + ".ply"))
          .string();
  DistributedField field = distributed_field(slice, {.n = 4, .connection = {ConnectionKind::polar}});
  write_distributed_ply(path, slice, field);
  DesignFile design = crosses();
  design.guidance = {.source = Source::file, .file = path};
  check_alike(data, design);  // with the global connection: the frames are others
  const auto message = [&](const MeshData& mesh, int n) -> std::string {
    DesignFile other{.n = n};
    other.guidance = design.guidance;
    try {
      (void)distributed_design(slice_of(mesh.V, mesh.F), other, together());
    } catch (const FileError& e) {
      return e.what();
    }
    return "";
  };
  CHECK(message(noisy_scan(3, 0.2, 12), 4).find("on another mesh") != std::string::npos);
  CHECK(message(bumpy_sphere(2, 0.3, 3), 4).find("on another mesh") != std::string::npos);
  CHECK(message(data, 1).find("n = 4") != std::string::npos);
  on_first_rank([&] { std::filesystem::remove(path); });
  CHECK(message(data, 4) != "");
}

TEST_CASE("on a trivial connection") {
  const MeshData data = bumpy_sphere(3, 0.3, 4);
  DesignFile design{.n = 2};
  design.connection = {.kind = ConnectionKind::trivial, .cones = {{5, 1}, {300, 0.5}}};
  design.connection.cones_at = {{.at = Vector3{0, 0, -3}, .index = 0.5}};
  design.fixed = {{.vertex = 200, .direction = Vector3{1, 2, 3}}};
  design.strokes = {{.path = {{1, 0, 0.2}, {0.3, 1, 0.4}}}};
  check_alike(data, design);
  design.connection.cones[0].index = 2;  // the sum is too large by one
  CHECK_THROWS_AS((void)distributed_design(slice_of(data.V, data.F), design, together()), OptionError);
}

TEST_CASE("places in space") {
  const MeshData data = noisy_scan(3, 0.2, 11);
  DesignFile design{.n = 2};
  design.singularities = {{.at = Vector3{1, 0.2, 0.1}, .kind = SingularityKind::wedge, .pin = true},
                          {.at = Vector3{-2, 1, 0}, .kind = SingularityKind::trisector}};
  design.fixed = {{.at = Vector3{0, 0, -3}, .direction = Vector3{1, 0, 0}}};
  check_alike(data, design);
}

TEST_CASE("along the boundary") {
  const MeshData data = cylinder(16, 14);
  DesignFile design{.n = 4};
  design.boundary = {.wanted = true};
  design.singularities = {{.face = 200, .kind = SingularityKind::source}};
  check_alike(data, design);
  design.boundary.normal = true;
  design.boundary.weight = 0.1;
  design.guidance = {.source = Source::zero, .weight = 0.1};
  check_alike(data, design);
}

TEST_CASE("flat surfaces, where parallel fields are free") {
  const MeshData data = disk(6);
  DesignFile design{.n = 1};
  design.connection.kind = ConnectionKind::polar;
  design.singularities = {{.face = 40, .kind = SingularityKind::source}};
  const MeshSlice slice = slice_of(data.V, data.F);
  CHECK_THROWS_AS((void)distributed_design(slice, design, together()), OptionError);
  SUBCASE("a fixed vertex") { design.fixed = {{.vertex = 90, .direction = Vector3{1, 0, 0}}}; }
  SUBCASE("directions alone") { design.fixed = {{.vertex = 90, .direction = Vector3{1, 0, 0}, .free_length = true}}; }
  SUBCASE("a pin") { design.singularities[0].pin = true; }
  SUBCASE("a stroke") { design.strokes = {{.vertices = walk(data, 20, 4)}}; }
  SUBCASE("guidance towards zero") { design.guidance = {.source = Source::zero}; }
  // Directions alone leave the length to a weight of 1e-6: what it decides has as many digits less.
  check_alike(data, design, 1e-7);
}

TEST_CASE("many components, without controls on some, and vertices that no face uses") {
  const MeshData scan = noisy_scan(3, 0.2, 5);
  const auto tetrahedron_vertex = static_cast<Index>(scan.V.rows() + 2);
  MeshData data = side_by_side({scan, tetrahedron(), bumpy_sphere(2, 0.3, 4), icosphere(0)});
  data.V.conservativeResize(data.V.rows() + 3, 3);
  data.V.bottomRows(3).setOnes();
  DesignFile design = crosses();
  design.connection.kind = ConnectionKind::polar;
  design.fixed.push_back({.vertex = tetrahedron_vertex, .angle = 5.0});
  const Surface surface(data.V, data.F);
  const DesignRun one = run_design(surface, design, {.triangulation = Triangulation::extrinsic});
  const MeshSlice slice = slice_of(data.V, data.F);
  const DistributedDesign all = distributed_design(slice, design, together());
  CHECK(all.certificate.holds());
  const auto note = [](const std::vector<Remark>& remarks) {
    return std::ranges::find(remarks, "pieces_without_control", &Remark::code);
  };
  REQUIRE(note(all.remarks) != all.remarks.end());
  REQUIRE(note(one.remarks) != one.remarks.end());
  CHECK(note(all.remarks)->first == note(one.remarks)->first);
  CHECK(note(all.remarks)->message == note(one.remarks)->message);
  REQUIRE(all.components.size() == 4);
  CHECK(all.components[0].eigen.solver.empty());
  CHECK(!all.components[2].eigen.solver.empty());
  // Smoothest fields of bumpy spheres are unique, of the regular one only their size is.
  double most = 0;
  for (Eigen::Index v = 0; v < all.u.size(); ++v) {
    const Eigen::Index at = slice.first_vertex + v;
    const Index c = surface.topology().vertex_component[static_cast<std::size_t>(at)];
    if (c == none) CHECK(all.u[v] == 0.0);
    if (c == 0 || c == 1) most = std::max(most, std::abs(all.u[v] - one.field.u[at]));
    if (c == 2) CHECK(std::abs(std::abs(all.u[v]) - std::abs(one.field.u[at])) < 1e-4);
  }
  CHECK(most <= 1e-8 * one.field.u.cwiseAbs().maxCoeff());
}

TEST_CASE("the outcomes of run_design, fewer vertices than ranks, and nothing asked") {
  const MeshData data = tetrahedron();
  DesignFile design;
  design.connection.kind = ConnectionKind::polar;
  design.singularities = {{.face = 2, .kind = SingularityKind::source, .pin = true}};
  design.fixed = {{.vertex = 1, .angle = 40.0}};
  const DesignRun one = run_design(Surface(data.V, data.F), design, {.triangulation = Triangulation::extrinsic});
  const MeshSlice slice = slice_of(data.V, data.F);
  const DistributedDesign all = distributed_design(slice, design, together());
  CHECK(error_of(one.field.u, slice, all) <= 1e-10);
  REQUIRE(all.outcomes.size() == one.outcomes.size());
  for (std::size_t k = 0; k < all.outcomes.size(); ++k) {
    const DesignOutcome &a = all.outcomes[k], &b = one.outcomes[k];
    CHECK(a.type == b.type);
    CHECK(a.number == b.number);
    CHECK(a.path == b.path);
    CHECK(a.name == b.name);
    CHECK(a.met == b.met);
    CHECK(a.tolerance_degrees == b.tolerance_degrees);
    CHECK(a.tolerance_relative == b.tolerance_relative);
    CHECK(a.found.has_value() == b.found.has_value());
    CHECK(a.length_at_pin == doctest::Approx(b.length_at_pin).epsilon(1e-6));
    REQUIRE(a.control.has_value());
    CHECK(a.control->index() == b.control->index());
  }
  CHECK(std::get<SingularityTarget>(*all.outcomes[0].control).face == 2);
  CHECK(std::get<VertexConstraint>(*all.outcomes[1].control).vertex == 1);

  const DistributedDesign smooth = distributed_design(slice, DesignFile{.n = 2}, together());
  double square = 0;
  for (Eigen::Index v = 0; v < all.u.size(); ++v) square += std::norm(smooth.u[v]) / 4;
  CHECK(smooth.certificate.holds());
  CHECK(smooth.rows + smooth.solves == 0);
  CHECK(square <= 1 + 1e-9);
}

TEST_CASE("controls are met within the tolerances of their kinds") {
  const MeshData data = bumpy_sphere(3, 0.2, 3);
  const MeshSlice slice = slice_of(data.V, data.F);
  DesignFile design{.n = 4};
  design.guidance = {.source = DesignGuidance::Source::zero};
  design.singularities = {{.face = 100, .kind = SingularityKind::saddle, .angle = 20}};
  design.strokes = {{.vertices = {data.F(0, 0), data.F(0, 1)}, .weight = 0.1}};
  const DistributedDesign usual = distributed_design(slice, design, together());
  for (const double factor : {1.01, 0.99}) {
    DistributedDesignOptions options = together();
    options.tolerances.singularity_degrees = factor * usual.outcomes[0].error_degrees;
    options.tolerances.stroke_degrees = factor * usual.outcomes[1].error_degrees;
    const DistributedDesign judged = distributed_design(slice, design, options);
    for (const DesignOutcome& outcome : judged.outcomes) {
      CAPTURE(outcome.path);
      CHECK(outcome.met == (factor > 1));
    }
    CHECK(judged.outcomes[1].tolerance_degrees == options.tolerances.stroke_degrees);
  }
  DistributedDesignOptions wrong = together();
  wrong.tolerances.cone_degrees = 0;
  CHECK_THROWS_AS((void)distributed_design(slice, design, wrong), OptionError);
}

TEST_CASE("what needs one machine is refused by name, and what is wrong as there") {
  const MeshData data = noisy_scan(3, 0.2, 11);
  const MeshSlice slice = slice_of(data.V, data.F);
  const auto field_of = [&](const DesignFile& design) -> std::string {
    try {
      (void)distributed_design(slice, design, together());
    } catch (const OptionError& e) {
      return e.field();
    }
    return "";
  };
  const auto with = [&](auto&& change) {
    DesignFile design = crosses();
    change(design);
    return field_of(design);
  };
  CHECK(with([](DesignFile& d) { d.connection = {.kind = ConnectionKind::trivial, .balance = true}; }) ==
        "/connection/balance");
  CHECK(with([](DesignFile& d) {
          d.connection = {.kind = ConnectionKind::trivial, .holonomy = {0.25, 0}};
        }) == "/connection/holonomy");
  CHECK(with([](DesignFile& d) {
          d.connection.kind = ConnectionKind::metric;
          d.connection.target.vertex_curvature = VectorX<double>::Zero(3);
        }) == "/connection/target");
  CHECK(with([](DesignFile& d) { d.strokes = {{.points = {{.face = 1}, {.face = 2}}}}; }) != "");
  CHECK(with([&](DesignFile& d) { d.strokes = {{.vertices = walk(data, 3, 3), .radius = 0.1}}; }) ==
        "/strokes/0/radius");
  CHECK(with([](DesignFile& d) { d.strokes = {{.vertices = {0, 500}}}; }) == "/strokes/0/vertices");
  CHECK(with([](DesignFile& d) { d.features.wanted = true; }) == "/features");
  CHECK(with([](DesignFile& d) { d.edits = {{.which = 0, .to = 3}}; }) == "/edits");
  CHECK(with([](DesignFile& d) {
          d.singularities.clear();
          d.fixed.clear();
          d.boundary.wanted = true;
        }) == "/boundary");
  CHECK(with([](DesignFile& d) {
          d.method = DesignMethod::eigen;
          d.singularities[2].pin = false;
        }) == "/method");
  // As on one machine.
  CHECK(with([](DesignFile& d) { d.fixed[0].vertex = 100000; }) == "/fixed/0/vertex");
  CHECK(with([](DesignFile& d) { d.singularities[0].face = 100000; }) == "/singularities/0/face");
  CHECK(with([](DesignFile& d) { d.mesh = DesignMesh{10, 16}; }) == "/mesh/vertices");
  CHECK(with([](DesignFile& d) { d.s = 2; }) == "/s");
  CHECK(with([&](DesignFile& d) {
          const Eigen::RowVector3d normal = connect(Surface(data.V, data.F)).frames()->N.row(5);
          d.fixed[0].direction = Vector3{normal[0], normal[1], normal[2]};
        }) == "/fixed/0/direction");
  const MeshData torus = torus_random_diagonals(20, 10, 1, 0.4, 2);
  try {
    const DesignFile flat{.connection = {.kind = ConnectionKind::trivial}};
    (void)distributed_design(slice_of(torus.V, torus.F), flat, together());
    CHECK(false);
  } catch (const OptionError& e) {
    CHECK(e.field() == "/connection/kind");
  }
  const MeshData closed = icosphere(2);
  const DesignFile along{.n = 1, .boundary = {.wanted = true}};
  CHECK_THROWS_AS((void)distributed_design(slice_of(closed.V, closed.F), along, together()), OptionError);
  MeshData more = data;
  more.V.conservativeResize(data.V.rows() + 1, 3);
  more.V.bottomRows(1).setOnes();
  DesignFile unused = crosses();
  unused.fixed[0].vertex = static_cast<Index>(data.V.rows());
  CHECK_THROWS_AS((void)distributed_design(slice_of(more.V, more.F), unused, together()), OptionError);
}
