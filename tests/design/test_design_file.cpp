// SPDX-License-Identifier: MIT
//
// test_design_file.cpp: designs survive writing and reading, everything wrong is named by its path and value, broken
// files are errors and nothing else, and what is written means on the mesh what docs/design.md says.
#include "alcap/design_file.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "alcap/errors.h"
#include "alcap/generators.h"
#include "alcap/output.h"
#include "src/base/random.h"
#include "tests/support/folder.h"

using namespace alcap;
using Json = nlohmann::json;

namespace {

/// Says everything that can be said, with numbers that need all their digits.
DesignFile full() {
  DesignFile d;
  d.comment = "all of it, \"quoted\" \xC3\xA4";
  d.mesh = DesignMesh{642, 1280};
  d.n = 2;
  d.s = 0.25;
  d.connection = {.kind = ConnectionKind::trivial,
                  .detail = 0.1,
                  .length_factor = LengthFactor::per_edge,
                  .tan_cap = 1.0 / 3,
                  .cones = {{3, 0.5}, {7, -0.5}, {11, 2}},
                  .cones_at = {{{0.1, 0.2, 1}, -1.5}},
                  .balance = true,
                  .holonomy = {0.5, -1},
                  .loops = {1.5}};
  d.guidance = {.source = DesignGuidance::Source::file, .file = "field.ply", .weight = 1.0 / 3};
  d.singularities = {{.name = "first", .face = 12, .kind = SingularityKind::wedge, .angle = 1e-17, .strength = 0.7},
                     {.face = 13,
                      .kind = SingularityKind::trisector,
                      .angle = -30.1,
                      .relative_to = Vector3{1, -0.1, 1e300},
                      .pin = true,
                      .barycentric = std::array<double, 3>{0.1, 0.2, 0.7}},
                     {.at = Vector3{0.1, 0.2, 0.3}, .kind = SingularityKind::saddle, .pin = true},
                     {.at = Vector3{0.1, 0.2, -0.3}, .kind = SingularityKind::source}};
  d.fixed = {{.name = "up", .vertex = 5, .direction = Vector3{0, 1, 0}, .length = 2.5},
             {.vertex = 6, .angle = 0.0},
             {.at = Vector3{1, 2, 3}, .angle = 45.5, .relative_to = Vector3{0, 0, 1}},
             {.vertex = 9, .angle = 1.0, .free_length = true}};
  d.strokes = {{.name = "stroke",
                .points = {{.face = 1, .barycentric = {0.2, 0.3, 0.5}}, {.at = Vector3{0, 0, 1}}},
                .weight = 3},
               {.vertices = {1, 2, 30}, .radius = 0.25},
               {.path = {{0, 0, 1}, {0.1, 0, 1e-3}}}};
  d.boundary = {.wanted = true, .normal = true, .weight = 0.1};
  d.features = {.wanted = true,
                .angle = 35.5,
                .weight = 2,
                .hold = true,
                .across = true,
                .boundary = true,
                .corner_angle = 50,
                .low_angle = 20,
                .gap = 0.25,
                .spur = 0.125};
  return d;
}

std::string error_of(const std::string& text) {
  try {
    (void)parse_design(text, "d.json");
  } catch (const FileError& e) {
    CHECK(e.path() == "d.json");
    return e.what();
  }
  return "no error";
}

/// The full design with the value at a JSON pointer replaced.
std::string with(const std::string& pointer, const Json& value) {
  Json json = Json::parse(design_text(full()));
  json[Json::json_pointer(pointer)] = value;
  return json.dump();
}

std::string without(const std::string& object, const std::string& key) {
  Json json = Json::parse(design_text(full()));
  json[Json::json_pointer(object)].erase(key);
  return json.dump();
}

struct Ball {
  MeshData surface = icosphere(3);
  ConnectedSurface connected = connect(Surface(surface.V, surface.F), {.kind = ConnectionKind::polar});
  const Mesh& mesh = connected.mesh();
  const Frames& frames = *connected.frames();
  [[nodiscard]] std::vector<DesignControl> controls(const DesignFile& d) const {
    return design_controls(place_design(d, connected), connected);
  }
  [[nodiscard]] Eigen::RowVector3d at(Index t, const std::array<double, 3>& b) const {
    Eigen::RowVector3d x = Eigen::RowVector3d::Zero();
    for (Index c = 0; c < 3; ++c) x += b[static_cast<std::size_t>(c)] * surface.V.row(mesh.F()(t, c));
    return x;
  }
};

}  // namespace

