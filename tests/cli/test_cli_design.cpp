// SPDX-License-Identifier: MIT
//
// test_cli_design.cpp: `alcap design` and `alcap make` as users meet them: the example designs, flags, what is met and
// what is not, files, --explain, exit codes.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <vector>

#include "alcap/output.h"
#include "tests/cli/cli_runner.h"

using namespace alcap;
using test::CliFolder;
using test::CliResult;
using test::Json;

namespace {

const Json& control(const Json& report, const std::string& path) {
  for (const Json& c : report["controls"])
    if (c["path"] == path) return c;
  throw std::runtime_error("no control " + path);
}

/// Index of a face in a report; 0 where there is no singularity.
int index_in(const Json& report, int face) {
  for (const Json& s : report["singularities"]["list"])
    if (s["face"] == face) return s["index"];
  return 0;
}

/// Where the singularity of a face lies, by the list of singularities.
Json xyz_in(const Json& report, int face) {
  for (const Json& s : report["singularities"]["list"])
    if (s["face"] == face) return s["xyz"];
  return nullptr;
}

void check_certified(const Json& r) {
  CHECK(r["ok"] == true);
  for (const auto& item : r["certificate"].items()) {
    CAPTURE(item.key());
    CHECK(item.value() == true);
  }
  CHECK(r["singularities"]["index_sum"] == r["singularities"]["expected"]);
  CHECK(r["solve"]["residual"].get<double>() <= (r["solve"]["method"] == "eigen" ? 1e-8 : 1e-9));
  for (const Json& c : r["controls"]) {
    CAPTURE(c.dump());
    CHECK(c["met"] == true);
    const bool soft = c["type"] == "stroke" || c["type"] == "boundary", cone = c["type"] == "cone";
    CHECK(c["tolerance_degrees"].get<double>() == (cone ? 360e-6 : soft ? 10 : 0.5));
    CHECK(c["error_degrees"].get<double>() <= c["tolerance_degrees"].get<double>());
    if (c["type"] == "singularity") {
      CHECK(c["achieved"]["index"] == c["asked"]["index"]);
      CHECK(c["achieved"]["index_nths"] == c["asked"]["index_nths"]);
      CHECK(c["asked"]["index_nths"] == c["asked"]["index"]);
      CHECK(index_in(r, c["asked"]["face"]) == c["asked"]["index"]);
      CHECK(c["achieved"]["xyz"] == xyz_in(r, c["asked"]["face"]));
      CHECK(std::abs(c["achieved"]["angle_degrees"].get<double>() - c["asked"]["angle_degrees"].get<double>()) < 2);
    }
  }
}

}  // namespace

TEST_CASE("every example design runs on a generated sphere and has what it asks for") {
  const CliFolder folder;
  REQUIRE(folder.run("make icosphere:4 -o ball.ply").exit == 0);
  std::map<std::string, Json> reports;
  for (const auto& entry : std::filesystem::directory_iterator(ALCAP_SOURCE_DIR "/datasets/designs")) {
    if (entry.path().extension() != ".json") continue;
    const std::string name = entry.path().stem();
    CAPTURE(name);
    const CliResult result = folder.run("design ball.ply --design '" + entry.path().string() + "' --json");
    CAPTURE(result.err);
    REQUIRE(result.exit == 0);
    reports[name] = result.json();
    check_certified(reports[name]);
    CHECK(reports[name]["singularities"]["expected"] == 2 * reports[name]["design"]["n"].get<int>());
  }
  // Turning by 60 degrees keeps the face and turns the pattern by 60 degrees, modulo its symmetry.
  struct Pair {
    std::string plain, turned;
    int symmetry;
  };
  for (const Pair& p : {Pair{"fig6_saddle", "fig6_saddle_turned", 2},
                        {"fig6_trisector", "fig6_trisector_turned", 3},
                        {"fig7_source", "fig7_spiral", 1},
                        {"fig7_wedge", "fig7_wedge_turned", 1}}) {
    CAPTURE(p.turned);
    const Json &a = control(reports[p.plain], "/singularities/0"), &b = control(reports[p.turned], "/singularities/0");
    CHECK(a["asked"]["face"] == b["asked"]["face"]);
    const double angle = b["achieved"]["angle_degrees"].get<double>() - a["achieved"]["angle_degrees"].get<double>();
    CHECK(std::abs(std::remainder(angle - 60, 360.0 / p.symmetry)) < 1);
  }
  // Singularities of the trivial connection lie at the cones.
  const MeshData ball = icosphere(4);
  for (const Json& s : reports["cones_icosphere"]["singularities"]["list"]) {
    bool at_cone = false;
    for (const Json& c : reports["cones_icosphere"]["controls"])
      for (int k = 0; k < 3; ++k) at_cone |= ball.F(s["face"].get<Index>(), k) == c["asked"]["vertex"].get<Index>();
    CHECK(at_cone);
  }
}

