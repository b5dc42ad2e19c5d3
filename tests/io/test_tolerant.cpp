// SPDX-License-Identifier: MIT
//
// Files that are not as their format says, but whose meaning is certain: read, with a remark. And what is next to them
// and is not certain: refused.
#include <alcap/mesh_io.h>
#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>
#include <vector>

#include "alcap/generators.h"

using namespace alcap;

namespace {

const MeshData box = cube();

std::string number(double x) { return std::to_string(static_cast<int>(x)) + " "; }

/// The rows of the cube; `end` between the numbers, `behind` at the end of a vertex's row.
std::string rows(const std::string& between_vertices, const std::string& between_faces,
                 const std::string& behind = "") {
  std::string text;
  for (Eigen::Index v = 0; v < box.V.rows(); ++v) {
    for (int c = 0; c < 3; ++c) text += number(box.V(v, c));
    text += behind + between_vertices;
  }
  for (Eigen::Index t = 0; t < box.F.rows(); ++t) {
    text += "3 ";
    for (int c = 0; c < 3; ++c) text += number(box.F(t, c));
    text += between_faces;
  }
  return text;
}

std::string counts() { return std::to_string(box.V.rows()) + " " + std::to_string(box.F.rows()) + " 0"; }

MeshFile read(const std::string& bytes, const char* format = "") { return read_mesh_from_memory(bytes, format); }

void is_box(const std::string& bytes, std::size_t remarks, const char* format = "") {
  INFO(bytes.substr(0, 400));
  const MeshFile m = read(bytes, format);
  REQUIRE(m.V.rows() == box.V.rows());
  CHECK(m.V == box.V);
  CHECK(m.F == box.F);
  CHECK(m.remarks.size() == remarks);
}

void refused(const std::string& bytes, const char* part, const char* format = "") {
  INFO(bytes.substr(0, 400));
  try {
    (void)read(bytes, format);
    FAIL_CHECK("was read");
  } catch (const FileError& e) {
    INFO(e.what());
    CHECK(std::string(e.what()).find(part) != std::string::npos);
  }
}

template <class T>
void put(std::string& bytes, T value, bool big) {
  char data[sizeof(T)];
  std::memcpy(data, &value, sizeof(T));
  if (big == (std::endian::native == std::endian::little)) std::reverse(data, data + sizeof(T));
  bytes.append(data, sizeof(T));
}

std::string binary_off(const char* keyword, int behind, int colours) {
  std::string bytes = std::string(keyword) + " BINARY\n";
  for (const auto n : {box.V.rows(), box.F.rows(), Eigen::Index{0}}) put(bytes, static_cast<std::int32_t>(n), true);
  for (Eigen::Index v = 0; v < box.V.rows(); ++v) {
    for (int c = 0; c < 3; ++c) put(bytes, static_cast<float>(box.V(v, c)), true);
    for (int k = 0; k < behind; ++k) put(bytes, 0.5F, true);
  }
  for (Eigen::Index t = 0; t < box.F.rows(); ++t) {
    put(bytes, std::int32_t{3}, true);
    for (int c = 0; c < 3; ++c) put(bytes, static_cast<std::int32_t>(box.F(t, c)), true);
    put(bytes, std::int32_t{colours}, true);
    for (int k = 0; k < colours; ++k) put(bytes, 1.0F, true);
  }
  return bytes;
}

std::string ply_header(const char* format, const std::string& more_vertex = "", const std::string& line = "",
                       Eigen::Index vertices = box.V.rows()) {
  return std::string("ply\nformat ") + format + " 1.0\n" + line + "element vertex " + std::to_string(vertices) +
         "\nproperty float x\nproperty float y\nproperty float z\n" + more_vertex + "element face " +
         std::to_string(box.F.rows()) + "\nproperty list uchar int vertex_indices\nend_header\n";
}

std::string binary_ply() {
  std::string bytes = ply_header("binary_little_endian");
  for (Eigen::Index v = 0; v < box.V.rows(); ++v)
    for (int c = 0; c < 3; ++c) put(bytes, static_cast<float>(box.V(v, c)), false);
  for (Eigen::Index t = 0; t < box.F.rows(); ++t) {
    bytes += '\3';
    for (int c = 0; c < 3; ++c) put(bytes, static_cast<std::int32_t>(box.F(t, c)), false);
  }
  return bytes;
}

std::string binary_stl(std::uint32_t announced) {
  std::string bytes(80, ' ');
  put(bytes, announced, false);
  for (Eigen::Index t = 0; t < box.F.rows(); ++t) {
    for (int k = 0; k < 3; ++k) put(bytes, 0.0F, false);
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 3; ++k) put(bytes, static_cast<float>(box.V(box.F(t, c), k)), false);
    bytes += std::string(2, '\0');
  }
  return bytes;
}