TEST_CASE("what is written reads back as the same design, bit for bit") {
  const std::string text = design_text(full());
  const DesignFile back = parse_design(text);
  CHECK(design_text(back) == text);
  CHECK(back.comment == full().comment);
  CHECK(back.singularities[1].angle == -30.1);
  CHECK(*back.singularities[1].relative_to == *full().singularities[1].relative_to);
  CHECK(*back.singularities[1].barycentric == *full().singularities[1].barycentric);
  CHECK(back.singularities[0].angle == 1e-17);
  CHECK(back.singularities[2].pin);
  CHECK_FALSE(back.singularities[3].pin);
  CHECK(back.guidance.weight == 1.0 / 3);
  CHECK(back.connection.cones[1].index == -0.5);
  CHECK(back.fixed[1].angle.has_value());
  CHECK(back.strokes[0].points[1].at.has_value());

  for (const char* kind : {"source", "sink", "vortex", "spiral", "saddle"}) {
    DesignFile d = parse_design(
        std::string(R"({"alcap_design":1,"n":1,"singularities":[{"face":0,"angle":5,"kind":")") + kind + "\"}]}");
    CHECK(std::string(name(d.singularities[0].kind)) == kind);
    CHECK(design_text(parse_design(design_text(d))) == design_text(d));
  }
  CHECK(back.s == 0.25);
  CHECK(back.connection.balance);
  CHECK(back.connection.length_factor == LengthFactor::per_edge);
  CHECK(back.connection.tan_cap == 1.0 / 3);
  CHECK(back.connection.holonomy == std::vector<double>{0.5, -1});
  CHECK(back.fixed[3].free_length);
  CHECK(back.strokes[1].vertices == std::vector<Index>{1, 2, 30});
  CHECK(back.strokes[2].path[1][2] == 1e-3);
  CHECK(back.boundary.normal);
  CHECK(back.features.angle == 35.5);
  CHECK(back.features.weight == 2);
  CHECK(back.features.hold);
  CHECK(back.features.across);
  CHECK(back.features.boundary);
  CHECK(back.features.corner_angle == 50);
  CHECK(back.features.low_angle == 20);
  CHECK(back.features.gap == 0.25);
  CHECK(back.features.spur == 0.125);
  DesignFile named = full();
  named.features = {.wanted = true, .hold = true, .edges = {{3, 4}, {4, 17}}, .gap = 1};
  CHECK(parse_design(design_text(named)).features.edges == named.features.edges);
  named.features = {.wanted = true, .file = "creases.sharp", .spur = 1};
  CHECK(parse_design(design_text(named), "design", "folder").features.file == "folder/creases.sharp");
  // Designs from before features could be held.
  const DesignFile old = parse_design(R"({"alcap_design":1,"n":4,"features":{"angle":30,"weight":2}})");
  CHECK_FALSE(old.features.hold);
  CHECK_FALSE(old.features.boundary);
  CHECK(Json::parse(design_text(old))["features"] == Json({{"angle", 30}, {"weight", 2}}));
  const DesignFile by_t = parse_design(
      R"({"alcap_design":1,"n":2,"method":"variational","guidance":{"field":"least-curvature","t":-0.1}})");
  CHECK(*by_t.guidance.t == -0.1);
  CHECK(design_text(parse_design(design_text(by_t))) == design_text(by_t));
  const DesignFile metric = parse_design(
      R"({"alcap_design":1,"n":3,"connection":{"kind":"metric","cones":[{"vertex":1,"index":0.123}],"holonomy":[0.3]}})");
  CHECK(metric.connection.cones[0].index == 0.123);
  CHECK(design_text(parse_design(design_text(metric))) == design_text(metric));
  const DesignFile target = parse_design(
      R"({"alcap_design":1,"n":3,"connection":{"kind":"metric","target":{"adjustment":[0,0.1,-0.2]},"spread":false}})");
  CHECK(target.connection.target.adjustment == Eigen::Vector3d(0, 0.1, -0.2));
  CHECK(!target.connection.spread);
  CHECK(design_text(parse_design(design_text(target))) == design_text(target));
  const DesignFile eigen = parse_design(
      R"({"alcap_design":1,"n":3,"method":"eigen","strokes":[{"vertices":[0,1]}],"singularities":[{"face":0,"kind":"saddle"}]})");
  CHECK(eigen.method == DesignMethod::eigen);
  CHECK(design_text(parse_design(design_text(eigen))) == design_text(eigen));
  for (const char* kind : {"global", "local", "polar", "polar-barycenter", "trivial", "metric"}) {
    const std::string given = std::string(R"({"alcap_design":1,"n":1,"connection":{"kind":")") + kind + "\"}}";
    CHECK(Json::parse(design_text(parse_design(given)))["connection"]["kind"] == kind);
  }
}

TEST_CASE("files: round trip, guidance beside the design, missing, folder, empty") {
  const auto folder = std::filesystem::temp_directory_path() / "alcap-test-design-file";
  std::filesystem::create_directories(folder);
  const auto file = folder / "d.json";
  write_design(file, full());
  DesignFile back = read_design(file);
  CHECK(back.guidance.file == folder / "field.ply");
  back.guidance.file = "field.ply";
  CHECK(design_text(back) == design_text(full()));
  CHECK_THROWS_AS((void)read_design(folder / "missing.json"), FileError);
  CHECK_THROWS_AS((void)read_design(folder), FileError);
  std::ofstream(folder / "empty.json").close();
  CHECK_THROWS_AS((void)read_design(folder / "empty.json"), FileError);
  CHECK_THROWS_AS(write_design(folder / "no" / "d.json", full()), FileError);
  DesignFile bad = full();
  bad.n = 0;
  CHECK_THROWS_AS(write_design(folder / "bad.json", bad), OptionError);
  CHECK_FALSE(std::filesystem::exists(folder / "bad.json"));
  std::filesystem::remove_all(folder);
}

