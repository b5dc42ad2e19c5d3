// SPDX-License-Identifier: MIT
//
// test_cli_field.cpp: `alcap field` on good meshes: the certificate holds, the report says what is known beforehand,
// scale does not matter, components are solved each on its own, and outputs are complete or absent.
#include <doctest/doctest.h>

#include <cmath>
#include <map>

#include "alcap/output.h"
#include "tests/cli/cli_runner.h"
#include "tests/support/parts.h"

using namespace alcap;
using test::CliFolder;
using test::CliResult;
using test::Json;

namespace {

struct Good {
  const char* name;
  MeshData surface;
  int euler, loops, genus;
};

std::vector<Good> good_meshes() {
  return {{"icosphere", icosphere(3), 2, 0, 0},      {"torus", torus(24, 12, 1.0, 0.4), 0, 0, 1},
          {"genus2", genus_surface(2, 2), -2, 0, 2}, {"cylinder", cylinder(24, 12), 0, 2, 0},
          {"tetrahedron", tetrahedron(), 2, 0, 0},   {"triangle", single_triangle(), 1, 1, 0},
          {"scan", noisy_scan(4, 0.1, 7), -3, 5, 0}};
}

std::map<int, int> indices_by_face(const Json& report) {
  std::map<int, int> indices;
  for (const Json& s : report["singularities"]["list"]) indices[s["face"]] = s["index"];
  return indices;
}

/// The field is the same up to one phase: |<u, v>| = |u| |v|.
double alignment(const ComplexVectorX<double>& u, const ComplexVectorX<double>& v) {
  return std::abs(u.dot(v)) / (u.norm() * v.norm());
}

}  // namespace

TEST_CASE("--prove, --no-prove and --modes: what is known about the smallest eigenvalue, and the next ones") {
  const CliFolder folder;
  folder.write("m.ply", icosphere(2));
  Json r = folder.run("field m.ply -n 1 --prove --modes 8 -o out --formats ply --json").json();
  CHECK(r["certificate"]["smallest"] == "proven");
  CHECK(r["eigen"]["next"].get<double>() == doctest::Approx(r["eigen"]["lambda"].get<double>()).epsilon(1e-5));
  CHECK(r["notes"].dump().find("not_unique") != std::string::npos);
  CHECK(r["modes"]["smallest"] == "proven");
  REQUIRE(r["modes"]["list"].size() == 8);
  // On the sphere l = 1 three times, l = 2 five times.
  for (int k = 0; k < 8; ++k) {
    CHECK(r["modes"]["list"][k]["cluster"] == (k < 3 ? 0 : 1));
    CHECK(r["modes"]["list"][k]["residual"].get<double>() <= 1e-8);
    CHECK(folder.files().count("out/mode-" + std::to_string(k + 1) + ".ply") == 1);
  }
  CHECK(r["modes"]["list"][0]["lambda"].get<double>() ==
        doctest::Approx(r["eigen"]["lambda"].get<double>()).epsilon(1e-9));

  const CliResult text = folder.run("field m.ply -n 1 --modes 3");
  CHECK(text.out.find("smallest      proven: no eigenvalue lies below") != std::string::npos);
  CHECK(text.out.find("; complete: proven") != std::string::npos);

  r = folder.run("field m.ply -n 1 --no-prove --json").json();
  CHECK(r["ok"] == true);
  CHECK(r["certificate"]["smallest"] == "not checked");
  CHECK(r["eigen"]["next"].is_null());
  CHECK(r["eigen"]["lower_bound"].is_null());
  CHECK(!r["eigen"]["smallest_note"].get<std::string>().empty());
  CHECK(!r.contains("modes"));
}

