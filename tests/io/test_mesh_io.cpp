// SPDX-License-Identifier: MIT
//
// Mesh files: what is read is what was written, in every format and with every habit of the programs that write them.
// Broken files are in test_mesh_io_broken.cpp.
#include <alcap/mesh_io.h>
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>

#include "tests/support/folder.h"
#include "tests/support/mesh_files.h"

using namespace alcap;
using mesh_files::encode;
using mesh_files::raw;
namespace fs = std::filesystem;

namespace {

bool same_bits(const Positions<double>& a, const Positions<double>& b) {
  if (a.rows() != b.rows()) return false;
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    if (std::bit_cast<std::uint64_t>(a.data()[i]) != std::bit_cast<std::uint64_t>(b.data()[i])) return false;
  }
  return true;
}

MeshFile parse(const std::string& bytes, const char* format = "") { return read_mesh_from_memory(bytes, format); }

// The unit square of two triangles, as most quirks below write it.
Positions<double> square_points() {
  Positions<double> V(4, 3);
  V << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0;
  return V;
}
Faces square_faces() {
  Faces F(2, 3);
  F << 0, 1, 2, 0, 2, 3;
  return F;
}
void check_square(const std::string& bytes, const char* format) {
  INFO(bytes);
  const MeshFile m = parse(bytes);
  CHECK(m.format == format);
  CHECK(m.V == square_points());
  CHECK(m.F == square_faces());
  CHECK(m.bytes == static_cast<std::int64_t>(bytes.size()));
}

void put(const fs::path& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

// Twice the area vector of a polygon and of a set of triangles.
Eigen::RowVector3d area_of(const Positions<double>& V, const std::vector<Index>& polygon) {
  Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::RowVector3d a = V.row(polygon[i]), b = V.row(polygon[(i + 1) % polygon.size()]);
    sum += a.cross(b);
  }
  return sum;
}

// Reads a polygon in the plane (turned into space) and checks that its triangles tile it.
void check_polygon(const std::vector<std::array<double, 2>>& points) {
  Eigen::Matrix3d turned = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (std::size_t first = 0; first < points.size(); ++first) {  // the result must not hinge on the first corner
    std::string text, face = "f";
    std::vector<Index> polygon;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto& p = points[(first + i) % points.size()];
      const Eigen::Vector3d q = turned * Eigen::Vector3d(p[0], p[1], 5);
      text += mesh_files::print("v %.17g %.17g %.17g\n", q.x(), q.y(), q.z());
      face += " " + std::to_string(i + 1);
      polygon.push_back(static_cast<Index>(i));
    }
    const MeshFile m = parse(text + face + "\n");
    const auto k = static_cast<Eigen::Index>(points.size());
    REQUIRE(m.F.rows() == k - 2);
    CHECK(m.polygon_of == std::vector<Index>(static_cast<std::size_t>(k - 2), 0));
    const Eigen::RowVector3d whole = area_of(m.V, polygon);
    double sum = 0;
    std::set<Index> used;
    for (Eigen::Index t = 0; t < m.F.rows(); ++t) {
      const Eigen::RowVector3d area = area_of(m.V, {m.F(t, 0), m.F(t, 1), m.F(t, 2)});
      CHECK(area.dot(whole) > 1e-6 * whole.squaredNorm());  // no triangle is flipped or flat
      sum += area.norm();
      used.insert(m.F.row(t).begin(), m.F.row(t).end());
    }
    CHECK(sum == doctest::Approx(whole.norm()).epsilon(1e-12));  // positive areas that add up cannot overlap
    CHECK(used.size() == points.size());
  }
}

}  // namespace

TEST_CASE("every encoding is read back bit for bit, numbering included") {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 20; ++trial) {
    for (const auto& encoding : mesh_files::encodings) {
      CAPTURE(encoding.name);
      Positions<double> V;
      Faces F;
      mesh_files::random_strip(random, 3 + trial * 7, std::string(encoding.name) == "stl binary", V, F);
      const MeshFile m = parse(encode(encoding.name, V, F));
      CHECK(m.format == encoding.format);
      CHECK(same_bits(m.V, V));
      CHECK(m.F == F);
      CHECK(m.polygon_of.empty());
    }
  }
}