TEST_CASE("every wrong value is named by its path and value") {
  struct Wrong {
    const char* pointer;
    Json value;
    const char* says;
  };
  const std::vector<Wrong> all = {
      {"/alcap_design", 2, "/alcap_design = 2: this alcap reads version 1"},
      {"/n", 0, "/n = 0:"},
      {"/n", 1001, "/n = 1001:"},
      {"/n", 1.5, "/n = 1.5: must be a whole number"},
      {"/n", "two", "/n = \"two\": must be a whole number"},
      {"/n", 1e300, "must be a whole number"},
      {"/comment", 5, "/comment = 5: must be a text"},
      {"/mesh/vertices", 2, "/mesh/vertices = 2:"},
      {"/mesh/faces", 0, "/mesh/faces = 0:"},
      {"/mesh", 3, "/mesh = 3: must be an object"},
      {"/connection/kind", "flat", "/connection/kind = \"flat\": must be one of global, local"},
      {"/connection/kind", "global", "cones: needs a trivial"},
      {"/connection/detail", 0, "/connection/detail = 0: must be in [1e-12, 1e12]"},
      {"/connection/detail", 1e30, "/connection/detail = 1e+30: must be in [1e-12, 1e12]"},
      {"/connection/cones/0/index", 1e9, "/connection/cones/0/index = 1e+09: must be in [-1e6, 1e6] turns"},
      {"/connection/holonomy/0", -1e9, "must be in [-1e6, 1e6] turns"},
      {"/connection/cones/0/index", 0.3, "/connection/cones/0/index = 0.3: must be a multiple of 1/n = 1/2"},
      {"/connection/cones/0/index", "1/", "/connection/cones/0/index = \"1/\": must be a number, or a fraction"},
      {"/connection/cones/0/index", "1/0", "must be a number, or a fraction"},
      {"/connection/cones/0/index", "a quarter", "must be a number, or a fraction"},
      {"/connection/cones/3/index", 0.3, "/connection/cones/3/index = 0.3: must be a multiple of 1/n = 1/2"},
      {"/connection/cones/3/vertex", 2, "/connection/cones/3 = an object: needs either vertex or at"},
      {"/connection/cones/1/vertex", -1, "/connection/cones/1/vertex = -1: must not be negative"},
      {"/guidance/weight", 0, "/guidance/weight = 0: must be in [1e-100, 1e12]"},
      {"/guidance/weight", 1e300, "/guidance/weight = 1e+300: must be in [1e-100, 1e12]"},
      {"/guidance/file", "", "/guidance/file = \"\": must be the name of a file"},
      {"/guidance/field", "smoothest", "needs either field or file"},
      {"/singularities", 1, "/singularities = 1: must be a list"},
      {"/singularities/0/face", -3, "/singularities/0/face = -3: must not be negative"},
      {"/singularities/0/face", sizeof(Index) == 4 ? 3e9 : 3e19, "must be a whole number"},
      {"/singularities/0/face", nullptr, "/singularities/0/face = null: must be a whole number"},
      {"/singularities/0/at", {0, 0, 1}, "/singularities/0 = two places: needs either face or at, not both"},
      {"/singularities/0/kind", "hole", "/singularities/0/kind = \"hole\": must be one of source"},
      {"/singularities/0/kind", "vortex", "/singularities/0/kind = \"vortex\": exists for n = 1 only, and here n = 2"},
      {"/singularities/0/angle", "30", "/singularities/0/angle = \"30\": must be a number"},
      {"/singularities/0/strength", -1, "/singularities/0/strength = -1: must be in [1e-100, 1e12]"},
      {"/singularities/0/strength", 1e308, "must be in [1e-100, 1e12]"},
      {"/singularities/0/relative_to", {1, 0}, "/singularities/0/relative_to = [1,0]: must be a list of three"},
      {"/singularities/0/relative_to", {0, 0, 0}, "a direction must not be zero"},
      {"/singularities/0/relative_to", {0, "x", 0}, "/singularities/0/relative_to/1 = \"x\": must be a number"},
      {"/singularities/0/pin", {0.5, 0.6, 0.5}, "/singularities/0/pin = [0.5,0.6,0.5]: barycentric"},
      {"/singularities/0/pin", {1.5, -0.5, 0.0}, "barycentric coordinates must not be negative"},
      {"/singularities/0/pin", "yes", "/singularities/0/pin = \"yes\": must be a list of three"},
      {"/singularities/2/pin", {0.2, 0.3, 0.5}, "/singularities/2/pin = [0.2,0.3,0.5]: needs face"},
      {"/singularities/0/colour", "red", "/singularities/0/colour = \"red\": unknown key; known are name, face"},
      {"/colour", "red", "/colour = \"red\": unknown key"},
      {"/mesh/edges", 7, "/mesh/edges = 7: unknown key"},
      {"/connection/n", 7, "/connection/n = 7: unknown key"},
      {"/connection/cones/0/n", 7, "/connection/cones/0/n = 7: unknown key"},
      {"/guidance/n", 7, "/guidance/n = 7: unknown key"},
      {"/fixed/0/n", 7, "/fixed/0/n = 7: unknown key"},
      {"/strokes/0/n", 7, "/strokes/0/n = 7: unknown key"},
      {"/strokes/0/points/0/n", 7, "/strokes/0/points/0/n = 7: unknown key"},
      {"/fixed/0/angle", 3, "/fixed/0 = two directions: needs either direction or angle"},
      {"/fixed/0/direction", {0, 0, 0}, "/fixed/0/direction = [0,0,0]: a direction must not be zero"},
      {"/fixed/2/at/0", 1e151, "/fixed/2/at = [1e+151,2,3]: is too far away"},
      {"/connection/cones/3/at/2", -1e300, "/connection/cones/3/at = [0.1,0.2,-1e+300]: is too far away"},
      {"/strokes/0/points/1/at/1", 1e200, "is too far away"},
      {"/strokes/2/path/0/0", 1e200, "/strokes/2/path/0 = [1e+200,0,1]: is too far away"},
      {"/fixed/0/relative_to", {0, 0, 1}, "/fixed/0/relative_to = [0,0,1]: needs angle"},
      {"/fixed/0/length", 0, "/fixed/0/length = 0: must be in [1e-100, 1e12]"},
      {"/fixed/0/length", "long", "/fixed/0/length = \"long\": must be one of free"},
      {"/method", "magic", "/method = \"magic\": must be one of variational, eigen"},
      {"/s", 1.5, "/s = 1.5: must be in [-1, 1]"},
      {"/boundary/align", "up", "/boundary/align = \"up\": must be one of tangent, normal"},
      {"/boundary/weight", -1, "/boundary/weight = -1: must be in [1e-100, 1e12]"},
      {"/connection/balance", 1, "/connection/balance = 1: must be true or false"},
      {"/connection/spread", 1, "/connection/spread = 1: must be true or false"},
      {"/connection/holonomy/1", 0.3, "/connection/holonomy/1 = 0.3: must be a multiple of 1/n = 1/2"},
      {"/connection/loops/0", "x", "must be a number, or a fraction"},
      {"/guidance/t", 0.5, "/guidance/t = 0.5: cannot be combined with weight"},
      {"/guidance/weights", {1, -2}, "/guidance/weights/1 = -2: must be in [0, 1e12]"},
      {"/guidance/weights", {0, 0}, "/guidance/weights = all 0: one at least must be positive"},
      {"/strokes/1/points", Json::array(), "/strokes/1 = an object: needs one of the keys points, vertices and path"},
      {"/strokes/1/vertices", {4}, "/strokes/1/vertices = 1 vertex: a stroke has at least two"},
      {"/strokes/1/vertices/2", -4, "/strokes/1/vertices/2 = -4: must not be negative"},
      {"/strokes/1/radius", -1, "/strokes/1/radius = -1: must be finite and not negative"},
      {"/strokes/2/path/0", {1, 2}, "/strokes/2/path/0 = [1,2]: must be a list of three"},
      {"/strokes/2/path", Json::array({{0, 0, 1}}), "/strokes/2/path = 1 point: a stroke has at least two"},
      {"/fixed/0/vertex", -7, "/fixed/0/vertex = -7: must not be negative"},
      {"/strokes/0/points", Json::array({{{"at", {0, 0, 1}}}}),
       "/strokes/0/points = 1 points: a stroke has at least two"},
      {"/strokes/0/points/0/barycentric", {0, 0, 2}, "/strokes/0/points/0/barycentric = [0,0,2]: barycentric"},
      {"/strokes/0/points/0/at",
       {0, 0, 1},
       "/strokes/0/points/0 = an object: needs either face and barycentric, or at"},
      {"/strokes/0/weight", -2, "/strokes/0/weight = -2: must be in [1e-100, 1e12]"},
      {"/strokes/0/weight", 1e-320, "must be in [1e-100, 1e12]"},
  };
  for (const Wrong& w : all) {
    const std::string error = error_of(with(w.pointer, w.value));
    CAPTURE(w.says);
    CAPTURE(error);
    CHECK(error.find(w.says) != std::string::npos);
    CHECK(error.rfind("d.json: /", 0) == 0);
  }
  struct Missing {
    std::string object, key, says;
  };
  for (const Missing& m :
       std::vector<Missing>{{"", "alcap_design", "/ = an object: needs the key alcap_design"},
                            {"", "n", "/ = an object: needs the key n"},
                            {"/mesh", "faces", "/mesh = an object: needs the key faces"},
                            {"/connection", "kind", "needs the key kind"},
                            {"/connection/cones/0", "index", "/connection/cones/0 = an object: needs the key index"},
                            {"/guidance", "file", "/guidance = an object: needs either field or file"},
                            {"/singularities/0", "kind", "/singularities/0 = an object: needs the key kind"},
                            {"/singularities/0", "face", "/singularities/0 = no place: needs either face or at"},
                            {"/fixed/0", "direction", "/fixed/0 = no direction: needs either direction or angle"},
                            {"/strokes/0", "points", "needs one of the keys points"}}) {
    CAPTURE(m.says);
    const std::string error = error_of(without(m.object, m.key));
    CAPTURE(error);
    CHECK(error.find(m.says) != std::string::npos);
  }
  const std::string vectors = R"({"alcap_design":1,"n":1,"singularities":[{"face":0,"kind":)";
  CHECK(error_of(vectors + R"("wedge"}]})").find("exists for n = 2 only") != std::string::npos);
  CHECK(error_of(vectors + R"("spiral"}]})").find("a spiral needs the key angle") != std::string::npos);
  CHECK(error_of(vectors + R"("source","relative_to":[1,0,0]}]})").find("is its swirl") != std::string::npos);
  CHECK(error_of(vectors + R"("saddle","relative_to":[1,0,0]}]})") == "no error");
}

