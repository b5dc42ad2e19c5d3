// SPDX-License-Identifier: MIT
//
// test_field_run.cpp: a whole run, from points and triangles to files, gives the same bits on any number of threads.
#include <doctest/doctest.h>

#include <map>

#include "alcap/field_run.h"
#include "src/base/parallel.h"
#include "tests/io/output_fixture.h"

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
    (void)write_field({.mesh = run.mesh,
                       .V = s.V,
                       .geometry = run.geometry,
                       .connection = run.connection,
                       .field = run.field,
                       .singularities = run.singularities},
                      paths);
  });
  std::map<std::string, std::string> files;
  for (const std::string& name : folder.names()) files[name] = contents(folder.path / name);
  return files;
}

}  // namespace

TEST_CASE("a whole run and its files are the same for 1, 2 and 4 threads") {
  // Large enough for every loop to be shared; open, and with vertices that no face uses.
  for (const MeshData& s : {noisy_scan(5, 0.1, 3), with_unreferenced(torus_random_diagonals(120, 60, 1, 0.4, 2))}) {
    for (const int n : {1, 4}) {
      // CHOLMOD's last bits depend on the threads of BLAS.
      FieldRunOptions options{.n = n, .eigen = {.tolerance = 1e-6, .method = "lobpcg"}, .threads = 1};
      FieldRun one;
      const auto expected = files_of(s, options, one);
      CHECK(one.certificate.holds());
      CHECK(expected.size() == 8);
      for (const int threads : {2, 4}) {
        CAPTURE(threads);
        options.threads = threads;
        FieldRun run;
        const auto files = files_of(s, options, run);
        CHECK(run.field.u == one.field.u);
        CHECK(run.field.frames->X == one.field.frames->X);
        CHECK(run.connection.K == one.connection.K);
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

TEST_CASE("faces that are moved in become the faces of the mesh, without a copy") {
  MeshData s = jittered_sphere(3, 0.2, 1);
  const Faces F = s.F;
  const Index* const place = s.F.data();
  const FieldRun run = run_field(s.V, std::move(s.F));
  CHECK(run.mesh.F() == F);
  CHECK(run.mesh.F().data() == place);
}

TEST_CASE("each file of a run appears with all the others or not at all") {
  const Folder folder;
  const MeshData s = jittered_sphere(3, 0.2, 1);
  const FieldRun run = run_field(s.V, s.F);
  const FieldOutput output{.mesh = run.mesh,
                           .V = s.V,
                           .geometry = run.geometry,
                           .connection = run.connection,
                           .field = run.field,
                           .singularities = run.singularities};
  const fs::path good = folder.path / "good.ply", bad = folder.path / "missing" / "bad.vtp",
                 last = folder.path / "last.rosy";
  CHECK_THROWS_AS(write_field(output, std::vector<fs::path>{good, bad, last}), FileError);
  CHECK(folder.names().empty());
  CHECK(write_field(output, std::vector<fs::path>{good, last}).size() == 2);
  CHECK(folder.names() == std::set<std::string>{"good.ply", "last.rosy"});
}
