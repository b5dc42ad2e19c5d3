// SPDX-License-Identifier: MIT
//
// test_cli_real_meshes.cpp: meshes as people have them: needles, faces without area, features listed in mesh files.
#include <doctest/doctest.h>

#include <string>

#include "tests/cli/cli_runner.h"

using namespace alcap;
using test::CliFolder;
using test::CliResult;
using test::Json;

TEST_CASE("needles: solved on better triangles, and what the report says of them") {
  const CliFolder folder;
  folder.write("shaft.ply", cad_like(120, 2));
  const Json r = folder.run("field shaft.ply --json").json();
  CHECK(r["ok"] == true);
  REQUIRE(r.contains("triangulation"));
  const Json& t = r["triangulation"];
  CHECK(t["before"]["angle_min_degrees"].get<double>() < 1);
  CHECK(t["after"]["angle_min_degrees"].get<double>() >= 14.99);
  CHECK(t["after"]["not_delaunay"] == t["barred"]);
  CHECK(t["added_vertices"].get<int>() > 0);
  CHECK(t["complete"] == true);
  CHECK(t["connection"]["kind"] == "global");
  CHECK(t["connection"]["converged"] == true);
  CHECK(r["connection"]["kind"] == "local");
  CHECK(r["options"]["triangulation"] == "auto");
  CHECK(r["singularities"]["index_sum"] == 8);
  const CliResult text = folder.run("field shaft.ply");
  CHECK(text.out.find("triangles     solved on intrinsic ones") != std::string::npos);

  const Json own = folder.run("field shaft.ply --triangulation extrinsic --json").json();
  CHECK_FALSE(own.contains("triangulation"));
  CHECK(own["connection"]["kind"] == "global");
  const Json flips = folder.run("field shaft.ply --triangulation intrinsic --min-angle 0 --json").json();
  CHECK(flips["triangulation"]["added_vertices"] == 0);
  const Json along = folder.run("field shaft.ply --align-features --json").json();
  CHECK(along["ok"] == true);
  CHECK(along["alignment"]["all"]["mean_degrees"].get<double>() < 1);
  CHECK(folder.run("field shaft.ply --triangulation better").exit == 2);
  CHECK(folder.run("field shaft.ply --min-angle 31").exit == 2);
  const Json cones = folder.run("field shaft.ply --cone 0:1 --cone 200:1 --json").json();
  CHECK(cones["triangulation"]["connection"]["kind"] == "trivial");
  CHECK(cones["triangulation"]["connection"]["cones"].size() == 2);
  CHECK(cones["singularities"]["index_sum"] == 8);
}

TEST_CASE("a design on a shaft of needles, solved on better triangles") {
  const CliFolder folder;
  folder.write("shaft.ply", cad_like(100, 1));
  const char* const design = "design shaft.ply -n 4 --fix 3:0,0,1 --guidance smoothest:0.1";
  const Json r = folder.run(std::string(design) + " --json").json();
  CHECK(r["met"] == true);
  CHECK(r["certified"] == true);
  CHECK(r["triangulation"]["after"]["angle_min_degrees"].get<double>() >= 14.99);
  CHECK(r["triangulation"]["connection"]["kind"] == "global");
  CHECK(r["connection"]["kind"] == "local");
  CHECK(r["singularities"]["index_sum"] == 8);
  CHECK(folder.run(design).out.find("triangles     solved on intrinsic ones") != std::string::npos);
  CHECK_FALSE(folder.run(std::string(design) + " --triangulation extrinsic --json").json().contains("triangulation"));
}

TEST_CASE("faces without area: refused, or mollified on request") {
  const CliFolder folder;
  MeshData flat = icosphere(2);
  const Index v = static_cast<Index>(flat.V.rows()), t = static_cast<Index>(flat.F.rows());
  flat.V.conservativeResize(v + 1, 3);
  flat.V.row(v) = flat.V.row(flat.F(0, 0));  // a face cut at one of its own corners
  flat.F.conservativeResize(t + 2, 3);
  flat.F.row(t) << flat.F(0, 1), flat.F(0, 2), v;
  flat.F.row(t + 1) << flat.F(0, 2), flat.F(0, 0), v;
  flat.F(0, 2) = v;
  folder.write("flat.off", flat);
  CHECK(folder.run("field flat.off").exit == 4);
  const Json r = folder.run("field flat.off --repair mollify --json").json();
  CHECK(r["ok"] == true);
  CHECK(r["notes"].dump().find("mollified") != std::string::npos);
  CHECK(r["mesh"]["vertices"] == v + 1);
  CHECK(folder.run("info flat.off").exit == 4);
  CHECK(folder.run("info flat.off --repair mollify").exit == 0);
}

TEST_CASE("features are the lines of an OBJ or the edges of a PLY") {
  const CliFolder folder;
  folder.write("plate.obj", grid(6, 6));
  std::string text = CliFolder::read(folder.work() / "plate.obj");
  CHECK(folder.run("field plate.obj --features plate.obj").error_says("lists no edges"));
  text += "l 22 23 24 25 26 27 28\n";  // across the middle
  folder.write("plate.obj", text);
  const Json r = folder.run("field plate.obj --features plate.obj --json").json();
  CHECK(r["alignment"]["edges"] == 6);
  CHECK(r["alignment"]["all"]["worst_degrees"].get<double>() < 1e-6);
  folder.write("other.obj", grid(5, 5));
  CHECK(folder.run("field plate.obj --features other.obj").error_says("edges of features are named by them"));
  folder.write("plate.obj", text + "l 1 49\n");
  CHECK(folder.run("field plate.obj --features plate.obj").exit == 2);
}
