// SPDX-License-Identifier: MIT
//
// test_cli_options.cpp: values at the limits of what numbers and names can be, for every kind of option: refused in
// words that name what was typed, or used; never taken for something else. Outputs that many runs write, and reports
// that are not what they seem.
#include <doctest/doctest.h>

#include <sstream>
#include <string>
#include <vector>

#include "tests/cli/cli_runner.h"

using namespace alcap;
using test::CliFolder;
using test::CliResult;
using test::Json;

namespace {

/// The message names the option that was given, and fits on a line.
void check_refused(const CliFolder& folder, const std::string& arguments, const std::string& says) {
  CAPTURE(arguments);
  const CliResult result = folder.run(arguments);
  CAPTURE(result.err);
  CHECK(result.exit == 2);
  CHECK(result.error_says(says));
  CHECK(result.err.size() < 300);
}

}  // namespace

TEST_CASE("numbers that are none, not finite, or out of range are refused by the option's name") {
  const CliFolder folder;
  folder.write("a.obj", icosphere(1));
  for (const char* option :
       {"--detail", "--tan-cap", "--connection-tolerance", "--tolerance", "--angle-tolerance", "--energy",
        "--min-angle", "--align-weight", "--curve-spacing", "--sizing-error", "--sizing-growth"})
    for (const char* value : {"nan", "inf", "-1e308", "1e400"})
      check_refused(folder, std::string("field a.obj ") + option + "=" + value, option);
  for (const char* value : {"0", "1", "-1", "2", "abc"}) {
    check_refused(folder, std::string("field a.obj --connection-tolerance=") + value, "--connection-tolerance");
    check_refused(folder, std::string("field a.obj --tolerance=") + value, "--tolerance");
  }
  check_refused(folder, "field a.obj --detail 0", "0 is not a finite number above 0");
  check_refused(folder, "field a.obj -s 1.5", "1.5 is not a number from -1 to 1");
  check_refused(folder, "field a.obj --detail 1e308", "--detail");
  check_refused(folder, "field a.obj --cones auto-balance -n 900", "--cones");
  check_refused(folder, "field a.obj --cone 0:1e300", "[-1e6, 1e6] turns");
  check_refused(folder, "field a.obj --connection metric --cone 0:1e15 --cone 1:-999999999999998", "[-1e6, 1e6] turns");
  check_refused(folder, "field a.obj --loop-index 1", "--loop-index");
}

TEST_CASE("plans are made for memory and speed that are numbers") {
  const CliFolder folder;
  for (const char* value : {"nan", "inf", "-1", "0", "1e400"}) {
    check_refused(folder, std::string("plan 1000 --speed 1 --memory=") + value, "--memory");
    check_refused(folder, std::string("plan 1000 --speed=") + value, "--speed");
  }
  // More than a count of bytes can hold is as much as it can.
  const CliResult all = folder.run("plan 1000 --speed 1 --memory 1e308 --json");
  CHECK(all.exit == 0);
  CHECK(all.json()["plan"]["memory"].get<double>() > 9e18);
}

TEST_CASE("weights, strengths and angles of designs") {
  const CliFolder folder;
  folder.write("a.obj", icosphere(2));
  folder.write("stroke", std::string("-1 0 0\n0 0 1\n1 0 0\n"));
  for (const char* value : {"1e13", "1e308", "1e-320"}) {
    const std::string text = value;
    check_refused(folder, "design a.obj --source 5 --strength " + text, "/singularities/0/strength");
    check_refused(folder, "design a.obj --source 5 --guidance smoothest:" + text, "/guidance/weight");
    check_refused(folder, "design a.obj --source 5 --guidance zero:" + text, "/guidance/weight");
    check_refused(folder, "design a.obj -n 2 --stroke stroke:" + text, "/strokes/0/weight");
    check_refused(folder, "design a.obj -n 2 --method eigen --stroke stroke:" + text, "/strokes/0/weight");
  }
  check_refused(folder, "design a.obj --source 5 --guidance smoothest --t=-1e300", "/guidance/t");
  check_refused(folder, "design a.obj -n 4 --cone 0:1e9 --cone 5:1", "[-1e6, 1e6] turns");
  check_refused(folder, "design a.obj -n 4 --holonomy 1e9", "[-1e6, 1e6] turns");
  // A source has no direction in space; what was typed is looked at all the same.
  for (const char* value : {"nan 0 0", "0 0 0", "inf 1 0"})
    check_refused(folder, std::string("design a.obj --source 5 --relative-to ") + value, "--relative-to");
  CHECK(folder.run("design a.obj --source 5 --strength 1e12 -q").exit == 0);
}