TEST_CASE("on closed and open surfaces the certificate holds and the indices sum to what topology demands") {
  for (const Good& mesh : good_meshes()) {
    for (const int n : {1, 2, 4}) {
      CAPTURE(mesh.name);
      CAPTURE(n);
      const CliFolder folder;
      folder.write("m.ply", mesh.surface);
      const CliResult result = folder.run("field m.ply -n " + std::to_string(n) + " --json");
      CAPTURE(result.err);
      REQUIRE(result.exit == 0);
      CHECK(result.err.empty());
      const Json r = result.json();
      CHECK(r["ok"] == true);
      CHECK(r["mesh"]["vertices"] == mesh.surface.V.rows());
      CHECK(r["mesh"]["faces"] == mesh.surface.F.rows());
      CHECK(r["mesh"]["components"] == 1);
      CHECK(r["mesh"]["euler"] == mesh.euler);
      CHECK(r["mesh"]["boundary_loops"] == mesh.loops);
      CHECK(r["mesh"]["genus"] == mesh.genus);
      CHECK(r["eigen"]["angle_tolerance_degrees"] == 0.01);
      CHECK(r["eigen"]["angle_degrees"].get<double>() <= 0.01);
      if (!r["eigen"]["next"].is_null()) CHECK(r["eigen"]["lambda"].get<double>() <= r["eigen"]["next"].get<double>());
      CHECK(r["certificate"]["smallest"] == "proven");
      CHECK(r["eigen"]["lower_bound"].get<double>() <= r["eigen"]["lambda"].get<double>());
      CHECK(r["singularities"]["index_sum"] == r["singularities"]["expected"]);
      if (mesh.loops == 0) {
        CHECK(r["singularities"]["expected"] == n * mesh.euler);
        CHECK(r["connection"]["K_sum"].get<double>() ==
              doctest::Approx(2 * pi<double> * mesh.euler).epsilon(1e-9).scale(1));
      }
      int sum = 0;
      for (const auto& [face, index] : indices_by_face(r)) sum += index;
      CHECK(sum == r["singularities"]["index_sum"]);
      CHECK(r["singularities"]["count"] == r["singularities"]["list"].size());
      for (const Json& s : r["singularities"]["list"]) {
        double total = 0;
        Eigen::RowVector3d xyz = Eigen::RowVector3d::Zero();
        for (int c = 0; c < 3; ++c) {
          const double b = s["barycentric"][c];
          total += b;
          xyz += b * mesh.surface.V.row(mesh.surface.F(s["face"].get<Index>(), c));
        }
        CHECK(total == doctest::Approx(1));
        REQUIRE(s["xyz"].size() == 3);
        // The mesh went through a file.
        for (int k = 0; k < 3; ++k) CHECK(std::abs(s["xyz"][k].get<double>() - xyz[k]) < 1e-12);
      }
      CHECK(r["peak_memory_bytes"] > 0);
      CHECK(r["times"]["total"].get<double>() >= r["times"]["eigen"].get<double>());
    }
  }
}

TEST_CASE("the sphere's eigenvalue and deviations are the reference numbers") {
  const CliFolder folder;
  folder.write("s.ply", icosphere(3));
  const std::map<int, double> lambda{{1, 1.0072299318}, {2, 2.0231796202}, {4, 4.0791350873}};
  for (const auto& [n, value] : lambda) {
    const Json r = folder.run("field s.ply --degree " + std::to_string(n) + " --json").json();
    CHECK(r["eigen"]["lambda"].get<double>() == doctest::Approx(value).epsilon(1e-7));
    CHECK(r["connection"]["D_T"].get<double>() == doctest::Approx(0.006127049193).epsilon(1e-7));
    CHECK(r["connection"]["D_E"].get<double>() == doctest::Approx(0.005996247209).epsilon(1e-7));
    CHECK(r["connection"]["K_min_over_area"].get<double>() == doctest::Approx(0.83520369).epsilon(1e-7));
    CHECK(r["connection"]["K_max_over_area"].get<double>() == doctest::Approx(1.14769776).epsilon(1e-7));
  }
}

TEST_CASE("coordinates scaled by a millionth and a million give the same field") {
  const CliFolder folder;
  const MeshData scan = noisy_scan(4, 0.1, 3);
  std::vector<Json> reports;
  std::vector<FieldFile> fields;
  for (const double scale : {1.0, 1e-6, 1e6}) {
    folder.write("m.obj", MeshData{scan.V * scale, scan.F});
    const CliResult result = folder.run("field m.obj -n 4 -o f.ply --json");
    REQUIRE(result.exit == 0);
    reports.push_back(result.json());
    fields.push_back(read_field(folder.work() / "f.ply"));
    CHECK(indices_by_face(reports.back()) == indices_by_face(reports.front()));
    CHECK(reports.back()["eigen"]["lambda"].get<double>() * scale * scale ==
          doctest::Approx(reports.front()["eigen"]["lambda"].get<double>()).epsilon(1e-6));
    CHECK(alignment(fields.back().field.u, fields.front().field.u) == doctest::Approx(1).epsilon(1e-6));
  }
}