TEST_CASE("written files come back bit for bit") {
  test::Folder folder;
  std::mt19937_64 random(2);
  Positions<double> V;
  Faces F;
  mesh_files::random_strip(random, 500, false, V, F);
  V.row(3) << -0.0, std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::max();
  V.row(4) << 0.1, 1.0 / 3, -std::numeric_limits<double>::min();
  for (const char* name : {"a.off", "a.obj", "a.ply", "B.OBJ"}) {
    CAPTURE(name);
    write_mesh(folder.path / name, V, F);
    const MeshFile m = read_mesh(folder.path / name);
    CHECK(same_bits(m.V, V));
    CHECK(m.F == F);
  }
  CHECK(std::distance(fs::directory_iterator(folder.path), fs::directory_iterator()) == 4);  // no temporary is left
}

TEST_CASE("numbers are the nearest doubles of their decimals") {
  const char* const texts[] = {"0.1", "+2.5", "-.5", "5.", "1E3", "1e-320", "123456789012345678901234567890",
                               "-0",  "7"};
  const double values[] = {0.1, 2.5, -0.5, 5.0, 1000.0, 1e-320, 123456789012345678901234567890.0, -0.0, 7.0};
  std::string text;
  for (int i = 0; i < 9; ++i) text += std::string(i % 3 == 0 ? "\nv" : "") + " " + texts[i];
  const MeshFile m = parse(text + "\nf 1 2 3");
  for (int i = 0; i < 9; ++i)
    CHECK(std::bit_cast<std::uint64_t>(m.V(i / 3, i % 3)) == std::bit_cast<std::uint64_t>(values[i]));
}

TEST_CASE("OBJ: the habits of its writers") {
  const std::string v = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  check_square(v + "f 1 2 3\nf 1 3 4", "obj");                                        // no newline at the end
  check_square(v + "f -4 -3 -2\nf -4 -2 -1\n", "obj");                                // from the end
  check_square("v 0 0 0\nv 1 0 0\nv 1 1 0\nf -3 -2 -1\nv 0 1 0\nf 1 -2 4\n", "obj");  // the end moves
  check_square("f 1 2 3\nf 1 3 4\n" + v, "obj");                                      // faces first
  check_square(v + "vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\nf 1/1/1 3/1/1 4/1/1\n", "obj");
  check_square(v + "vt 0 0\nvn 0 0 1\nf 1//1 2//1 3//-1\nf 1/1 3/-1 4/1\n", "obj");
  check_square("v 0 0 0 1\nv 1 0 0 0.5\nv 1 1 0 .1 .2 .3\nv 0 1 0 1 255 0 0\nf 1 2 3\nf 1 3 4\n", "obj");
  check_square(
      "# c\n\n  mtllib a.mtl\no thing\ng a b\ns off\nusemtl m\n" + v + "\tf 1 2 3  \n g x # y\nf 1 3 4 # end\n", "obj");
  check_square("v 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nf 1 2 3\r\nf 1 3 4\r\n", "obj");
  check_square("v 0 0 0\rv 1 0 0\rv 1 1 0\rv 0 1 0\rf 1 2 3\rf 1 3 4\r", "obj");
  check_square("v 0 0 \\\n0\nv 1\\\n 0 0\nv 1 1 0\nv 0 \\\r\n 1 0\nf 1 2 \\\n  3\nf 1 3 4", "obj");
  check_square("l 1 2 \\\n 3\n# a path\\\n" + v + "f 1 2 3\nf 1 3 4\n", "obj");  // joined; not in a comment
  check_square("\xEF\xBB\xBF" + v + "f 1 2 3\nf 1 3 4\n", "obj");
  check_square(v + "f 1 2 3\nf 1 3 4\ncstype bezier\ncurv 0 1 1 2\nend\np 1\n", "obj");

  const MeshFile m = parse(v + "vt 0 0\nvt 1 0\nl 1 2\nf 1 2 3\nvt 1 1\n");
  REQUIRE(m.ignored.size() == 2);
  CHECK(m.ignored[0].kind == "vt");
  CHECK(m.ignored[0].count == 3);
  CHECK(m.ignored[1].kind == "l");
  CHECK(m.V.rows() == 4);  // the unreferenced vertex stays
}

