// SPDX-License-Identifier: MIT
//
// The connection on the command line: any metric one, its weights, intrinsic surfaces, and field files that hold it.
#include <doctest/doctest.h>

#include <cstdio>

#include "alcap/output.h"
#include "alcap/surface.h"
#include "tests/cli/cli_runner.h"

using namespace alcap;
using namespace alcap::test;

namespace {

bool noted(const Json& report, const std::string& code) {
  for (const char* list : {"notes", "warnings"})
    if (report.contains(list))
      for (const Json& remark : report[list])
        if (remark["code"] == code) return true;
  return false;
}

/// Lengths of all halfedges times `scale`, three a line.
std::string lengths_of(const MeshData& data, double scale) {
  const Surface surface(data.V, data.F);
  std::string text;
  for (Index h = 0; h < surface.mesh().halfedges(); ++h) {
    char number[64];
    std::snprintf(number, sizeof number, "%.17g%c", scale * surface.geometry().length(surface.mesh().edge(h)),
                  h % 3 == 2 ? '\n' : ' ');
    text += number;
  }
  return text;
}

}  // namespace

TEST_CASE("cones and holonomies of any size: solved, certified, and a note that no field is parallel") {
  const CliFolder folder;
  folder.write("s.ply", jittered_sphere(3, 0.2, 4));
  folder.write("t.ply", torus(24, 12, 1, 0.4));
  const CliResult odd = folder.run("field s.ply -n 4 --connection metric --cone 10:0.3,200:1.7 --json");
  CAPTURE(odd.err);
  REQUIRE(odd.exit == 0);
  CHECK(odd.json()["connection"]["kind"] == "metric");
  CHECK(noted(odd.json(), "no_parallel_field"));
  CHECK(!noted(folder.run("field s.ply -n 4 --connection metric --cone 10:1/4,200:7/4 --json").json(),
               "no_parallel_field"));
  const Json turned = folder.run("field t.ply -n 1 --connection metric --holonomy 0.1,-1/3 --json").json();
  CHECK(turned["connection"]["generator_holonomy"][0].get<double>() == doctest::Approx(0.1));
  CHECK(turned["connection"]["generator_holonomy"][1].get<double>() == doctest::Approx(-1.0 / 3));

  const CliResult sum = folder.run("field s.ply --connection metric --cone 10:0.3");
  CHECK(sum.exit == 2);
  CHECK(sum.error_says("1.7 is missing"));
  CHECK(folder.run("field s.ply --connection trivial --cone 10:0.3,200:1.7").error_says("multiple of 1/4"));
}

TEST_CASE("a target from a file, in field and in design") {
  const CliFolder folder;
  const MeshData sphere = icosphere(2);
  folder.write("s.ply", sphere);
  Json zeros = Json::array(), bad = Json::array({1});
  for (Eigen::Index h = 0; h < 3 * sphere.F.rows(); ++h) zeros.push_back(0);
  folder.write("none.json", Json{{"adjustment", zeros}}.dump());
  folder.write("bad.json", Json{{"adjustment", bad}}.dump());
  folder.write("two.json", Json{{"adjustment", zeros}, {"rotation", zeros}}.dump());
  // No adjustment is the globally optimal connection.
  const Json global = folder.run("field s.ply --json").json();
  const Json target = folder.run("field s.ply --target none.json --json").json();
  CHECK(target["connection"]["kind"] == "metric");
  CHECK(target["connection"]["D_T"].get<double>() ==
        doctest::Approx(global["connection"]["D_T"].get<double>()).epsilon(1e-8));
  CHECK(target["eigen"]["lambda"].get<double>() ==
        doctest::Approx(global["eigen"]["lambda"].get<double>()).epsilon(1e-7));
  CHECK(folder.run("field s.ply --target bad.json").error_says("needs one per halfedge"));
  CHECK(folder.run("field s.ply --target two.json").error_says("needs one of the keys"));
  const Json design = folder.run("design s.ply -n 2 --saddle 30 --target none.json --hold-curvature --json").json();
  CHECK(design["design"]["connection"]["spread"] == false);
  CHECK(design["controls"][0]["met"] == true);
}