TEST_CASE("a design made by a program is refused with the path, the value and the rule") {
  using Source = DesignGuidance::Source;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  struct Wrong {
    const char *path, *value, *rule;
    std::function<void(DesignFile&)> change;
  };
  const std::vector<DesignPoint> points = {{.face = 1, .barycentric = {1, 0, 0}},
                                           {.face = 2, .barycentric = {0, 1, 0}}};
  const auto one = [](DesignSingularity s) { return [s](DesignFile& d) { d.singularities = {s}; }; };
  const auto held = [](DesignFixed f) { return [f](DesignFile& d) { d.fixed = {f}; }; };
  const auto guided = [](DesignGuidance g) { return [g](DesignFile& d) { d.guidance = g; }; };
  const auto featured = [](DesignFeatures f) { return [f](DesignFile& d) { d.features = f; }; };
  const std::vector<Wrong> all = {
      {"/n", "0", "is 1 to 1000", [](DesignFile& d) { d.n = 0; }},
      {"/s", "nan", "[-1, 1]", [](DesignFile& d) { d.s = std::nan(""); }},
      {"/connection/tan_cap", "infinity", "positive and finite",
       [](DesignFile& d) { d.connection.tan_cap = infinity; }},
      {"/singularities/0/kind", "\"wedge\"", "exists for n = 2 only, and here n = 1",
       one({.face = 0, .kind = SingularityKind::wedge})},
      {"/singularities/0/angle", "infinity", "must be finite", one({.face = 0, .angle = infinity})},
      {"/singularities/0/relative_to", "[nan,0,0]", "must be finite",
       one({.face = 0, .relative_to = Vector3{std::nan(""), 0, 0}})},
      {"/singularities/0/count", "0", "must be 1 to ", one({.face = 0, .count = 0})},
      {"/singularities/0/count", "2", "is only for source and saddle; \"sink\" has index 1",
       one({.face = 0, .kind = SingularityKind::sink, .count = 2})},
      {"/singularities/0/pin", "[1,0,0]", "needs face; with at, give true",
       one({.at = Vector3{0, 0, 1}, .pin = true, .barycentric = std::array<double, 3>{1, 0, 0}})},
      {"/singularities/0/pin", "[1,0,0]", "coordinates of a pin without a pin",
       one({.face = 0, .barycentric = std::array<double, 3>{1, 0, 0}})},
      {"/fixed/0", "two directions", "either direction or angle",
       held({.vertex = 0, .direction = Vector3{1, 0, 0}, .angle = 3})},
      {"/fixed/0", "no direction", "either direction or angle", held({.vertex = 0})},
      {"/fixed/0/relative_to", "[1,0,0]", "needs angle",
       held({.vertex = 0, .direction = Vector3{1, 0, 0}, .relative_to = Vector3{1, 0, 0}})},
      {"/fixed/0/length", "2", "a length that is free has no value",
       held({.vertex = 0, .angle = 3, .length = 2, .free_length = true})},
      {"/strokes/0", "two courses", "needs one of points, vertices and path",
       [=](DesignFile& d) {
         d.strokes = {{.points = points, .vertices = {1, 2}}};
       }},
      {"/strokes/0/points", "0 points", "at least two", [](DesignFile& d) { d.strokes = {{}}; }},
      {"/guidance/t", "-1", "needs the variational method",
       [](DesignFile& d) {
         d.method = DesignMethod::eigen;
         d.guidance = {.source = Source::smoothest, .t = -1};
       }},
      {"/guidance/field", "\"least-curvature\"", "needs n = 2, and here n = 1",
       guided({.source = Source::least_curvature})},
      {"/guidance/field", "\"curvature\"", "n must be even, and here it is 1", guided({.source = Source::curvature})},
      {"/guidance/t", "1e+13", "[-1e12, 1e12]", guided({.source = Source::smoothest, .t = 1e13})},
      {"/guidance/t", "0", "cannot be combined with weight",
       guided({.source = Source::smoothest, .weight = 2, .t = 0})},
      {"/guidance/file", "\"\"", "the name of a file", guided({.source = Source::file})},
      {"/guidance/t", "0", "cannot be combined with weights per vertex",
       guided({.source = Source::smoothest, .t = 0, .weights = {1}})},
      {"/features", "n = 1", "an even n", [](DesignFile& d) { d.features.wanted = true; }},
      {"/features/corner_angle", "0", "(0, 180]", featured({.wanted = true, .corner_angle = 0})},
      {"/features/weight", "0", "[1e-100, 1e12]", featured({.wanted = true, .weight = 0})},
      {"/features/low_angle", "41", "(0, angle]", featured({.wanted = true, .low_angle = 41})},
      {"/features/low_angle", "30", "not with file and edges",
       featured({.wanted = true, .file = "a.sharp", .low_angle = 30})},
      {"/features/boundary", "true", "goes with angle",
       featured({.wanted = true, .edges = {{1, 2}}, .boundary = true})},
      {"/features/edges", "1 edges", "cannot be combined with file",
       featured({.wanted = true, .file = "a.sharp", .edges = {{1, 2}}})},
      {"/features/gap", "-1", "not negative", featured({.wanted = true, .gap = -1})},
      {"/features/spur", "-1", "not negative", featured({.wanted = true, .spur = -1})},
  };
  for (const Wrong& w : all) {
    CAPTURE(std::string(w.path));
    CAPTURE(std::string(w.rule));
    DesignFile design;
    w.change(design);
    try {
      check_design(design);
      FAIL("was not refused");
    } catch (const OptionError& e) {
      CAPTURE(std::string(e.what()));
      CHECK(e.field() == w.path);
      CHECK(e.value() == w.value);
      CHECK(e.rule().find(w.rule) != std::string::npos);
    }
  }
  for (const auto& [features, says] : std::vector<std::pair<std::string, std::string>>{
           {R"({"hold":1})", "/features/hold = 1: must be true or false"},
           {R"({"edges":[]})", "/features/edges = []: needs an edge at least"},
           {R"({"edges":[[1,2,3]]})", "/features/edges/0 = [1,2,3]: must be a list of two vertices"},
           {R"({"edges":[[1,"a"]]})", "/features/edges/0/1 = \"a\": must be a whole number"},
           {R"({"file":""})", "/features/file = \"\": must be the name of a file"},
           {R"({"file":"a.sharp","angle":3})", "/features/angle = 3: cannot be combined with file and edges"},
           {R"({"gap":"wide"})", "/features/gap = \"wide\": must be a number"}})
    CHECK(error_of(R"({"alcap_design":1,"n":4,"features":)" + features + "}") == "d.json: " + says);
  const std::string merged = error_of(R"({"alcap_design":1,"n":1,"edits":[{"merge":[0]}]})");
  CHECK(merged == "d.json: /edits/0/merge = [0]: must be a list of two singularities");
}

