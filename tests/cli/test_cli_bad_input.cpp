// SPDX-License-Identifier: MIT
//
// test_cli_bad_input.cpp: every kind of bad input gets its documented exit code, one line on stderr that names the
// element and the remedy, the same as JSON, and leaves nothing behind; what can work, works.
#include <doctest/doctest.h>

#include "tests/cli/cli_runner.h"

using namespace alcap;
using test::CliFolder;
using test::CliResult;
using test::Json;

namespace {

constexpr const char* tetrahedron_vertices = "v 1 1 1\nv 1 -1 -1\nv -1 1 -1\nv -1 -1 1\n";
constexpr const char* tetrahedron_faces = "f 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n";

struct BadInput {
  const char* what;
  std::string name;   // of the file
  std::string bytes;  // empty name of a defect: the file itself cannot be read
  int exit;
  std::string kind;                // "input" or "mesh"
  std::string defect;              // for meshes
  std::vector<std::string> words;  // that the message must have
};

std::vector<BadInput> bad_inputs() {
  const std::string v = tetrahedron_vertices, f = tetrahedron_faces;
  return {
      {"empty file", "a.obj", "", 3, "input", "", {"a.obj", "empty"}},
      {"not a number", "a.obj", "v 1 1 1x\nv 1 -1 -1\nv -1 1 -1\nf 1 2 3\n", 3, "input", "", {"a.obj", "1x"}},
      {"NaN", "a.obj", "v 1 1 nan\nv 1 -1 -1\nv -1 1 -1\nf 1 2 3\n", 3, "input", "", {"a.obj", "nan"}},
      {"infinity", "a.off", "OFF\n3 1 0\n0 0 0\n1 0 inf\n0 1 0\n3 0 1 2\n", 3, "input", "", {"a.off", "inf"}},
      {"number beyond double", "a.obj", "v 1e999 1 1\nv 1 -1 -1\nv -1 1 -1\nf 1 2 3\n", 3, "input", "", {"1e999"}},
      {"index out of range", "a.obj", v + "f 1 2 9\n", 3, "input", "", {"vertex 8", "4 vertices"}},
      {"index zero", "a.obj", v + "f 0 1 2\n", 3, "input", "", {"0"}},
      {"cut", "a.off", "OFF\n4 4 0\n1 1 1\n1 -1 -1\n", 3, "input", "", {"a.off"}},
      {"no faces", "a.obj", v, 3, "input", "", {"face"}},
      {"garbage", "a.xyz", "hello\nworld\n", 3, "input", "", {"a.xyz"}},
      {"repeated vertex", "a.obj", v + "f 1 2 2\n", 4, "mesh", "repeated_vertex_in_face", {"0", "delete"}},
      {"duplicate face", "a.obj", v + f + "f 2 3 1\n", 4, "mesh", "duplicate_face", {"4", "delete"}},
      {"non-manifold edge", "a.obj", v + "v 5 5 5\n" + f + "f 2 1 5\n", 4, "mesh", "non_manifold_edge", {"(0, 1)"}},
      {"inconsistent orientation",
       "a.obj",
       v + "f 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 3 4\n",
       4,
       "mesh",
       "inconsistent_orientation",
       {"--repair orient"}},
      {"Moebius strip",
       "a.obj",
       "v 1 0 0\nv 1 0 1\nv 0 1 0\nv 0 1 1\nv -1 0 0\nv -1 0 1\nf 1 2 3\nf 3 2 4\nf 3 4 5\nf 5 4 6\nf 5 6 2\nf 2 6 1\n",
       4,
       "mesh",
       "not_orientable",
       {"one-sided"}},
      {"zero-length edge",
       "a.obj",
       "v 0 0 0\nv 1 0 0\nv 1 0 0\nf 1 2 3\n",
       4,
       "mesh",
       "zero_length_edge",
       {"(1, 2)", "--repair weld"}},
      {"zero area", "a.obj", "v 0 0 0\nv 1 0 0\nv 3 0 0\nf 1 2 3\n", 4, "mesh", "zero_area_face", {"line"}},
  };
}

}  // namespace