TEST_CASE("what does not go together is refused by the names of both, and nothing is written") {
  const CliFolder folder;
  folder.write("a.obj", icosphere(1));
  folder.write("list", std::string("a.obj\n"));
  folder.write("twice", std::string("a.obj\nsub/a.obj\n"));
  REQUIRE(folder.shell("mkdir sub; cp a.obj sub; $ALCAP field a.obj -n 2 -q -o f.ply") == 0);
  const auto before = folder.files();
  struct Wrong {
    const char *arguments, *says;
  };
  for (const Wrong& w : std::vector<Wrong>{
           {"field", "mesh is required"},
           {"field a.obj --batch list", "MESH and --batch exclude each other"},
           {"field a.obj --jobs 2", "--lines and --jobs need --batch"},
           {"field a.obj --lines x", "--lines and --jobs need --batch"},
           {"field --batch list --lengths x", "--lengths is for one mesh, and --batch has many"},
           {"field --batch list --for directional", "--for is for one mesh"},
           {"field --batch list --sizing x.csv", "--sizing is for one mesh"},
           {"field --batch list --features x", "--features is for one mesh"},
           {"field --batch list --modes 2", "--modes is for one mesh"},
           {"field --batch list --html x.html", "--html is for one mesh"},
           {"field --batch list --png x.png", "--png is for one mesh"},
           {"field --batch list --curves x.obj", "--curves is for one mesh"},
           {"field --batch twice -o out", "would have the same name; rename one mesh"},
           {"field --batch list --report a.obj", "--report a.obj would replace a mesh of the list"},
           {"field --batch list --lines ./sub/../a.obj", "would replace a mesh of the list"},
           {"field a.obj --for quadwild -n 2 -o out", "--for quadwild takes crosses: leave out -n, or say -n 4"},
           {"field a.obj --for directional", "--for writes several files, so it needs -o FOLDER"},
           {"field a.obj --for directional --formats ply -o out", "--for and --formats exclude each other"},
           {"field a.obj --for gimp -o out", "--for: gimp not in {quadwild,directional}"},
           {"field a.obj --formats exe -o out", "--formats exe: unknown; known are "},
           {"field a.obj --formats ply -o x.ply", "--formats needs -o FOLDER"},
           {"field a.obj -o x.exe", "-o x.exe: unknown extension .exe (known: "},
           {"field a.obj --sizing x.doc", "--sizing x.doc: use one of ."},
           {"field a.obj --repair glue", "--repair: glue not in {"},
           {"field a.obj --repair weld:2", "--repair: weld:2: the tolerance is a number above 0 and at most 0.1"},
           {"field a.obj --lengths list --repair mollify", "give one or the other"},
           {"field a.obj --cone 5", "--cone: 5 should be VERTEX:INDEX"},
           {"field a.obj --cone 5:1/0", "--cone: 5:1/0 has no finite index"},
           {"field a.obj --connection metric --loop-index 1/0", "--loop-index: 1/0 is not finite"},
           {"field a.obj --align-features=200", "200 is not an angle in degrees"},
           {"export-matrices a.obj -o x.npz", "-o x.npz: the matrices go into a folder"},
           {"make cloud -o x.obj", "cloud: there is no such generator; known are "},
           {"make icosphere:1 -o out", "-o must name a file that ends with .obj, .off or .ply"},
           {"ops a.obj f.ply -o out", "-o must name a file that ends with .csv or .vtp"},
           {"view f.ply", "nothing is to be made; give -o FILE.html, --png FILE or --curves FILE"},
           {"design a.obj", "nothing is designed; give --design FILE"},
           {"design a.obj --source 5 --t 0", "--t weighs a guidance field; give one with --guidance"},
           {"design a.obj --source 5 --guidance :2", "should be FIELD.ply, smoothest, curvature or zero"},
           {"design a.obj --source x", "--source: x should be "},
           {"design a.obj --source -5", "--source: -5 should be "},
           {"design a.obj --fix 5:1,2", "--fix: 5:1,2 should be VERTEX:ANGLE or VERTEX:X,Y,Z"},
           {"design a.obj --fix 5", "--fix: 5 should be VERTEX:ANGLE or VERTEX:X,Y,Z"},
           {"design a.obj --stroke :2", "--stroke: the name is empty"},
           {"design a.obj --stroke list:-1", "--stroke: list:-1 should be FILE or FILE:WEIGHT with a weight above 0"},
       })
    check_refused(folder, w.arguments, w.says);
  CHECK(folder.files() == before);
}