TEST_CASE("what is not JSON is told with its line; keys given twice and absurd depth are refused") {
  CHECK(error_of("{\n\"n\": 1,\n\"alcap_design\" 1}").rfind("d.json:3: not JSON", 0) == 0);
  CHECK(error_of("").find("not JSON") != std::string::npos);
  CHECK(error_of("[]").find("must be an object") != std::string::npos);
  CHECK(error_of(R"({"alcap_design":1,"n":1,"n":2})").find("\"n\" is given twice") != std::string::npos);
  CHECK(error_of(R"({"alcap_design":1,"n":1e999})").find("d.json") == 0);
  CHECK(error_of(std::string(100000, '[')).find("too deeply") != std::string::npos);
  CHECK(error_of("{\"alcap_design\":1,\"n\":1,\"comment\":\"\xff\xfe\"}").find("d.json") == 0);
  CHECK(error_of(R"({"alcap_design":1,"n":2.0})") == "no error");  // a whole number in JSON Schema's eyes
}

TEST_CASE("cut, flipped, inserted and shuffled bytes are errors or designs, never anything else") {
  const std::string good = design_text(full());
  const auto attempt = [](const std::string& text) {
    try {
      const DesignFile d = parse_design(text);
      CHECK(design_text(parse_design(design_text(d))) == design_text(d));
      return 1;
    } catch (const FileError&) {
      return 0;
    }
  };
  for (std::size_t cut = 0; cut + 2 < good.size(); ++cut) CHECK(attempt(good.substr(0, cut)) == 0);
  detail::Random random(11);
  const auto below = [&](std::size_t n) {
    return static_cast<std::size_t>(random.below(static_cast<std::int64_t>(n)));
  };
  const std::vector<std::string> bits = {"-", "1e308", "null", "{}",      "[]", "\"",
                                         ",", "0.5",   "true", "\\u0000", ":",  "9"};
  int accepted = 0;
  for (int round = 0; round < 4000; ++round) {
    std::string text = good;
    for (std::size_t edits = 1 + below(3); edits > 0; --edits) {
      const std::size_t at = below(text.size());
      switch (below(4)) {
        case 0:
          text[at] = static_cast<char>(below(256));
          break;
        case 1:
          text.insert(at, bits[below(bits.size())]);
          break;
        case 2:
          text.erase(at, 1 + below(20));
          break;
        default:
          text.insert(at, text.substr(below(text.size()), below(40)));
      }
      if (text.empty()) text = " ";
    }
    accepted += attempt(text);
  }
  CHECK(accepted > 0);
  CHECK(accepted < 4000);
}