std::string text_stl() {
  std::string text = "solid box\n";
  for (Eigen::Index t = 0; t < box.F.rows(); ++t) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (int c = 0; c < 3; ++c) {
      text += "vertex ";
      for (int k = 0; k < 3; ++k) text += number(box.V(box.F(t, c), k));
      text += "\n";
    }
    text += "endloop\nendfacet\n";
  }
  return text;
}

std::string obj_vertices() {
  std::string text;
  for (Eigen::Index v = 0; v < box.V.rows(); ++v) {
    text += "v ";
    for (int c = 0; c < 3; ++c) text += number(box.V(v, c));
    text += "\n";
  }
  return text;
}

std::string obj_faces(const char* word = "f") {
  std::string text;
  for (Eigen::Index t = 0; t < box.F.rows(); ++t) {
    text += std::string(word) + " ";
    for (int c = 0; c < 3; ++c) text += number(box.F(t, c) + 1);
    text += "\n";
  }
  return text;
}

}  // namespace

TEST_CASE("OFF: letters in any order, counts glued to the keyword, any layout, binary") {
  for (const char* keyword : {"OFF", "COFF", "NOFF", "STOFF", "CNOFF", "NCOFF", "STCNOFF", "NSTCOFF", "CSTOFF"})
    is_box(std::string(keyword) + "\n" + counts() + "\n" + rows("\n", "\n", "1 2 3 4"), 0);
  for (const char* keyword : {"4OFF", "nOFF", "C4OFF", "4COFF", "4nOFF"})
    refused(std::string(keyword) + "\n" + counts() + "\n" + rows("\n", "\n"), "not three-dimensional");
  for (const char* keyword : {"CCOFF", "XOFF", "OFFX", "OF"})
    refused(std::string(keyword) + "\n" + counts() + "\n" + rows("\n", "\n"), "starts with the word OFF", "off");
  is_box("OFF" + counts() + "\n" + rows("\n", "\n"), 0);
  is_box("OFF " + counts() + "\n" + rows("\n", "\n"), 0);
  // Line ends that mean nothing.
  is_box("OFF\n" + counts() + "\n" + rows("", ""), 1);
  is_box("OFF " + counts() + " " + rows(" ", " "), 1);
  std::string broken = "OFF\n" + counts() + "\n" + rows("\n", "\n");
  const std::size_t last = broken.rfind("\n3 ");
  std::replace(broken.begin() + static_cast<std::ptrdiff_t>(last) + 1, broken.end(), ' ', '\n');
  is_box(broken, 1);
  // A face that was cut is not the beginning of the next one.
  std::string cut = "OFF\n" + counts() + "\n" + rows("\n", "\n");
  cut.erase(cut.find('\n', cut.find("\n3 ") + 1) - 2, 2);
  refused(cut, "the line ends before corner");
  is_box(binary_off("OFF", 0, 0), 0);
  is_box(binary_off("CNOFF", 7, 4), 0);
  is_box(binary_off("STOFF", 2, 0), 0);
  const std::string whole = binary_off("OFF", 0, 0);
  for (std::size_t size = 12; size < whole.size(); size += 7) refused(whole.substr(0, size), "");
  refused(whole + "x", "more behind");
}

TEST_CASE("OBJ: statements of other programs are skipped, short faces left out") {
  const MeshFile plain = read(obj_vertices() + obj_faces());
  CHECK(plain.remarks.empty());
  is_box(obj_vertices() + "sm 1 2\nt 0 0\nvw 1 2\nsm 3 4\nx_y9\n" + obj_faces(), 1);
  const MeshFile odd = read(obj_vertices() + "sm 1 2\nt 0 0\nsm 3 4\n" + obj_faces());
  REQUIRE(odd.remarks.size() == 1);
  CHECK(odd.remarks[0].find("sm, t") != std::string::npos);
  CHECK(odd.ignored.size() == 2);
  is_box(obj_vertices() + obj_faces("fo"), 0);
  // Short faces keep their numbers.
  const MeshFile gaps = read(obj_vertices() + "f 1\n" + obj_faces() + "f 3 4\nf\n");
  CHECK(gaps.F == box.F);
  REQUIRE(gaps.polygon_of.size() == static_cast<std::size_t>(box.F.rows()));
  CHECK(gaps.polygon_of[0] == 1);
  CHECK(gaps.remarks.size() == 1);
  refused(obj_vertices() + "f 1 2\n", "2 corners; a face needs three");
  for (const char* line : {"V 0 0 0\n", "F 1 2 3\n", "1 2 3\n", "%x\n"})
    refused(obj_vertices() + line + obj_faces(), "is no OBJ statement");
}