TEST_CASE("flags make the same design as a file, and add to one") {
  const CliFolder folder;
  folder.write("s.ply", bumpy_sphere(3, 0.2, 3));
  folder.write("d.json",
               R"({"alcap_design":1,"n":1,"guidance":{"field":"smoothest","weight":0.5},"singularities":[
                   {"face":40,"kind":"source","angle":10,"strength":2,"pin":true},
                   {"face":700,"kind":"saddle","angle":30,"relative_to":[1,2,3],"strength":2,"pin":true}],
                   "fixed":[{"vertex":100,"direction":[0,0,1]}]})");
  const CliResult file = folder.run("design s.ply --design d.json -o a.ply --json");
  const CliResult flags = folder.run(
      "design s.ply --source 40:10 --saddle 700:30 --relative-to 1,2,3 --strength 2 --pin --fix 100:0,0,1 "
      "--guidance smoothest:0.5 -o b.ply --json");
  CAPTURE(flags.err);
  REQUIRE(file.exit == 0);
  REQUIRE(flags.exit == 0);
  check_certified(file.json());
  check_certified(flags.json());
  CHECK(read_field(folder.work() / "a.ply").field.u == read_field(folder.work() / "b.ply").field.u);
  CHECK(flags.json()["solve"]["rows"] == 3);
  // Sums of indices are in turns, for people: the Euler characteristic.
  const CliResult text = folder.run("design s.ply -n 4 --source 40 --guidance smoothest");
  CHECK(text.out.find("indices sum to 2, expected 2") != std::string::npos);

  const Json pinned = control(file.json(), "/singularities/1")["achieved"];
  CHECK(pinned["length_at_pin"].get<double>() < 1e-9);
  for (const Json& b : pinned["barycentric"]) CHECK(b.get<double>() == doctest::Approx(1.0 / 3).epsilon(1e-6));
  const Json up = control(file.json(), "/fixed/0");
  for (std::size_t k = 0; k < 3; ++k)
    CHECK(up["achieved"]["direction"][k].get<double>() ==
          doctest::Approx(up["asked"]["direction"][k].get<double>()).epsilon(1e-6).scale(1));

  const Json more = folder.run("design s.ply --design d.json --vortex 1000 --singularity 300:-1 --json").json();
  CHECK(more["controls"].size() == 5);
  CHECK(control(more, "/singularities/2")["asked"]["angle_degrees"].get<double>() == doctest::Approx(90));
  CHECK(control(more, "/singularities/3")["asked"]["index"] == -1);
  const Json lines = folder.run("design s.ply --design d.json -n 2 --json").json();
  CHECK(lines["singularities"]["denominator"] == 2);
  check_certified(lines);
}

TEST_CASE("an existing field is a start: alone it comes back, with a control it changes near it") {
  const CliFolder folder;
  folder.write("s.ply", bumpy_sphere(3, 0.2, 3));
  REQUIRE(folder.run("field s.ply -n 2 -o f.ply").exit == 0);
  const CliResult same = folder.run("design s.ply -n 2 --guidance f.ply:1e6 -o g.ply --json");
  CAPTURE(same.err);
  REQUIRE(same.exit == 0);
  const ComplexVectorX<double> f = read_field(folder.work() / "f.ply").field.u,
                               g = read_field(folder.work() / "g.ply").field.u;
  const double scale = same.json()["guidance"]["scale"];
  CHECK((g - scale * f).cwiseAbs().maxCoeff() < 1e-3 * g.cwiseAbs().maxCoeff());
  const Json edited = folder.run("design s.ply -n 2 --guidance f.ply --saddle 700:20 --json").json();
  check_certified(edited);
  CHECK(folder.run("design s.ply -n 4 --guidance f.ply").exit == 3);  // another n
  folder.write("t.ply", icosphere(2));
  CHECK(folder.run("design t.ply -n 2 --guidance f.ply").exit == 3);  // another mesh
  CHECK(folder.run("design s.ply -n 2 --guidance missing.ply").exit == 3);
}