TEST_CASE("a design says what does not fit the mesh") {
  const Ball ball;
  const auto field_of = [&](const DesignFile& d) -> std::string {
    try {
      check_design(d, ball.mesh);
    } catch (const OptionError& e) {
      return e.field() + " = " + e.value();
    }
    return "";
  };
  CHECK(field_of(full()) == "");
  DesignFile d = full();
  d.mesh->faces = 1281;
  CHECK(field_of(d) == "/mesh/faces = 1281");
  d = full();
  d.mesh->vertices = 643;
  CHECK(field_of(d) == "/mesh/vertices = 643");
  d = full();
  d.singularities[1].face = 1280;
  CHECK(field_of(d) == "/singularities/1/face = 1280");
  d = full();
  d.fixed[0].vertex = 642;
  CHECK(field_of(d) == "/fixed/0/vertex = 642");
  d = full();
  d.fixed[1].vertex = 5;
  CHECK(field_of(d) == "/fixed/1/vertex = 5");
  d = full();
  d.connection.cones[2].vertex = 642;
  CHECK(field_of(d) == "/connection/cones/2/vertex = 642");
  d = full();
  d.strokes[0].points[0].face = 5000;
  CHECK(field_of(d) == "/strokes/0/points/0/face = 5000");
  d = {.guidance = {.source = DesignGuidance::Source::smoothest, .weights = {1, 1}}};
  CHECK(field_of(d) == "/guidance/weights = 2 values");
  const Mesh loose(tetrahedron().F, 5);
  d = {.fixed = {{.vertex = 4, .angle = 0.0}}};
  CHECK_THROWS_WITH_AS(check_design(d, loose), "option '/fixed/0/vertex' = 4: no face uses this vertex", OptionError);
}

TEST_CASE("points of space become the nearest face, vertex and barycentric coordinates") {
  const Ball ball;
  detail::Random random(5);
  for (int round = 0; round < 50; ++round) {
    const auto t = static_cast<Index>(random.below(ball.mesh.faces()));
    const double a = random.uniform(0.1, 0.5), b = random.uniform(0.1, 0.4);
    const Eigen::RowVector3d x = ball.at(t, {a, b, 1 - a - b});
    DesignFile d;
    d.singularities = {{.at = Vector3{x[0], x[1], x[2]}, .pin = true}};
    d.strokes = {{.points = {{.at = Vector3{x[0], x[1], x[2]}}, {.face = 3, .barycentric = {1, 0, 0}}}}};
    d.fixed = {{.at = Vector3{x[0], x[1], x[2]}, .angle = 0.0}};
    const DesignFile placed = place_design(d, ball.connected);
    CHECK(placed.singularities[0].face == t);
    CHECK((ball.at(t, *placed.singularities[0].barycentric) - x).norm() < 1e-12);
    CHECK(placed.strokes[0].points[0].face == t);
    double least = 10;
    for (Index v = 0; v < ball.mesh.vertices(); ++v) least = std::min(least, (ball.surface.V.row(v) - x).norm());
    CHECK((ball.surface.V.row(placed.fixed[0].vertex) - x).norm() == least);
  }
}