TEST_CASE("weights of the connection are flags, and metric is the paper's") {
  const CliFolder folder;
  folder.write("s.ply", icosphere(3));
  // docs: reference numbers of this sphere.
  const Json paper = folder.run("field s.ply --length-factor metric --json").json()["connection"];
  CHECK(paper["D_T"].get<double>() == doctest::Approx(0.006020087564).epsilon(1e-8));
  CHECK(paper["D_E"].get<double>() == doctest::Approx(0.0009393253754).epsilon(1e-6));
  const Json flat = folder.run("field s.ply --length-factor per_edge --tan-cap 5 --json").json()["connection"];
  CHECK(flat["D_T"].get<double>() == doctest::Approx(0.006094258938).epsilon(1e-8));
  CHECK(flat["length_factor"] == "per_edge");
  CHECK(flat["tan_cap"] == 5);
  CHECK(folder.run("field s.ply --length-factor feet").exit == 2);
  CHECK(folder.run("field s.ply --tan-cap 0").exit == 2);
}

TEST_CASE("ops and view need nothing said twice: the field file holds the connection") {
  const CliFolder folder;
  folder.write("s.ply", jittered_sphere(3, 0.2, 4));
  for (const std::string how : {"--detail 0.1", "--length-factor metric", "--connection polar-barycenter",
                                "--cones auto-balance", "--connection metric --cone 10:0.25,200:1.75"}) {
    CAPTURE(how);
    REQUIRE(folder.run("field s.ply -n 4 -o f.ply --quiet " + how).exit == 0);
    const Json said = folder.run("field s.ply -n 4 --json " + how).json();
    const CliResult result = folder.run("ops s.ply f.ply --json");
    CAPTURE(result.err);
    REQUIRE(result.exit == 0);
    const Json ops = result.json();
    for (const char* key : {"kind", "detail", "length_factor"})
      CHECK(ops["connection"][key] == said["connection"][key]);
    CHECK(!noted(ops, "reprojected"));
    CHECK(2 * ops["energies"]["E_D"].get<double>() ==
          doctest::Approx(said["eigen"]["lambda"].get<double>()).epsilon(1e-6));
    CHECK(!noted(folder.run("view f.ply --curves c.obj --json").json(), "cones_unknown"));
  }
  // What is said counts.
  CHECK(folder.run("ops s.ply f.ply --connection polar --json").json()["connection"]["kind"] == "polar");
  CHECK(folder.run("ops s.ply f.ply --detail 0.5 --json").json()["connection"]["detail"] == 0.5);
}

TEST_CASE("an intrinsic surface: the lengths count, not where it is drawn") {
  const CliFolder folder;
  const MeshData sphere = jittered_sphere(3, 0.2, 4);
  folder.write("s.ply", sphere);
  folder.write("lengths.txt", "# of a sphere twice as large\n" + lengths_of(sphere, 2));
  MeshData squeezed = sphere;
  squeezed.V.col(2) *= 0.7;
  folder.write("flat.ply", squeezed);
  const Json known = folder.run("field s.ply --json").json();
  const Json result = folder.run("field flat.ply --lengths lengths.txt -o f.ply --json").json();
  CHECK(result["eigen"]["lambda"].get<double>() ==
        doctest::Approx(known["eigen"]["lambda"].get<double>() / 4).epsilon(1e-7));
  CHECK(result["mesh"]["area"].get<double>() == doctest::Approx(4 * known["mesh"]["area"].get<double>()));
  const Json ops = folder.run("ops flat.ply f.ply --lengths lengths.txt --json").json();
  CHECK(2 * ops["energies"]["E_D"].get<double>() ==
        doctest::Approx(result["eigen"]["lambda"].get<double>()).epsilon(1e-6));
  folder.write("short.txt", "1 1 1\n");
  CHECK(folder.run("field s.ply --lengths short.txt").exit == 3);
  CHECK(folder.run("field s.ply --lengths none.txt").exit == 3);
}

TEST_CASE("singularities of index +-k/n and edits as flags") {
  const CliFolder folder;
  folder.write("s.ply", jittered_sphere(4, 0.1, 4));
  const CliResult two = folder.run("design s.ply -n 2 --singularity 900:-2 --json");
  CAPTURE(two.err);
  CHECK(two.json()["controls"][0]["achieved"]["index"] == -2);
  const Json edited =
      folder.run("design s.ply -n 2 --saddle 900 --saddle 2000 --merge 0:1 --split 0:3000 --move 0:910 --json").json();
  REQUIRE(edited["controls"].size() == 2);
  CHECK(edited["controls"][0]["asked"]["face"] == 910);
  CHECK(edited["controls"][0]["achieved"]["index"] == -1);
  CHECK(edited["controls"][1]["asked"]["face"] == 3000);
  CHECK(edited["controls"][1]["achieved"]["index"] == -1);
  CHECK(folder.run("design s.ply -n 2 --saddle 900 --split 0:3000").exit == 2);
}
