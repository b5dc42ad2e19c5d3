// SPDX-License-Identifier: MIT
//
// run_design() gives what `alcap design` writes: the same field, bit for bit, and the same figures.
#include <doctest/doctest.h>

#include "alcap/design_run.h"
#include "alcap/output.h"
#include "tests/cli/cli_runner.h"

using namespace alcap;
using test::CliFolder;
using test::CliResult;
using test::Json;

TEST_CASE("the library's run is the tool's, on every example design") {
  const CliFolder folder;
  REQUIRE(folder.run("make icosphere:3 -o ball.ply").exit == 0);
  const MeshFile ball = read_mesh(folder.work() / "ball.ply");
  const Surface surface(ball.V, ball.F);
  for (const auto& entry : std::filesystem::directory_iterator(ALCAP_SOURCE_DIR "/datasets/designs")) {
    if (entry.path().extension() != ".json") continue;
    CAPTURE(entry.path().string());
    // One thread: CHOLMOD's last bits depend on the threads of BLAS.
    const CliResult result =
        folder.run("design ball.ply --design '" + entry.path().string() + "' --threads 1 -o f.ply --json");
    CAPTURE(result.err);
    REQUIRE((result.exit == 0 || result.exit == 8));
    const Json report = result.json();
    const DesignRun run = run_design(surface, read_design(entry.path()), {.threads = 1});

    const FieldFile file = read_field(folder.work() / "f.ply");
    CHECK(file.field.n == run.field.n);
    CHECK(file.field.u == run.field.u);
    CHECK(*file.field.frames == *run.field.frames);
    CHECK(report["solve"]["residual"] == run.residual);
    CHECK(report["solve"]["rows"] == run.rows);
    CHECK(report["solve"]["solver"] == run.solver);
    CHECK(report["ok"] == (run.certificate.holds() && run.met()));
    CHECK(report["certified"] == run.certificate.holds());
    CHECK(report["met"] == run.met());
    CHECK(report["certificate"]["residual_small"] == run.certificate.residual_small);
    REQUIRE(report["controls"].size() == run.outcomes.size());
    for (std::size_t k = 0; k < run.outcomes.size(); ++k) {
      const Json& control = report["controls"][k];
      CHECK(control["path"] == run.outcomes[k].path);
      CHECK(control["name"] == run.outcomes[k].name);
      CHECK(control["met"] == run.outcomes[k].met);
      CHECK(control["error_degrees"] == run.outcomes[k].error_degrees);
    }
    REQUIRE(report["singularities"]["count"] == run.singularities.size());
    for (std::size_t k = 0; k < run.singularities.size(); ++k)
      CHECK(report["singularities"]["list"][k]["face"] == run.singularities[k].face);
    if (run.guidance)
      CHECK(report["guidance"]["scale"] == run.guidance_scale);
    else
      CHECK(report["guidance"]["scale"].is_null());
    CHECK(report["warnings"].size() == run.remarks.size());
  }
}
