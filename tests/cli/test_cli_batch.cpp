// SPDX-License-Identifier: MIT
//
// test_cli_batch.cpp: `alcap field --batch`: a line per mesh in the order of the list, bad meshes among good ones.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/cli/cli_runner.h"

using namespace alcap;
using test::CliFolder;
using test::CliResult;
using test::Json;

namespace {

std::vector<Json> lines_of(const std::string& text) {
  std::vector<Json> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(Json::parse(line));
  return lines;
}

void write_list(const CliFolder& folder, const char* text) { std::ofstream(folder.work() / "list.txt") << text; }

}  // namespace

TEST_CASE("every mesh has its line, in order; one that cannot be read or used is named, the others are computed") {
  const CliFolder folder;
  folder.write("a.ply", icosphere(2));
  folder.write("b.obj", torus(12, 8, 1, 0.4));
  MeshData broken = icosphere(1);
  broken.F(3, 0) = broken.F(3, 1);
  folder.write("broken.off", broken);
  write_list(folder, "# meshes\na.ply\nmissing.ply\n\nbroken.off\nb.obj\n");
  for (const char* jobs : {"1", "2"}) {
    const CliResult result = folder.run(std::string("field --batch list.txt -n 4 -o fields -j ") + jobs);
    CHECK(result.exit == 5);
    const std::vector<Json> lines = lines_of(result.out);
    REQUIRE(lines.size() == 4);
    for (std::size_t k = 0; k < 4; ++k) CHECK(lines[k]["index"] == k);
    CHECK(lines[0]["ok"] == true);
    CHECK(lines[0]["vertices"] == 162);
    CHECK(lines[0]["residual"].get<double>() <= 1e-8);
    CHECK(lines[1]["error"]["kind"] == "input");
    CHECK(lines[2]["error"]["kind"] == "mesh");
    CHECK(lines[3]["ok"] == true);
    CHECK(std::filesystem::exists(folder.work() / "fields/a.ply"));
    CHECK(std::filesystem::exists(folder.work() / "fields/b.ply"));
    CHECK_FALSE(std::filesystem::exists(folder.work() / "fields/broken.ply"));
  }
}

TEST_CASE("a name that is no UTF-8 stops neither the batch nor a single run") {
  const CliFolder folder;
  folder.write("a.ply", icosphere(1));
  folder.write("m\xfc.ply", icosphere(1));
  write_list(folder, "m\xfc.ply\nnot there \xfc.ply\na.ply\n");
  const CliResult result = folder.run("field --batch list.txt -n 2 -o fields");
  CHECK(result.exit == 5);
  const std::vector<Json> lines = lines_of(result.out);
  REQUIRE(lines.size() == 3);
  CHECK(lines[0]["ok"] == true);
  CHECK(lines[1]["error"]["kind"] == "input");
  CHECK(lines[2]["ok"] == true);
  CHECK(folder.run("field 'm\xfc.ply' -n 2 -o out").exit == 0);
  CHECK(std::filesystem::exists(folder.work() / "out/report.json"));
}

TEST_CASE("with --json there is one object, with --lines the lines go to a file") {
  const CliFolder folder;
  folder.write("a.ply", icosphere(2));
  write_list(folder, "a.ply\na.ply\n");
  const CliResult result = folder.run("field --batch list.txt --json");
  CHECK(result.exit == 0);
  CHECK(result.json()["batch"]["meshes"] == 2);
  CHECK(result.json()["batch"]["failed"] == 0);
  CHECK(result.json()["meshes"].size() == 2);
  CHECK(folder.run("field --batch list.txt --lines lines.jsonl").exit == 0);
  std::ifstream in(folder.work() / "lines.jsonl");
  std::stringstream text;
  text << in.rdbuf();
  CHECK(lines_of(text.str()).size() == 2);
  // Two fields of the same name would overwrite each other.
  CHECK(folder.run("field --batch list.txt -o fields").exit == 2);
}

TEST_CASE("a mesh and a batch exclude each other, and one of them is needed") {
  const CliFolder folder;
  folder.write("a.ply", icosphere(1));
  write_list(folder, "a.ply\n");
  CHECK(folder.run("field a.ply --batch list.txt").exit == 2);
  CHECK(folder.run("field -n 4").exit == 2);
  CHECK(folder.run("field --batch nowhere.txt").exit == 3);
}