TEST_CASE("what a file that an option names does not hold is told by its name and line") {
  const CliFolder folder;
  folder.write("a.obj", icosphere(1));
  folder.write("b.obj", icosphere(2));
  folder.write("words", std::string("0 0 1\n1 zero 0\n"));
  folder.write("pairs", std::string("0 0 1\n1 0\n"));
  folder.write("empty", std::string("# nothing\n\n"));
  folder.write("point", std::string("0 0 1\n1 0 0\n\n0 1 0\n"));
  folder.write("zero", std::string("a\0b\n", 4));
  REQUIRE(folder.run("field b.obj -n 2 -q -o b.ply").exit == 0);
  struct Wrong {
    const char *arguments, *says;
  };
  for (const Wrong& w : std::vector<Wrong>{
           {"design a.obj -n 2 --stroke words", "words:2: not a number: zero 0"},
           {"design a.obj -n 2 --stroke pairs", "pairs:2: 2 numbers instead of a point x y z"},
           {"design a.obj -n 2 --stroke empty", "empty: holds no stroke"},
           {"design a.obj -n 2 --stroke point", "point: stroke 1 has one point; at least two are needed"},
           {"field a.obj --features b.obj", "b.obj: has 162 vertices, and the mesh 42"},
           {"field a.obj --features a.obj", "a.obj: lists no edges"},
           {"field --batch zero", "zero: a name has a zero byte; give one path a line"},
           {"field --batch empty", "empty: the list names no mesh; give one path a line"},
           {"ops a.obj b.ply", "b.ply holds a field on another mesh (162 vertices, 320 faces) than a.obj"},
           {"design a.obj -n 2 --source 3 --guidance b.ply", "b.ply: holds a field on another mesh"}}) {
    CAPTURE(std::string(w.arguments));
    const CliResult result = folder.run(w.arguments);
    CAPTURE(result.err);
    CHECK(result.exit == 3);
    CHECK(result.error_says(w.says));
  }
}

TEST_CASE("an error of a file that an option names is told like any other, as JSON too") {
  const CliFolder folder;
  folder.write("a.obj", icosphere(1));
  folder.write("t.json", std::string("{\"rotation\":[NaN]}"));
  for (const char* arguments : {"field a.obj --json --target none", "field a.obj --json --target t.json",
                                "design a.obj --json --stroke none", "field a.obj --json --lengths none"}) {
    CAPTURE(arguments);
    const CliResult result = folder.run(arguments);
    CHECK(result.exit == 3);
    CHECK(result.json()["error"]["kind"] == "input");
    CHECK(result.err.find("alcap " + std::string(arguments).substr(0, 5)) == 0);
  }
}

TEST_CASE("a name that is empty is no output and no input") {
  const CliFolder folder;
  folder.write("a.ply", icosphere(1));
  REQUIRE(folder.run("field a.ply -n 1 -q -o f.ply").exit == 0);
  const auto before = folder.files();
  for (const char* arguments : {"field a.ply -o ''",
                                "field a.ply --report ''",
                                "field a.ply --html ''",
                                "field a.ply --png ''",
                                "field a.ply --curves ''",
                                "field a.ply --sizing ''",
                                "field a.ply --lengths ''",
                                "field a.ply --features ''",
                                "field a.ply --target ''",
                                "field --batch ''",
                                "field ''",
                                "info ''",
                                "plan ''",
                                "make cube -o ''",
                                "export-matrices a.ply -o ''",
                                "ops a.ply ''",
                                "view '' -o p.html",
                                "view f.ply -o ''",
                                "design a.ply --design ''",
                                "design a.ply --stroke ''",
                                "design a.ply --guidance ''"})
    check_refused(folder, arguments, arguments == std::string("design a.ply --guidance ''") ? "--guidance" : "empty");
  CHECK(folder.files() == before);
}