TEST_CASE("components of very different size are each solved and reported as if alone") {
  const CliFolder folder;
  const MeshData big = noisy_scan(4, 0.1, 5);
  MeshData tiny = torus(10, 6, 1.0, 0.4);
  tiny.V *= 1e-4;
  folder.write("big.obj", big);
  folder.write("tiny.obj", tiny);
  folder.write("both.obj", test::both(big, tiny, 5));
  const Json whole = folder.run("field both.obj --json").json();
  CHECK(whole["ok"] == true);
  CHECK(whole["mesh"]["components"] == 2);
  REQUIRE(whole["components"].size() == 2);
  const char* names[] = {"big.obj", "tiny.obj"};
  for (std::size_t c = 0; c < 2; ++c) {
    const Json alone = folder.run(std::string("field ") + names[c] + " --json").json();
    const Json& part = whole["components"][c];
    CHECK(part["eigen"]["lambda"].get<double>() ==
          doctest::Approx(alone["eigen"]["lambda"].get<double>()).epsilon(1e-5));
    CHECK(part["eigen"]["converged"] == true);
    CHECK(part["singularities"]["index_sum"] == alone["singularities"]["index_sum"]);
    CHECK(part["singularities"]["expected"] == alone["singularities"]["expected"]);
    CHECK(part["mesh"]["euler"] == alone["mesh"]["euler"]);
  }
}

TEST_CASE("every connection gives a certified field; detail changes the deviations the way it must") {
  const CliFolder folder;
  folder.write("b.obj", bumpy_sphere(3, 0.3, 6));
  for (const std::string kind : {"global", "local", "polar", "polar-barycenter"}) {
    CAPTURE(kind);
    const CliResult result = folder.run("field b.obj --connection " + kind + " --json");
    REQUIRE(result.exit == 0);
    CHECK(result.json()["connection"]["kind"] == kind);
    CHECK(result.json()["singularities"]["index_sum"] == 8);
  }
  const Json spread = folder.run("field b.obj --detail 0.1 --json").json(),
             sharp = folder.run("field b.obj --detail 10 --json").json();
  CHECK(spread["connection"]["D_T"].get<double>() < sharp["connection"]["D_T"].get<double>());
  CHECK(spread["connection"]["D_E"].get<double>() > sharp["connection"]["D_E"].get<double>());
}

TEST_CASE("with prescribed cones the singularities lie at them and nowhere else") {
  const CliFolder folder;
  const MeshData sphere = icosphere(3);
  folder.write("s.obj", sphere);
  const std::map<int, int> cones{{0, 4}, {100, 2}, {200, 1}, {300, 1}};  // quarters; sum 8 = 4 chi
  std::string flags;
  for (const auto& [v, quarters] : cones)
    flags += " --cone " + std::to_string(v) + ":" + std::to_string(quarters) + "/4";
  const CliResult result = folder.run("field s.obj -n 4" + flags + " --json");
  CAPTURE(result.err);
  REQUIRE(result.exit == 0);
  std::map<int, int> found;
  for (const auto& [face, index] : indices_by_face(result.json())) {
    for (int c = 0; c < 3; ++c) {
      if (cones.count(sphere.F(face, c)) > 0) found[sphere.F(face, c)] += index;
    }
  }
  CHECK(found == cones);
  CHECK(folder.run("field s.obj -n 4 --cone 0:1").exit == 2);     // the sum is not 2
  CHECK(folder.run("field s.obj -n 4 --cone 0:one").exit == 2);   // not a number
  CHECK(folder.run("field s.obj -n 4 --cone 9999:2").exit == 2);  // no such vertex
}

TEST_CASE("a folder gets binary files and a report equal to --json; an existing folder is filled, other files stay") {
  const CliFolder folder;
  folder.write("s.obj", icosphere(2));
  const CliResult first = folder.run("field s.obj -o deep/out --json");
  REQUIRE(first.exit == 0);
  const Json report = first.json();
  CHECK(folder.read_json("deep/out/report.json") == report);
  std::set<std::string> expected{"s.obj", "deep", "deep/out"};
  for (const Json& f : report["files"]) expected.insert(f.get<std::string>());
  CHECK(folder.files() == expected);
  for (const char* f : {"field.ply", "field.vtp", "field_singularities.vtp", "report.json"}) {
    CHECK(expected.count(std::string("deep/out/") + f) == 1);
  }
  CHECK(expected.size() == 7);

  folder.write("deep/out/mine.txt", "keep me");
  expected.insert("deep/out/mine.txt");
  REQUIRE(folder.run("field s.obj -n 2 -o deep/out").exit == 0);
  CHECK(folder.files() == expected);
  CHECK(folder.read_json("deep/out/report.json")["options"]["n"] == 2);
  CHECK(read_field(folder.work() / "deep/out/field.ply").field.n == 2);

  // Every format that there is, and nothing else has that name.
  REQUIRE(folder.run("field s.obj -o every --formats all").exit == 0);
  for (const std::string& format : field_formats()) CHECK(folder.files().count("every/field." + format) == 1);
  CHECK(folder.files().count("every/field.sings") == 1);
  CHECK(folder.run("field s.obj -o two --formats all,ply").exit == 2);
}

