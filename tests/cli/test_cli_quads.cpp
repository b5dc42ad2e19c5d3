// SPDX-License-Identifier: MIT
//
// test_cli_quads.cpp: --for and --sizing, and every command of docs/recipes/quads.md.
#include <doctest/doctest.h>

#include <fstream>
#include <string>

#include "tests/cli/cli_runner.h"
#include "tests/support/parts.h"

namespace {

using namespace alcap;
using namespace alcap::test;

/// As a CAD system exports it: triangles that share nothing.
std::string stl(const MeshData& part) {
  std::ostringstream text;
  text.precision(9);
  text << "solid part\n";
  for (Eigen::Index t = 0; t < part.F.rows(); ++t) {
    text << "facet normal 0 0 0\nouter loop\n";
    for (int c = 0; c < 3; ++c) text << "vertex " << part.V.row(part.F(t, c)) << "\n";
    text << "endloop\nendfacet\n";
  }
  text << "endsolid part\n";
  return text.str();
}

MeshData bracket(int m) {
  return blocks(cells(3, 2, 2, [](int i, int, int k) { return i > 0 && k > 0; }), m);
}

}  // namespace

TEST_CASE("every command of docs/recipes/quads.md runs, and what it hands over is there") {
  const CliFolder folder;
  folder.write("part.stl", stl(bracket(6)));
  std::ifstream page(ALCAP_SOURCE_DIR "/docs/recipes/quads.md");
  int commands = 0, handed = 0;
  for (std::string line; std::getline(page, line);) {
    const std::size_t begin = std::min(line.find_first_not_of(' '), line.size());
    const std::string text = line.substr(begin, line.find(" #") - begin);
    if (text.starts_with("alcap field ")) {
      const CliResult result = folder.run(text.substr(6));
      CHECK_MESSAGE(result.exit == 0, text << "\n" << result.err);
      ++commands;
    } else if (text.starts_with("quadwild ")) {
      std::istringstream words(text.substr(9));
      for (std::string word; words >> word;)
        if (word.size() > 1) CHECK_MESSAGE(std::filesystem::exists(folder.work() / word), word);
      ++handed;
    }
  }
  CHECK(commands == 5);
  CHECK(handed == 2);
}

TEST_CASE("--for quadwild aligns with creases by itself, and the summary says how to go on") {
  const CliFolder folder;
  folder.write("box.obj", bracket(5));
  const CliResult said = folder.run("field box.obj --for quadwild -o out");
  CHECK(said.exit == 0);
  CHECK(said.out.find("quadwild out/field.obj 3 out/field.rosy out/field.sharp out/field.txt") != std::string::npos);
  CHECK(folder.files() == std::set<std::string>{"box.obj", "out", "out/field.obj", "out/field.rosy", "out/field.sharp",
                                                "out/field.txt", "out/report.json"});
  const Json report = folder.read_json("out/report.json");
  CHECK(report.contains("alignment"));
  CHECK(report["files"].size() == 5);
  const MeshFile mesh = read_mesh(folder.work() / "out/field.obj");
  CHECK(mesh.V == bracket(5).V);
  CHECK(mesh.F == bracket(5).F);
}

TEST_CASE("--for directional takes any n, leaves alignment to the user, and works in designs") {
  const CliFolder folder;
  folder.write("ball.obj", icosphere(3));
  const CliResult field = folder.run("field ball.obj -n 2 --for directional -o out --json");
  CHECK(field.exit == 0);
  CHECK_FALSE(field.json().contains("alignment"));
  CHECK(folder.files().count("out/field.rawfield") == 1);
  CHECK(folder.files().count("out/field.sings") == 1);
  CHECK(folder.files().count("out/field.off") == 1);
  CHECK(folder.run("design ball.obj -n 4 --cone 0:1 --cone 11:1 --for quadwild -o quads").exit == 0);
  CHECK(folder.files().count("quads/field.rosy") == 1);
}

TEST_CASE("--for without a folder, with --formats, with another n or in a batch is a usage error that says why") {
  const CliFolder folder;
  folder.write("ball.obj", icosphere(2));
  folder.write("list.txt", "ball.obj\n");
  for (const char* arguments :
       {"field ball.obj --for quadwild", "field ball.obj --for quadwild -o f.rosy",
        "field ball.obj --for quadwild -o out --formats ply", "field ball.obj --for quadwild -n 2 -o out",
        "field ball.obj --for blender -o out", "field --batch list.txt --for quadwild -o out",
        "field --batch list.txt --sizing h.sol -o out", "field ball.obj --sizing h.vtp",
        "field ball.obj --sizing-error 0", "field ball.obj --sizing-range 0.2,0.1 --sizing h.csv"}) {
    const CliResult result = folder.run(arguments);
    CHECK_MESSAGE(result.exit == 2, arguments);
    CHECK_MESSAGE(!result.err.empty(), arguments);
  }
  CHECK(folder.files() == std::set<std::string>{"ball.obj", "list.txt"});
}

TEST_CASE("--sizing writes one length per vertex, the report says their range, in the folder's report as well") {
  const CliFolder folder;
  folder.write("ball.obj", icosphere(4));
  const CliResult result =
      folder.run("field ball.obj --sizing h.csv --sizing-error 0.002 --sizing-range 0.0001,1 -o out --json");
  CHECK(result.exit == 0);
  const Json sizing = result.json()["sizing"];
  const double error = 0.002 * 2 * std::sqrt(3.0), expected = 2 * std::sqrt(error * (2 - error));
  CHECK(sizing["mean"].get<double>() == doctest::Approx(expected).epsilon(0.03));
  CHECK(sizing["smallest"].get<double>() > 0.95 * expected);
  CHECK(sizing["largest"].get<double>() < 1.05 * expected);
  CHECK(folder.read_json("out/report.json")["sizing"] == sizing);
  const std::string text = CliFolder::read(folder.work() / "h.csv");
  CHECK(std::count(text.begin(), text.end(), '\n') == 1 + 2562);
  CHECK(result.json()["files"].back() == "h.csv");
}

TEST_CASE("tables come as a file of their own or on request into a folder, and only then") {
  const CliFolder folder;
  folder.write("ball.obj", icosphere(2));
  CHECK(folder.run("field ball.obj -n 2 --unit -o ball.csv").exit == 0);
  CHECK(CliFolder::read(folder.work() / "ball.csv").starts_with("face,x,y,z,e1_x"));
  CHECK(folder.run("field ball.obj -o ball.vertex.npy").exit == 0);
  CHECK(CliFolder::read(folder.work() / "ball.vertex.npy").starts_with("\x93NUMPY"));
  CHECK(folder.run("field ball.obj -o all").exit == 0);
  CHECK(folder.files().count("all/field.csv") == 0);
  CHECK(folder.run("field ball.obj -o some --formats csv,vertex.dmat").exit == 0);
  CHECK(folder.files().count("some/field.csv") == 1);
  CHECK(folder.files().count("some/field.vertex.dmat") == 1);
  CHECK(folder.files().count("some/field.ply") == 0);
}
