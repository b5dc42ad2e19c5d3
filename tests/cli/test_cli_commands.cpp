// SPDX-License-Identifier: MIT
//
// test_cli_commands.cpp: what all subcommands share (help, version, exit codes, --json, --report, outputs that cannot
// be written), and `alcap info`, `alcap ops` and `alcap tables`.
#include <doctest/doctest.h>

#include <cmath>
#include <sstream>

#include "alcap/version.h"
#include "tests/cli/cli_runner.h"

using namespace alcap;
using test::CliFolder;
using test::CliResult;
using test::Json;

TEST_CASE("help and version go to stdout with exit code 0, and every subcommand teaches by examples") {
  const CliFolder folder;
  const CliResult version = folder.run("--version");
  CHECK(version.exit == 0);
  CHECK(version.out.find(std::string("alcap ") + alcap::version()) == 0);
  CHECK(version.out.find("solvers: ") != std::string::npos);
  CHECK(version.out.find("instruction set: ") != std::string::npos);
  CHECK(folder.run("--help").exit == 0);
  for (const std::string command : {"field", "info", "ops", "tables", "export-matrices", "plan"}) {
    CAPTURE(command);
    const CliResult help = folder.run(command + " --help");
    CHECK(help.exit == 0);
    CHECK(help.err.empty());
    CHECK(help.out.find("Examples:") != std::string::npos);
    CHECK(help.out.find("alcap " + command) != std::string::npos);
    CHECK(help.out.find("--json") != std::string::npos);
  }
}

TEST_CASE("wrong usage exits with 2, names the option, and leaves stdout to JSON") {
  const CliFolder folder;
  folder.write("s.obj", icosphere(1));
  for (const std::string bad :
       {"field s.obj -n 0", "field s.obj -n four", "field s.obj --energy 2", "field s.obj --solver abacus",
        "field s.obj --connection lokal", "field s.obj --repair glue", "field s.obj --tolerance 0",
        "field s.obj --threads -1", "field s.obj --nonsense", "field", "field s.obj extra.obj", "frobnicate s.obj",
        "field s.obj -o out.xyz", "field s.obj -o out --formats ply,gif", "field s.obj -o f.ply --formats ply", "info",
        "ops s.obj"}) {
    CAPTURE(bad);
    const CliResult result = folder.run(bad);
    CHECK(result.exit == 2);
    CHECK(result.out.empty());
    CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
    CHECK(folder.run(bad + " --json").json()["error"]["kind"] == "usage");
    CHECK(folder.files() == std::set<std::string>{"s.obj"});
  }
  CHECK(folder.run("").exit == 2);
}

TEST_CASE("what cannot be written exits with 6 and leaves nothing behind") {
  const CliFolder folder;
  folder.write("s.obj", icosphere(1));
  folder.write("file", "I am a file");
  std::filesystem::create_directory(folder.work() / "dir.json");
  const auto before = folder.files();
  for (const std::string bad :
       {"field s.obj -o file", "field s.obj -o file/out", "field s.obj -o missing/f.ply",
        "field s.obj --report dir.json", "field s.obj -o /dev/null/x/", "field s.obj --report /proc/x.json"}) {
    CAPTURE(bad);
    const CliResult result = folder.run(bad + " --json");
    CAPTURE(result.err);
    CHECK(result.exit == 6);
    CHECK(result.json()["error"]["kind"] == "output");
    CHECK(folder.files() == before);
  }
  CHECK(CliFolder::read(folder.work() / "file") == "I am a file");
}

TEST_CASE("--quiet says nothing, --report writes what --json prints, threads change nothing") {
  const CliFolder folder;
  folder.write("s.obj", noisy_scan(3, 0.1, 1));
  const CliResult quiet = folder.run("field s.obj --quiet --report r.json");
  CHECK(quiet.exit == 0);
  CHECK(quiet.out.empty());
  CHECK(quiet.err.empty());
  Json one = folder.read_json("r.json"), two = folder.run("field s.obj --threads 1 --json").json();
  CHECK(one["singularities"]["count"] == two["singularities"]["count"]);
  CHECK(one["connection"]["D_T"] == two["connection"]["D_T"]);
  CHECK(one["eigen"]["lambda"].get<double>() == doctest::Approx(two["eigen"]["lambda"].get<double>()).epsilon(1e-10));
}

TEST_CASE("info measures what is known and can be trusted with --repair") {
  const CliFolder folder;
  folder.write("cube.obj", cube());
  const CliResult result = folder.run("info cube.obj --json");
  CHECK(result.exit == 0);
  const Json mesh = result.json()["mesh"];
  CHECK(mesh["vertices"] == 8);
  CHECK(mesh["edges"] == 18);
  CHECK(mesh["faces"] == 12);
  CHECK(mesh["euler"] == 2);
  CHECK(mesh["area"].get<double>() == doctest::Approx(24));
  CHECK(mesh["edge_length_min"].get<double>() == doctest::Approx(2));
  CHECK(mesh["edge_length_max"].get<double>() == doctest::Approx(2 * std::sqrt(2.0)));
  CHECK(mesh["angle_min_degrees"].get<double>() == doctest::Approx(45));
  CHECK(mesh["angle_max_degrees"].get<double>() == doctest::Approx(90));
  CHECK(mesh["box_min"] == Json{-1.0, -1.0, -1.0});

  folder.write("open.obj", test::both(cylinder(12, 3), single_triangle(), 9));
  const Json open = folder.run("info open.obj --json").json();
  CHECK(open["mesh"]["components"] == 2);
  CHECK(open["mesh"]["boundary_loops"] == 3);
  CHECK(open["components"].size() == 2);
  CHECK(folder.run("info open.obj").out.find("can be computed") != std::string::npos);
}