TEST_CASE("what is not met is written, named, and exits with 8: the certificate is another matter") {
  const CliFolder folder;
  folder.write("s.ply", icosphere(3));
  folder.write("d.json", R"({"alcap_design":1,"n":1,"guidance":{"field":"smoothest","weight":1000},
      "singularities":[{"name":"too weak","face":600,"kind":"saddle","strength":1e-6},{"face":3,"kind":"source"}]})");
  const CliResult result = folder.run("design s.ply --design d.json -o out --json");
  CHECK(result.exit == 8);
  CHECK(result.error_says("the design is not met everywhere:"));
  CHECK(result.error_says("too weak (/singularities/0) is not met"));
  const Json r = result.json();
  CHECK(r["ok"] == false);
  CHECK(r["met"] == false);
  CHECK(r["certified"] == true);
  CHECK(r["certificate"]["index_sums_match"] == true);
  CHECK(control(r, "/singularities/0")["met"] == false);
  bool warned = false;
  for (const Json& w : r["warnings"]) warned |= w["code"] == "control_not_met" && w["first"] == Json({600});
  CHECK(warned);
  CHECK(folder.read_json("out/report.json") == r);
}

TEST_CASE("a looser tolerance lets a stroke that was missed count as met, and nothing else changes") {
  const CliFolder folder;
  folder.write("s.ply", bumpy_sphere(3, 0.2, 3));
  folder.write("d.json", R"({"alcap_design":1,"n":4,"guidance":{"field":"smoothest","weight":10},
      "strokes":[{"vertices":[0,30],"weight":0.01}]})");
  const std::string flags = "design s.ply --design d.json --json";
  const CliResult missed = folder.run(flags);
  CHECK(missed.exit == 8);
  const Json before = missed.json()["controls"][0];
  CHECK(before["tolerance_degrees"] == 10);
  REQUIRE(before["error_degrees"].get<double>() > 10);
  REQUIRE(before["error_degrees"].get<double>() < 45);
  const CliResult met = folder.run(flags + " --tolerance-of cone:0.5 --tolerance-of stroke:45");
  CHECK(met.exit == 0);
  const Json after = met.json()["controls"][0];
  CHECK(after["met"] == true);
  CHECK(after["tolerance_degrees"] == 45);
  CHECK(after["error_degrees"] == before["error_degrees"]);
  CHECK(folder.run(flags + " --tolerance-of boundary:45").exit == 8);

  const CliResult zero = folder.run(flags + " --tolerance-of stroke:0");
  CHECK(zero.exit == 2);
  CHECK(zero.error_says("--tolerance-of stroke"));
  CHECK(zero.error_says("must be in (0, 180], degrees"));
  for (const char* bad : {"line:3", "stroke", "stroke:", "stroke:x", "stroke:1x", ":1"}) {
    CAPTURE(bad);
    const CliResult refused = folder.run(flags + " --tolerance-of " + bad);
    CHECK(refused.exit == 2);
    CHECK(refused.error_says("should be KIND:VALUE"));
  }
}

TEST_CASE("texts give indices in turns, keys that end with _nths in n-ths") {
  const CliFolder folder;
  folder.write("t.ply", torus(24, 12, 1, 0.4));
  const std::string flags =
      "design t.ply -n 4 --saddle 3 --singularity 200:+2 --strength 1e-9 --guidance smoothest:1000";
  const CliResult text = folder.run(flags);
  CHECK(text.exit == 8);
  CHECK(text.out.find("saddle (index -1/4) in face 3") != std::string::npos);
  CHECK(text.out.find("source (index 2/4) in face 200") != std::string::npos);
  CHECK(text.out.find("indices sum to 0, expected 0") != std::string::npos);
  CHECK(text.error_says("index 0 instead of -1/4"));
  CHECK(folder.run(flags + " --explain").out.find("source (index 2/4) in face 200") != std::string::npos);
  const Json plan = folder.run(flags + " --explain --json").json()["plan"];
  CHECK(plan["controls"][1]["asked"]["index_nths"] == 2);
  folder.write("s.ply", icosphere(3));
  for (const char* command : {"field s.ply -n 4 --json", "design s.ply -n 4 --saddle 3 --guidance smoothest --json"}) {
    CAPTURE(command);
    const Json r = folder.run(command).json();
    int sum = 0;
    for (const Json& s : r["singularities"]["list"]) {
      CHECK(s["index_nths"] == s["index"]);
      sum += s["index_nths"].get<int>();
    }
    CHECK(sum == 8);  // 4 chi
    CHECK(r["singularities"]["index_sum_nths"] == 8);
    CHECK(r["singularities"]["expected_nths"] == 8);
  }
  const Json part = folder.run("field s.ply -n 4 --json").json()["components"][0]["singularities"];
  CHECK(part["index_sum_nths"] == 8);
  CHECK(part["expected_nths"] == 8);
}