TEST_CASE("each kind of bad input is refused by name, with its exit code, and leaves nothing behind") {
  for (const BadInput& bad : bad_inputs()) {
    CAPTURE(bad.what);
    const CliFolder folder;
    folder.write(bad.name, bad.bytes);
    const auto before = folder.files();
    const CliResult result = folder.run("field " + bad.name + " -o out --report r.json --json");
    CAPTURE(result.err);
    CHECK(result.exit == bad.exit);
    CHECK(folder.files() == before);
    // One line for people ...
    CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
    for (const std::string& word : bad.words) {
      CAPTURE(word);
      CHECK(result.error_says(word));
    }
    // ... and the same for programs.
    const Json report = result.json();
    CHECK(report["ok"] == false);
    CHECK(report["command"] == "field");
    CHECK(report["error"]["exit_code"] == bad.exit);
    CHECK(report["error"]["kind"] == bad.kind);
    CHECK(result.error_says(report["error"]["message"].get<std::string>()));
    if (!bad.defect.empty()) {
      CHECK(report["error"]["defect"] == bad.defect);
      CHECK(report["error"]["count"] >= 1);
      CHECK(!report["error"]["first"].empty());
    }
  }
}

TEST_CASE("a value that the library refuses comes with its field, value, rule and flag") {
  const CliFolder folder;
  folder.write("a.obj", std::string(tetrahedron_vertices) + tetrahedron_faces);
  const CliResult result = folder.run("field a.obj --cone 0:1 --json");
  CHECK(result.exit == 2);
  CHECK(result.error_says("--cone"));
  const Json error = result.json()["error"];
  CHECK(error["option"] == "cones");
  CHECK(error["value"] == "1");
  CHECK(error["rule"].get<std::string>().find("Euler characteristic 2; 1 is missing") != std::string::npos);
  CHECK(error["flag"] == "--cone");
}

TEST_CASE("info works on every mesh that can be read, lists the defects, and exits with 4") {
  for (const BadInput& bad : bad_inputs()) {
    if (bad.exit != 4) continue;
    CAPTURE(bad.what);
    const CliFolder folder;
    folder.write(bad.name, bad.bytes);
    const CliResult result = folder.run("info " + bad.name + " --json");
    CHECK(result.exit == 4);
    const Json report = result.json();
    CHECK(report["ok"] == false);
    bool named = false;
    for (const Json& d : report["defects"]) named = named || d["defect"] == bad.defect;
    CHECK(named);
    CHECK(report["mesh"]["faces"] == std::count(bad.bytes.begin(), bad.bytes.end(), 'f'));
  }
}

TEST_CASE("a missing file, a folder and a file cut in a binary block are input errors") {
  const CliFolder folder;
  std::filesystem::create_directory(folder.work() / "dir.obj");
  folder.write("whole.ply", icosphere(1));
  const std::string whole = CliFolder::read(folder.work() / "whole.ply");
  folder.write("cut.ply", whole.substr(0, whole.size() - 7));
  for (const char* name : {"missing.obj", "dir.obj", "cut.ply"}) {
    CAPTURE(name);
    const CliResult result = folder.run(std::string("field ") + name + " -o out --json");
    CHECK(result.exit == 3);
    CHECK(result.error_says(name));
    CHECK(result.json()["error"]["path"] == name);
  }
  CHECK(folder.files() == std::set<std::string>{"dir.obj", "whole.ply", "cut.ply"});
}

TEST_CASE("--repair orient turns the wrong faces and the field comes out") {
  const CliFolder folder;
  folder.write("a.obj", std::string(tetrahedron_vertices) + "f 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 3 4\n");
  CHECK(folder.run("info a.obj --json").json()["repairs_that_help"] == Json{"orient"});
  const CliResult result = folder.run("field a.obj --repair orient --json");
  CHECK(result.exit == 0);
  CHECK(result.json()["mesh"]["euler"] == 2);
  CHECK(result.json()["singularities"]["index_sum"] == 8);
}

TEST_CASE("a triangle soup works as separate pieces with a warning, and whole after --repair weld") {
  const MeshData whole = icosphere(0);
  MeshData soup;
  soup.V.resize(3 * whole.F.rows(), 3);
  soup.F.resize(whole.F.rows(), 3);
  for (Index t = 0; t < whole.F.rows(); ++t) {
    for (int c = 0; c < 3; ++c) {
      soup.V.row(3 * t + c) = whole.V.row(whole.F(t, c));
      soup.F(t, c) = 3 * t + c;
    }
  }
  const CliFolder folder;
  folder.write("soup.obj", soup);
  const Json pieces = folder.run("field soup.obj --json").json();
  CHECK(pieces["ok"] == true);
  CHECK(pieces["mesh"]["components"] == 20);
  CHECK(pieces["components"].size() == 20);
  REQUIRE(pieces["warnings"].size() == 1);
  CHECK(pieces["warnings"][0]["code"] == "separate_pieces");
  CHECK(pieces["warnings"][0]["count"] == 48);
  CHECK(pieces["warnings"][0]["message"].get<std::string>().find("--repair weld") != std::string::npos);

  const Json welded = folder.run("field soup.obj --repair weld --json").json();
  CHECK(welded["mesh"]["components"] == 1);
  CHECK(welded["mesh"]["euler"] == 2);
  CHECK(welded["singularities"]["index_sum"] == 8);
  for (const Json& w : welded["warnings"]) CHECK(w["code"] == "unreferenced_vertices");
}