TEST_CASE("ops: the smoothest vector field of a flat sheet is constant: every derivative vanishes, in the CSV too") {
  const CliFolder folder;
  folder.write("sheet.obj", grid(8, 6));
  REQUIRE(folder.run("field sheet.obj -n 1 -o v.ply --quiet").exit == 0);
  for (const std::string kind : {"edge", "triangle"}) {
    CAPTURE(kind);
    const CliResult result = folder.run("ops sheet.obj v.ply --operators " + kind + " -o v.csv --json");
    CAPTURE(result.err);
    REQUIRE(result.exit == 0);
    const Json report = result.json();
    CHECK(report["n"] == 1);
    for (const char* key : {"div", "curl", "reflected"}) CHECK(report["norms"][key].get<double>() < 1e-6);
    CHECK(std::abs(report["energies"]["E_D"].get<double>()) < 1e-9);
    std::istringstream csv(CliFolder::read(folder.work() / "v.csv"));
    std::string line;
    std::getline(csv, line);
    CHECK(line == "face,area,div,curl,reflected_div,reflected_curl");
    int rows = 0;
    while (std::getline(csv, line)) ++rows;
    CHECK(rows == 96);
  }
}

TEST_CASE("ops: the energies of the smoothest field are its eigenvalue and its Euler characteristic") {
  const CliFolder folder;
  folder.write("s.obj", icosphere(3));
  for (const int n : {1, 4}) {
    const Json field = folder.run("field s.obj -n " + std::to_string(n) + " -o f.ply --json").json();
    const Json ops = folder.run("ops s.obj f.ply -o f.vtp --json").json();
    // u* S u = lambda for |u|_M = 1, E_D is half of it, and E_A + E_H all of it.
    const double lambda = field["eigen"]["lambda"];
    CHECK(ops["energies"]["E_D"].get<double>() == doctest::Approx(lambda / 2).epsilon(1e-7));
    CHECK(ops["energies"]["E_A"].get<double>() + ops["energies"]["E_H"].get<double>() ==
          doctest::Approx(lambda).epsilon(1e-7));
    CHECK(ops["connection"]["kind"] == "global");
    CHECK(ops["files"][0] == "f.vtp");
    CHECK(ops["notes"].empty());
  }
  REQUIRE(folder.run("field s.obj -n 1 -o u.ply --unit --quiet").exit == 0);
  const Json unit = folder.run("ops s.obj u.ply --json").json();
  CHECK(unit["energies"]["operators"]["difference_over_pi"].get<double>() == doctest::Approx(4).epsilon(1e-3));

  folder.write("other.obj", icosphere(2));
  const CliResult other = folder.run("ops other.obj u.ply --json");
  CHECK(other.exit == 3);
  CHECK(other.error_says("another mesh"));
}

TEST_CASE("tables: a small run has every row, and the errors fall with refinement") {
  const CliFolder folder;
  const CliResult result = folder.run("tables --levels 1,2 --fields 3 --json");
  REQUIRE(result.exit == 0);
  const Json report = result.json();
  CHECK(report["options"]["levels"] == Json{1, 2});
  std::map<std::string, double> coarse;
  int compared = 0;
  for (const Json& row : report["operators"]) {
    if (row["sphere"] != "clean" || row["connection"] != "global") continue;
    const std::string kind = row["kind"];
    if (row["level"] == 1) {
      coarse[kind] = row["l2_div"];
    } else {
      CHECK(row["l2_div"].get<double>() < coarse.at(kind));
      ++compared;
    }
  }
  CHECK(compared == 2);
  CHECK(!report["euler"].empty());
}

TEST_CASE("plan says what fits, what does not, and what cannot be numbered, by its exit code") {
  const CliFolder folder;
  folder.write("s.obj", icosphere(3));
  const CliResult mesh = folder.run("plan s.obj -n 4 --speed 1 --memory 4 --json");
  CHECK(mesh.exit == 0);
  CHECK(mesh.json()["plan"]["faces"] == 1280);
  CHECK(mesh.json()["plan"]["matrix_entries"] == 642 + 2 * 1920);
  CHECK(mesh.json()["plan"]["phases"].size() == 6);
  CHECK(folder.run("plan 1280 -n 4 --speed 1 --memory 4 --json").json()["plan"] == mesh.json()["plan"]);
  const CliResult large = folder.run("plan 50000000 --speed 1 --memory 4");
  CHECK(large.exit == 7);
  CHECK(large.error_says("triangles fit"));
  const CliResult beyond = folder.run("plan 1000000000 --speed 1 --memory 100000");
  CHECK(beyond.exit == (sizeof(Index) == 4 ? 4 : 0));
  CHECK(beyond.error_says("1000000000 faces are more than the 715827882") == (sizeof(Index) == 4));
  CHECK(folder.run("plan 1000 --formats gif").exit == 2);
  CHECK(folder.run("plan none.obj").exit == 3);
  const CliResult measured = folder.run("plan 1000 --json");
  CHECK(measured.exit == 0);
  CHECK(measured.json()["plan"]["speed"].get<double>() > 0);
}
