// SPDX-License-Identifier: MIT
//
// test_handoff.cpp: what write_for() leaves is read by the rules of the programs it is for: the fscanf formats of
// QuadWild and vcglib, and the streams and the principal matching of Directional.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <set>

#include "alcap/field_run.h"
#include "alcap/handoff.h"
#include "alcap/mesh_io.h"
#include "tests/io/directional_reader.h"
#include "tests/support/parts.h"

namespace {

using namespace alcap;
using namespace alcap::test;

class Scanner {
 public:
  explicit Scanner(const fs::path& path) : file_(std::fopen(path.c_str(), "rt"), &std::fclose) { REQUIRE(file_); }
  template <class... Values>
  void read(const char* format, Values*... values) {
    REQUIRE(std::fscanf(file_.get(), format, values...) == int(sizeof...(values)));
  }
  [[nodiscard]] bool at_end() {
    char rest = 0;
    return std::fscanf(file_.get(), " %c", &rest) == EOF;
  }

 private:
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
};

FieldRun crosses(const MeshData& mesh, bool aligned) {
  FieldRunOptions options{.n = 4};
  if (aligned) options.align.emplace();
  return run_field(mesh.V, mesh.F, options);
}

FieldOutput output_of(const FieldRun& run) {
  return {.surface = run.surface, .field = run.field, .singularities = run.singularities};
}

double degrees_off_cross(const Row& d, const Row& along) {
  const double angle = std::acos(std::min(1.0, std::abs(d.dot(along.normalized())))) * 180 / pi<double>;
  return std::min(angle, 90 - angle);
}

}  // namespace

TEST_CASE("QuadWild: mesh, crosses, creases and setup by its own formats; crosses run along every straight crease") {
  const Folder folder;
  const MeshData part = blocks(cells(3, 2, 2, [](int i, int, int k) { return i > 0 && k > 0; }), 6);
  const FieldRun run = crosses(part, true);
  const auto files = write_for(Reader::quadwild, output_of(run), &run.features->graph, folder.path / "part");
  CHECK(folder.names() == std::set<std::string>{"part.obj", "part.rosy", "part.sharp", "part.txt"});
  CHECK(files.size() == 4);

  const MeshFile mesh = read_mesh(folder.path / "part.obj");
  CHECK(mesh.V == part.V);
  CHECK(mesh.F == part.F);

  // vcglib's Load4ROSY: two counts, both asserted, then a direction per face in float.
  Scanner rosy(folder.path / "part.rosy");
  int faces = 0, n = 0;
  rosy.read("%d", &faces);
  rosy.read("%d", &n);
  REQUIRE(faces == mesh.F.rows());
  REQUIRE(n == 4);
  Positions<double> cross(faces, 3);
  const Surface surface(mesh.V, mesh.F);
  for (Index t = 0; t < faces; ++t) {
    float x = 0, y = 0, z = 0;
    rosy.read("%f %f %f", &x, &y, &z);
    cross.row(t) << x, y, z;
    CHECK(cross.row(t).norm() == doctest::Approx(1));
    CHECK(std::abs(cross.row(t).dot(face_normal(surface, t))) < 1e-6);
  }
  CHECK(rosy.at_end());

  // QuadWild's LoadSharpFeatures: a count, then "%d,%d,%d".
  Scanner sharp(folder.path / "part.sharp");
  int count = 0, concave = 0;
  sharp.read("%d", &count);
  std::set<std::pair<int, int>> listed;
  for (int k = 0; k < count; ++k) {
    int type = -1, face = -1, edge = -1;
    sharp.read("%d,%d,%d", &type, &face, &edge);
    REQUIRE((face >= 0 && face < faces && edge >= 0 && edge < 3));
    concave += type == 0;
    listed.emplace(face, edge);
    const Index h = 3 * face + edge;
    const Row along = surface.V().row(surface.mesh().tip(h)) - surface.V().row(surface.mesh().tail(h));
    CHECK(degrees_off_cross(cross.row(face), along) < 10);
  }
  CHECK(sharp.at_end());
  CHECK(concave == 2 * 2 * 6);  // the inner edge of the L, 2 cubes of 6 edges, from both sides
  int folded = 0;
  for (Index e = 0; e < surface.mesh().edges(); ++e) folded += std::abs(dihedral_angle(surface, e)) > 1;
  CHECK(listed.size() == 2 * std::size_t(folded));

  Scanner setup(folder.path / "part.txt");
  int remesh = 1;
  float threshold = 0, alpha = 0, scale = 0;
  setup.read("do_remesh %d\n", &remesh);
  setup.read("sharp_feature_thr %f\n", &threshold);
  setup.read("alpha %f\n", &alpha);
  setup.read("scaleFact %f\n", &scale);
  CHECK(remesh == 0);
  CHECK(alpha == doctest::Approx(0.02));
  CHECK(scale == 1);
  CHECK(command_for(Reader::quadwild, "out/part") ==
        "quadwild out/part.obj 3 out/part.rosy out/part.sharp out/part.txt");
}

TEST_CASE("QuadWild without creases gets an empty list, and takes nothing but crosses") {
  const Folder folder;
  const FieldRun run = crosses(icosphere(2), false);
  write_for(Reader::quadwild, output_of(run), nullptr, folder.path / "ball");
  Scanner sharp(folder.path / "ball.sharp");
  int count = -1;
  sharp.read("%d", &count);
  CHECK(count == 0);
  CHECK(sharp.at_end());
  FieldRun lines = run_field(icosphere(2).V, icosphere(2).F, {.n = 2});
  CHECK_THROWS_AS(write_for(Reader::quadwild, output_of(lines), nullptr, folder.path / "lines"), OptionError);
  CHECK_FALSE(fs::exists(folder.path / "lines.obj"));
}

TEST_CASE("Directional: unit directions per face, and the singular vertices that its matching finds in them") {
  const Folder folder;
  for (const int n : {2, 4}) {
    const MeshData mesh = bumpy_sphere(3, 0.3, 4);
    const FieldRun run = run_field(mesh.V, mesh.F, {.n = n});
    write_for(Reader::directional, output_of(run), nullptr, folder.path / "f");
    CHECK(folder.names() == std::set<std::string>{"f.off", "f.rawfield", "f.sings"});
    const MeshFile read = read_mesh(folder.path / "f.off");
    CHECK(read.V == mesh.V);
    CHECK(read.F == mesh.F);
    const Raw raw = read_raw(folder.path / "f.rawfield");
    REQUIRE(raw.n == n);
    REQUIRE(raw.rows.rows() == mesh.F.rows());
    for (Index t = 0; t < mesh.F.rows(); ++t)
      for (int k = 0; k < n; ++k) CHECK(raw.at(t, k).norm() == doctest::Approx(1).epsilon(1e-12));
    int degree = 0, sum = 0;
    const std::map<int, int> found = read_sings(folder.path / "f.sings", degree);
    const Surface surface(read.V, read.F);
    for (Index v = 0; v < surface.mesh().vertices(); ++v) {
      const int expected = index_by_matching(surface, raw, v);
      CHECK((found.count(v) != 0 ? found.at(v) : 0) == expected);
      sum += expected;
    }
    CHECK(sum == 2 * n);
  }
}
