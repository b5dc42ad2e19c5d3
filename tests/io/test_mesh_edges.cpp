// SPDX-License-Identifier: MIT
//
// Edges that mesh files list beside their faces.
#include <doctest/doctest.h>

#include <string>

#include "alcap/mesh_io.h"

using namespace alcap;

namespace {

using Edges = std::vector<std::array<Index, 2>>;

const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";

MeshFile obj(const std::string& more) { return read_mesh_from_memory(square + more, "obj"); }

std::string ply(const std::string& edges) {
  return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 2\nproperty list uchar int vertex_indices\n" +
         edges + "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";
}

}  // namespace

TEST_CASE("the lines of an OBJ are segments, by their vertices") {
  CHECK(obj("").edges.empty());
  CHECK(obj("l 1 2 3\nl 4/1 1/2\n").edges == Edges{{0, 1}, {1, 2}, {3, 0}});
  CHECK(obj("l -1 -2\n").edges == Edges{{3, 2}});
  CHECK(obj("l 1\n").edges.empty());
  const MeshFile lost = obj("l 1 2 9\n");
  CHECK(lost.edges == Edges{{0, 1}});
  CHECK(lost.remarks.size() == 1);
  // Lines were never a reason to refuse a file.
  CHECK(obj("l 1 x 2\nl 3 4\n").edges == Edges{{2, 3}});
  CHECK(obj("l 0 1 2\n").edges.empty());
  const MeshFile counted = obj("l 1 2\nl 2 3\n");
  REQUIRE(counted.ignored.size() == 1);
  CHECK(counted.ignored[0].count == 2);
}

TEST_CASE("the elements edge of a PLY") {
  const auto read = [](const std::string& text) { return read_mesh_from_memory(text, "ply"); };
  CHECK(read(ply("")).edges.empty());
  const std::string header = "element edge 2\nproperty int vertex1\nproperty int vertex2\nproperty uchar crease\n";
  CHECK(read(ply(header) + "0 1 1\n2 1 0\n").edges == Edges{{0, 1}, {2, 1}});
  const MeshFile lost = read(ply(header) + "0 7 1\n2 1 0\n");
  CHECK(lost.edges == Edges{{2, 1}});
  CHECK_FALSE(lost.remarks.empty());
  CHECK(read(ply("element edge 1\nproperty int a\n") + "5\n").edges.empty());
  CHECK_THROWS_WITH_AS((void)read(ply(header) + "0 x 1\n2 1 0\n"), doctest::Contains("'x'"), FileError);
}
