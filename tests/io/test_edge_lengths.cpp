// SPDX-License-Identifier: MIT
//
// Edge lengths of intrinsic surfaces from text files.
#include <doctest/doctest.h>

#include <fstream>

#include "alcap/generators.h"
#include "alcap/mesh_io.h"
#include "alcap/surface.h"
#include "tests/support/folder.h"

using namespace alcap;
using namespace alcap::test;

namespace {

void write(const std::filesystem::path& file, const std::string& text) { std::ofstream(file) << text; }

std::string refused(const std::filesystem::path& file, const std::string& text, const Mesh& mesh) {
  write(file, text);
  try {
    static_cast<void>(read_edge_lengths(file, mesh));
  } catch (const FileError& e) {
    return e.what();
  }
  return "accepted";
}

bool has(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("lengths of every face come back as those of the edges, in any layout") {
  const Folder folder;
  const MeshData data = jittered_sphere(2, 0.2, 3);
  const Surface surface(data.V, data.F);
  std::string lines = "# three a face\n", stream;
  for (Index h = 0; h < surface.mesh().halfedges(); ++h) {
    char number[64];
    std::snprintf(number, sizeof number, "%.17g", surface.geometry().length(surface.mesh().edge(h)));
    lines += number + std::string(h % 3 == 2 ? "  # a face\r\n" : " ");
    stream += number + std::string(",");
  }
  for (const std::string& text : {lines, stream}) {
    write(folder.path / "lengths.txt", text);
    const VectorX<double> read = read_edge_lengths(folder.path / "lengths.txt", surface.mesh());
    CHECK(read == surface.geometry().lengths());
    const Surface again = Surface::from_lengths(surface.mesh(), read, data.V);
    CHECK((again.geometry().angles() - surface.geometry().angles()).cwiseAbs().maxCoeff() < 1e-12);
  }
}

TEST_CASE("what is wrong with a file of lengths is named with its line") {
  const Folder folder;
  const std::filesystem::path file = folder.path / "l.txt";
  const MeshData data = tetrahedron();
  const Mesh mesh(data.F, 4);
  CHECK(refused(file, "1 1 1\n1 1 1\n1 1 1\n1 1 1\n", mesh) == "accepted");
  CHECK(has(refused(file, "1 1 1\n1 1 1\n", mesh), "ends after 6 lengths"));
  CHECK(has(refused(file, "1 1 1\n1 1 1\n1 1 1\n1 1 1\n1", mesh), ":5: more than"));
  CHECK(has(refused(file, "1 1 1\n1 x 1\n1 1 1\n1 1 1\n", mesh), ":2: not a number"));
  CHECK(has(refused(file, "1 1 1\n1 1.5abc 1\n1 1 1\n1 1 1\n", mesh), ":2: not a number"));
  CHECK(has(refused(file, "1 1 1\n1 1 0\n1 1 1\n1 1 1\n", mesh), ":2: a length must be positive"));
  CHECK(has(refused(file, "1 1 1\n1 1 nan\n1 1 1\n1 1 1\n", mesh), ":2: "));
  CHECK(has(refused(file, "1 1 1\n1 1 1\n1 1 1\n1 1 2\n", mesh), "different lengths"));
  CHECK(has(refused(file, "", mesh), "ends after 0"));
  CHECK_THROWS_AS(static_cast<void>(read_edge_lengths(folder.path / "none.txt", mesh)), FileError);
}