TEST_CASE("a folder gets the fields, the whole design and the report; the design gives the same field again") {
  const CliFolder folder;
  folder.write("s.ply", icosphere(3));
  const CliResult first =
      folder.run("design s.ply -n 4 --saddle 7:10 --cone 0:1 --cone 1:1 --guidance smoothest -o out --json");
  CAPTURE(first.err);
  std::set<std::string> expected{"s.ply", "out"};
  const Json report = first.json();
  for (const Json& f : report["files"]) expected.insert(f.get<std::string>());
  CHECK(folder.files() == expected);
  CHECK(expected.count("out/design.json") == 1);
  CHECK(folder.read_json("out/design.json") == first.json()["design"]);
  CHECK(folder.run("design s.ply --design out/design.json -o again.ply --quiet").exit == first.exit);
  CHECK(read_field(folder.work() / "again.ply").field.u == read_field(folder.work() / "out/field.ply").field.u);
}

TEST_CASE("--explain says what would be solved and writes nothing") {
  const CliFolder folder;
  folder.write("s.ply", icosphere(3));
  const std::string flags =
      "design s.ply -n 4 --source 12 --saddle 900:30 --pin --fix 5:0,0,1 --guidance zero:0.5 -o out --explain";
  const CliResult text = folder.run(flags);
  CHECK(text.exit == 0);
  for (const char* says : {"642 vertices", "zero, weight 0.5", "3 exact", "3 controls",
                           "saddle (index -1/4) in face 900", "pinned", "vertex 5 fixed"}) {
    CAPTURE(says);
    CHECK(text.out.find(says) != std::string::npos);
  }
  const Json plan = folder.run(flags + " --json").json()["plan"];
  CHECK(plan["unknowns"] == 642);
  CHECK(plan["exact_rows"] == 3);
  CHECK(plan["controls"].size() == 3);
  CHECK(folder.files() == std::set<std::string>{"s.ply"});
}

TEST_CASE("a design shows itself as a field does: picture, curves, page") {
  const CliFolder folder;
  folder.write("s.ply", icosphere(3));
  const CliResult help = folder.run("design --help");
  for (const char* flag : {"--png", "--html", "--curves"}) CHECK(help.out.find(flag) != std::string::npos);
  const CliResult curves = folder.run("design s.ply -n 4 --source 12 --guidance smoothest --curves c.json --json");
  REQUIRE(curves.exit == 0);
  CHECK(folder.read_json("c.json")["n"] == 4);
  CHECK(curves.json()["files"] == Json({"c.json"}));
}