TEST_CASE("OFF: headers, comments, colours") {
  const std::string v = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n", f = "3 0 1 2\n3 0 2 3\n";
  check_square("OFF\n4 2 0\n" + v + f, "off");
  check_square("OFF 4 2 5\n" + v + f, "off");
  check_square("OFF\n4 2\n" + v + f, "off");
  check_square("# c\n\nOFF # c\n# c\n4 2 0 # c\n\n0 0 0 # c\n# c\n1 0 0\n1 1 0\n0 1 0\n#\n" + f + "# c\n\n", "off");
  check_square("  OFF\r\n4 2 0\r\n0 0 0\r\n1 0 0\r\n1 1 0\r\n0 1 0\r\n3 0 1 2\r\n3 0 2 3\r\n", "off");
  const std::string colours = "0 0 0 1 0 0 1\n1 0 0 1 0 0 1\n1 1 0 1 0 0 1\n0 1 0 1 0 0 1\n";
  for (const char* word : {"OFF", "COFF", "NOFF", "CNOFF", "STOFF", "STCNOFF", "STNOFF"}) {
    check_square(word + ("\n4 2 0\n" + colours) + "3 0 1 2 255 0 0\n3 0 2 3 0.1 0.2 0.3 1\n", "off");
  }
}

TEST_CASE("PLY: any property, any order, any type, both endians") {
  const std::string header =
      "element extra 2\nproperty list uchar double weights\nproperty short s\n"
      "element vertex 4\nproperty uchar red\nproperty float z\nproperty list int short tags\nproperty char x\nproperty "
      "double y\n"
      "element face 2\nproperty float quality\nproperty list ushort uint vertex_index\nproperty list char float uv\n"
      "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n";
  const auto start = [&](const char* encoding) {
    return "ply\nformat " + std::string(encoding) + " 1.0\nobj_info x\n" + header;
  };
  const auto check = [](const std::string& bytes) {
    check_square(bytes, "ply");
    const MeshFile m = parse(bytes);
    REQUIRE(m.ignored.size() == 2);
    CHECK(m.ignored[0].kind == "extra");
    CHECK(m.ignored[1].kind == "edge");
  };
  check(start("ascii") + "2 nan 1e999 3\n0 -7\n255 0 0 0 0\n9 0 1 -1 1 0\n9 0 2 5 6 1 1\n9 0 0 0 1\n" +
        "nan 3 0 1 2 0\ninf 3 0 2 3 1 0.5\n0 1\n");
  for (const bool big : {false, true}) {
    std::string b = start(big ? "binary_big_endian" : "binary_little_endian");
    b += raw(std::uint8_t{2}) + raw(1.5, big) + raw(std::nan(""), big) + raw(std::int16_t{3}, big);
    b += raw(std::uint8_t{0}) + raw(std::int16_t{-7}, big);
    for (int i = 0; i < 4; ++i) {
      b += raw(std::uint8_t{13}) + raw(0.0F, big) + raw(std::int32_t{i}, big);
      for (int k = 0; k < i; ++k) b += raw(std::int16_t{10}, big);
      b += raw(static_cast<std::int8_t>(i == 1 || i == 2)) + raw(i < 2 ? 0.0 : 1.0, big);
    }
    for (std::uint32_t t = 0; t < 2; ++t) {
      b += raw(std::nanf(""), big) + raw(std::uint16_t{3}, big);
      for (const std::uint32_t i : {0U, 1U + t, 2U + t}) b += raw(i, big);
      b += raw(static_cast<std::int8_t>(t));
      for (std::uint32_t k = 0; k < t; ++k) b += raw(0.5F, big);
    }
    check(b + raw(0, big) + raw(1, big));
  }
  // The byte behind the header may look like a line end; a header with CRLF ends after both.
  for (const char* end : {"\n", "\r\n"}) {
    std::string b =
        "ply?format binary_little_endian 1.0?element vertex 3?property char x?property char y?property char z?"
        "element face 1?property list uchar uchar vertex_indices?end_header?";
    for (auto at = b.find('?'); at != b.npos; at = b.find('?')) b.replace(at, 1, end);
    const MeshFile m = parse(b + "\n\r " + "abc" + "def" + std::string("\3\0\1\2", 4));
    CHECK(m.V.row(0) == Eigen::RowVector3d(10, 13, 32));
    CHECK(m.V.row(2) == Eigen::RowVector3d(100, 101, 102));
  }
}

