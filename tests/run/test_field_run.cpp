// SPDX-License-Identifier: MIT
//
// test_field_run.cpp: a whole run, from points and triangles to files, gives the same bits on any number of threads.
#include <doctest/doctest.h>

#include <map>

#include "alcap/field_run.h"
#include "src/base/parallel.h"
#include "tests/io/output_fixture.h"
#include "tests/support/mesh_helpers.h"

using namespace alcap;
using namespace alcap::test;

namespace {

// Runs on so many threads and returns all files of the result, by name.
std::map<std::string, std::string> files_of(const MeshData& s, const FieldRunOptions& options, FieldRun& run) {
  const Folder folder;
  run = run_field(s.V, s.F, options);
  std::vector<fs::path> paths;
  for (const std::string& format : field_formats()) paths.push_back(folder.path / ("f." + format));
  run_with_threads(options.threads, [&] {
    (void)write_field({.surface = run.surface, .field = run.field, .singularities = run.singularities}, paths);
  });
  std::map<std::string, std::string> files;
  for (const std::string& name : folder.names()) files[name] = contents(folder.path / name);
  return files;
}

}  // namespace

TEST_CASE("by default, the smallest eigenvalue of a smooth shape of 163,842 vertices is proven") {
  const MeshData shape = bumpy_sphere(7, 0.3, 4);
  const FieldRun run = run_field(shape.V, shape.F, {.n = 4});
  CHECK(run.certificate.holds());
  CHECK(run.eigen[0].smallest == Smallest::proven);
}

TEST_CASE("a whole run and its files are the same for 1, 2, 4 and 8 threads") {
  // Large enough for every loop to be shared; open, and with vertices that no face uses.
  for (const MeshData& s : {noisy_scan(5, 0.1, 3), with_unreferenced(torus_random_diagonals(120, 60, 1, 0.4, 2))}) {
    for (const int n : {1, 4}) {
      // CHOLMOD's last bits depend on the threads of BLAS.
      FieldRunOptions options{.n = n, .eigen = {.tolerance = 1e-6, .method = "lobpcg"}, .threads = 1};
      FieldRun one;
      const auto expected = files_of(s, options, one);
      CHECK(one.certificate.holds());
      CHECK(expected.size() >= field_formats().size());
      for (const int threads : {2, 4, 8}) {
        CAPTURE(threads);
        options.threads = threads;
        FieldRun run;
        const auto files = files_of(s, options, run);
        CHECK(run.field.u == one.field.u);
        CHECK(run.field.frames->X == one.field.frames->X);
        CHECK(run.connection().K == one.connection().K);
        CHECK(run.indices == one.indices);
        CHECK(run.eigen[0].lambda == one.eigen[0].lambda);
        REQUIRE(files.size() == expected.size());
        for (const auto& file : expected) {
          CAPTURE(file.first);
          CHECK(files.at(file.first) == file.second);
        }
      }
    }
  }
}

TEST_CASE("points and faces that are moved in become those of the surface, without a copy") {
  MeshData s = jittered_sphere(3, 0.2, 1);
  const Faces F = s.F;
  const Index* const faces = s.F.data();
  const double* const points = s.V.data();
  const FieldRun run = run_field(std::move(s.V), std::move(s.F));
  CHECK(run.mesh().F() == F);
  CHECK(run.mesh().F().data() == faces);
  CHECK(run.surface.V().data() == points);
}

TEST_CASE("a run on a surface is the run on its arrays, and arrays may be of any kind") {
  const MeshData s = jittered_sphere(3, 0.2, 1);
  const FieldRun run = run_field(s.V, s.F, {.n = 2});
  const Surface surface(s.V, s.F);
  const FieldRunOptions options{.n = 2};
  const FieldRun other = run_field(surface, options);
  CHECK(other.field.u == run.field.u);
  CHECK(other.indices == run.indices);
  CHECK(&other.mesh() == &surface.mesh());
  const Eigen::MatrixXd V = s.V;  // column-major
  const Eigen::Matrix<std::uint64_t, Eigen::Dynamic, 3> wide = s.F.cast<std::uint64_t>();
  CHECK(run_field(V, wide, {.n = 2}).field.u == run.field.u);
  CHECK_THROWS_AS((void)run_field(surface, {.repairs = {Repair::weld}}), OptionError);
}

TEST_CASE("a surface that lies in no space has a field without frames") {
  const FlatTorus torus = flat_torus(12, 8);
  const Mesh mesh(torus.F, torus.vertices);
  VectorX<double> lengths(mesh.edges());
  for (Index e = 0; e < mesh.edges(); ++e) lengths[e] = torus.lengths.data()[mesh.halfedge(e)];
  const FieldRun run = run_field(Surface::from_lengths(mesh, lengths), {.n = 4});
  CHECK(run.certificate.holds());
  CHECK(run.singularities.empty());
  CHECK(run.field.frames == nullptr);
  CHECK_THROWS_AS((void)run.field.vectors(0), OptionError);
}

TEST_CASE("each file of a run appears with all the others or not at all") {
  const Folder folder;
  const MeshData s = jittered_sphere(3, 0.2, 1);
  const FieldRun run = run_field(s.V, s.F);
  const FieldOutput output{.surface = run.surface, .field = run.field, .singularities = run.singularities};
  const fs::path good = folder.path / "good.ply", bad = folder.path / "missing" / "bad.vtp",
                 last = folder.path / "last.rosy";
  CHECK_THROWS_AS(write_field(output, std::vector<fs::path>{good, bad, last}), FileError);
  CHECK(folder.names().empty());
  CHECK(write_field(output, std::vector<fs::path>{good, last}).size() == 2);
  CHECK(folder.names() == std::set<std::string>{"good.ply", "last.rosy"});
}

TEST_CASE("a run says whether its field is the smoothest one, and replaces one that is not") {
  const MeshData scan = noisy_scan(5, 0.5, 1);
  const FieldRun proven = run_field(scan.V, scan.F, {.n = 8});
  CHECK(proven.certificate.smallest == Smallest::proven);
  CHECK(proven.certificate.holds());
  CHECK(proven.eigen[0].lambda == doctest::Approx(352.443).epsilon(1e-5));
  const FieldRun unproven = run_field(scan.V, scan.F, {.n = 8, .eigen = {.prove_smallest = Prove::never}});
  CHECK(unproven.certificate.smallest == Smallest::not_checked);
  CHECK(unproven.certificate.holds());

  // Of several components the least that is known; modes of all of them together, in ascending order.
  const MeshData pieces = with_unreferenced(together(icosphere(2), bumpy_sphere(3, 0.3, 5)));
  const FieldRun run = run_field(pieces.V, pieces.F, {.n = 2, .modes = 7});
  CHECK(run.certificate.smallest == Smallest::proven);
  CHECK(run.modes.smallest == Smallest::proven);
  REQUIRE(run.modes.lambda.size() == 7);
  const double least = std::min(run.eigen[0].lambda, run.eigen[1].lambda);
  CHECK(run.modes.lambda[0] == doctest::Approx(least).epsilon(1e-8));
  CHECK(run.modes.U.rows() == pieces.V.rows());
  CHECK_THROWS_AS(static_cast<void>(run_field(scan.V, scan.F, {.modes = 0})), OptionError);
}