TEST_CASE("vertices without a position are read unless a face uses them") {
  for (const char* nowhere : {"nan nan nan", "0 inf 0", "-1.#QNAN 1.#IND00 NaN", "0 0 -Infinity"}) {
    const bool odd = std::string(nowhere).find("IND00") != std::string::npos;
    const std::string line = odd ? "-1.#QNAN 1.#IND NaN" : nowhere;
    std::string obj = obj_vertices();
    obj += "v " + line + "\n" + obj_faces();
    const MeshFile m = read(obj);
    CHECK(m.V.rows() == box.V.rows() + 1);
    CHECK(m.V.allFinite());
    CHECK(m.F == box.F);
    CHECK(m.remarks.size() == 1);
    refused(obj + "f 1 2 9\n", "vertex 8");
    const std::string ply = ply_header("ascii", "", "", box.V.rows() + 1);
    std::string body = rows("\n", "\n");
    std::size_t at = 0;
    for (Eigen::Index v = 0; v < box.V.rows(); ++v) at = body.find('\n', at) + 1;
    body.insert(at, line + "\n");
    CHECK(read(ply + body).remarks.size() == 1);
  }
}

TEST_CASE("PLY: bytes behind the data, wrapped lists, properties twice, lines without a keyword") {
  is_box(ply_header("ascii") + rows("\n", "\n"), 0);
  for (const char* between : {" ", "\n\n", "\n \n"})
    is_box(ply_header("ascii") + rows(between, between), between[0] == ' ');
  std::string wrapped = rows("\n", "\n");
  std::replace(wrapped.begin(), wrapped.end(), ' ', '\n');
  is_box(ply_header("ascii") + wrapped, 1);
  refused(ply_header("ascii") + wrapped + "7\n", "");
  refused(ply_header("ascii") + wrapped.substr(0, wrapped.size() - 4), "");
  is_box(ply_header("ascii", "property float q\nproperty float q\n") + rows("\n", "\n", "1 2"), 1);
  refused(ply_header("ascii", "property float x\n") + rows("\n", "\n", "1"), "announced twice");
  is_box(ply_header("ascii", "", "Created by hand, without the word\n") + rows("\n", "\n"), 1);
  refused(ply_header("ascii", "propertyy float q\n") + rows("\n", "\n", "1"), "does not belong");
  is_box(binary_ply(), 0);
  is_box(binary_ply() + "\n", 1);
  is_box(binary_ply() + "\r\n", 1);
  refused(binary_ply() + std::string(13, '\3'), "more behind");
  refused(binary_ply().substr(0, binary_ply().size() - 1), "cut");
}

TEST_CASE("STL: counts of 0 and too small, bytes behind the data, no endsolid") {
  const auto count = static_cast<std::uint32_t>(box.F.rows());
  const MeshFile whole = read(binary_stl(count), "stl");
  CHECK(whole.remarks.empty());
  const auto same = [&](const std::string& bytes, std::size_t remarks) {
    const MeshFile m = read(bytes, "stl");
    CHECK(m.V == whole.V);
    CHECK(m.F == whole.F);
    CHECK(m.remarks.size() == remarks);
  };
  same(binary_stl(0), 1);
  same(binary_stl(count - 1), 1);
  same(binary_stl(count) + "\n", 1);
  same(binary_stl(count) + std::string(49, '\0'), 1);
  refused(binary_stl(count + 1), "announces", "stl");
  refused(binary_stl(count - 2) + "\n", "announces", "stl");
  same(text_stl() + "endsolid box\n", 0);
  same(text_stl(), 1);
  std::string cut = text_stl();
  refused(cut.substr(0, cut.size() - 12), "belongs");
}