TEST_CASE("unreferenced vertices are reported and do no harm") {
  const CliFolder folder;
  MeshData sphere = icosphere(1);
  folder.write("plain.obj", sphere);
  Positions<double> more(sphere.V.rows() + 3, 3);
  more << sphere.V, Positions<double>::Constant(3, 3, 100.0);
  sphere.V = more;
  folder.write("more.obj", sphere);
  const Json plain = folder.run("field plain.obj --json").json(), extra = folder.run("field more.obj --json").json();
  CHECK(extra["ok"] == true);
  CHECK(extra["mesh"]["unreferenced_vertices"] == 3);
  CHECK(extra["mesh"]["euler"] == 2);
  REQUIRE(extra["warnings"].size() == 1);
  CHECK(extra["warnings"][0]["code"] == "unreferenced_vertices");
  CHECK(extra["warnings"][0]["first"] == Json{42, 43, 44});
  CHECK(extra["eigen"]["lambda"].get<double>() ==
        doctest::Approx(plain["eigen"]["lambda"].get<double>()).epsilon(1e-9));
}

TEST_CASE("the content decides what a file is, not its extension; quads are triangulated or refused") {
  const CliFolder folder;
  folder.write("a.ply", std::string(tetrahedron_vertices) + tetrahedron_faces);
  CHECK(folder.run("field a.ply --json").json()["input"]["format"] == "obj");
  folder.write("quad.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  const Json report = folder.run("field quad.obj --json").json();
  CHECK(report["mesh"]["faces"] == 2);
  CHECK(report["input"]["polygons_triangulated"] == true);
  CHECK(folder.run("field quad.obj --refuse-polygons").exit == 3);
}

TEST_CASE("what alcap info proposes works, word for word") {
  const MeshData ball = icosphere(1);
  struct Broken {
    const char* what;
    MeshData mesh;
    const char* repair;
  };
  std::vector<Broken> broken;
  MeshData twice = ball;
  twice.F.conservativeResize(twice.F.rows() + 1, 3);
  twice.F.bottomRows(1) = ball.F.topRows(1);
  broken.push_back({"duplicate face", twice, "duplicates"});
  MeshData flat{Positions<double>(5, 3), Faces(4, 3)};
  flat.V << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0.5, 0.5, 0;
  flat.F << 0, 1, 2, 0, 2, 4, 0, 4, 3, 4, 2, 3;
  broken.push_back({"flat face", flat, "degenerate"});
  MeshData fin = grid(4, 4);
  fin.V.conservativeResize(fin.V.rows() + 1, 3);
  fin.V.bottomRows(1) << 0.1, 0.2, 1;
  fin.F.conservativeResize(fin.F.rows() + 1, 3);
  fin.F.bottomRows(1) << 6, 7, static_cast<Index>(fin.V.rows() - 1);
  broken.push_back({"three faces at an edge", fin, "split"});
  MeshData turned = ball;
  std::swap(turned.F(3, 0), turned.F(3, 1));
  broken.push_back({"a turned face", turned, "orient"});
  MeshData several = twice;
  std::swap(several.F(3, 0), several.F(3, 1));
  broken.push_back({"turned and duplicate", several, "auto"});
  for (const Broken& b : broken) {
    CAPTURE(b.what);
    const CliFolder folder;
    folder.write("part.obj", b.mesh);
    CHECK(folder.run("field part.obj --json").exit == 4);
    const Json info = folder.run("info part.obj --json").json();
    CHECK(info["ok"] == false);
    REQUIRE(info["command_that_works"].is_string());
    const std::string command = info["command_that_works"];
    CHECK(info["repairs_that_help"].back() == b.repair);
    REQUIRE(command.rfind("alcap field ", 0) == 0);
    const CliResult result = folder.run(command.substr(6) + " --json");
    CAPTURE(result.err);
    CHECK(result.exit == 0);
    CHECK(result.json()["ok"] == true);
  }
}

TEST_CASE("what info proposes is a command for a shell, whatever the name of the mesh") {
  MeshData twice = icosphere(1);
  twice.F.conservativeResize(twice.F.rows() + 1, 3);
  twice.F.bottomRows(1) = twice.F.topRows(1);
  for (const std::string& name : std::vector<std::string>{"plain.obj",
                                                          "two words.obj",
                                                          "it's.obj",
                                                          "'quoted'.obj",
                                                          "-n.obj",
                                                          "--json",
                                                          "$HOME.obj",
                                                          "`id`.obj",
                                                          "a\\b.obj",
                                                          "a\nb.obj",
                                                          "tab\tand\x1B[31m.obj",
                                                          "it's\na \\ trap.obj",
                                                          "\xC3\xA4.obj",
                                                          "\xFFraw.obj",
                                                          "\xC2\x85next.obj",
                                                          "*?[a].obj",
                                                          "a;b&c|d.obj",
                                                          "!x.obj",
                                                          "#x.obj",
                                                          "~.obj",
                                                          "caf\xE9's.obj"}) {
    CAPTURE(name);
    const CliFolder folder;
    write_mesh(folder.work() / "part.obj", twice.V, twice.F);
    std::filesystem::rename(folder.work() / "part.obj", folder.work() / name);
    // The name reaches the tool by a variable, quoted by nobody; the proposal is run as it is printed.
    folder.write("../name", name);
    folder.write("../run",
                 "name=$(cat ../name; echo x); name=${name%x}\n"
                 "case $name in -*) name=./$name;; esac\n"
                 "$ALCAP info \"$name\" --input-format obj --json > ../info.json 2> ../said\n"
                 "[ $? = 4 ] || exit 10\n"
                 "$ALCAP info \"$name\" --input-format obj > ../info.txt 2> ../said\n"
                 "alcap() { $ALCAP \"$@\"; }\n"
                 "command=$(sed -n 's/^field *cannot be computed; it can by: //p' ../info.txt)\n"
                 "[ -n \"$command\" ] || exit 11\n"
                 "eval \"$command --json\" > ../field.json || exit 12\n");
    CHECK(folder.shell("bash ../run") == 0);
    const Json info = Json::parse(CliFolder::read(folder.work() / "../info.json"));
    const std::string command = info["command_that_works"];
    CHECK(command.find('\n') == std::string::npos);
    CHECK(CliFolder::read(folder.work() / "../info.txt").find(command) != std::string::npos);
    CHECK(Json::parse(CliFolder::read(folder.work() / "../field.json"))["ok"] == true);
  }
  // Where nothing is unusual, for any shell at all.
  const CliFolder folder;
  folder.write("it's.obj", twice);
  const std::string command = folder.run("info \"it's.obj\" --json").json()["command_that_works"];
  CHECK(command == "alcap field 'it'\\''s.obj' --repair duplicates");
  CHECK(folder.shell("sh -c 'alcap() { $ALCAP \"$@\"; }; "
                     "eval \"$1\"' sh \"$(cat <<'END'\n" +
                     command + " --quiet\nEND\n)\"") == 0);
}

TEST_CASE("bow-ties are split with a note and a map; the field comes out on the split surface") {
  const CliFolder folder;
  folder.write("bow.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv -1 0 0\nv 0 -1 0\nf 1 2 3\nf 1 4 5\n");
  const CliResult result = folder.run("field bow.obj -o out/ --json");
  CHECK(result.exit == 0);
  const Json report = result.json();
  CHECK(report["mesh"]["vertices"] == 6);
  CHECK(report["repaired"]["copies_of"] == Json::array({0}));
  bool said = false;
  for (const Json& note : report["notes"]) said = said || note["code"] == "bow_ties_split";
  CHECK(said);
  CHECK(folder.run("info bow.obj --json").json()["ok"] == true);
  // What was written can be read again, with the mesh it came from.
  CHECK(folder.run("ops bow.obj out/field.ply -o v.csv --json").exit == 0);
}

TEST_CASE("--repair: unknown words, tolerances") {
  const CliFolder folder;
  folder.write("a.obj", icosphere(0));
  for (const char* bad : {"glue", "weld:", "weld:x", "weld:-1", "weld:1", "orient:1"})
    CHECK(folder.run("field a.obj --repair " + std::string(bad)).exit == 2);
  CHECK(folder.run("field a.obj --repair weld:1e-6 --json").exit == 0);
}