TEST_CASE("--unit writes directions of length one, the default n-vectors whose M-norm is one") {
  const CliFolder folder;
  folder.write("s.obj", icosphere(2));
  REQUIRE(folder.run("field s.obj -o v.ply --quiet").exit == 0);
  REQUIRE(folder.run("field s.obj -o d.ply --unit --quiet").exit == 0);
  const ComplexVectorX<double> v = read_field(folder.work() / "v.ply").field.u,
                               d = read_field(folder.work() / "d.ply").field.u;
  CHECK((d.cwiseAbs().array() - 1).abs().maxCoeff() < 1e-12);
  CHECK(v.cwiseAbs().maxCoeff() > 1.5 * v.cwiseAbs().minCoeff());
  CHECK((v.cwiseProduct(d.conjugate()).array() - v.cwiseAbs().array()).abs().maxCoeff() < 1e-12);
}

TEST_CASE("what does not converge is written, marked, and exits with 5") {
  const CliFolder folder;
  folder.write("s.obj", noisy_scan(4, 0.3, 11));
  const CliResult result = folder.run("field s.obj -o out --max-iterations 2 --tolerance 1e-14 --json");
  CHECK(result.exit == 5);
  const Json report = result.json();
  CHECK(report["ok"] == false);
  CHECK(report["certificate"]["index_sums_match"] == true);
  REQUIRE(!report["warnings"].empty());
  CHECK(report["warnings"].back()["code"] == "eigen_not_converged");
  // Advice, in flags.
  const std::string said = report["warnings"].back()["message"];
  CAPTURE(said);
  for (const char* flag : {"--solver", "--method", "--tolerance", "--max-iterations"})
    CHECK(said.find(flag) != std::string::npos);
  CHECK(said.find("Options::") == std::string::npos);
  CHECK(result.error_says("certificate"));
  CHECK(folder.read_json("out/report.json")["ok"] == false);
}

TEST_CASE("--align-features: crosses along every crease, a report per line, and .sharp beside the field") {
  const CliFolder folder;
  const MeshData box = test::blocks(test::cells(2, 1, 1, [](int, int, int) { return false; }), 6);
  folder.write("box.obj", box);
  const CliResult result = folder.run("field box.obj --align-features -n 4 -o out --formats ply,rosy --json");
  CAPTURE(result.err);
  CHECK(result.exit == 0);
  const Json report = result.json();
  CHECK(report["eigen"].is_null());
  const Json& alignment = report["alignment"];
  CHECK(alignment["angle_degrees"] == doctest::Approx(40));
  CHECK(alignment["lines"].size() == 12);
  CHECK(alignment["corners"] == 8);
  CHECK(alignment["all"]["mean_degrees"].get<double>() < 1);
  CHECK(alignment["all"]["singularities"] == 0);
  CHECK(report["certificate"]["directions_settled"] == true);
  CHECK(report["alignment"]["followed"] == true);
  CHECK(report["singularities"]["index_sum"] == 8);
  // The file of features, read back, asks for the same.
  const std::string sharp = CliFolder::read(folder.work() / "out/field.sharp");
  CHECK(sharp.rfind(std::to_string(2 * alignment["edges"].get<int>()) + "\n1,", 0) == 0);
  const Json again = folder.run("field box.obj --features out/field.sharp -n 4 --json").json();
  CHECK(again["alignment"]["lines"].size() == 12);
  CHECK(again["singularities"]["list"].size() == report["singularities"]["list"].size());
  CHECK(folder.run("field box.obj --align-features=100 --json").json()["alignment"]["edges"] == 0);
  CHECK(folder.run("field box.obj --align-features 30 --json").json()["alignment"]["lines"].size() == 12);
  CHECK(folder.run("field box.obj --align-features -n 3").exit == 2);
  CHECK(folder.run("field box.obj --align-features=no").exit == 2);
  CHECK(folder.run("field box.obj --features missing.sharp").exit == 3);
  CHECK(folder.run("field box.obj --align-features --align-weight 20 --align-across -n 2 --json").exit == 0);
}

TEST_CASE("--align-boundary on a plate: no singularities on a square, four on a disk") {
  const CliFolder folder;
  folder.write("square.obj", grid(16, 16));
  folder.write("disk.obj", disk(16));
  CHECK(folder.run("field square.obj --align-boundary --json").json()["singularities"]["count"] == 0);
  CHECK(folder.run("field disk.obj --align-boundary --json").json()["singularities"]["count"] == 4);
}
