// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>

#include "alcap/field_run.h"
#include "alcap/generators.h"
#include "alcap/output.h"
#include "tests/support/folder.h"
#include "tests/support/parts.h"

using namespace alcap;

namespace {

bool said(const FieldRun& run, const std::string& code) {
  return std::any_of(run.remarks.begin(), run.remarks.end(), [&](const Remark& r) { return r.code == code; });
}

}  // namespace

TEST_CASE("a run along features: certificate, deviations and what it says") {
  const MeshData part = test::cad_parts().at(1).surface;
  const FieldRun run = run_field(part.V, part.F, {.n = 4, .align = FieldAlignment{}});
  CHECK(run.certificate.holds());
  REQUIRE(run.features.has_value());
  CHECK(run.eigen.empty());
  CHECK(run.features->report.all.mean_degrees < 1);
  CHECK(run.features->report.lines.size() == run.features->graph.lines.size());
  CHECK(said(run, "free_corners"));
  CHECK_FALSE(said(run, "not_settled"));
  const FieldRun short_of = run_field(disk(20).V, disk(20).F, {.n = 4, .align = FieldAlignment{.max_steps = 2}});
  CHECK_FALSE(short_of.certificate.directions_settled);
  CHECK_FALSE(short_of.certificate.holds());
  CHECK(said(short_of, "not_settled"));
  CHECK_FALSE(said(short_of, "boundary"));  // it is not free there
  const FieldRun smooth = run_field(icosphere(3).V, icosphere(3).F, {.n = 4, .align = FieldAlignment{}});
  CHECK(said(smooth, "no_features"));
  CHECK(smooth.certificate.holds());
  CHECK_THROWS_AS((void)run_field(part.V, part.F, {.n = 3, .align = FieldAlignment{}}), OptionError);
  CHECK_THROWS_AS((void)run_field(part.V, part.F, {.n = 4, .s = 0.5, .align = FieldAlignment{}}), OptionError);
  CHECK_THROWS_WITH_AS((void)run_field(part.V, part.F, {.n = 4, .modes = 2, .align = FieldAlignment{}}),
                       "option 'modes' = 2: must be 1 for alignment, which solves for one field", OptionError);
}

TEST_CASE("a mesh that is refused for bow-ties alone gets its field, on the split surface") {
  MeshData two = test::together(icosphere(1), icosphere(1));
  two.V.bottomRows(42).rowwise() += two.V.row(0) - two.V.row(3);
  for (Eigen::Index t = 80; t < 160; ++t)
    for (int c = 0; c < 3; ++c)
      if (two.F(t, c) == 45) two.F(t, c) = 0;
  const FieldRun run = run_field(two.V, two.F, {.n = 4});
  CHECK(run.certificate.holds());
  CHECK(run.copies_of == std::vector<Index>{0});
  CHECK(said(run, "bow_ties_split"));
  CHECK(run.mesh().vertices() == 85);
  // Repairs before it keep their maps.
  MeshData more = two;
  more.F.conservativeResize(161, 3);
  more.F.bottomRows(1) = two.F.row(5);
  const FieldRun both = run_field(more.V, more.F, {.n = 4, .repairs = {Repair::duplicates}});
  CHECK(both.copies_of == std::vector<Index>{0});
  CHECK(both.face_of.size() == 160);
}

TEST_CASE("welding is advised only where it helps, also for corners that nearly coincide") {
  const auto advice = [](const MeshData& mesh, const std::string& code) {
    for (const Remark& r : mesh_remarks(Surface(mesh.V, mesh.F)))
      if (r.code == code) return r.message;
    return std::string();
  };
  const MeshData soup = test::soup(icosphere(1));
  CHECK(advice(soup, "separate_pieces").find("Repair::weld") != std::string::npos);
  MeshData jittered = soup;
  detail::Random random(2);
  for (Eigen::Index v = 0; v < jittered.V.rows(); ++v) jittered.V(v, 0) += 1e-7 * random.uniform(-1, 1);
  CHECK(advice(jittered, "near_pieces").find("Repair::weld:1e-6") != std::string::npos);
  // Three sheets that meet along a line: welded, three faces would meet at each edge there.
  MeshData three = test::together(test::together(grid(2, 2), grid(2, 2)), grid(2, 2));
  const double rim = three.V.col(1).minCoeff();
  for (Eigen::Index v = 9; v < 18; ++v) {
    three.V(v, 2) = three.V(v, 1) - rim;
    three.V(v, 1) = rim;
  }
  for (Eigen::Index v = 18; v < 27; ++v) three.V(v, 1) = 2 * rim - three.V(v, 1);
  CHECK(advice(test::together(grid(2, 2), icosphere(1)), "separate_pieces").empty());
  const std::string message = advice(three, "separate_pieces");
  CHECK_FALSE(message.empty());
  CHECK(message.find("Repair::weld") == std::string::npos);
}

TEST_CASE(".sharp: written for every face of an edge, by sign; read back; refused by line") {
  const MeshData part = test::blocks(test::cells(2, 1, 2, [](int i, int, int k) { return i > 0 && k > 0; }), 2);
  const Surface surface(part.V, part.F);
  const FeatureGraph graph = sharp_edges(surface);
  const test::Folder folder;
  const auto file = folder.path / "part.sharp";
  write_sharp(surface, graph, file);
  std::vector<Index> back = edges_between(surface, read_sharp(part.F, file));
  std::sort(back.begin(), back.end());
  CHECK(back == graph.edges);
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  CHECK(line == std::to_string(2 * graph.edges.size()));
  int concave = 0;
  for (; std::getline(in, line);) concave += line.rfind("0,", 0) == 0 ? 1 : 0;
  CHECK(concave == 2 * std::count_if(graph.angles.begin(), graph.angles.end(), [](double a) { return a < 0; }));
  for (const char* bad :
       {"", "x\n", "1\n1 2 0\n", "1\n1,2\n", "1\n1,99999,0\n", "1\n1,2,3\n", "2\n1,2,0\n", "1\n1,-2,0\n"}) {
    std::ofstream(file) << bad;
    CHECK_THROWS_AS((void)read_sharp(part.F, file), FileError);
  }
  CHECK_THROWS_AS((void)read_sharp(part.F, folder.path / "none.sharp"), FileError);
}
