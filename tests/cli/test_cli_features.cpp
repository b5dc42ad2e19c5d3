// SPDX-License-Identifier: MIT
//
// test_cli_features.cpp: features of fields and designs by flags: held and drawn, along and across, by angle and by a
// file, with gaps closed and spurs removed.
#include <doctest/doctest.h>

#include "tests/cli/cli_runner.h"
#include "tests/support/parts.h"

using namespace alcap;
using test::CliFolder;
using test::CliResult;
using test::Json;

namespace {

MeshData small_box() {
  return test::blocks(test::cells(2, 1, 1, [](int, int, int) { return false; }), 4);
}

Json certified_design(const CliFolder& folder, const std::string& arguments) {
  CAPTURE(arguments);
  const CliResult result = folder.run("design " + arguments + " --json");
  CAPTURE(result.err);
  REQUIRE(result.exit == 0);
  return result.json();
}

}  // namespace

TEST_CASE("design --align-hold: exact along every line, by both methods, told per line") {
  const CliFolder folder;
  folder.write("box.obj", small_box());
  for (const char* method : {"variational", "eigen"})
    for (const char* more : {"", "--guidance smoothest", "--align-across", "--guidance zero"}) {
      const Json report = certified_design(
          folder, "box.obj -n 4 --align-features --align-hold --method " + std::string(method) + " " + more);
      const Json& alignment = report["alignment"];
      CHECK(alignment["hold"] == true);
      CHECK(alignment["lines"].size() == 12);
      CHECK(alignment["free_corners"] == 8);
      CHECK(alignment["all"]["mean_degrees"].get<double>() < 1);
      CHECK(alignment["all"]["worst_degrees"].get<double>() < 5);
      CHECK(report["design"]["features"]["hold"] == true);
      bool told = false;
      for (const Json& control : report["controls"])
        if (control["type"] == "features") {
          told = true;
          CHECK(control["path"] == "/features");
          CHECK(control["asked"]["edges"] == alignment["edges"]);
          CHECK(control["achieved"]["mean_deviation_degrees"].get<double>() < 1);
        }
      CHECK(told);
    }
  // Alone, as `alcap field` does it.
  const Json design = certified_design(folder, "box.obj -n 4 --align-features --align-hold -o d");
  CHECK(folder.run("field box.obj -n 4 --align-features -o f").exit == 0);
  CHECK(design["alignment"]["steps"].get<int>() > 0);
  CHECK(CliFolder::read(folder.work() / "d/field.ply").size() == CliFolder::read(folder.work() / "f/field.ply").size());
  CHECK(CliFolder::read(folder.work() / "d/field.sharp") == CliFolder::read(folder.work() / "f/field.sharp"));
  // The design that was written is the same design.
  const Json again = certified_design(folder, "box.obj --design d/design.json");
  CHECK(again["alignment"] == design["alignment"]);
  // By a file of edges, named by the flag or by the design.
  const Json named = certified_design(folder, "box.obj -n 4 --features d/field.sharp --align-hold -o e");
  CHECK(named["alignment"]["lines"] == design["alignment"]["lines"]);
  CHECK(folder.read_json("e/design.json")["features"]["file"].get<std::string>().ends_with("d/field.sharp"));
  CHECK(certified_design(folder, "box.obj --design e/design.json")["alignment"]["lines"] ==
        named["alignment"]["lines"]);
}

TEST_CASE("design --align-features alone draws strokes, as ever; weights, across and the boundary by flags") {
  const CliFolder folder;
  folder.write("box.obj", small_box());
  folder.write("plate.obj", grid(8, 8));
  const Json drawn = certified_design(folder, "box.obj -n 4 --align-features --align-weight 20 --guidance smoothest");
  CHECK(drawn["design"]["features"] == Json({{"angle", 40}, {"weight", 20}}));
  CHECK(drawn["controls"].size() == 12);
  CHECK(drawn["controls"][0]["type"] == "stroke");
  CHECK(drawn["alignment"]["hold"] == false);
  const Json rim = certified_design(folder, "plate.obj -n 4 --align-hold --feature-boundary --align-features=180");
  CHECK(rim["alignment"]["boundary"] == true);
  CHECK(rim["alignment"]["free_corners"] == 0);
  CHECK(rim["singularities"]["count"] == 0);
  CHECK(folder.run("design box.obj --align-hold").error_says("/features"));  // n is 1
  CHECK(folder.run("design box.obj -n 4 --features none.sharp").exit == 3);
  CHECK(folder.run("design box.obj -n 4 --features ''").exit == 2);
  CHECK(folder.run("design box.obj -n 4 --align-weight 0 --align-features").exit == 2);
}

TEST_CASE("--feature-gap, --feature-spur, --feature-low-angle and --feature-corner-angle in field and design") {
  const CliFolder folder;
  folder.write("box.obj", small_box());
  REQUIRE(folder.run("field box.obj --align-features -o out").exit == 0);
  // Without the edges of one face's third line: a gap of a quarter.
  std::istringstream all(CliFolder::read(folder.work() / "out/field.sharp"));
  std::vector<std::string> lines;
  for (std::string line; std::getline(all, line);) lines.push_back(line);
  const MeshFile box = read_mesh(folder.work() / "box.obj");
  const auto middle_of_long = [&](const std::string& line) {
    const auto comma = line.find(','), second = line.find(',', comma + 1);
    const int face = std::stoi(line.substr(comma + 1)), edge = std::stoi(line.substr(second + 1));
    const Eigen::RowVector3d m = (box.V.row(box.F(face, edge)) + box.V.row(box.F(face, (edge + 1) % 3))) / 2;
    return m[0] == 0.875 && m[1] == 0 && m[2] == 0;
  };
  std::string cut;
  std::size_t kept = 0;
  for (std::size_t k = 1; k < lines.size(); ++k)
    if (!middle_of_long(lines[k])) {
      cut += lines[k] + "\n";
      ++kept;
    }
  REQUIRE(kept + 3 == lines.size());  // two faces name it
  folder.write("cut.sharp", std::to_string(kept) + "\n" + cut);
  for (const std::string& command : {std::string("field"), std::string("design -n 4 --align-hold")}) {
    CAPTURE(command);
    const auto edges = [&](const std::string& flags) {
      const CliResult result = folder.run(command + " box.obj --json " + flags);
      CAPTURE(result.err);
      return result.json()["alignment"]["edges"].get<int>();
    };
    const int whole = edges("--align-features=40");
    CHECK(edges("--features cut.sharp") == whole - 1);
    CHECK(edges("--features cut.sharp --feature-gap 0.3") == whole);
    CHECK(edges("--features cut.sharp --feature-gap 0.2") == whole - 1);
    CHECK(edges("--features cut.sharp --feature-spur 0.9") == whole - 4);  // three edges to the gap
    CHECK(edges("--align-features=100") == 0);
    CHECK(edges("--align-features=100 --feature-low-angle 40") == 0);  // joined to nothing sharper
    CHECK(edges("--align-features=90 --feature-low-angle 40") == whole);
    CHECK(folder.run(command + " box.obj --align-features=40 --feature-low-angle 60").exit == 2);
    CHECK(folder.run(command + " box.obj --feature-gap -1").exit == 2);
    const auto corners = [&](const std::string& flags) {
      return folder.run(command + " box.obj --json " + flags).json()["alignment"]["corners"].get<int>();
    };
    CHECK(corners("--feature-corner-angle 179") == 8);  // three lines meet
  }
}