TEST_CASE("no output takes the place of any file that the command line names") {
  const CliFolder folder;
  const MeshData sphere = icosphere(1);
  for (const char* name : {"a.ply", "field.ply", "mode-1.ply"}) folder.write(name, sphere);
  folder.write("b.obj", sphere);
  folder.write("list", std::string("a.ply\nb.obj\n"));
  folder.write("stroke", std::string("-1 0 0\n0 0 1\n1 0 0\n"));
  std::string lengths;
  const Mesh mesh(sphere.F, sphere.V.rows());
  for (Index t = 0; t < mesh.faces(); ++t)
    for (Index c = 0; c < 3; ++c)
      lengths += std::to_string((sphere.V.row(sphere.F(t, c)) - sphere.V.row(sphere.F(t, (c + 1) % 3))).norm()) +
                 (c == 2 ? "\n" : " ");
  folder.write("lengths", lengths);
  REQUIRE(folder.shell("$ALCAP field a.ply -n 1 -q -o g.ply; mkdir sub; cp a.ply sub") == 0);
  const auto before = folder.files();
  for (const char* arguments :
       {"field a.ply --lengths lengths --report lengths", "field a.ply --lengths lengths --html lengths",
        "design a.ply -n 2 --stroke stroke --report stroke", "design a.ply -n 2 --stroke stroke:2 --html stroke",
        "design a.ply -n 1 --guidance g.ply -o g.ply", "design a.ply -n 1 --guidance g.ply:2 --report g.ply",
        "plan a.ply --report a.ply", "export-matrices a.ply -o m --report a.ply",
        "export-matrices a.ply -o m --report m/mass.npz", "tables --levels 1 --fields 2 --mesh a.ply --report a.ply",
        "field --batch list --report a.ply", "field --batch list --lines b.obj",
        "field --batch list --lines sub/../a.ply", "field --batch list -o .", "field --batch list -o sub/..",
        "field field.ply -o .", "field mode-1.ply --modes 2 -o ."}) {
    CAPTURE(arguments);
    const CliResult result = folder.run(arguments);
    CAPTURE(result.err);
    CHECK(result.exit == 2);
    CHECK(folder.files() == before);
  }
  CHECK(folder.run("field --batch list -q -o out").exit == 0);
}

TEST_CASE("options that a batch cannot honour are refused, and those of a batch without one") {
  const CliFolder folder;
  folder.write("a.ply", icosphere(1));
  folder.write("list", std::string("\xEF\xBB\xBF"
                                   "a.ply\r\n"));
  CHECK(folder.run("field --batch list -q").exit == 0);  // with a byte order mark
  for (const char* option : {"--png x.png", "--html x.html", "--curves x.obj", "--modes 2", "--lengths x"})
    check_refused(folder, std::string("field --batch list ") + option, "--batch");
  for (const char* option : {"--lines x", "--jobs 2"})
    check_refused(folder, std::string("field a.ply ") + option, "--batch");
  folder.write("list", std::string("a.ply\0\n", 7));
  CHECK(folder.run("field --batch list").exit == 3);
}

TEST_CASE("the files of a folder are of one run, also when several write into it at the same time") {
  const CliFolder folder;
  folder.write("a.obj", icosphere(1));
  for (const char* before : {"true", "mkdir out"}) {
    CAPTURE(before);
    for (int round = 0; round < 4; ++round) {
      REQUIRE(folder.shell(
                  std::string("rm -rf out; ") + before +
                  "; for n in 1 2 3 4 6; do $ALCAP field a.obj -n $n -q -o out --formats rosy,rawfield & done; wait") ==
              0);
      const int n = folder.read_json("out/report.json")["singularities"]["denominator"].get<int>();
      std::istringstream rosy(CliFolder::read(folder.work() / "out/field.rosy"));
      int rows = 0, degree = 0;
      rosy >> rows >> degree;
      CHECK(degree == n);
      std::istringstream raw(CliFolder::read(folder.work() / "out/field.rawfield"));
      raw >> degree;
      CHECK(degree == n);
    }
  }
}

TEST_CASE("a page shows the figures of its own field, and no report can stop it") {
  const CliFolder folder;
  folder.write("a.obj", icosphere(1));
  REQUIRE(folder.shell("$ALCAP field a.obj -n 4 -q -o out && $ALCAP field a.obj -n 1 -q -o out/other.ply") == 0);
  const auto other_report = [&](const std::string& field) {
    const CliResult result = folder.run("view " + field + " -o p.html --json");
    CAPTURE(result.err);
    REQUIRE(result.exit == 0);
    const Json report = result.json();
    bool said = false;
    for (const Json& w : report["warnings"]) said = said || w["code"] == "other_report";
    return said;
  };
  CHECK_FALSE(other_report("out"));
  CHECK(other_report("out/other.ply"));
  const Json good = folder.read_json("out/report.json");
  for (const char* key : {"ok", "met", "certificate", "connection", "eigen", "times", "input"})
    for (const Json& value : {Json(5), Json("x"), Json(), Json::array({1}), Json{{"kind", 7}, {"lambda", "x"}}}) {
      CAPTURE(key);
      Json report = good;
      report[key] = value;
      folder.write("out/report.json", report.dump());
      CHECK_FALSE(other_report("out"));
    }
  for (const std::string& text : {std::string("[]"), std::string("5"), std::string("{"), std::string("\xff"),
                                  std::string(300000, '['), std::string(300000, '[') + std::string(300000, ']')}) {
    folder.write("out/report.json", text);
    CHECK_FALSE(other_report("out"));
  }
  std::string deep = "{\"a\":";
  for (int k = 0; k < 200000; ++k) deep += "{\"a\":";
  folder.write("out/report.json", deep + "1" + std::string(200001, '}'));
  CHECK(other_report("out"));
}