TEST_CASE("angles: swirl of vectors, directions from the first edge or a direction of space, n-th powers at vertices") {
  const Ball ball;
  const double degree = pi<double> / 180;
  const auto orientation = [&](int n, DesignSingularity s) {
    DesignFile d;
    d.n = n;
    d.singularities = {std::move(s)};
    return std::get<SingularityTarget>(ball.controls(d)[0].control);
  };
  using K = SingularityKind;
  CHECK(orientation(1, {.face = 9, .kind = K::source}).orientation == doctest::Approx(0));
  CHECK(orientation(1, {.face = 9, .kind = K::vortex}).orientation == doctest::Approx(90 * degree));
  CHECK(orientation(1, {.face = 9, .kind = K::vortex, .angle = -20}).orientation == doctest::Approx(70 * degree));
  CHECK(std::abs(orientation(1, {.face = 9, .kind = K::sink}).orientation) == doctest::Approx(180 * degree));
  CHECK(orientation(1, {.face = 9, .kind = K::spiral, .angle = 60}).orientation == doctest::Approx(60 * degree));
  for (const int n : {1, 2, 4}) {
    const auto saddle = orientation(n, {.face = 9, .kind = K::saddle, .angle = 33});
    CHECK(saddle.sign == -1);
    CHECK(saddle.orientation == doctest::Approx(33 * degree));
    // Relative to the face's second edge: its exterior angle more.
    const Eigen::RowVector3d edge = ball.surface.V.row(ball.mesh.F()(9, 2)) - ball.surface.V.row(ball.mesh.F()(9, 1));
    const auto from =
        orientation(n, {.face = 9, .kind = K::saddle, .angle = 33, .relative_to = Vector3{edge[0], edge[1], edge[2]}});
    CHECK(std::abs(wrap(from.orientation - 33 * degree -
                        (pi<double> - ball.connected.geometry().angles()[9 * 3 + 1]))) < 1e-12);
  }
  const auto side = [&](int k) {
    return Eigen::RowVector3d(ball.surface.V.row(ball.mesh.F()(9, k)) - ball.surface.V.row(ball.mesh.F()(9, 0)));
  };
  const Eigen::RowVector3d normal = side(1).cross(side(2));
  CHECK_THROWS_AS(
      (void)orientation(2, {.face = 9, .kind = K::trisector, .relative_to = Vector3{normal[0], normal[1], normal[2]}}),
      OptionError);
  // The length of a direction says nothing, not even where its square overflows or vanishes.
  const auto towards = [&](double length) {
    return orientation(2, {.face = 9, .kind = K::trisector, .relative_to = Vector3{length, 2 * length, -length}});
  };
  for (const double length : {1e-320, 1e-200, 1e200, 8e307})
    CHECK(towards(length).orientation == doctest::Approx(towards(1).orientation).epsilon(1e-3));

  for (const int n : {1, 2, 3}) {
    DesignFile d;
    d.n = n;
    d.fixed = {{.vertex = 40, .direction = Vector3{1, 2, 3}, .length = 2},
               {.vertex = 41, .angle = 90.0, .relative_to = Vector3{1, 2, 3}}};
    const auto controls = ball.controls(d);
    Field field{.n = n, .u = ComplexVectorX<double>::Ones(ball.mesh.vertices()), .frames = nullptr};
    field.frames = std::make_shared<const Frames>(ball.frames);
    for (const auto& c : controls) {
      const auto& v = std::get<VertexConstraint>(c.control);
      field.u[v.vertex] = v.value;
    }
    CHECK(std::abs(field.u[40]) == doctest::Approx(2));
    // One of the n branches points along the projected direction; at 41 one is at right angles to it.
    const auto tangential = [&](Index v) {
      const Eigen::RowVector3d x(1, 2, 3), N = ball.frames.N.row(v);
      return Eigen::RowVector3d((x - x.dot(N) * N).normalized());
    };
    double along = -1, across = 1;
    for (int k = 0; k < n; ++k) {
      const Positions<double> w = field.vectors(k);
      along = std::max(along, w.row(40).normalized().dot(tangential(40)));
      const Eigen::RowVector3d N = ball.frames.N.row(41);
      across = std::min(across, (w.row(41).normalized() - N.cross(tangential(41))).norm());
    }
    CHECK(along == doctest::Approx(1));
    CHECK(across < 1e-9);
  }
}