TEST_CASE("wrong flags, designs and meshes: exit code, and a message that names what is wrong") {
  const CliFolder folder;
  folder.write("s.ply", icosphere(2));
  folder.write("flat.ply", disk(5));
  folder.write("bad.json", R"({"alcap_design":1,"n":1,"singularities":[{"face":1,"kind":"sadle"}]})");
  folder.write("cut.json", R"({"alcap_design":1,)");
  folder.write("one.txt", "0 0 1\n");
  folder.write("letters.txt", "# a comment\n0 0 x\n");
  folder.write(
      "other.json",
      R"({"alcap_design":1,"n":1,"mesh":{"vertices":9,"faces":9},"singularities":[{"face":1,"kind":"source"}]})");
  struct Wrong {
    const char* arguments;
    int exit;
    const char* says;
  };
  for (const Wrong& w :
       std::vector<Wrong>{{"design s.ply", 2, "nothing is designed"},
                          {"design s.ply --source", 2, "--source"},
                          {"design s.ply --source x", 2, "x should be FACE"},
                          {"design s.ply --source -1", 2, "--source"},
                          {"design s.ply --source 1:2:3", 2, "1:2:3 should be FACE"},
                          {"design s.ply --source 1:nan", 2, "1:nan should be FACE"},
                          {"design s.ply --singularity 1:0", 2, "1:0 should be FACE:+1"},
                          {"design s.ply --singularity 1:+9", 2, "must be 1 to 8"},
                          {"design s.ply --fix 1:0,1", 2, "1:0,1 should be VERTEX"},
                          {"design s.ply --fix 1", 2, "1 should be VERTEX"},
                          {"design s.ply --guidance smoothest:-1", 2, "--guidance"},
                          {"design s.ply --guidance zero", 2, "nothing is designed"},
                          {"design s.ply --source 320", 2, "/singularities/0/face"},
                          {"design s.ply --fix 162:0", 2, "/fixed/0/vertex"},
                          {"design s.ply -n 2 --vortex 1", 2, "/singularities/0/kind"},
                          {"design s.ply -n 0 --source 1", 2, "--degree"},
                          {"design s.ply --source 1 --cone 0:1", 2, "Euler characteristic"},
                          {"design s.ply --source 1 --t 0", 2, "--t weighs a guidance field"},
                          {"design s.ply -n 2 --align-curvature 5", 2, "must be below lambda_1"},
                          {"design s.ply -n 3 --align-curvature 0", 2, "n must be even"},
                          {"design s.ply --align-boundary", 2, "/boundary"},
                          {"design s.ply --method eigen --guidance smoothest --t -1", 2, "'/guidance/t' = -1"},
                          {"design s.ply --source 1 --cones balanced", 2, "--cones"},
                          {"design s.ply --stroke missing.txt", 3, "missing.txt"},
                          {"design s.ply --stroke one.txt", 3, "one.txt: stroke 0 has one point"},
                          {"design s.ply --stroke letters.txt", 3, "letters.txt:2: not a number"},
                          {"design s.ply --source 1 -o out.xyz", 2, "unknown extension"},
                          {"design s.ply --source 1 --solver abacus", 2, "--solver"},
                          {"design s.ply --design other.json", 2, "/mesh/vertices"},
                          {"design s.ply --design bad.json", 3, "bad.json: /singularities/0/kind = \"sadle\""},
                          {"design s.ply --design cut.json", 3, "cut.json:1: not JSON"},
                          {"design s.ply --design missing.json", 3, "missing.json"},
                          {"design missing.ply --source 1", 3, "missing.ply"},
                          {"design flat.ply --source 1", 2, "guidance weight"},
                          {"make", 2, "kind is required"},
                          {"make icosphere:3", 2, "-o"},
                          {"make ball -o b.ply", 2, "known are icosphere"},
                          {"make icosphere:x -o b.ply", 2, "should be icosphere:LEVEL"},
                          {"make icosphere:3,4 -o b.ply", 2, "should be icosphere:LEVEL"},
                          {"make icosphere:2.5 -o b.ply", 2, "should be icosphere:LEVEL"},
                          {"make icosphere:99 -o b.ply", 2, "level"},
                          {"make cube:3 -o b.ply", 2, "takes no arguments"},
                          {"make cube -o b.stl", 2, ".stl"},
                          {"make cube -o no/b.ply", 6, "no/b.ply"}}) {
    CAPTURE(w.arguments);
    const CliResult result = folder.run(w.arguments);
    CAPTURE(result.err);
    CHECK(result.exit == w.exit);
    CHECK(result.error_says(w.says));
    CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
    CHECK(folder.run(std::string(w.arguments) + " --json").json()["error"]["exit_code"] == w.exit);
  }
  CHECK(folder.files() ==
        std::set<std::string>{"s.ply", "flat.ply", "bad.json", "cut.json", "other.json", "one.txt", "letters.txt"});
  CHECK(folder.run("design flat.ply --source 20 --guidance zero:0.1 --quiet").exit == 0);
}

TEST_CASE("alcap make writes the meshes of generators.h") {
  const CliFolder folder;
  const CliResult made = folder.run("make torus:12,8 -o t.obj --json");
  REQUIRE(made.exit == 0);
  CHECK(made.json()["vertices"] == 96);
  CHECK(made.json()["files"] == Json({"t.obj"}));
  CHECK(read_mesh(folder.work() / "t.obj").F == torus(12, 8, 1, 0.4).F);
  for (const std::string kind : {"icosphere:2", "bumpy:2,0.3,4", "scan:3", "genus:3,2", "disk:5", "grid:4,3",
                                 "cylinder:9", "cube", "tetrahedron"}) {
    CAPTURE(kind);
    CHECK(folder.run("make " + kind + " -o m.ply --quiet").exit == 0);
    CHECK(folder.run("info m.ply").exit == 0);
  }
  for (const std::string command : {"design", "make"}) {
    const CliResult help = folder.run(command + " --help");
    CHECK(help.exit == 0);
    CHECK(help.out.find("Examples:") != std::string::npos);
  }
}