TEST_CASE("STL: welded by exact position, numbered by first appearance") {
  Positions<double> V(6, 3);
  V << 0, 0, 0, 1, 0, 0, 1, 1, 0, -0.0, 0, -0.0, 1, 1, 0, 0, 1, 0;
  Faces F(2, 3);
  F << 0, 1, 2, 3, 4, 5;
  check_square(encode("stl binary", V, F), "stl");  // begins with "solid"
  check_square(encode("stl ascii", V, F), "stl");
  V(4, 0) = std::nextafter(1.0, 2.0);
  CHECK(parse(encode("stl ascii", V, F)).V.rows() == 5);  // near is not the same
  check_square(
      "SOLID\n FACET NORMAL nan nan nan\r\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1 0 0\nVERTEX 1 1 0\nENDLOOP\nENDFACET\n"
      "endsolid a\nsolid b\nfacet\nouter loop vertex 0 0 0 vertex 1 1 0 vertex 0 1 0 endloop endfacet endsolid",
      "stl");

  std::mt19937_64 random(3);  // against the obvious algorithm, on a lattice where most corners coincide
  Positions<double> soup(3000, 3);
  for (Eigen::Index i = 0; i < soup.size(); ++i) soup.data()[i] = static_cast<double>(random() % 8) - 4;
  Faces corners(1000, 3);
  for (Index i = 0; i < 3000; ++i) corners.data()[i] = i;
  for (const char* encoding : {"stl ascii", "stl binary"}) {
    const MeshFile m = parse(encode(encoding, soup, corners));
    std::vector<Eigen::RowVector3d> seen;
    for (Index i = 0; i < 3000; ++i) {
      auto at = std::find(seen.begin(), seen.end(), soup.row(i));
      if (at == seen.end()) at = seen.insert(at, soup.row(i));
      REQUIRE(m.F.data()[i] == at - seen.begin());
    }
    REQUIRE(m.V.rows() == static_cast<Eigen::Index>(seen.size()));
    for (std::size_t i = 0; i < seen.size(); ++i) CHECK(m.V.row(static_cast<Eigen::Index>(i)) == seen[i]);
  }
}

TEST_CASE("the content decides about the format, then the extension") {
  test::Folder folder;
  for (const auto& encoding : mesh_files::encodings) {
    for (const char* name : {"a.obj", "a.stl", "a.txt", "a"}) {
      put(folder.path / name, encode(encoding.name, square_points(), square_faces()));
      const MeshFile m = read_mesh(folder.path / name);
      CHECK(m.format == encoding.format);
      CHECK(m.F == square_faces());
    }
  }
  CHECK(mesh_formats().size() == 4);
}

TEST_CASE("polygons become triangles that tile them") {
  check_polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  check_polygon({{0, 0}, {2, 0}, {2, 2}, {1.6, 0.4}});                              // concave quad
  check_polygon({{0, 0}, {1, 0}, {2, 0}, {1, 2}});                                  // a corner within a side
  check_polygon({{0, 0}, {4, 0}, {4, 3}, {3, 3}, {3, 1}, {1, 1}, {1, 3}});          // concave, seven corners
  check_polygon({{0, 0}, {3, -1}, {2, 1}, {3, 3}, {1, 2}, {-1, 4}, {-0.5, 1.5}});   // concave, seven corners
  check_polygon({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 1}, {3, 2}, {3, 3}, {0, 3}});  // several within sides
  check_polygon(
      {{0, 0}, {9, 0}, {9, 9}, {1, 9}, {1, 3}, {6, 3}, {6, 6}, {3, 6}, {3, 7}, {7, 7}, {7, 2}, {0, 2}});  // spiral
  std::vector<std::array<double, 2>> star;
  for (int i = 0; i < 60; ++i)
    star.push_back({(i % 2 ? 1 : 3) * std::cos(i * 0.1047), (i % 2 ? 1 : 3) * std::sin(i * 0.1047)});
  check_polygon(star);
}

TEST_CASE("polygons keep the numbers of vertices and faces, or are refused") {
  const std::string v = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n";
  const MeshFile m = parse("f 5 2 3\n" + v + "f 1 2 3 4\nf 5 6 3\n");
  CHECK(m.V.rows() == 6);
  Faces F(4, 3);
  F << 4, 1, 2, 0, 1, 2, 0, 2, 3, 4, 5, 2;
  CHECK(m.F == F);
  CHECK(m.polygon_of == std::vector<Index>{0, 1, 1, 2});
  ReadOptions strict{.polygons = ReadOptions::Polygons::refuse};
  CHECK_THROWS_AS(std::ignore = read_mesh_from_memory(v + "f 1 2 3\nf 1 2 3 4\n", "", strict), FileError);
  CHECK(read_mesh_from_memory(v + "f 1 2 3\n", "", strict).F.rows() == 1);
  // Without area or crossing itself: still k - 2 triangles on its own corners.
  CHECK(parse(v + "f 1 2 5 2\n").F.rows() == 2);
  CHECK(parse(v + "f 1 3 2 4 5\n").F.rows() == 3);
  CHECK(parse("v 7 7 7\nf 1 1 1 1 1\n").F.rows() == 3);
}