TEST_CASE("the schema knows the keys that the reader knows, and the examples are designs") {
  std::ostringstream text;
  text << std::ifstream(ALCAP_SOURCE_DIR "/docs/design.schema.json").rdbuf();
  const Json schema = Json::parse(text.str());
  const auto keys = [](const Json& object) {
    std::set<std::string> names;
    for (const auto& [key, value] : object["properties"].items()) names.insert(key);
    return names;
  };
  // The reader's list is in its message about an unknown key.
  const auto reader = [](const std::string& pointer) {
    std::string list = error_of(with(pointer + "/no_such_key", 1));
    const std::string start = "known are ";
    list = list.substr(list.find(start) + start.size());
    std::set<std::string> names;
    for (std::size_t from = 0; from < list.size();) {
      const std::size_t to = std::min(list.find(", ", from), list.size());
      names.insert(list.substr(from, to - from));
      from = to + 2;
    }
    return names;
  };
  CHECK(keys(schema) == reader(""));
  CHECK(keys(schema["properties"]["mesh"]) == reader("/mesh"));
  CHECK(keys(schema["properties"]["connection"]) == reader("/connection"));
  CHECK(keys(schema["properties"]["guidance"]) == reader("/guidance"));
  CHECK(keys(schema["properties"]["boundary"]) == reader("/boundary"));
  CHECK(keys(schema["properties"]["features"]) == reader("/features"));
  CHECK(keys(schema["$defs"]["target"]) == reader("/connection/target"));
  CHECK(keys(schema["$defs"]["cone"]) == reader("/connection/cones/0"));
  CHECK(keys(schema["$defs"]["singularity"]) == reader("/singularities/0"));
  CHECK(keys(schema["$defs"]["fixed"]) == reader("/fixed/0"));
  CHECK(keys(schema["$defs"]["stroke"]) == reader("/strokes/0"));
  CHECK(keys(schema["$defs"]["stroke_point"]) == reader("/strokes/0/points/0"));
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(ALCAP_SOURCE_DIR "/datasets/designs")) {
    if (entry.path().extension() != ".json") continue;
    CAPTURE(entry.path().string());
    CHECK_NOTHROW((void)read_design(entry.path()));
    ++count;
  }
  CHECK(count >= 15);
}

TEST_CASE("features become a stroke along every crease, for even n") {
  DesignFile design;
  design.n = 4;
  design.features = {.wanted = true};
  MeshData box = cube();
  const Surface surface(box.V, box.F);
  const DesignFile placed = place_design(design, surface);
  CHECK(placed.strokes.size() == 12);
  CHECK_FALSE(placed.features.wanted);
  for (const DesignStroke& s : placed.strokes) CHECK(s.vertices.size() == 2);
  design.features.angle = 100;
  CHECK(place_design(design, surface).strokes.empty());
  for (const double bad : {0.0, -1.0, 181.0}) {
    design.features.angle = bad;
    CHECK_THROWS_AS(check_design(design), OptionError);
  }
  design.features.angle = 40;
  design.n = 3;
  CHECK_THROWS_AS(check_design(design), OptionError);
}

TEST_CASE("held features and those across are placed as their edges, by angle, list and file alike") {
  MeshData box = cube();
  const Surface surface(box.V, box.F);
  DesignFile design;
  design.n = 4;
  design.features = {.wanted = true, .weight = 3, .hold = true, .corner_angle = 60};
  const DesignFile placed = place_design(design, surface);
  CHECK(placed.strokes.empty());
  CHECK(placed.features.edges.size() == 12);
  CHECK(placed.features.hold);
  CHECK(placed.features.weight == 3);
  CHECK(placed.features.corner_angle == 60);
  CHECK(place_design(placed, surface).features.edges == placed.features.edges);
  const auto controls = design_controls(placed, connect(surface));
  REQUIRE(controls.size() == 1);
  CHECK(controls[0].path == "/features");
  CHECK(std::get<FeatureAlignment>(controls[0].control).features.lines.size() == 12);

  const test::Folder folder;
  write_sharp(surface, sharp_edges(surface), folder.path / "box.sharp");
  DesignFile by_file = design;
  by_file.features = {.wanted = true, .across = true, .file = folder.path / "box.sharp"};
  CHECK(place_design(by_file, surface).features.edges == placed.features.edges);
  CHECK(place_design(by_file, surface).features.across);
  by_file.features.across = false;  // drawn along: strokes, as by angle
  CHECK(place_design(by_file, surface).strokes.size() == 12);
  by_file.features.file = folder.path / "none.sharp";
  CHECK_THROWS_AS((void)place_design(by_file, surface), FileError);

  design.features = {.wanted = true, .angle = 100, .hold = true};  // no edge folds by so much
  CHECK_FALSE(place_design(design, surface).features.wanted);
  const auto refused = [&](std::vector<std::array<Index, 2>> edges) {
    design.features = {.wanted = true, .hold = true, .edges = std::move(edges)};
    try {
      (void)place_design(design, surface);
    } catch (const OptionError& e) {
      return e.field() + " = " + e.value();
    }
    return std::string();
  };
  CHECK(refused({{0, 1}, {0, 99}}) == "/features/edges/1 = 99");
  CHECK(refused({{0, -1}}) == "/features/edges/0 = -1");
  CHECK(refused({{0, 0}}).find("/features/edges/0") == 0);
}

TEST_CASE("eigen designs take guidance by weight, pins and strokes with a radius; lambda_t they find themselves") {
  DesignFile design;
  design.n = 2;
  design.method = DesignMethod::eigen;
  design.guidance = {.source = DesignGuidance::Source::curvature, .weight = 3};
  design.singularities = {{.face = 3, .pin = true}};
  design.strokes = {{.vertices = {3, 17}, .radius = 0.5}};
  CHECK_NOTHROW(check_design(design));
  CHECK(design_text(parse_design(design_text(design))) == design_text(design));
  design.guidance.weight = 1;
  design.guidance.t = -1;
  try {
    check_design(design);
    FAIL("t was accepted");
  } catch (const OptionError& e) {
    CHECK(e.field() == "/guidance/t");
    CHECK(std::string(e.what()).find("give weight") != std::string::npos);
  }
  design.method = DesignMethod::variational;
  CHECK_NOTHROW(check_design(design));
}