TEST_CASE("strokes from a file, boundary, curvature, balanced cones and eigen designs as flags") {
  const CliFolder folder;
  folder.write("ball.ply", icosphere(3));
  folder.write("ring.ply", torus(40, 20, 1, 0.4));
  folder.write("disk.ply", disk(10));
  folder.write("lines.txt", "# two strokes\n1 0 0.1\n0.8, 0.5, 0.1\n0.5 0.8 0.1\n\n-1 0 0\n-0.7 0 0.7\n0 0 1\n");
  const auto run = [&](const std::string& arguments) {
    const CliResult result = folder.run("design " + arguments + " --json");
    CAPTURE(arguments);
    CAPTURE(result.err);
    REQUIRE(result.exit == 0);
    check_certified(result.json());
    return result.json();
  };
  for (const char* method : {"variational", "eigen"})
    for (const int n : {1, 4}) {
      const Json report = run("ball.ply --stroke lines.txt:20 --method " + std::string(method) + " -n " +
                              std::to_string(n) + (n == 1 ? "" : " --saddle 900:10"));
      CHECK(report["solve"]["method"] == method);
      CHECK(control(report, "/strokes/1")["asked"]["points"] == 3);
      CHECK(control(report, "/strokes/1")["asked"]["faces"].get<int>() > 5);
    }
  const Json along = run("disk.ply -n 2 --align-boundary --guidance zero:0.01");
  CHECK(control(along, "/boundary")["achieved"]["mean_deviation_degrees"].get<double>() < 5);
  CHECK(run("disk.ply -n 2 --align-boundary-normal --guidance zero:0.01")["singularities"]["index_sum"] == 2);
  // Crosses along the circles of a torus have no singularities.
  const Json bent = run("ring.ply -n 4 --align-curvature -1");
  CHECK(bent["singularities"]["count"] == 0);
  CHECK(bent["guidance"]["t"] == -1);
  CHECK(run("ring.ply -n 2 --guidance least-curvature --t -5")["singularities"]["count"] == 0);
  const Json cones = run("ball.ply -n 4 --cone 0:1/2 --cones auto-balance --guidance smoothest");
  double sum = 0;
  for (const Json& c : cones["controls"]) sum += c["achieved"]["index"].get<double>();
  CHECK(sum == doctest::Approx(2));
  CHECK(cones["controls"].size() == 7);
  CHECK(run("ball.ply --method eigen")["solve"]["lambda"].size() == 1);
  const Json guided = run("ring.ply -n 4 --method eigen --guidance curvature:2");
  CHECK(guided["guidance"]["field"] == "curvature");
  CHECK(guided["guidance"]["weight"] == 2);
  CHECK(guided["guidance"]["scale"].get<double>() > 0);
  CHECK(guided["singularities"]["count"] == 0);
  const Json pinned = run("ball.ply -n 4 --method eigen --guidance smoothest:2 --saddle 100 --pin");
  CHECK(control(pinned, "/singularities/0")["achieved"]["length_at_pin"].get<double>() < 1e-9);
}

TEST_CASE("the designs of the figures on a scan of 70,000 triangles, where Debian's glmark2-data has it") {
  const std::filesystem::path bunny = "/usr/share/glmark2/models/bunny.obj";
  if (!std::filesystem::exists(bunny)) {
    MESSAGE("skipped: there is no " << bunny.string());
    return;
  }
  const CliFolder folder;
  for (const char* name : {"fig5_crosses", "fig6_trisector_turned", "fig7_wedge", "fig8_stroke_vectors",
                           "fig10_stroke_crosses", "fig11_trivial_stroke"}) {
    CAPTURE(name);
    const CliResult result =
        folder.run("design " + bunny.string() + " --design '" +
                   (std::filesystem::path(ALCAP_SOURCE_DIR) / "datasets/designs" / name).string() + ".json' --json");
    CAPTURE(result.err);
    REQUIRE(result.exit == 0);
    check_certified(result.json());
  }
}
